/* Memory that runs out and a camera that is unplugged: at every place, told and without a trace. */
#include "base/memory.h"
#include "tests/genicam/memory_port.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

/* Everything that a driver asks of a camera; returns the first status that is not good. */
static int use(struct memory *memory) {
  placido_genicam *features = memory->features;
  placido_error *err = &memory->err;
  placido_feature feature;
  int64_t whole;
  double real;
  char text[64];
  int status = placido_genicam_describe(features, "Gain", &feature, err);
  status = status ? status : placido_genicam_describe(features, "ExposureTime", &feature, err);
  status = status ? status : placido_genicam_get_float(features, "Gain", &real, err);
  status = status ? status : placido_genicam_set_float(features, "Gain", 3.59, err);
  status = status ? status : placido_genicam_set_float(features, "ExposureTime", 2000, err);
  status = status ? status : placido_genicam_get_integer(features, "LUTValue", &whole, err);
  status = status ? status : placido_genicam_set_integer(features, "LUTValue", 5, err);
  status = status ? status
                  : placido_genicam_get_text(features, "ExposureAuto", text, sizeof text, err);
  status = status ? status : placido_genicam_set_text(features, "TriggerSource", "Software", err);
  status = status ? status : placido_genicam_execute(features, "TriggerSoftware", err);
  return status;
}

static void open_camera(struct memory *memory) {
  memory_open_file(memory, "converted.xml");
  memory_put(memory, 0x48, 4, true, 0xC0000000);
  memory_put(memory, 0x54, 4, true, 12500);
  memory_put(memory, 0x58, 4, true, 40000);
  memory_put(memory, 0x5C, 4, true, 1);
}

static void an_unplugged_camera_is_told_at_every_access(void **state) {
  (void)state;
  struct memory memory;
  open_camera(&memory);
  assert_int_equal(use(&memory), PLACIDO_OK);
  const unsigned accesses = memory.reads + memory.writes;
  assert_true(accesses > 10);
  memory_close(&memory);
  for (unsigned i = 1; i <= accesses; i++) {
    open_camera(&memory);
    memory.until_failure = i;
    assert_int_equal(use(&memory), PLACIDO_GONE);
    assert_says(&memory, "the camera was unplugged");
    /* Plugged in again, it works. */
    placido_genicam_forget(memory.features);
    assert_int_equal(use(&memory), PLACIDO_OK);
    memory_close(&memory);
  }
}

static void memory_that_runs_out_is_told_while_reading(void **state) {
  (void)state;
  char nodes[8192];
  size_t length = 0;
  for (int i = 0; i < 150; i++) { /* enough that every table grows */
    length += (size_t)snprintf(nodes + length, sizeof nodes - length,
                               "<Integer Name=\"N%d\"><Value>1</Value></Integer>", i);
  }
  struct memory memory;
  placido_memory_fail_at(0);
  memory_open_nodes(&memory, nodes);
  memory_close(&memory);
  const unsigned long allocations = placido_memory_fail_at(0);
  assert_true(allocations > 8);
  for (unsigned long i = 1; i <= allocations; i++) {
    placido_memory_fail_at(i);
    const int status = memory_try(&memory, nodes);
    placido_memory_fail_at(0);
    assert_int_equal(status, PLACIDO_MEMORY);
    assert_null(memory.features);
    assert_says(&memory, "out of memory");
  }
}

static void memory_that_runs_out_is_told_with_texts(void **state) {
  (void)state;
  struct memory memory;
  char text[64];
  memory_open_nodes(&memory, "<StringReg Name=\"S\"><Address>0</Address><Length>32</Length>"
                             "<AccessMode>RW</AccessMode></StringReg>");
  placido_memory_fail_at(1);
  assert_int_equal(
      placido_genicam_get_text(memory.features, "S", text, sizeof text, &memory.err),
      PLACIDO_MEMORY);
  placido_memory_fail_at(1);
  assert_int_equal(placido_genicam_set_text(memory.features, "S", "x", &memory.err),
                   PLACIDO_MEMORY);
  placido_memory_fail_at(0);
  assert_int_equal(memory.reads + memory.writes, 0);
  memory_close(&memory);
}

static void nothing_is_freed_well(void **state) {
  (void)state;
  placido_genicam_free(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_unplugged_camera_is_told_at_every_access),
      cmocka_unit_test(memory_that_runs_out_is_told_while_reading),
      cmocka_unit_test(memory_that_runs_out_is_told_with_texts),
      cmocka_unit_test(nothing_is_freed_well),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

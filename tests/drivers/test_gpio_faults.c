/* Whatever call on a GPIO chip fails: no crash, no hang, nothing held, no light left on. */
#include "base/memory.h"
#include "drivers/gpio/gpio.h"
#include "tests/drivers/gpio_fake.h"

#include <errno.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

static const placido_driver *const driver = &placido_gpio_driver;

/* How many calls a day with a chip may take, at most: a loop would pass it. */
#define CALLS_MAX 2000

static void set_up(void) {
  gpio_fake_reset();
  gpio_fake.lines[5].name = "RINGLIGHT";
  for (int i = 0; i < 6; i++) {
    gpio_fake_pull(100 + 50 * i, 7, 1 - i % 2);
    gpio_fake_pull(110 + 50 * i, 4, 1);
    gpio_fake_pull(111 + 50 * i, 4, 0);
  }
}

static void assert_told(int status, const placido_error *err) {
  if (status != PLACIDO_OK && !err->text[0]) {
    fail_msg("status %d without a sentence", status);
  }
  if (status != PLACIDO_OK) {
    assert_int_equal(err->status, status);
  }
}

static int first_of(int first, int status, const placido_error *err) {
  assert_told(status, err);
  return first ? first : status;
}

/* Lights up, listens, stops. */
static int run_a_round(void *chip) {
  placido_error err = {0};
  placido_event event;
  int first = first_of(PLACIDO_OK, driver->start(chip, &err), &err);
  if (first) {
    return first;
  }
  first = first_of(first, driver->set(chip, 0, 1, &err), &err);
  for (int i = 0; i < 4; i++) {
    first = first_of(first, driver->event(chip, &event, 200, &err), &err);
  }
  return first_of(first, driver->stop(chip, &err), &err);
}

/* Returns the first status that is not PLACIDO_OK. */
static int run_a_day(void) {
  void *chip = NULL;
  placido_error err = {0};
  int first = placido_gpio_open(&chip, "fake?light=RINGLIGHT&trigger=4&pedal=7", &gpio_fake_lines,
                                NULL, &err);
  assert_told(first, &err);
  assert_true((first == PLACIDO_OK) == (chip != NULL));
  for (int round = 0; chip && round < 2; round++) {
    const int status = run_a_round(chip);
    first = first ? first : status;
  }
  if (chip) {
    driver->close(chip);
  }
  assert_int_equal(gpio_fake.open_count, 0);
  assert_int_equal(gpio_fake.requested_count, 0);
  assert_true(gpio_fake.call_count < CALLS_MAX);
  return first;
}

static void every_call_may_fail_in_every_way(void **state) {
  (void)state;
  static const int codes[] = {EINTR, EAGAIN, EIO, ENODEV, EINVAL, ENOMEM, EBUSY, ENXIO, EPERM};
  int failed_runs = 0;
  set_up();
  assert_int_equal(run_a_day(), PLACIDO_OK);
  const int calls = gpio_fake.call_count;
  assert_true(calls > 40);
  for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
    for (int n = 1; n <= calls; n++) {
      for (int for_ever = 0; for_ever < 2; for_ever++) {
        set_up();
        gpio_fake.fail_at = n;
        gpio_fake.fail_code = codes[i];
        gpio_fake.fails_for_ever = for_ever;
        failed_runs += run_a_day() != PLACIDO_OK;
        /* one failure may be of the switching off itself; close tries once more */
        assert_true(for_ever || gpio_fake.lines[5].voltage == 0);
      }
    }
  }
  assert_true(failed_runs > 100); /* the faults did arrive */
}

static void every_moment_may_be_the_unplugging(void **state) {
  (void)state;
  for (int ms = 0; ms < 400; ms += 3) {
    set_up();
    gpio_fake.unplug_ns = gpio_fake.clock_ns + (int64_t)ms * FAKE_MS;
    run_a_day();
  }
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    set_up();
    placido_memory_fail_at(n);
    status = run_a_day();
    placido_memory_fail_at(0);
  }
  assert_int_equal(status, PLACIDO_OK);
}

static void absurd_times_are_survived(void **state) {
  (void)state;
  static const int64_t offsets_ns[] = {-1, -5000000000, -6000000000, 1, 1000000000, 1LL << 62};
  for (size_t i = 0; i < sizeof offsets_ns / sizeof *offsets_ns; i++) {
    set_up();
    gpio_fake.clock_offset_ns = offsets_ns[i];
    run_a_day();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_call_may_fail_in_every_way),
      cmocka_unit_test(every_moment_may_be_the_unplugging),
      cmocka_unit_test(every_allocation_may_fail),
      cmocka_unit_test(absurd_times_are_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Memory behind a port. */
#include "tests/genicam/memory_port.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Counts the access; fails where its turn has come, or it lies outside. */
static int begin(struct memory *memory, uint64_t address, size_t size, placido_error *err) {
  memory->address = address;
  memory->size = size;
  if (memory->until_failure > 0 && --memory->until_failure == 0) {
    return placido_error_set(err, PLACIDO_GONE, "the camera was unplugged");
  }
  if (address > MEMORY_BYTES || size > MEMORY_BYTES - address) {
    return placido_error_set(err, PLACIDO_SYSTEM, "no register at 0x%llx",
                             (unsigned long long)address);
  }
  return PLACIDO_OK;
}

static int read_memory(void *user, uint64_t address, void *bytes, size_t size,
                       placido_error *err) {
  struct memory *memory = user;
  memory->reads++;
  const int status = begin(memory, address, size, err);
  if (!status) {
    memcpy(bytes, memory->bytes + address, size);
  }
  return status;
}

static int write_memory(void *user, uint64_t address, const void *bytes, size_t size,
                        placido_error *err) {
  struct memory *memory = user;
  memory->writes++;
  const int status = begin(memory, address, size, err);
  if (!status) {
    memcpy(memory->bytes + address, bytes, size);
  }
  return status;
}

void memory_reset(struct memory *memory) {
  memset(memory, 0, sizeof *memory);
  memory->port = (placido_genicam_port){read_memory, write_memory, memory};
}

void memory_open_file(struct memory *memory, const char *name) {
  char path[1024];
  memory_reset(memory);
  snprintf(path, sizeof path, "%s/genicam/%s", PLACIDO_TEST_DATA, name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char *xml = malloc(1 << 20);
  assert_non_null(xml);
  const size_t size = fread(xml, 1, 1 << 20, file);
  fclose(file);
  assert_int_equal(
      placido_genicam_read(&memory->features, xml, size, &memory->port, &memory->err),
      PLACIDO_OK);
  free(xml); /* it is not kept */
}

int memory_try(struct memory *memory, const char *nodes) {
  memory_reset(memory);
  const size_t size = strlen(nodes) + 100;
  char *xml = malloc(size);
  assert_non_null(xml);
  snprintf(xml, size, "<RegisterDescription>%s</RegisterDescription>", nodes);
  const int status =
      placido_genicam_read(&memory->features, xml, strlen(xml), &memory->port, &memory->err);
  free(xml);
  return status;
}

void memory_open_nodes(struct memory *memory, const char *nodes) {
  assert_int_equal(memory_try(memory, nodes), PLACIDO_OK);
  assert_non_null(memory->features);
}

void memory_close(struct memory *memory) {
  placido_genicam_free(memory->features);
  memory->features = NULL;
}

void memory_put(struct memory *memory, uint64_t address, size_t size, bool is_big_endian,
                uint64_t value) {
  for (size_t i = 0; i < size; i++) {
    memory->bytes[address + (is_big_endian ? size - 1 - i : i)] = (uint8_t)(value >> 8 * i);
  }
}

uint64_t memory_take(const struct memory *memory, uint64_t address, size_t size,
                     bool is_big_endian) {
  uint64_t value = 0;
  for (size_t i = 0; i < size; i++) {
    value |= (uint64_t)memory->bytes[address + (is_big_endian ? size - 1 - i : i)] << 8 * i;
  }
  return value;
}

int64_t integer_of(struct memory *memory, const char *name) {
  int64_t value;
  const int status = placido_genicam_get_integer(memory->features, name, &value, &memory->err);
  if (status) {
    fail_msg("%s: %s", name, memory->err.text);
  }
  return value;
}

double float_of(struct memory *memory, const char *name) {
  double value;
  const int status = placido_genicam_get_float(memory->features, name, &value, &memory->err);
  if (status) {
    fail_msg("%s: %s", name, memory->err.text);
  }
  return value;
}

placido_feature description_of(struct memory *memory, const char *name) {
  placido_feature feature;
  const int status = placido_genicam_describe(memory->features, name, &feature, &memory->err);
  if (status) {
    fail_msg("%s: %s", name, memory->err.text);
  }
  return feature;
}

void assert_says(const struct memory *memory, const char *words) {
  if (!strstr(memory->err.text, words)) {
    fail_msg("\"%s\" does not say \"%s\"", memory->err.text, words);
  }
}

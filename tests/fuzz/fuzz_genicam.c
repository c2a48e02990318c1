/* A camera's description and everything that can be asked of it, with registers that answer. */
#include "drivers/genicam/genicam.h"
#include "tests/fuzz/target.h"

#include <string.h>

#define FEATURES_MAX 24

struct fuzz {
  placido_genicam *features;
  uint8_t bytes[256];
  unsigned count;
};

static int read_port(void *user, uint64_t address, void *bytes, size_t size, placido_error *err) {
  const struct fuzz *fuzz = user;
  uint8_t *to = bytes;
  if (address % 256 == 255) {
    return placido_error_set(err, PLACIDO_GONE, "gone");
  }
  for (size_t i = 0; i < size; i++) {
    to[i] = fuzz->bytes[(address + i) % sizeof fuzz->bytes];
  }
  return PLACIDO_OK;
}

static int write_port(void *user, uint64_t address, const void *bytes, size_t size,
                      placido_error *err) {
  struct fuzz *fuzz = user;
  const uint8_t *from = bytes;
  (void)err;
  for (size_t i = 0; i < size; i++) {
    fuzz->bytes[(address + i) % sizeof fuzz->bytes] = from[i];
  }
  return PLACIDO_OK;
}

static int try_entry(void *user, const char *entry, int64_t value) {
  struct fuzz *fuzz = user;
  (void)value;
  return ++fuzz->count > 4 * FEATURES_MAX || !entry[0];
}

static int try_feature(void *user, const char *name, const char *category) {
  struct fuzz *fuzz = user;
  placido_genicam *features = fuzz->features;
  placido_feature feature;
  placido_error err;
  int64_t whole;
  double real;
  char text[40];
  (void)category;
  placido_genicam_describe(features, name, &feature, &err);
  if (placido_genicam_get_integer(features, name, &whole, &err) == PLACIDO_OK) {
    placido_genicam_set_integer(features, name, whole, &err);
  }
  if (placido_genicam_get_float(features, name, &real, &err) == PLACIDO_OK) {
    placido_genicam_set_float(features, name, real / 3, &err);
  }
  if (placido_genicam_get_text(features, name, text, sizeof text, &err) == PLACIDO_OK) {
    placido_genicam_set_text(features, name, text, &err);
  }
  placido_genicam_execute(features, name, &err);
  placido_genicam_entries(features, name, try_entry, fuzz, &err);
  return ++fuzz->count >= FEATURES_MAX;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  struct fuzz fuzz = {0};
  for (size_t i = 0; i < sizeof fuzz.bytes; i++) {
    fuzz.bytes[i] = (uint8_t)(i * 7);
  }
  const placido_genicam_port port = {read_port, write_port, &fuzz};
  if (placido_genicam_read(&fuzz.features, (const char *)data, size, &port, NULL) == PLACIDO_OK) {
    placido_genicam_each(fuzz.features, try_feature, &fuzz, NULL);
  }
  placido_genicam_free(fuzz.features);
  return 0;
}

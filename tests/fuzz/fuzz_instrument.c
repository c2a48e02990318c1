/* Instrument files: what is read is within its ranges, and reads back the same once written. */
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <placido/uncertainty.h>

#include <math.h>
#include <string.h>

static void check_instrument(const placido_instrument *instrument) {
  placido_instrument copy = *instrument;
  FUZZ_REQUIRE(instrument->edge_count >= 1 && instrument->edge_count <= PLACIDO_EDGES_MAX);
  FUZZ_REQUIRE(instrument->width_px > 0 && instrument->width_px <= 65536);
  FUZZ_REQUIRE(instrument->height_px > 0 && instrument->height_px <= 65536);
  FUZZ_REQUIRE(memchr(instrument->name, '\0', sizeof instrument->name) != NULL);
  FUZZ_REQUIRE(instrument->focal_px[0] > 0 && instrument->focal_px[1] > 0);
  FUZZ_REQUIRE(instrument->position_mm[2] > 0);
  for (int k = 0; k < PLACIDO_UNCERTAINTY_CAMERA + 2 * instrument->edge_count; k++) {
    FUZZ_REQUIRE(fabs(*placido_instrument_parameter(&copy, k)) <= 1e9);
  }
  for (int k = 0; k < instrument->edge_count; k++) {
    FUZZ_REQUIRE(instrument->edges[k].radius_mm > 0);
  }
}

static void check_uncertainty(const placido_uncertainty *uncertainty) {
  size_t count = (size_t)uncertainty->mode_count * (size_t)uncertainty->parameter_count;
  for (size_t i = 0; i < count; i++) {
    FUZZ_REQUIRE(fabs(uncertainty->factor[i]) <= 1e9);
  }
  for (int i = 0; uncertainty->sigma && i < uncertainty->parameter_count; i++) {
    FUZZ_REQUIRE(uncertainty->sigma[i] >= 0);
  }
}

/* Written, read and written again: two equal files. */
static void write_twice(const placido_instrument *instrument,
                        const placido_uncertainty *uncertainty) {
  placido_instrument again;
  placido_uncertainty same;
  placido_error err = {0};
  const char *first = fuzz_path("first.json"), *second = fuzz_path("second.json");
  FUZZ_REQUIRE(fuzz_check(placido_uncertainty_save(uncertainty, instrument, first, &err), &err));
  FUZZ_REQUIRE(fuzz_check(placido_instrument_load(&again, first, NULL, &err), &err));
  FUZZ_REQUIRE(fuzz_check(placido_uncertainty_load(&same, first, &err), &err));
  FUZZ_REQUIRE(fuzz_check(placido_uncertainty_save(&same, &again, second, &err), &err));
  FUZZ_REQUIRE(same.mode_count == uncertainty->mode_count);
  FUZZ_REQUIRE(fuzz_same(first, second));
  placido_uncertainty_free(&same);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const placido_instrument none;
  placido_instrument instrument;
  placido_uncertainty uncertainty;
  placido_notes notes = {0};
  placido_error err = {0};
  const char *path = fuzz_file("instrument.json", data, size);
  bool read = fuzz_check(placido_instrument_load(&instrument, path, &notes, &err), &err);
  if (read) {
    check_instrument(&instrument);
  } else {
    FUZZ_REQUIRE(memcmp(&instrument, &none, sizeof none) == 0);
  }
  if (fuzz_check(placido_uncertainty_load(&uncertainty, path, &err), &err)) {
    check_uncertainty(&uncertainty);
    if (read) {
      write_twice(&instrument, &uncertainty);
    }
  } else {
    FUZZ_REQUIRE(!uncertainty.factor && !uncertainty.sigma && uncertainty.mode_count == 0);
  }
  placido_uncertainty_free(&uncertainty);
  placido_notes_clear(&notes);
  return 0;
}

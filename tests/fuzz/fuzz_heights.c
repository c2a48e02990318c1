/* Heights from other programs: a CSO export or a table of points, and the surface through them. The
 * first byte tells how they are read. */
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <placido/elevation.h>

#include <math.h>

#define FITTED_MAX 400 /* points: more take too long */
#define FITTED 0x40    /* of the first byte */

static void check(const placido_elevation *elevation) {
  FUZZ_REQUIRE(elevation->kind != NULL && elevation->ring_count >= 0);
  for (size_t i = 0; i < elevation->count; i++) {
    const placido_height *height = &elevation->heights[i];
    FUZZ_REQUIRE(isfinite(height->x_mm) && isfinite(height->y_mm) && isfinite(height->z_mm));
    FUZZ_REQUIRE(elevation->lines[i] >= 1);
  }
}

/* Error bars are numbers wherever the surface is one. */
static void ask(const placido_elevation *elevation, const placido_fit *fit) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count = 0;
  placido_error err = {0};
  fuzz_check(placido_elevation_indices(values, &count, elevation, fit, &err), &err);
  FUZZ_REQUIRE(count <= PLACIDO_INDICES_MAX);
  const placido_surface *surface = placido_fit_surface(fit);
  for (int i = -3; i <= 3; i++) {
    placido_jet jet;
    double x_mm = 0.3 * i * placido_surface_radius_mm(surface);
    FUZZ_REQUIRE(!placido_surface_at(surface, x_mm, 0, &jet) || isfinite(jet.sag));
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const double units_mm[] = {0, 1, 1e-3, 25.4};
  placido_elevation elevation;
  placido_notes notes = {0};
  placido_error err = {0};
  const uint8_t how = fuzz_byte(&data, &size);
  const placido_elevation_options options = {.xy_mm = units_mm[how & 3],
                                             .z_mm = units_mm[how >> 2 & 3],
                                             .sign = (enum placido_height_sign)(how >> 4 & 3) % 3};
  const char *path = fuzz_file("heights.csv", data, size);
  if (fuzz_check(placido_elevation_load(&elevation, path, &options, &notes, &err), &err)) {
    placido_fit *fit = NULL;
    placido_heights_summary summary;
    check(&elevation);
    if ((how & FITTED) && elevation.count <= FITTED_MAX &&
        fuzz_check(placido_heights_fit(&fit, &summary, elevation.heights, elevation.count, 2, &err),
                   &err)) {
      FUZZ_REQUIRE(summary.rms_um >= 0 && summary.worst < elevation.count);
      ask(&elevation, fit);
    }
    placido_fit_free(fit);
  } else {
    FUZZ_REQUIRE(elevation.count == 0 && !elevation.heights && !elevation.ring_x_mm);
  }
  placido_elevation_free(&elevation);
  placido_notes_clear(&notes);
  return 0;
}

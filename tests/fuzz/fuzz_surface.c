/* Surface files: what is read is finite wherever it is defined, and reads back bit for bit. */
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <placido/surface.h>

#include <math.h>
#include <string.h>

#define HALF 6 /* of the grid on which a surface is asked */

static bool is_finite(const placido_jet *jet) {
  return isfinite(jet->sag) && isfinite(jet->sx) && isfinite(jet->sy) && isfinite(jet->sxx) &&
         isfinite(jet->sxy) && isfinite(jet->syy);
}

/* The same answers, beyond the rim as well. */
static void ask(const placido_surface *surface, const placido_surface *same) {
  double step_mm = placido_surface_radius_mm(surface) / (HALF - 1);
  for (int j = -HALF; j <= HALF; j++) {
    for (int i = -HALF; i <= HALF; i++) {
      placido_jet jet, other;
      double x_mm = i * step_mm, y_mm = j * step_mm;
      bool defined = placido_surface_at(surface, x_mm, y_mm, &jet);
      FUZZ_REQUIRE(defined == placido_surface_at(same, x_mm, y_mm, &other));
      FUZZ_REQUIRE(defined ? is_finite(&jet) : isnan(jet.sag));
      FUZZ_REQUIRE(!defined || memcmp(&jet, &other, sizeof jet) == 0);
      FUZZ_REQUIRE(placido_surface_covered(surface, x_mm, y_mm) ==
                   placido_surface_covered(same, x_mm, y_mm));
    }
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  placido_surface *surface, *same;
  placido_notes notes = {0};
  placido_error err = {0};
  const char *path = fuzz_file("surface.json", data, size);
  if (fuzz_check(placido_surface_load(&surface, path, &notes, &err), &err)) {
    const char *first = fuzz_path("first.json"), *second = fuzz_path("second.json");
    FUZZ_REQUIRE(placido_surface_radius_mm(surface) > 0);
    FUZZ_REQUIRE(fuzz_check(placido_surface_save(surface, first, &err), &err));
    FUZZ_REQUIRE(fuzz_check(placido_surface_load(&same, first, NULL, &err), &err));
    FUZZ_REQUIRE(fuzz_check(placido_surface_save(same, second, &err), &err));
    FUZZ_REQUIRE(fuzz_same(first, second));
    ask(surface, same);
    placido_surface_free(same);
  } else {
    FUZZ_REQUIRE(surface == NULL);
  }
  placido_surface_free(surface);
  placido_notes_clear(&notes);
  return 0;
}

/* Scene files with the picture and the depth map beside them, and how they are seen. An input is up
 * to three files, a record separator (ASCII 30) between them: the scene, then what it may call
 * "photo" and "depth". */
#include "tests/fuzz/files.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <string.h>

#define SEEN_MAX_PX 64 /* a side: larger ones take too long */

/* Netpbm and PFM, because they say all that matters in few bytes. */
static const char photo[] = "P3 3 2 255\n0 0 0 255 255 255 10 20 30\n200 100 50 1 2 3 77 88 99\n";
static const char depth[] = "Pf 3 2 -1\n\0\0\x80?\0\0\0@\0\0\0@\0\0\x80\x7f\0\0\0?\0\0\x80?";

static void write_part(const char *name, const uint8_t **data, size_t *size, const char *usual,
                       size_t usual_size) {
  size_t part_size;
  const uint8_t *part = fuzz_part(&part_size, data, size);
  if (part_size > 0) {
    fuzz_file(name, part, part_size);
  } else {
    fuzz_file(name, usual, usual_size);
  }
}

/* Through a spread that dims nothing: no light appears and none is lost to NaN. */
static void see(const placido_scene *scene) {
  double values[9] = {0.05, 0.1, 0.05, 0.1, 0.4, 0.1, 0.05, 0.1, 0.05};
  const placido_psf psf = {.n = 3, .bucket_arcmin = 0.5, .values = values};
  placido_image seen;
  placido_error err = {0};
  if (fuzz_check(placido_scene_see(&seen, scene, &psf, 1, &err), &err)) {
    size_t count = (size_t)seen.planes * (size_t)seen.width_px * (size_t)seen.height_px;
    for (size_t i = 0; i < count; i++) {
      FUZZ_REQUIRE(isfinite(seen.data[i]));
    }
    placido_image_free(&seen);
  } else {
    FUZZ_REQUIRE(seen.data == NULL);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  placido_scene scene;
  placido_notes notes = {0};
  placido_error err = {0};
  size_t scene_size;
  const uint8_t *text = fuzz_part(&scene_size, &data, &size);
  const char *path = fuzz_file("scene.json", text, scene_size);
  write_part("photo", &data, &size, photo, sizeof photo - 1);
  write_part("depth", &data, &size, depth, sizeof depth - 1);
  if (fuzz_check(placido_scene_load(&scene, path, 4, &notes, &err), &err)) {
    fuzz_check_scene(&scene);
    if (scene.image.width_px <= SEEN_MAX_PX && scene.image.height_px <= SEEN_MAX_PX) {
      see(&scene);
    }
  } else {
    FUZZ_REQUIRE(scene.image.data == NULL && scene.depth_D == NULL);
  }
  placido_scene_free(&scene);
  placido_notes_clear(&notes);
  return 0;
}

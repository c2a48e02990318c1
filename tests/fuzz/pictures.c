/* Checks of pictures and scenes. */
#include "tests/fuzz/pictures.h"

#include "tests/fuzz/files.h"

#include <math.h>
#include <string.h>

void fuzz_check_image(const placido_image *image, bool light) {
  FUZZ_REQUIRE(image->width_px >= 1 && image->width_px <= 65536);
  FUZZ_REQUIRE(image->height_px >= 1 && image->height_px <= 65536);
  FUZZ_REQUIRE(image->planes == 1 || image->planes == 3 || image->planes == 4);
  size_t count = (size_t)image->planes * (size_t)image->width_px * (size_t)image->height_px;
  for (size_t i = 0; light && i < count; i++) {
    FUZZ_REQUIRE(isfinite(image->data[i]) && image->data[i] >= 0);
  }
}

void fuzz_check_scene(const placido_scene *scene) {
  const placido_conditions *conditions = &scene->conditions;
  size_t pixels = (size_t)scene->image.width_px * (size_t)scene->image.height_px;
  fuzz_check_image(&scene->image, true);
  FUZZ_REQUIRE(memchr(scene->name, '\0', sizeof scene->name) != NULL);
  FUZZ_REQUIRE(scene->name[0] != '\0' && !strchr(scene->name, '/'));
  FUZZ_REQUIRE(scene->arcmin_per_px > 0 && scene->arcmin_per_px < 180 * 60);
  FUZZ_REQUIRE(scene->bleed_px >= 0 && 2 * scene->bleed_px < scene->image.width_px);
  FUZZ_REQUIRE(conditions->tolerance > 0 && conditions->tolerance <= 1);
  FUZZ_REQUIRE(conditions->distance_m > 0);
  for (size_t i = 0; scene->depth_D && i < pixels; i++) {
    FUZZ_REQUIRE(isfinite(scene->depth_D[i]) && scene->depth_D[i] >= 0);
  }
}

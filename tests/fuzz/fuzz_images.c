/* Picture files and depth maps: whatever the bytes are, a picture within its limits or a refusal. */
#include "simulate/depth/map.h"
#include "simulate/scene_file.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/target.h"

#include <math.h>

#define WIDTH_PX 4 /* of the picture that a depth map belongs to */
#define HEIGHT_PX 3
#define PIXELS_PER_BYTE 10000u

/* A few bytes do not make gigabytes. */
static void read_image(const char *path, size_t file_size) {
  placido_image image;
  placido_error err = {0};
  int bits;
  if (fuzz_check(placido_image_load_bits(&image, &bits, path, &err), &err)) {
    fuzz_check_image(&image, false);
    FUZZ_REQUIRE(bits == 8 || bits == 16 || bits == 32);
    FUZZ_REQUIRE((size_t)image.width_px * (size_t)image.height_px <=
                 PIXELS_PER_BYTE * (file_size + 1));
  } else {
    FUZZ_REQUIRE(image.data == NULL);
  }
  placido_image_free(&image);
}

static void read_photograph(const char *path) {
  placido_image image;
  placido_notes notes = {0};
  placido_error err = {0};
  int bits;
  if (fuzz_check(placido_photograph_load(&image, &bits, path, &notes, &err), &err)) {
    fuzz_check_image(&image, true);
  } else {
    FUZZ_REQUIRE(image.data == NULL);
  }
  placido_image_free(&image);
  placido_notes_clear(&notes);
}

/* A frame that was read reads back bit for bit once written. */
static void read_frame(const char *path) {
  placido_frame frame = {0}, same = {0};
  placido_error err = {0};
  if (fuzz_check(placido_frame_load(&frame, path, &err), &err) && frame.width_px <= 256 &&
      frame.height_px <= 256) {
    const char *first = fuzz_path("first.png"), *second = fuzz_path("second.png");
    FUZZ_REQUIRE(fuzz_check(placido_frame_save_png(&frame, first, &err), &err));
    FUZZ_REQUIRE(fuzz_check(placido_frame_load(&same, first, &err), &err));
    FUZZ_REQUIRE(same.format == frame.format && same.width_px == frame.width_px);
    FUZZ_REQUIRE(fuzz_check(placido_frame_save_png(&same, second, &err), &err));
    FUZZ_REQUIRE(fuzz_same(first, second));
  }
  placido_frame_free(&frame);
  placido_frame_free(&same);
}

static void read_depth(const char *path) {
  placido_error err = {0};
  placido_scene scene = {.name = "fuzz",
                         .arcmin_per_px = 1,
                         .conditions = {.distance_m = NAN, .tolerance = 0.01}};
  FUZZ_REQUIRE(placido_image_new(&scene.image, WIDTH_PX, HEIGHT_PX, 1, &err) == PLACIDO_OK);
  if (fuzz_check(placido_depth_load(&scene, path, &err), &err)) {
    FUZZ_REQUIRE(scene.depth_D != NULL);
    fuzz_check_scene(&scene);
  }
  placido_scene_free(&scene);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file("picture", data, size);
  read_image(path, size);
  read_photograph(path);
  read_frame(path);
  read_depth(path);
  return 0;
}

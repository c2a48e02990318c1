/* The scenes that ship with the project, corneas of six kinds, and four pupils. */
#include "grid.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

const char *const grid_scenes[GRID_SCENES] = {"tumbling-e", "building", "street", "monitor",
                                              "page",       "stars",    "colours"};
const double grid_pupils_mm[GRID_PUPILS] = {2, 4, 7, 0};
const char *const grid_eyes[GRID_EYES] = {"normal",     "astigmatic", "keratoconus",
                                          "post-lasik", "perfect",    "post-graft"};

/* Where the part lies that is looked at, as shares of what is seen. */
static const double middles[GRID_SCENES][2] = {{0.5, 0.5},  {0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5},
                                               {0.5, 0.46}, {0.5, 0.5}, {0.3, 0.66}};

static const placido_part corneas[GRID_EYES][2] = {
  {{PLACIDO_PART_BICONIC, {.biconic = {7.84, -0.24, 7.75, -0.2, 4, 0, 0}}}},
  {{PLACIDO_PART_BICONIC, {.biconic = {8.04, -0.22, 7.47, -0.18, 28, 0, 0}}}},
  {{PLACIDO_PART_BICONIC, {.biconic = {7.74, -0.3, 7.58, -0.28, 12, 0, 0}}},
   {PLACIDO_PART_BUMP, {.bump = {0.036, 1.2, 1.05, 0.45, -1.15, 20}}}},
  {{PLACIDO_PART_BICONIC, {.biconic = {7.7, -0.2, 7.7, -0.2, 0, 0, 0}}},
   {PLACIDO_PART_ABLATION, {.ablation = {4.5, 6, 1.6, 7.7, 1.376, 0.25, -0.1}}}},
  /* All rays of a cornea alone meet in a point at Q = -1 / n² = -0.559. */
  {{PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.55, 7.8, -0.55, 0, 0, 0}}}},
  {{PLACIDO_PART_BICONIC, {.biconic = {8.1, -0.1, 7.2, -0.05, 150, 0, 0}}},
   {PLACIDO_PART_ZERNIKE,
    {.zernike = {{[6] = -2, [7] = 2.4, [8] = -1.4, [9] = 1.2, [10] = 0.8, [11] = 1, [12] = -0.8,
                  [14] = 0.7, [16] = 0.5},
                 4}}}},
};

placido_surface *grid_cornea(int number) {
  placido_surface *surface;
  placido_error err = {0};
  const placido_part *parts = corneas[number];
  size_t count = parts[1].kind == PLACIDO_PART_BICONIC ? 1 : 2; /* zero is a biconic */
  if (placido_surface_new(&surface, 0, 5.6, parts, count, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return surface;
}

/* A part of what is seen, in samples of the picture with its bleed. */
typedef struct region {
  int left, top, width, height;
} region;

static int between(double value, int least, int most) {
  return value < least ? least : value > most ? most : (int)value;
}

/* A plane of the part, its rim continued outwards by the bleed. */
static void copy(float *to, const float *from, int from_width, const region *part, int bleed) {
  for (int y = 0; y < part->height + 2 * bleed; y++) {
    int row = part->top + between(y - bleed, 0, part->height - 1);
    for (int x = 0; x < part->width + 2 * bleed; x++) {
      int column = part->left + between(x - bleed, 0, part->width - 1);
      *to++ = from[(size_t)row * (size_t)from_width + (size_t)column];
    }
  }
}

/* Cuts a part out of a scene. */
static void cut(placido_scene *scene, const region *part) {
  placido_image image;
  const int width = scene->image.width_px, bleed = scene->bleed_px;
  assert_int_equal(placido_image_new(&image, part->width + 2 * bleed, part->height + 2 * bleed,
                                     scene->image.planes, NULL),
                   PLACIDO_OK);
  for (int plane = 0; plane < image.planes; plane++) {
    copy(placido_image_plane(&image, plane), placido_image_plane(&scene->image, plane), width,
         part, bleed);
  }
  if (scene->depth_D != NULL) {
    float *depth_D = placido_memory_new((size_t)image.width_px,
                                        (size_t)image.height_px * sizeof *depth_D, NULL);
    assert_non_null(depth_D);
    copy(depth_D, scene->depth_D, width, part, bleed);
    placido_memory_free(scene->depth_D);
    scene->depth_D = depth_D;
  }
  placido_image_free(&scene->image);
  scene->image = image;
}

/* Luminance in place of colours (ITU-R BT.709, linear light). */
static void make_grey(placido_image *image) {
  placido_image grey;
  assert_int_equal(placido_image_new(&grey, image->width_px, image->height_px, 1, NULL),
                   PLACIDO_OK);
  const float *red = placido_image_plane(image, 0), *green = placido_image_plane(image, 1);
  const float *blue = placido_image_plane(image, 2);
  for (size_t i = 0; i < (size_t)image->width_px * (size_t)image->height_px; i++) {
    grey.data[i] = 0.2126f * red[i] + 0.7152f * green[i] + 0.0722f * blue[i];
  }
  placido_image_free(image);
  *image = grey;
}

placido_scene grid_scene(int number, double arcmin_per_px, int side_px) {
  placido_scene scene;
  placido_error err = {0};
  if (placido_scene_load(&scene, grid_scenes[number], arcmin_per_px, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  int bleed = scene.bleed_px;
  int width = scene.image.width_px - 2 * bleed, height = scene.image.height_px - 2 * bleed;
  int across = side_px < width ? side_px : width, down = side_px < height ? side_px : height;
  double left = middles[number][0] * width - across / 2.0;
  double top = middles[number][1] * height - down / 2.0;
  const region part = {bleed + between(left, 0, width - across),
                       bleed + between(top, 0, height - down), across, down};
  cut(&scene, &part);
  if (scene.image.planes >= 3 && strcmp(grid_scenes[number], "colours") != 0) {
    make_grey(&scene.image);
  }
  return scene;
}

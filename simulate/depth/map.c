/* Depth maps become vergences, pixel by pixel of a scene's picture. */
#include "simulate/depth/map.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double steps_per_m = 1000;      /* of 16-bit samples: millimetres */
static const double full_scale_16 = 65535;

int placido_depth_check_size(const placido_depth_file *file, long width_px, long height_px,
                             const int size[2], placido_error *err) {
  if (width_px == size[0] && height_px == size[1]) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s: a depth map of %ld by %ld pixels, expected the picture's %d by %d",
                           file->name, width_px, height_px, size[0], size[1]);
}

/* Millimetres, 0 standing for what is too far to be measured. */
static void scale_whole_numbers(placido_image *metres) {
  size_t pixels = (size_t)metres->width_px * (size_t)metres->height_px;
  for (size_t i = 0; i < pixels; i++) {
    double millimetres = round(metres->data[i] * full_scale_16);
    metres->data[i] = millimetres > 0 ? (float)(millimetres / steps_per_m) : INFINITY;
  }
}

/* PNG of 16 bits, or TIFF of 32. */
static int read_picture(placido_image *metres, const placido_depth_file *file, const char *path,
                        const int size[2], placido_error *err) {
  int bits;
  int status = placido_image_load_bits(metres, &bits, path, err);
  if (status == PLACIDO_OK && (metres->planes != 1 || bits < 16)) {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "%s: a picture of %d bits in %d planes is no depth map: 16 bits "
                               "(millimetres) or 32 (metres) in one plane are expected",
                               file->name, bits, metres->planes);
  }
  if (status == PLACIDO_OK) {
    status = placido_depth_check_size(file, metres->width_px, metres->height_px, size, err);
  }
  if (status == PLACIDO_OK && bits == 16) {
    scale_whole_numbers(metres);
  }
  return status;
}

static bool begins_with(const placido_depth_file *file, const char *magic, size_t length) {
  return file->size >= length && memcmp(file->bytes, magic, length) == 0;
}

/* By what the file begins with, whatever it is called. */
static int read_metres(placido_image *metres, const char *path, const int size[2],
                       placido_error *err) {
  char *bytes = NULL;
  placido_depth_file file = {.name = placido_text_tail(path)};
  int status = placido_file_read(&bytes, &file.size, path, 0, err);
  file.bytes = bytes;
  if (status != PLACIDO_OK) {
    return status;
  }
  if (begins_with(&file, "\x76\x2f\x31\x01", 4)) {
    status = placido_depth_read_exr(metres, &file, size, err);
  } else if (begins_with(&file, "Pf", 2)) {
    status = placido_depth_read_pfm(metres, &file, size, err);
  } else if (begins_with(&file, "\x89PNG", 4) || begins_with(&file, "II*", 4) ||
             begins_with(&file, "MM\0*", 4)) {
    status = read_picture(metres, &file, path, size, err);
  } else {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "%s is no depth map: OpenEXR, PFM, TIFF of 32 bits or PNG of 16 is "
                               "expected", file.name);
  }
  placido_memory_free(bytes);
  return status;
}

static int to_vergences(placido_image *map, const char *path, placido_error *err) {
  for (int y = 0; y < map->height_px; y++) {
    float *row = &map->data[(size_t)y * (size_t)map->width_px];
    for (int x = 0; x < map->width_px; x++) {
      if (!(row[x] >= (float)PLACIDO_DEPTH_NEAREST_M)) {
        return placido_error_set(err, PLACIDO_INPUT,
                                 "%s: pixel (%d, %d) is %g m away, expected %g m to infinity",
                                 placido_text_tail(path), x, y, row[x], PLACIDO_DEPTH_NEAREST_M);
      }
      row[x] = 1 / row[x];
    }
  }
  return PLACIDO_OK;
}

static int within(int value, int size) {
  return value < 0 ? 0 : value < size ? value : size - 1;
}

/* Room for a vergence of every pixel, the bleed's too. */
static int make_room(placido_scene *scene, placido_error *err) {
  placido_memory_free(scene->depth_D);
  scene->depth_D = placido_memory_new((size_t)scene->image.width_px,
                                      (size_t)scene->image.height_px * sizeof *scene->depth_D, err);
  return scene->depth_D != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* Where the eye looks, if nothing else is said. */
static void look_at_the_middle(placido_scene *scene) {
  const placido_image *image = &scene->image;
  if (isnan(scene->conditions.distance_m)) {
    size_t middle = (size_t)(image->height_px / 2) * (size_t)image->width_px +
                    (size_t)(image->width_px / 2);
    scene->conditions.distance_m = 1 / (double)scene->depth_D[middle];
  }
}

/* What shows through holes is nowhere. */
static int refuse_holes(const placido_image *image, const char *path, placido_error *err) {
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  const float *alpha = image->planes == 4 ? placido_image_plane(image, 3) : NULL;
  for (size_t i = 0; alpha != NULL && i < pixels; i++) {
    if (alpha[i] < 1) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "%s: the picture has transparent parts, which have no distance; one "
                               "without is expected where there is a depth map",
                               placido_text_tail(path));
    }
  }
  return PLACIDO_OK;
}

int placido_depth_load(placido_scene *scene, const char *path, placido_error *err) {
  const int bleed = scene->bleed_px;
  const int size[2] = {scene->image.width_px - 2 * bleed, scene->image.height_px - 2 * bleed};
  placido_image map = {0};
  int status = refuse_holes(&scene->image, path, err);
  if (status == PLACIDO_OK) {
    status = read_metres(&map, path, size, err);
  }
  if (status == PLACIDO_OK) {
    status = to_vergences(&map, path, err);
  }
  if (status == PLACIDO_OK) {
    status = make_room(scene, err);
  }
  float *to = scene->depth_D;
  for (int y = 0; y < scene->image.height_px && status == PLACIDO_OK; y++) {
    const float *from = &map.data[(size_t)within(y - bleed, size[1]) * (size_t)size[0]];
    for (int x = 0; x < scene->image.width_px; x++) {
      *to++ = from[within(x - bleed, size[0])];
    }
  }
  placido_image_free(&map);
  if (status == PLACIDO_OK) {
    look_at_the_middle(scene);
  }
  return status;
}

int placido_depth_draw(placido_scene *scene,
                       double (*vergence_D)(double x_arcmin, double y_arcmin),
                       placido_error *err) {
  const int bleed = scene->bleed_px, width = scene->image.width_px - 2 * bleed,
            height = scene->image.height_px - 2 * bleed;
  int status = make_room(scene, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  float *to = scene->depth_D;
  for (int y = 0; y < scene->image.height_px; y++) {
    double y_arcmin = (within(y - bleed, height) + 0.5) * scene->arcmin_per_px;
    for (int x = 0; x < scene->image.width_px; x++) {
      double x_arcmin = (within(x - bleed, width) + 0.5) * scene->arcmin_per_px;
      *to++ = (float)vergence_D(x_arcmin, y_arcmin);
    }
  }
  return PLACIDO_OK;
}

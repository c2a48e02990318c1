/* The canvas: a scene brought to a PSF's scale, its bleed as wide as that reaches, its colours
 * weighted where it has holes. */
#include "simulate/canvas.h"

#include "simulate/bleed.h"
#include "simulate/depth/map.h"
#include "simulate/resample.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Scales that differ by less than this are one: a monitor's distance is not known better. */
static const double scale_tolerance = 1e-3;
static const int side_max_px = 16384;
/* Of a scene that is made larger than its picture: a few pixels must not ask for gigabytes. */
static const double enlarged_max = 8192.0 * 8192;
/* Of light, relative to white: what double precision leaves of it in a transform, 1e-16 a step and
 * 30 steps, is under a hundredth of white. */
static const float brightest = 1e12f;

static bool is_coarse(const placido_scene *scene, double bucket_arcmin) {
  return scene->arcmin_per_px > bucket_arcmin * (1 + scale_tolerance);
}

bool placido_scene_coarse(const placido_scene *scene, const placido_psf *psf) {
  return is_coarse(scene, psf->bucket_arcmin);
}

/* The first of `count` samples that does not lie from `least` to `most`; `count` where all do. */
static size_t find_stray(const float *samples, size_t count, float least, float most) {
  unsigned stray = 0;
  for (size_t i = 0; i < count; i++) {
    stray += !(samples[i] >= least && samples[i] <= most);
  }
  for (size_t i = 0; i < count && stray > 0; i++) {
    if (!(samples[i] >= least && samples[i] <= most)) {
      return i;
    }
  }
  return count;
}

int placido_scene_check_light(const placido_scene *scene, placido_error *err) {
  const placido_image *image = &scene->image;
  const size_t width = (size_t)image->width_px, height = (size_t)image->height_px;
  for (size_t row = 0; row < height * (size_t)image->planes; row++) {
    const float *samples = &image->data[row * width];
    size_t x = find_stray(samples, width, -brightest, brightest);
    if (x < width) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "scene %s: sample (%zu, %zu) of plane %zu is %g, expected a number "
                               "up to %g times white",
                               scene->name, x, row % height, row / height, (double)samples[x],
                               (double)brightest);
    }
  }
  return PLACIDO_OK;
}

int placido_scene_check_depth(const placido_scene *scene, placido_error *err) {
  const float nearest_D = (float)(1 / PLACIDO_DEPTH_NEAREST_M) * (1 + FLT_EPSILON);
  const size_t width = (size_t)scene->image.width_px, height = (size_t)scene->image.height_px;
  for (size_t row = 0; row < height && scene->depth_D != NULL; row++) {
    const float *samples = &scene->depth_D[row * width];
    size_t x = find_stray(samples, width, 0, nearest_D);
    if (x < width) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "scene %s: pixel (%zu, %zu) has a vergence of %g D, expected 0 to %g",
                               scene->name, x, row, (double)samples[x],
                               1 / PLACIDO_DEPTH_NEAREST_M);
    }
  }
  return PLACIDO_OK;
}

static int check(const placido_scene *scene, double bucket_arcmin, placido_error *err) {
  const placido_image *image = &scene->image;
  if (image->data == NULL || !(image->planes == 1 || image->planes == 3 || image->planes == 4)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: %d planes, expected 1, 3 or 4",
                             scene->name, image->planes);
  }
  if (!(scene->arcmin_per_px > 0) || !isfinite(scene->arcmin_per_px)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: %g arcmin per pixel", scene->name,
                             scene->arcmin_per_px);
  }
  if (scene->bleed_px < 0 || scene->bleed_px > side_max_px) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: a bleed of %d px, expected 0 to %d",
                             scene->name, scene->bleed_px, side_max_px);
  }
  if (is_coarse(scene, bucket_arcmin) && !scene->allow_coarse) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "scene %s is too coarse: a pixel is %.4g', the PSF's bucket %.4g'; "
                             "the blur would be hidden in the pixels (finer picture, watched from "
                             "farther away, or --allow-coarse)",
                             scene->name, scene->arcmin_per_px, bucket_arcmin);
  }
  return PLACIDO_OK;
}

/* Sizes in buckets: of the picture that is seen, and of its bleed; and a bucket in pixels. */
typedef struct frame_size {
  int width, height, bleed;
  double step;
} frame_size;

static int find_size(const placido_scene *scene, double bucket_arcmin, frame_size *size,
                     placido_error *err) {
  double ratio = scene->arcmin_per_px / bucket_arcmin;
  if (fabs(ratio - 1) <= scale_tolerance) {
    ratio = 1;
  }
  double bleed = round(scene->bleed_px * ratio), max = side_max_px - 2 * bleed;
  double width = round((scene->image.width_px - 2 * scene->bleed_px) * ratio);
  double height = round((scene->image.height_px - 2 * scene->bleed_px) * ratio);
  if (!(fmax(width, height) <= max) || scene->image.width_px <= 2 * scene->bleed_px ||
      scene->image.height_px <= 2 * scene->bleed_px) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "scene %s: %.0f by %.0f buckets of %g', expected 1 to %.0f a side",
                             scene->name, width, height, bucket_arcmin, max);
  }
  if (ratio > 1 && width * height > enlarged_max) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "scene %s: %.0f by %.0f buckets of %g', %.3g times the picture's; "
                             "expected at most %.0f million in all",
                             scene->name, width, height, bucket_arcmin, ratio * ratio,
                             enlarged_max / 1e6);
  }
  *size = (frame_size){(int)fmax(width, 1), (int)fmax(height, 1), (int)bleed, 1 / ratio};
  return PLACIDO_OK;
}

static bool has_holes(const placido_image *image) {
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  const float *alpha = image->planes == 4 ? placido_image_plane(image, 3) : NULL;
  for (size_t i = 0; alpha != NULL && i < pixels; i++) {
    if (alpha[i] != 1) {
      return true;
    }
  }
  return false;
}

/* Colours times alpha, or by it. Where there is nothing there is no colour either. */
static void weigh_colours(placido_image *image, bool divide) {
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  const float *alpha = placido_image_plane(image, 3);
  const float least = 1e-6f; /* transforms leave about as much where there is none */
  for (int plane = 0; plane < 3; plane++) {
    float *colour = placido_image_plane(image, plane);
    for (size_t i = 0; i < pixels; i++) {
      float share = divide ? (alpha[i] > least ? 1 / alpha[i] : 0) : alpha[i];
      colour[i] *= share;
    }
  }
}

void placido_scene_canvas_unweigh(placido_image *image) { weigh_colours(image, true); }

/* The scene with its bleed at the PSF's scale, its colours weighted where it has holes. The left
 * and upper rim of what is seen stays where it is; the others fall on whole buckets. */
static int bring_to_scale(placido_scene_canvas *canvas, const placido_scene *scene,
                          const frame_size *size, int threads, placido_error *err) {
  const placido_image *image = &scene->image;
  placido_image weighted = {0};
  int status = PLACIDO_OK;
  canvas->image = image;
  if (size->step == 1 && !canvas->holes) {
    return PLACIDO_OK;
  }
  if (canvas->holes) {
    status = placido_image_new(&weighted, image->width_px, image->height_px, image->planes, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    memcpy(weighted.data, image->data, (size_t)image->width_px * (size_t)image->height_px *
                                         (size_t)image->planes * sizeof *image->data);
    weigh_colours(&weighted, false);
    image = &weighted;
  }
  if (size->step == 1) {
    canvas->own = weighted;
  } else {
    double before = scene->bleed_px - size->bleed * size->step;
    status = placido_image_new(&canvas->own, size->width + 2 * size->bleed,
                               size->height + 2 * size->bleed, image->planes, err);
    if (status == PLACIDO_OK) {
      status = placido_resample(&canvas->own, image, before, before, size->step, scene->resampling,
                                threads, err);
    }
    placido_image_free(&weighted);
  }
  canvas->image = &canvas->own;
  return status;
}

/* Where there is a bleed, it reaches as far as the light is spread: what was drawn, and the rim of
 * that outwards. */
static int reach_out(placido_scene_canvas *canvas, int reach, placido_error *err) {
  const int more = reach - canvas->bleed_px;
  placido_image wide;
  if (canvas->bleed_px == 0 || more <= 0) {
    return PLACIDO_OK;
  }
  int status = placido_bleed_widen(&wide, canvas->image, more, err);
  if (status == PLACIDO_OK) {
    placido_image_free(&canvas->own);
    canvas->own = wide;
    canvas->image = &canvas->own;
    canvas->bleed_px += more;
  }
  return status;
}

int placido_scene_canvas_new(placido_scene_canvas *canvas, const placido_scene *scene,
                             double bucket_arcmin, int reach, int threads, placido_error *err) {
  frame_size size = {0};
  *canvas = (placido_scene_canvas){.image = NULL};
  int status = check(scene, bucket_arcmin, err);
  if (status == PLACIDO_OK) {
    status = find_size(scene, bucket_arcmin, &size, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  canvas->holes = has_holes(&scene->image);
  canvas->bleed_px = size.bleed;
  status = bring_to_scale(canvas, scene, &size, threads, err);
  if (status == PLACIDO_OK) {
    status = reach_out(canvas, reach, err);
  }
  if (status != PLACIDO_OK) {
    placido_scene_canvas_free(canvas);
  }
  return status;
}

void placido_scene_canvas_free(placido_scene_canvas *canvas) {
  if (canvas != NULL) {
    placido_image_free(&canvas->own);
    *canvas = (placido_scene_canvas){.image = NULL};
  }
}

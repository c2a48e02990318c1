/* A scene as the patient sees it: brought to the PSF's scale, spread by it, its bleed cut off. */
#include "simulate/bleed.h"
#include "simulate/convolve.h"
#include "simulate/resample.h"

#include <placido/simulate.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Scales that differ by less than this are one: a monitor's distance is not known better. */
static const double scale_tolerance = 1e-3;
static const int threads_max = 256;
static const int side_max_px = 16384;

static int check(const placido_scene *scene, const placido_psf *psf, placido_error *err) {
  const placido_image *image = &scene->image;
  if (image->data == NULL || !(image->planes == 1 || image->planes == 3 || image->planes == 4)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: %d planes, expected 1, 3 or 4",
                             scene->name, image->planes);
  }
  if (psf->values == NULL || psf->n < 1 || psf->n % 2 == 0 || !(psf->bucket_arcmin > 0)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: the PSF is empty", scene->name);
  }
  if (!(scene->arcmin_per_px > 0) || !isfinite(scene->arcmin_per_px)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: %g arcmin per pixel", scene->name,
                             scene->arcmin_per_px);
  }
  if (scene->bleed_px < 0 || scene->bleed_px > side_max_px) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: a bleed of %d px, expected 0 to %d",
                             scene->name, scene->bleed_px, side_max_px);
  }
  if (placido_scene_coarse(scene, psf) && !scene->allow_coarse) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "scene %s is too coarse: a pixel is %.4g', the PSF's bucket %.4g'; "
                             "the blur would be hidden in the pixels (finer picture, watched from "
                             "farther away, or --allow-coarse)",
                             scene->name, scene->arcmin_per_px, psf->bucket_arcmin);
  }
  return PLACIDO_OK;
}

/* Sizes in buckets: of the picture that is seen, and of its bleed; and a bucket in pixels. */
typedef struct frame_size {
  int width, height, bleed;
  double step;
} frame_size;

bool placido_scene_coarse(const placido_scene *scene, const placido_psf *psf) {
  return scene->arcmin_per_px > psf->bucket_arcmin * (1 + scale_tolerance);
}

static int find_size(const placido_scene *scene, const placido_psf *psf, frame_size *size,
                     placido_error *err) {
  double ratio = scene->arcmin_per_px / psf->bucket_arcmin;
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
                             scene->name, width, height, psf->bucket_arcmin, max);
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

/* A picture that is the caller's to free, or the scene's own where that will do. */
typedef struct source {
  placido_image own;
  const placido_image *image;
} source;

/* The scene with its bleed at the PSF's scale, its colours weighted where it has holes. The left
 * and upper rim of what is seen stays where it is; the others fall on whole buckets. */
static int bring_to_scale(source *from, const placido_scene *scene, const frame_size *size,
                          bool holes, int threads, placido_error *err) {
  const placido_image *image = &scene->image;
  placido_image weighted = {0};
  int status = PLACIDO_OK;
  from->image = image;
  if (size->step == 1 && !holes) {
    return PLACIDO_OK;
  }
  if (holes) {
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
    from->own = weighted;
  } else {
    double before = scene->bleed_px - size->bleed * size->step;
    status = placido_image_new(&from->own, size->width + 2 * size->bleed,
                               size->height + 2 * size->bleed, image->planes, err);
    if (status == PLACIDO_OK) {
      status = placido_resample(&from->own, image, before, before, size->step, scene->resampling,
                                threads, err);
    }
    placido_image_free(&weighted);
  }
  from->image = &from->own;
  return status;
}

/* How light is spread, and where what is to be said about it goes. */
typedef struct spreading {
  const placido_psf *psf;
  const placido_convolution *how;
  placido_notes *notes;
} spreading;

/* Spreads the light; where the picture has holes, its alpha too, as a picture of its own. */
static int spread(placido_image *seen, const placido_image *image, const spreading *by, bool holes,
                  placido_error *err) {
  int status = placido_convolve_as(seen, image, by->psf, by->how, by->notes, err);
  if (status != PLACIDO_OK || !holes) {
    return status;
  }
  placido_image alpha = *image, seen_alpha = *seen;
  alpha.planes = seen_alpha.planes = 1;
  alpha.data = placido_image_plane(image, 3);
  seen_alpha.data = placido_image_plane(seen, 3);
  status = placido_convolve_as(&seen_alpha, &alpha, by->psf, by->how, by->notes, err);
  if (status == PLACIDO_OK) {
    weigh_colours(seen, true);
  }
  return status;
}

/* Where there is a bleed, it reaches as far as the light is spread: what was drawn, and the rim of
 * that outwards. */
static int reach_out(source *from, frame_size *size, const placido_psf *psf, placido_error *err) {
  const int more = placido_psf_reach(psf) - size->bleed;
  placido_image wide;
  if (size->bleed == 0 || more <= 0) {
    return PLACIDO_OK;
  }
  int status = placido_bleed_widen(&wide, from->image, more, err);
  if (status == PLACIDO_OK) {
    placido_image_free(&from->own);
    from->own = wide;
    from->image = &from->own;
    size->bleed += more;
  }
  return status;
}

int placido_scene_see_as(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                         const placido_convolution *how, placido_notes *notes,
                         placido_error *err) {
  source from = {.image = NULL};
  frame_size size = {0};
  const spreading by = {psf, how, notes};
  *seen = (placido_image){0};
  int status = check(scene, psf, err);
  if (status == PLACIDO_OK) {
    status = find_size(scene, psf, &size, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  bool holes = has_holes(&scene->image);
  int threads = how->threads > 0 && how->threads <= threads_max ? how->threads : 1;
  status = bring_to_scale(&from, scene, &size, holes, threads, err);
  if (status == PLACIDO_OK) {
    status = reach_out(&from, &size, psf, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(seen, from.image->width_px, from.image->height_px,
                               from.image->planes, err);
  }
  if (status == PLACIDO_OK) {
    status = spread(seen, from.image, &by, holes, err);
  }
  placido_image_free(&from.own);
  if (status != PLACIDO_OK) {
    placido_image_free(seen);
    return status;
  }
  placido_bleed_cut(seen, size.bleed);
  return PLACIDO_OK;
}

int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err) {
  *seen = (placido_image){0};
  if (threads < 0 || threads > threads_max) {
    return placido_error_set(err, PLACIDO_INPUT, "%d threads, expected 0 to %d", threads,
                             threads_max);
  }
  const placido_convolution how = {.threads = threads};
  return placido_scene_see_as(seen, scene, psf, &how, NULL, err);
}

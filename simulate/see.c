/* A scene as the patient sees it: brought to the PSF's scale, spread by it, its bleed cut off. */
#include "base/cv/cv.h"
#include "simulate/convolve.h"

#include <placido/simulate.h>

#include <math.h>
#include <string.h>

/* Scales that differ by less than this are one: a monitor's distance is not known better. */
static const double scale_tolerance = 1e-3;
static const int side_max_px = 16384; /* 4 GB of work for a colour picture */

static int check(const placido_scene *scene, const placido_psf *psf, int threads,
                 placido_error *err) {
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
  if (threads < 0 || threads > 256) {
    return placido_error_set(err, PLACIDO_INPUT, "%d threads, expected 0 to 256", threads);
  }
  if (scene->arcmin_per_px > psf->bucket_arcmin * (1 + scale_tolerance)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "scene %s is too coarse: a pixel is %.4g', the PSF's bucket %.4g'; "
                             "the blur would be hidden in the pixels (finer picture, or watched "
                             "from farther away)",
                             scene->name, scene->arcmin_per_px, psf->bucket_arcmin);
  }
  return PLACIDO_OK;
}

/* Sizes in buckets: of the picture that is seen, and of its bleed. */
typedef struct frame_size {
  int width, height, bleed;
} frame_size;

static int find_size(const placido_scene *scene, const placido_psf *psf, frame_size *size,
                     placido_error *err) {
  double ratio = scene->arcmin_per_px / psf->bucket_arcmin;
  if (ratio >= 1 - scale_tolerance) {
    ratio = 1;
  }
  size->bleed = (int)lround(scene->bleed_px * ratio);
  size->width = (int)lround((scene->image.width_px - 2 * scene->bleed_px) * ratio);
  size->height = (int)lround((scene->image.height_px - 2 * scene->bleed_px) * ratio);
  int side_max = side_max_px - 2 * size->bleed;
  if (size->width >= 1 && size->height >= 1 && size->width <= side_max &&
      size->height <= side_max) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "scene %s: %d by %d buckets of %g', expected 1 to %d a side",
                           scene->name, size->width, size->height, psf->bucket_arcmin, side_max);
}

/* The scene with its bleed, at the PSF's scale: `scaled`, which is the caller's, or the scene's own
 * picture where that has the scale already. */
static int bring_to_scale(const placido_image **source, placido_image *scaled,
                          const placido_scene *scene, const frame_size *size,
                          placido_error *err) {
  int width = size->width + 2 * size->bleed, height = size->height + 2 * size->bleed;
  *source = &scene->image;
  if (width == scene->image.width_px && height == scene->image.height_px) {
    return PLACIDO_OK;
  }
  *source = scaled;
  int status = placido_image_new(scaled, width, height, scene->image.planes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  return placido_cv_resize(scaled, &scene->image, PLACIDO_CV_AREA, err);
}

/* Cuts the bleed off: moves every row to its place and keeps the memory. */
static void cut_bleed(placido_image *image, const frame_size *size) {
  if (size->bleed == 0) {
    return;
  }
  float *to = image->data;
  for (int plane = 0; plane < image->planes; plane++) {
    const float *from = placido_image_plane(image, plane) + size->bleed +
                        (size_t)size->bleed * (size_t)image->width_px;
    for (int y = 0; y < size->height; y++, to += size->width, from += image->width_px) {
      memmove(to, from, (size_t)size->width * sizeof *to);
    }
  }
  image->width_px = size->width;
  image->height_px = size->height;
}

int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err) {
  placido_image scaled = {0};
  const placido_image *source;
  frame_size size;
  *seen = (placido_image){0};
  int status = check(scene, psf, threads, err);
  if (status == PLACIDO_OK) {
    status = find_size(scene, psf, &size, err);
  }
  if (status == PLACIDO_OK) {
    status = bring_to_scale(&source, &scaled, scene, &size, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(seen, source->width_px, source->height_px, source->planes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_convolve(seen, source, psf, threads > 0 ? threads : 1, err);
  }
  placido_image_free(&scaled);
  if (status != PLACIDO_OK) {
    placido_image_free(seen);
    return status;
  }
  cut_bleed(seen, &size);
  return PLACIDO_OK;
}

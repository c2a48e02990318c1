/* A scene as the patient sees it: brought to the PSF's scale, then spread by it. */
#include "base/cv/cv.h"
#include "simulate/convolve.h"

#include <placido/simulate.h>

#include <math.h>

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

/* The scene's size in buckets. */
static int find_size(const placido_scene *scene, const placido_psf *psf, int *width, int *height,
                     placido_error *err) {
  double ratio = scene->arcmin_per_px / psf->bucket_arcmin;
  *width = scene->image.width_px;
  *height = scene->image.height_px;
  if (ratio < 1 - scale_tolerance) {
    *width = (int)lround(*width * ratio);
    *height = (int)lround(*height * ratio);
  }
  if (*width >= 1 && *height >= 1 && *width <= side_max_px && *height <= side_max_px) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "scene %s: %d by %d buckets of %g', expected 1 to %d a side",
                           scene->name, *width, *height, psf->bucket_arcmin, side_max_px);
}

int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err) {
  placido_image scaled = {0};
  const placido_image *source = &scene->image;
  int width, height;
  *seen = (placido_image){0};
  int status = check(scene, psf, threads, err);
  if (status == PLACIDO_OK) {
    status = find_size(scene, psf, &width, &height, err);
  }
  if (status != PLACIDO_OK) {
    goto fail;
  }
  if (width != source->width_px || height != source->height_px) {
    status = placido_image_new(&scaled, width, height, source->planes, err);
    if (status != PLACIDO_OK) {
      goto fail;
    }
    status = placido_cv_resize(&scaled, source, PLACIDO_CV_AREA, err);
    source = &scaled;
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(seen, width, height, source->planes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_convolve(seen, source, psf, threads > 0 ? threads : 1, err);
  }
fail:
  placido_image_free(&scaled);
  if (status != PLACIDO_OK) {
    placido_image_free(seen);
  }
  return status;
}

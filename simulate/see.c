/* A scene as the patient sees it: brought to the PSF's scale, spread by it, its bleed cut off. */
#include "simulate/bleed.h"
#include "simulate/canvas.h"
#include "simulate/convolve.h"

#include <placido/simulate.h>

#include <stdbool.h>

static const int threads_max = 256;

static int check(const placido_scene *scene, const placido_psf *psf, placido_error *err) {
  if (psf->values == NULL || psf->n < 1 || psf->n % 2 == 0 || !(psf->bucket_arcmin > 0)) {
    return placido_error_set(err, PLACIDO_INPUT, "scene %s: the PSF is empty", scene->name);
  }
  return PLACIDO_OK;
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
    placido_scene_canvas_unweigh(seen);
  }
  return status;
}

int placido_scene_see_as(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                         const placido_convolution *how, placido_notes *notes,
                         placido_error *err) {
  placido_scene_canvas canvas;
  const spreading by = {psf, how, notes};
  *seen = (placido_image){0};
  int status = check(scene, psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int threads = how->threads > 0 && how->threads <= threads_max ? how->threads : 1;
  status = placido_scene_canvas_new(&canvas, scene, psf->bucket_arcmin, placido_psf_reach(psf),
                                    threads, err);
  if (status == PLACIDO_OK) {
    status = placido_scene_check_light(scene, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(seen, canvas.image->width_px, canvas.image->height_px,
                               canvas.image->planes, err);
  }
  if (status == PLACIDO_OK) {
    status = spread(seen, canvas.image, &by, canvas.holes, err);
  }
  if (status == PLACIDO_OK) {
    placido_bleed_cut(seen, canvas.bleed_px);
  } else {
    placido_image_free(seen);
  }
  placido_scene_canvas_free(&canvas);
  return status;
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

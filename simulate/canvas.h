/* A scene brought to a PSF's scale, with as much bleed as that reaches. */
#ifndef PLACIDO_SIMULATE_CANVAS_H
#define PLACIDO_SIMULATE_CANVAS_H

#include <placido/scene.h>

/* The picture and its rim. Free with placido_scene_canvas_free. */
typedef struct placido_scene_canvas {
  placido_image own;          /* no data: the scene's own picture is used */
  const placido_image *image; /* borrowed: from `own` or from the scene */
  int bleed_px;
  bool holes;                 /* the picture has alpha other than 1: colours are weighted by it */
} placido_scene_canvas;

/* Checks the scene against a PSF of this bucket and reach (buckets from its middle), resamples and
 * widens. Errors as placido_scene_see. */
int placido_scene_canvas_new(placido_scene_canvas *canvas, const placido_scene *scene,
                             double bucket_arcmin, int reach, int threads, placido_error *err);
void placido_scene_canvas_free(placido_scene_canvas *canvas);

/* Refuses samples that are no numbers, or brighter than what transforms carry beside white. The
 * scene has an image. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_scene_check_light(const placido_scene *scene, placido_error *err);

/* Refuses vergences that are no distance. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_scene_check_depth(const placido_scene *scene, placido_error *err);

/* Divides the colours of a picture of four planes by its alpha: what a picture with holes needs
 * when colours and alpha are spread. Where there is nothing there is no colour either. */
void placido_scene_canvas_unweigh(placido_image *image);

#endif

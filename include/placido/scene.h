/* Scenes, and how they are seen through a point spread function. */
#ifndef PLACIDO_SCENE_H
#define PLACIDO_SCENE_H

#include <placido/image.h>
#include <placido/notes.h>
#include <placido/psf.h>
#include <placido/status.h>

/* What is looked at: an image in linear light with its scale. */
typedef struct placido_scene {
  char name[128];          /* also the stem of the output picture */
  placido_image image;     /* linear light, relative to white; 1, 3 or 4 planes */
  double arcmin_per_px;
  int bleed_px;            /* on every side: there to be looked at, spreads its light into the
                              picture and is then cut off; 0 for photographs */
} placido_scene;

/* Loads a scene: a file `placido-scene/1` (docs/formats.md), or a generated chart by name
 * (`tumbling-e`, `fan`), which has a bleed of white as wide as half of the default PSF, so that
 * the dark beyond does not reach the picture. Charts are drawn at chart_arcmin_per_px, 0.05 to 4
 * (0: 0.5), which should be the PSF's bucket. Free with placido_scene_free. Returns PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_SYSTEM, PLACIDO_UNSUPPORTED (a chart that this build does not draw),
 * PLACIDO_MEMORY. */
int placido_scene_load(placido_scene *scene, const char *name_or_path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err);
void placido_scene_free(placido_scene *scene);

/* Calls `each` with the name and a sentence for every generated chart. */
void placido_chart_list(void (*each)(void *user, const char *name, const char *help), void *user);

/* The scene as seen through the PSF: resampled to the PSF's bucket where it is finer, convolved in
 * linear light with zero padding, R, G and B alike, its bleed cut off. `seen` gets linear light;
 * free with placido_image_free. A scene coarser than the bucket is refused with the reason.
 * Returns PLACIDO_OK, PLACIDO_INPUT, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err);

#endif

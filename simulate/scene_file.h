/* What a file `placido-scene/1` says. */
#ifndef PLACIDO_SIMULATE_SCENE_FILE_H
#define PLACIDO_SIMULATE_SCENE_FILE_H

#include "base/json.h"
#include "simulate/charts/chart.h"

#include <placido/scene.h>

/* Conditions of a scene that says nothing: of a chart, or (NULL) of a photograph. */
placido_conditions placido_conditions_of(const placido_chart *chart);

/* Reads the optional fields about light, distance and tolerance; those that are missing stay as
 * they are. `path` is the scene file's. The depth map is not read; where it alone says where things
 * are, distance_m is NaN. Returns PLACIDO_OK, PLACIDO_INPUT. */
int placido_conditions_read(placido_conditions *conditions, const placido_json *json,
                            const char *path, placido_error *err);

/* Fills `scene` (zeroed) from a file. Charts without a calibration get chart_arcmin_per_px. */
int placido_scene_read(placido_scene *scene, const char *path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err);

/* A picture file in linear light: sRGB of 8 or 16 bit decoded, 32-bit TIFF taken as linear light.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT (not an image; samples that are no numbers),
 * PLACIDO_MEMORY. */
int placido_photograph_load(placido_image *image, int *bits, const char *path,
                            placido_notes *notes, placido_error *err);

/* A file named in the file `path`, relative to its folder. `out` has PLACIDO_PATH_MAX bytes. */
int placido_scene_beside(char *out, const char *path, const char *name, placido_error *err);

#endif

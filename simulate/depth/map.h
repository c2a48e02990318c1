/* Depth maps: files with the distance of every pixel (docs/formats.md). */
#ifndef PLACIDO_SIMULATE_DEPTH_MAP_H
#define PLACIDO_SIMULATE_DEPTH_MAP_H

#include <placido/image.h>
#include <placido/scene.h>
#include <placido/status.h>
#include <stddef.h>

#define PLACIDO_DEPTH_NEAREST_M 0.01 /* nothing is looked at from nearer */

/* A file in memory, and what it is called in messages. Borrowed. */
typedef struct placido_depth_file {
  const char *bytes;
  size_t size;
  const char *name;
} placido_depth_file;

/* Reads the depth map `path` into scene->depth_D. It has the size of what is shown of the scene's
 * picture; its rim goes on over the bleed. Where scene->conditions.distance_m is NaN it becomes the
 * distance in the picture's middle. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT (another
 * size, not a depth map, distances that make no sense: the line names file and pixel),
 * PLACIDO_MEMORY. */
int placido_depth_load(placido_scene *scene, const char *path, placido_error *err);

/* Fills scene->depth_D from a function of the place in what is shown, minutes of arc from its top
 * left corner; beyond its rim the rim goes on. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_depth_draw(placido_scene *scene,
                       double (*vergence_D)(double x_arcmin, double y_arcmin),
                       placido_error *err);

/* The readers of single formats: samples in metres, as they stand in the file, one plane. Free with
 * placido_image_free. `size` (width, height) is the only one that they take. PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_depth_read_exr(placido_image *metres, const placido_depth_file *file, const int size[2],
                           placido_error *err);
int placido_depth_read_pfm(placido_image *metres, const placido_depth_file *file, const int size[2],
                           placido_error *err);

/* PLACIDO_INPUT with the reason where a map of width_px * height_px is not `size`. */
int placido_depth_check_size(const placido_depth_file *file, long width_px, long height_px,
                             const int size[2], placido_error *err);

#endif

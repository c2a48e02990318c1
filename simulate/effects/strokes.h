/* A sketch of how light is spread: a few rays, a few wavelengths. Enough to tell whether leaving
 * something out would be seen; never seen itself. */
#ifndef PLACIDO_SIMULATE_STROKES_H
#define PLACIDO_SIMULATE_STROKES_H

#include <placido/diffraction.h>
#include <placido/eye.h>
#include <placido/surface.h>
#include <stdbool.h>

enum { PLACIDO_SKETCH_RINGS = 6, PLACIDO_SKETCH_RAYS = 3 * PLACIDO_SKETCH_RINGS * PLACIDO_SKETCH_RINGS };
enum { PLACIDO_SKETCH_WAVES = 5, PLACIDO_LIGHTS_MAX = 3 };

/* Rays at the nodes of the disc quadrature over the pupil of a settled eye. Angles are those at
 * which light is seen, arcmin, x and y of the retina as the cornea has them (not turned for the
 * patient), from the point of fixation. */
typedef struct placido_sketch_rays {
  int count;                              /* those that arrive, at most PLACIDO_SKETCH_RAYS */
  float x_mm[PLACIDO_SKETCH_RAYS], y_mm[PLACIDO_SKETCH_RAYS]; /* in the pupil, from its centre */
  float angle_x[PLACIDO_SKETCH_RAYS], angle_y[PLACIDO_SKETCH_RAYS];
  float weight[PLACIDO_SKETCH_RAYS];      /* sum to 1 */
} placido_sketch_rays;

/* Some waves of a light, weights summing to 1. */
typedef struct placido_sketch_light {
  int count;
  placido_wave waves[PLACIDO_SKETCH_WAVES];
} placido_sketch_light;

/* What an effect does to a sketch; what is zero it leaves alone. */
typedef struct placido_strokes {
  bool turns, dims, varies;
  float angle_x[PLACIDO_SKETCH_RAYS], angle_y[PLACIDO_SKETCH_RAYS]; /* turns: added, arcmin */
  float half_x[PLACIDO_SKETCH_RAYS], half_y[PLACIDO_SKETCH_RAYS];   /* varies: turns half-way from
                                                   the picture's middle, where there are none */
  float weight[PLACIDO_SKETCH_RAYS];                                /* dims: factors */
  int lights;                                   /* 1, or one a colour: in place of one wavelength */
  placido_sketch_light light[PLACIDO_LIGHTS_MAX];
  double shift_x_arcmin, shift_y_arcmin;        /* of a wave, per dioptre of its defocus_D */
  double defocus_D;                             /* of the part of the scene that is worst off */
  double relief_D;                              /* added to that: the part that is best off */
  bool waves;                                   /* light diffracts */
  double aperture_arcmin;                       /* light is averaged over a square of this width */
} placido_strokes;

#endif

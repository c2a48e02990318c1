/* A sketch of how an eye spreads light, with what effects do to it, and its transfer function:
 * what the planner looks at in place of pictures. */
#ifndef PLACIDO_SIMULATE_PLAN_SKETCH_H
#define PLACIDO_SIMULATE_PLAN_SKETCH_H

#include "simulate/effects/facts.h"
#include "simulate/effects/strokes.h"

#include <placido/eye.h>
#include <placido/surface.h>

enum {
  PLACIDO_SKETCH_LANES = 16,
  PLACIDO_SKETCH_ROOM = 112,       /* for the rays: whole lanes */
  PLACIDO_SKETCH_DIRECTIONS = 4,   /* 0, 45, 90 and 135 degrees: pictures have edges along axes */
  PLACIDO_SKETCH_FREQUENCIES = 21, /* half octaves from 0.125 to 128 cycles/degree */
};

/* How a quantity changes across each ray's cell of the pupil, from its neighbours' rays: factors of
 * differences between rays number `from` and `to`, along the circle and outwards. */
typedef struct placido_sketch_cell {
  short before, after, inner, outer;
  float around, outwards;
} placido_sketch_cell;

/* Rays of an eye, and for each direction where they pass. */
typedef struct placido_sketch {
  placido_sketch_rays rays;
  double pupil_mm;
  placido_sketch_cell cells[PLACIDO_SKETCH_RAYS];
  float place_mm[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_ROOM]; /* along the direction */
  float around_mm[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_ROOM]; /* its change across the cell */
  float outwards_mm[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_ROOM];
  float rim_mm[PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_ROOM]; /* way to the nearer rim */
} placido_sketch;

/* The optical transfer function in a few directions, of each light. */
typedef struct placido_sketch_otf {
  int lights; /* 1: of all planes of the picture */
  float re[PLACIDO_LIGHTS_MAX][PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES];
  float im[PLACIDO_LIGHTS_MAX][PLACIDO_SKETCH_DIRECTIONS][PLACIDO_SKETCH_FREQUENCIES];
} placido_sketch_otf;

/* The frequency of number `index`, cycles/degree. */
double placido_sketch_frequency_cpd(int index);

/* Angle of direction number `index`, degrees from x. */
double placido_sketch_direction_deg(int index);

/* All the rays of a pupil without aberrations: angles of 0. */
void placido_sketch_disc(placido_sketch *sketch, double pupil_mm);

/* The rays of an eye whose focus is found, cornea alone, against `fixation_mm` on its retina. False
 * where none arrives. */
bool placido_sketch_trace(placido_sketch *sketch, const placido_surface *surface,
                          const placido_eye *eye, const double fixation_mm[2]);

/* Adds what an effect does to what others do: angles and defocus add up, weights multiply, squares
 * of apertures add up; its lights take the place of those before. `whole` is zeroed before the
 * first. */
void placido_strokes_add(placido_strokes *whole, const placido_strokes *part, int rays);

/* What the strokes make of the sketch. By rays: each stands for its cell, whose light is spread
 * evenly over what it becomes. By waves: of the rays those whose cell overlaps the pupil shifted
 * by wavelength times frequency (J. W. Goodman, Introduction to Fourier Optics, 6.3-6.4, with the
 * wavefront's slope for its difference), and of their weights together what the pupil without
 * aberrations overlaps. A sketch's transfer is the same bits on every machine. */
void placido_sketch_transfer(placido_sketch_otf *otf, const placido_sketch *sketch,
                             const placido_strokes *strokes);

/* What a picture's samples are when spread light falls into them. */
typedef struct placido_sketch_scale {
  double sample_arcmin; /* of the scene */
  double bucket_arcmin; /* of the seen picture */
} placido_sketch_scale;

/* At most so much of the seen picture differs between two transfer functions: linear light relative
 * to white, up to white. See bound.c. */
double placido_sketch_bound(const placido_sketch_otf *one, const placido_sketch_otf *other,
                            const placido_facts *facts, const placido_sketch_scale *scale);

#endif

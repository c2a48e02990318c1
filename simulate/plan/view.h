/* A run of a plan: what effects set before light is spread, and the picture after it. */
#ifndef PLACIDO_SIMULATE_VIEW_H
#define PLACIDO_SIMULATE_VIEW_H

#include "simulate/effects/facts.h"
#include "simulate/ocular/ocular.h"

#include <placido/convolution.h>
#include <placido/diffraction.h>
#include <placido/plan.h>

enum { PLACIDO_WAVES_MAX = 31, PLACIDO_VIEW_LIGHTS = 3, PLACIDO_NODES_SIDE_MAX = 9 };

/* The wavelengths of a light, weights summing to 1. */
typedef struct placido_light {
  int count;
  placido_wave waves[PLACIDO_WAVES_MAX];
} placido_light;

/* Part of the scene at one distance, in the size of the canvas. */
typedef struct placido_layer {
  double defocus_D;      /* more power of the eye than this distance needs */
  placido_image light;   /* its light, weighted by cover; colours only */
  float *cover;          /* share of each pixel that it covers; NULL: whatever nearer ones leave */
} placido_layer;

/* The view. What effects do not touch is the cornea alone, on the axis, by rays, in one colour, far
 * away. Owned by placido_view_run, which frees everything in it. */
typedef struct placido_view {
  const placido_surface *surface;
  const placido_scene *scene;
  const placido_facts *facts;
  const placido_plan_settings *settings;
  int threads;

  /* EYE, PUPIL */
  placido_eye eye;              /* settled */
  enum placido_correct open;    /* what of it was sought */
  placido_ocular ocular;        /* what is behind the cornea, and how the retina is curved */
  double apodisation_per_mm2;   /* rho of 10^(-rho r²) for a ray's light [0] */
  double apodisation_x_mm, apodisation_y_mm; /* where it peaks, from the corneal axis */

  /* SPECTRUM: one light for all planes of the picture, or one for each of its three */
  int light_count;
  placido_light lights[PLACIDO_VIEW_LIGHTS];
  double shift_mm[2];           /* of the pupil's centre from the achromatic axis: a wave's image
                                   moves by that times its defocus_D */
  bool shifts;                  /* whether waves move at all, here and off the axis */

  /* PSF */
  bool waves;                   /* light diffracts */

  /* FIELD: nodes a side, in a grid over the picture; 1: one in its middle */
  int nodes;

  /* the scene at the PSF's scale, its bleed included */
  placido_image canvas;         /* borrowed: the run frees it */
  int bleed_px;
  bool holes;                   /* the canvas has alpha other than 1: colours are weighted by it */
  int layer_count;              /* 0: the canvas is all there is, in focus */
  placido_layer *layers;        /* from far to near */
  double core;                  /* share of the light in the traced spread [1]; IMAGE adds the rest */

  placido_psf psf;              /* spread in the middle, first light, what is in focus */
  placido_image seen;           /* from IMAGE on: the spread picture, bleed included */
} placido_view;

#endif

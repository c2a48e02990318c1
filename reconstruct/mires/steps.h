/* Blurred steps fitted to short profiles, many abreast. */
#ifndef PLACIDO_MIRES_STEPS_H
#define PLACIDO_MIRES_STEPS_H

#define PLACIDO_STEPS_LANES 8
#define PLACIDO_STEPS_SAMPLES 64 /* most that a profile may have */

#define PLACIDO_STEPS_UNUSED 0.0F
#define PLACIDO_STEPS_KNOWN 1.0F
#define PLACIDO_STEPS_CLIPPED 2.0F /* the value or more: pulls only steps that fall short of it */

/* A blurred step: offset + height·(Φ((r - place)/width) - 1/2), Φ the normal distribution; one a
 * lane. Places are in px from an origin of the lane's own. */
typedef struct placido_step_lanes {
  float place[PLACIDO_STEPS_LANES], offset[PLACIDO_STEPS_LANES];
  float height[PLACIDO_STEPS_LANES], width[PLACIDO_STEPS_LANES];
} placido_step_lanes;

/* What is fitted to what. Unused lanes hold zeros, but for a width of 1. */
typedef struct placido_steps {
  int samples; /* of the longest lane */
  float value[PLACIDO_STEPS_SAMPLES][PLACIDO_STEPS_LANES];
  float weight[PLACIDO_STEPS_SAMPLES][PLACIDO_STEPS_LANES]; /* one of PLACIDO_STEPS_... below */
  float first[PLACIDO_STEPS_LANES], pitch[PLACIDO_STEPS_LANES]; /* sample i at first + i·pitch */
  placido_step_lanes step;          /* in: a guess; out: the fit */
  float usual[PLACIDO_STEPS_LANES]; /* width that is expected, */
  float hold[PLACIDO_STEPS_LANES];  /* and the weight of (width - usual)² beside the residuals' */
  float squares[PLACIDO_STEPS_LANES]; /* out: sum of squared residuals */
  float spread[PLACIDO_STEPS_LANES];  /* out: variance of `place` for samples of variance 1 */
  float held[PLACIDO_STEPS_LANES];    /* out: share of what is known of the width that is `hold` */
} placido_steps;

/* Takes a neighbouring step's tail off the values: of a step that lies inwards what is missing of
 * its full height, of one that lies outwards what is there of it. height 0: no neighbour. */
void placido_steps_take_off(placido_steps *steps, const placido_step_lanes *neighbour,
                            int is_inner);

/* The background of a step: it rises by rise·t + bend·t², t px from `place`. */
typedef struct placido_step_light {
  float place[PLACIDO_STEPS_LANES];
  float rise[PLACIDO_STEPS_LANES], bend[PLACIDO_STEPS_LANES];
} placido_step_light;

/* Takes off what the background differs by from that at `place`. */
void placido_steps_even(placido_steps *steps, const placido_step_light *light);

/* Least squares by Gauss-Newton, place, offset, height and width free, until no place moves by more
 * than settled_px: the next step would be about its square. */
void placido_steps_fit(placido_steps *steps, float settled_px);

#endif

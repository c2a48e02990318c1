/* Gauss-Newton on eight blurred steps at a time: every loop over lanes is one that compilers turn
 * into vector instructions, so there are no branches in them and no calls. */
#include "reconstruct/mires/steps.h"

#include "reconstruct/vector.h"

#include <math.h>

#define LANES PLACIDO_STEPS_LANES
#define PASSES 8
/* Weight of a clipped sample that the step reaches beyond: just enough to bound its height. */
#define BEYOND 0.03F
#define WIDTH_LEAST 0.3F

/* The normal density at x and the distribution less a half. The error function by Abramowitz and
 * Stegun 7.1.26, absolute error 1.5e-7; the exponential by its 32nd root, relative error 4e-6. */
PLACIDO_INSIDE void normal(float x, float *bell, float *wave) {
  float z = x * x < 50 ? x * x : 50, u = z * (-1.0F / 64);
  float e = 1 + u * (1 + u * (1.0F / 2 + u * (1.0F / 6 + u * (1.0F / 24 + u * (1.0F / 120 +
            u * (1.0F / 720))))));
  e *= e;
  e *= e;
  e *= e;
  e *= e;
  e *= e;
  float t = 1 / (1 + 0.3275911F * 0.70710678F * fabsf(x));
  float rest = t * (0.254829592F + t * (-0.284496736F + t * (1.421413741F +
               t * (-1.453152027F + t * 1.061405429F)))) * e;
  float half = 0.5F * (1 - rest);
  *wave = x < 0 ? -half : half;
  *bell = 0.39894228F * e;
}

PLACIDO_WIDE void placido_steps_take_off(placido_steps *s, const placido_step_lanes *n,
                                         int is_inner) {
  float gone = is_inner ? -0.5F : 0.5F;
  for (int i = 0; i < s->samples; i++) {
    for (int l = 0; l < LANES; l++) {
      float bell, wave, r = s->first[l] + (float)i * s->pitch[l];
      normal((r - n->place[l]) / n->width[l], &bell, &wave);
      s->value[i][l] -= n->height[l] * (wave + gone);
    }
  }
}

PLACIDO_WIDE void placido_steps_even(placido_steps *s, const placido_step_light *p) {
  for (int i = 0; i < s->samples; i++) {
    for (int l = 0; l < LANES; l++) {
      float t = s->first[l] + (float)i * s->pitch[l] - p->place[l];
      s->value[i][l] -= t * (p->rise[l] + t * p->bend[l]);
    }
  }
}

/* Normal equations of the four parameters, lower triangle row by row, and the right-hand side. The
 * order is offset, height, width, place: the last pivot is the place's alone. */
typedef struct equations {
  float a[10][LANES], b[4][LANES];
} equations;

PLACIDO_INSIDE void gather(equations *e, placido_steps *s) {
  *e = (equations){0};
  const placido_step_lanes *p = &s->step;
  for (int l = 0; l < LANES; l++) {
    s->squares[l] = 0;
    e->a[5][l] = s->hold[l];
    e->b[2][l] = s->hold[l] * (s->usual[l] - p->width[l]);
  }
  for (int i = 0; i < s->samples; i++) {
    for (int l = 0; l < LANES; l++) {
      float bell, wave, inverse = 1 / p->width[l];
      float x = (s->first[l] + (float)i * s->pitch[l] - p->place[l]) * inverse;
      normal(x, &bell, &wave);
      float error = s->value[i][l] - (p->offset[l] + p->height[l] * wave);
      float weight = s->weight[i][l];
      weight = weight > 1 ? (error > 0 ? 1.0F : BEYOND) : weight;
      float by_place = -p->height[l] * bell * inverse;
      float by_width = by_place * x, we = weight * error, ww = weight * wave;
      float wv = weight * by_width, wp = weight * by_place;
      s->squares[l] += we * error;
      e->a[0][l] += weight;
      e->a[1][l] += ww;
      e->a[2][l] += ww * wave;
      e->a[3][l] += wv;
      e->a[4][l] += wv * wave;
      e->a[5][l] += wv * by_width;
      e->a[6][l] += wp;
      e->a[7][l] += wp * wave;
      e->a[8][l] += wp * by_width;
      e->a[9][l] += wp * by_place;
      e->b[0][l] += we;
      e->b[1][l] += we * wave;
      e->b[2][l] += we * by_width;
      e->b[3][l] += we * by_place;
    }
  }
}

PLACIDO_INSIDE float least(float value, float limit) {
  return value > limit ? value : limit;
}

/* Solves by LDL' and moves the steps; no further than half a width at a time. Returns the longest
 * move of a place. */
PLACIDO_INSIDE float solve(placido_steps *s, const equations *e) {
  float moved[LANES];
  for (int l = 0; l < LANES; l++) {
    float d0 = least(e->a[0][l], 1e-9F);
    float l1 = e->a[1][l] / d0, l3 = e->a[3][l] / d0, l6 = e->a[6][l] / d0;
    float d1 = least(e->a[2][l] - l1 * e->a[1][l], 1e-9F);
    float e4 = e->a[4][l] - l3 * e->a[1][l], e7 = e->a[7][l] - l6 * e->a[1][l];
    float l4 = e4 / d1, l7 = e7 / d1;
    float d2 = least(e->a[5][l] - l3 * e->a[3][l] - l4 * e4, 1e-12F);
    float e8 = e->a[8][l] - l6 * e->a[3][l] - l7 * e4;
    float l8 = e8 / d2;
    float d3 = least(e->a[9][l] - l6 * e->a[6][l] - l7 * e7 - l8 * e8, 1e-12F);
    float y0 = e->b[0][l], y1 = e->b[1][l] - l1 * y0;
    float y2 = e->b[2][l] - l3 * y0 - l4 * y1, y3 = e->b[3][l] - l6 * y0 - l7 * y1 - l8 * y2;
    float place = y3 / d3, width = y2 / d2 - l8 * place;
    float height = y1 / d1 - l4 * width - l7 * place;
    float offset = y0 / d0 - l1 * height - l3 * width - l6 * place;
    float before = s->usual[l] - s->step.width[l], after = before - width;
    float gain = y0 * y0 / d0 + y1 * y1 / d1 + y2 * y2 / d2 + y3 * y3 / d3;
    gain -= s->hold[l] * (before * before - after * after);
    s->squares[l] = least(s->squares[l] - gain, 0);
    float limit = 0.5F * s->step.width[l];
    place = place > limit ? limit : place < -limit ? -limit : place;
    width = width > limit ? limit : width < -limit ? -limit : width;
    s->spread[l] = 1 / d3;
    s->held[l] = s->hold[l] / d2;
    s->step.place[l] += place;
    s->step.width[l] = least(s->step.width[l] + width, WIDTH_LEAST);
    s->step.height[l] += height;
    s->step.offset[l] += offset;
    moved[l] = fabsf(place);
  }
  float longest = 0;
  for (int l = 0; l < LANES; l++) {
    longest = moved[l] > longest ? moved[l] : longest;
  }
  return longest;
}

PLACIDO_WIDE void placido_steps_fit(placido_steps *steps, float settled_px) {
  equations e;
  float moved = INFINITY;
  for (int pass = 0; pass < PASSES && moved > settled_px; pass++) {
    gather(&e, steps);
    moved = solve(steps, &e);
  }
}

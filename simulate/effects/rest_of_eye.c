/* The rest of the eye: the back of the cornea and the crystalline lens, accommodating, bend what
 * the measured cornea has bent. With them the cornea has an index of its own, not the keratometric
 * one that stands for all of it. */
#include "base/dense.h"
#include "simulate/effects/aside.h"
#include "simulate/focus.h"
#include "simulate/models/accommodation.h"
#include "simulate/plan/view.h"

#include <math.h>
#include <stdio.h>

enum { TERMS = 5, STEPS = 2 }; /* tip, tilt, sphere, J0, J45 */

static const double accommodation_max_D = 10;
static const double wide_share = 0.25; /* of the spread: so few rays have no narrower core */

static placido_ocular whole_eye(const placido_facts *facts, double age_years) {
  double response_D = placido_accommodation_response_D(facts->focus_D, age_years);
  return (placido_ocular){.whole = true,
                          .accommodation_D = fmin(response_D, accommodation_max_D)};
}

/* How many terms the eye's search leaves free. */
static int terms_of(enum placido_correct open) {
  return open == PLACIDO_CORRECT_FULL ? TERMS : open == PLACIDO_CORRECT_SPHERE ? 3 : 2;
}

/* Where rays are seen, and the terms that bring the eye to its focus. */
typedef struct fan {
  const placido_sketch_rays *rays;
  int terms;
  double wide_arcmin; /* of the profile by which light counts */
  double by[TERMS];
  double x[PLACIDO_SKETCH_RAYS], y[PLACIDO_SKETCH_RAYS];
} fan;

static double across(const fan *f, int i) {
  double u = (double)f->rays->x_mm[i], v = (double)f->rays->y_mm[i];
  return f->x[i] - f->by[0] - (f->by[2] + f->by[3]) * u - f->by[4] * v;
}

static double along(const fan *f, int i) {
  double u = (double)f->rays->x_mm[i], v = (double)f->rays->y_mm[i];
  return f->y[i] - f->by[1] - (f->by[2] - f->by[3]) * v - f->by[4] * u;
}

/* Adds the equations of a ray that the terms shall move by (x, y). */
static void add_ray(double square[TERMS][TERMS], double sum[TERMS], const fan *f, int i,
                    double weight, double x, double y) {
  double u = (double)f->rays->x_mm[i], v = (double)f->rays->y_mm[i];
  const double right[TERMS] = {1, 0, u, u, v}, up[TERMS] = {0, 1, v, -v, u};
  for (int k = 0; k < f->terms; k++) {
    sum[k] += weight * (right[k] * x + up[k] * y);
    for (int j = 0; j <= k; j++) {
      square[k][j] += weight * (right[k] * right[j] + up[k] * up[j]);
    }
  }
}

/* A step of the terms: to where `to` has its rays, as those of them count; or, where that is NULL,
 * to where the light is densest. Light counts as in the search of the focus (pencil.h). */
static void step(fan *f, const fan *to) {
  double square[TERMS][TERMS] = {{0}}, change[TERMS] = {0};
  for (int i = 0; i < f->rays->count; i++) {
    double x = across(f, i), y = along(f, i), to_x = to ? to->x[i] : 0, to_y = to ? to->y[i] : 0;
    double u = to ? to_x : x, v = to ? to_y : y;
    double near = 1 / (1 + (u * u + v * v) / (f->wide_arcmin * f->wide_arcmin));
    double weight = (double)f->rays->weight[i] * near * near * sqrt(near);
    add_ray(square, change, f, i, weight, x - to_x, y - to_y);
  }
  if (placido_dense_factor(&square[0][0], f->terms, TERMS, 1e-9)) {
    placido_dense_solve(&square[0][0], f->terms, TERMS, change);
    for (int k = 0; k < f->terms; k++) {
      f->by[k] += change[k];
    }
  }
}

/* Rays as the sketch has them. */
static void take_sketch(fan *f, const placido_sketch_rays *rays, enum placido_correct open) {
  double square = 0;
  *f = (fan){.rays = rays, .terms = terms_of(open)};
  for (int i = 0; i < rays->count; i++) {
    f->x[i] = (double)rays->angle_x[i];
    f->y[i] = (double)rays->angle_y[i];
    square += (double)rays->weight[i] * (f->x[i] * f->x[i] + f->y[i] * f->y[i]);
  }
  f->wide_arcmin = fmax(PLACIDO_FOCUS_WIDTH_ARCMIN, wide_share * sqrt(square));
}

/* Where they go in the whole eye; false where it has no retina. One that does not arrive stays
 * where it was, as sketches cannot lose rays. */
static bool land(fan *f, const placido_question *question, const placido_ocular *ocular) {
  static const double axis_deg[2] = {0, 0}, no_offset[2] = {0, 0};
  const placido_sketch_rays *rays = question->rays;
  float x[PLACIDO_SKETCH_RAYS], y[PLACIDO_SKETCH_RAYS];
  placido_eye eye = *question->eye;
  if (placido_ocular_retina(&eye.retina_mm, question->surface, question->eye, ocular, NULL) !=
      PLACIDO_OK) {
    return false;
  }
  placido_ocular_angles(x, y, rays->x_mm, rays->y_mm, rays->count, question->surface, &eye, ocular,
                        axis_deg, no_offset);
  for (int i = 0; i < rays->count; i++) {
    if (isfinite(x[i]) && isfinite(y[i])) {
      f->x[i] = (double)x[i];
      f->y[i] = (double)y[i];
    }
  }
  return true;
}

/* The turns of the rays between the two eyes, each in its focus. That of the whole eye is sought
 * from that of the cornea alone, by the same few steps for both: what so few rays would find by
 * chance falls out. Tests hold them against the search itself. */
static void find_turns(placido_strokes *strokes, const placido_question *question,
                       const placido_ocular *ocular) {
  fan alone, whole;
  take_sketch(&alone, question->rays, question->open);
  whole = alone;
  if (!land(&whole, question, ocular)) {
    return;
  }
  step(&whole, &alone);
  for (int i = 0; i < STEPS; i++) {
    step(&whole, NULL);
    step(&alone, NULL);
  }
  for (int i = 0; i < alone.rays->count; i++) {
    strokes->angle_x[i] = (float)(across(&whole, i) - across(&alone, i));
    strokes->angle_y[i] = (float)(along(&whole, i) - along(&alone, i));
  }
}

static double rms_arcmin(const placido_strokes *strokes, const placido_sketch_rays *rays) {
  double sum = 0;
  for (int i = 0; i < rays->count; i++) {
    double x = (double)strokes->angle_x[i], y = (double)strokes->angle_y[i];
    sum += (double)rays->weight[i] * (x * x + y * y);
  }
  return sqrt(sum);
}

/* Off the middle both eyes turn rays in their own ways, which those of the field have for the whole
 * eye only: where that makes more of a difference than on the axis, the difference there counts. */
static void look_aside(placido_strokes *strokes, const placido_question *question,
                       const placido_ocular *ocular) {
  const placido_ocular alone = {.whole = false};
  const placido_sketch_rays *rays = question->rays;
  placido_strokes there = *strokes;
  float whole_x[PLACIDO_SKETCH_RAYS], whole_y[PLACIDO_SKETCH_RAYS];
  float alone_x[PLACIDO_SKETCH_RAYS], alone_y[PLACIDO_SKETCH_RAYS];
  double field_deg[2], retina_mm;
  if ((question->refused & PLACIDO_GIVES_FIELD) != 0 ||
      placido_ocular_retina(&retina_mm, question->surface, question->eye, ocular, NULL) !=
        PLACIDO_OK) {
    return;
  }
  placido_aside_deg(field_deg, question);
  placido_aside_turns(whole_x, whole_y, question, ocular, retina_mm, field_deg);
  placido_aside_turns(alone_x, alone_y, question, &alone, question->eye->retina_mm, field_deg);
  for (int i = 0; i < rays->count; i++) {
    there.angle_x[i] += whole_x[i] - alone_x[i];
    there.angle_y[i] += whole_y[i] - alone_y[i];
  }
  if (rms_arcmin(&there, rays) > rms_arcmin(strokes, rays)) {
    *strokes = there;
  }
}

/* The focus is sought again; rays pass three surfaces more. */
static double cost_ms(const placido_question *question) {
  const double search_ms = 5, sample_ms = 2e-5, sample_mm = 0.025;
  double across = question->eye->pupil_mm / sample_mm;
  return search_ms + sample_ms * across * across;
}

static void ask(const placido_question *question, placido_answer *answer) {
  placido_ocular ocular = whole_eye(question->facts, question->eye->age_years);
  find_turns(answer->strokes, question, &ocular);
  look_aside(answer->strokes, question, &ocular);
  answer->applies = answer->strokes->turns = true;
  answer->cost_ms = cost_ms(question);
  double turned = rms_arcmin(answer->strokes, question->rays);
  if (ocular.accommodation_D > 0) {
    snprintf(answer->reason, sizeof answer->reason,
             "the cornea's back and the lens, accommodating by %.2f D, turn the rays of the %.2g "
             "mm pupil by %.2g' (rms)",
             ocular.accommodation_D, question->eye->pupil_mm, turned);
  } else {
    snprintf(answer->reason, sizeof answer->reason,
             "the cornea's back and the lens at rest turn the rays of the %.2g mm pupil by %.2g' "
             "(rms)",
             question->eye->pupil_mm, turned);
  }
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  placido_ocular whole = whole_eye(view->facts, view->eye.age_years);
  view->ocular.whole = whole.whole;
  view->ocular.accommodation_D = whole.accommodation_D;
  placido_eye eye = view->eye;
  return placido_ocular_focus(&view->eye, &view->ocular, view->surface, &eye, view->open, err);
}

const placido_effect placido_effect_rest_of_eye = {
  .name = "rest-of-eye",
  .summary = "the cornea's back and the crystalline lens refract, too",
  .stage = PLACIDO_STAGE_EYE,
  .gives = PLACIDO_GIVES_WHOLE_EYE,
  .ask = ask,
  .apply = apply,
};

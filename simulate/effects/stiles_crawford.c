/* The Stiles-Crawford effect: cones see less of the light that comes through the pupil's rim.
 *
 * A ray counts 10^(-rho r²), rho = 0.05 /mm² (R. A. Applegate, V. Lakshminarayanan, J. Opt. Soc.
 * Am. A 10, 1611 (1993)); a wave's amplitude the square root of that. What counts is where light
 * goes, not how much: the sum of all rays stays. */
#include "simulate/effects/effect.h"
#include "simulate/plan/view.h"

#include <math.h>
#include <stdio.h>

static const double rho_per_mm2 = 0.05;

/* The peak, from the corneal axis. Cones point at a fixed place of the eye, on the average 0.4 mm
 * nasally of the pupil's middle; so does the corneal axis, and which eye it is is not known. */
static const double peak_x_mm = 0, peak_y_mm = 0;

static double counts(double x_mm, double y_mm) {
  double x = x_mm - peak_x_mm, y = y_mm - peak_y_mm;
  return pow(10, -rho_per_mm2 * (x * x + y * y));
}

/* Factors of the rays, such that all their weights keep their sum. */
static void dim(placido_strokes *strokes, const placido_sketch_rays *rays, const placido_eye *eye) {
  double before = 0, after = 0;
  for (int i = 0; i < rays->count; i++) {
    double factor = counts(eye->pupil_x_mm + (double)rays->x_mm[i],
                           eye->pupil_y_mm + (double)rays->y_mm[i]);
    strokes->weight[i] = (float)factor;
    before += (double)rays->weight[i];
    after += (double)rays->weight[i] * factor;
  }
  for (int i = 0; i < rays->count && after > 0; i++) {
    strokes->weight[i] *= (float)(before / after);
  }
  strokes->dims = after > 0;
}

static void ask(const placido_question *question, placido_answer *answer) {
  const placido_eye *eye = question->eye;
  const double weighing_ms = 0.3; /* a power for each sample of the pupil */
  double rim_mm = eye->pupil_mm / 2;
  double off_mm = hypot(eye->pupil_x_mm - peak_x_mm, eye->pupil_y_mm - peak_y_mm);
  dim(answer->strokes, question->rays, eye);
  answer->applies = answer->strokes->dims;
  answer->cost_ms = weighing_ms;
  snprintf(answer->reason, sizeof answer->reason,
           "through the rim of a pupil of %.3g mm light counts %.0f %% of what it does in its best "
           "place",
           eye->pupil_mm, 100 * counts(peak_x_mm + rim_mm + off_mm, peak_y_mm));
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  (void)err;
  view->apodisation_per_mm2 = rho_per_mm2;
  view->apodisation_x_mm = peak_x_mm;
  view->apodisation_y_mm = peak_y_mm;
  return PLACIDO_OK;
}

const placido_effect placido_effect_stiles_crawford = {
  .name = "stiles-crawford",
  .summary = "light through the pupil's rim counts less",
  .stage = PLACIDO_STAGE_PUPIL,
  .ask = ask,
  .apply = apply,
};

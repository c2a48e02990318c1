/* Longitudinal chromatic aberration: the eye has more power for blue than for red, so that only
 * light of about 555 nm is in focus. L. N. Thibos, M. Ye, X. Zhang, A. Bradley, Applied Optics 31,
 * 3594 (1992), as a difference of focus; the light's wavelengths from its spectrum. */
#include "simulate/effects/effect.h"
#include "simulate/plan/view.h"
#include "simulate/spectrum/spectrum.h"

#include <math.h>
#include <stdio.h>

/* How much the focus differs between the lights' ends, which are wider than their few waves: from
 * the bluest of these to the reddest. */
static double spread_D(const placido_strokes *strokes) {
  double most = -INFINITY, least = INFINITY;
  for (int k = 0; k < strokes->lights; k++) {
    for (int i = 0; i < strokes->light[k].count; i++) {
      most = fmax(most, strokes->light[k].waves[i].defocus_D);
      least = fmin(least, strokes->light[k].waves[i].defocus_D);
    }
  }
  return most - least;
}

static void sketch(placido_strokes *strokes, const placido_question *question) {
  placido_light lights[PLACIDO_VIEW_LIGHTS];
  strokes->lights =
    placido_spectrum_lights(lights, &question->scene->conditions, question->facts->planes,
                            PLACIDO_SKETCH_WAVES, PLACIDO_FOCUS_NM);
  for (int k = 0; k < strokes->lights; k++) {
    strokes->light[k].count = lights[k].count;
    for (int i = 0; i < lights[k].count; i++) {
      strokes->light[k].waves[i] = lights[k].waves[i];
    }
  }
}

static void ask(const placido_question *question, placido_answer *answer) {
  const placido_conditions *conditions = &question->scene->conditions;
  if (placido_spectrum_is_line(conditions)) {
    snprintf(answer->reason, sizeof answer->reason,
             "the light has one wavelength, %.0f nm, in which the eye is focused",
             conditions->wavelength_nm);
    return;
  }
  sketch(answer->strokes, question);
  double differs_D = spread_D(answer->strokes), pupil_mm = question->eye->pupil_mm;
  answer->applies = true;
  snprintf(answer->reason, sizeof answer->reason,
           "between the light's blue and red the eye's focus differs by %.1f D, which a pupil of "
           "%.1f mm spreads over %.1f'",
           differs_D, pupil_mm, differs_D * pupil_mm / 2 * PLACIDO_ARCMIN_PER_D_MM);
}

static int apply(void *state, placido_view *view, placido_error *err) {
  const placido_conditions *conditions = &view->scene->conditions;
  (void)state;
  (void)err;
  view->light_count = placido_spectrum_lights(
    view->lights, conditions, view->facts->planes, view->settings->wavelengths,
    placido_spectrum_focus_nm(conditions));
  return PLACIDO_OK;
}

const placido_effect placido_effect_longitudinal_chromatic = {
  .name = "longitudinal-chromatic",
  .summary = "the eye's power, and so its focus, changes with the wavelength",
  .stage = PLACIDO_STAGE_SPECTRUM,
  .gives = PLACIDO_GIVES_SPECTRUM,
  .ask = ask,
  .apply = apply,
};

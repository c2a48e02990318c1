/* Transverse chromatic aberration: images of unlike wavelengths lie side by side where the pupil is
 * off the axis or light comes from the side (spectrum/transverse.c). */
#include "simulate/effects/aside.h"
#include "simulate/plan/view.h"
#include "simulate/spectrum/spectrum.h"

#include <math.h>
#include <stdio.h>

/* The largest shift as far off the middle as matters most: on which side of it that is does not
 * count, as the pupil may be off the axis. Returns how much of the scene's contrast meets it: what
 * the pupil's place does is the same everywhere. */
static double worst_shift(double shift_mm[2], double place_deg[2],
                          const placido_question *question) {
  const double pupil_mm[2] = {question->eye->pupil_x_mm, question->eye->pupil_y_mm};
  const double share = placido_aside_deg(place_deg, question);
  shift_mm[0] = shift_mm[1] = 0;
  for (int side = 0; side < 4; side++) {
    const double field_deg[2] = {side % 2 != 0 ? place_deg[0] : -place_deg[0],
                                 side / 2 != 0 ? place_deg[1] : -place_deg[1]};
    double found_mm[2];
    placido_transverse_shift(found_mm, pupil_mm, field_deg);
    if (hypot(found_mm[0], found_mm[1]) > hypot(shift_mm[0], shift_mm[1])) {
      shift_mm[0] = found_mm[0];
      shift_mm[1] = found_mm[1];
    }
  }
  return pupil_mm[0] == 0 && pupil_mm[1] == 0 ? share : 0;
}

static void ask(const placido_question *question, placido_answer *answer) {
  const placido_eye *eye = question->eye;
  double shift_mm[2], place_deg[2];
  if (placido_spectrum_is_line(&question->scene->conditions)) {
    snprintf(answer->reason, sizeof answer->reason, "the light has one wavelength, %.0f nm",
             question->scene->conditions.wavelength_nm);
    return;
  }
  answer->share = worst_shift(shift_mm, place_deg, question);
  double shift_arcmin = PLACIDO_ARCMIN_PER_D_MM * hypot(shift_mm[0], shift_mm[1]);
  answer->applies = true;
  answer->strokes->shift_x_arcmin = PLACIDO_ARCMIN_PER_D_MM * shift_mm[0];
  answer->strokes->shift_y_arcmin = PLACIDO_ARCMIN_PER_D_MM * shift_mm[1];
  snprintf(answer->reason, sizeof answer->reason,
           "the pupil is %.2f mm off the axis: %.1f degrees off the middle colours lie %.2f' apart for "
           "each dioptre between them",
           hypot(eye->pupil_x_mm, eye->pupil_y_mm), hypot(place_deg[0], place_deg[1]),
           shift_arcmin);
}

static int apply(void *state, placido_view *view, placido_error *err) {
  const double middle_deg[2] = {0, 0};
  const double pupil_mm[2] = {view->eye.pupil_x_mm, view->eye.pupil_y_mm};
  (void)state;
  (void)err;
  placido_transverse_shift(view->shift_mm, pupil_mm, middle_deg);
  view->shifts = true;
  return PLACIDO_OK;
}

const placido_effect placido_effect_transverse_chromatic = {
  .name = "transverse-chromatic",
  .summary = "images of unlike wavelengths lie side by side",
  .stage = PLACIDO_STAGE_SPECTRUM,
  .needs = PLACIDO_GIVES_SPECTRUM | PLACIDO_GIVES_FIELD,
  .ask = ask,
  .apply = apply,
};

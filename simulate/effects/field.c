/* The field: light from the side passes through another part of the cornea, because the entrance
 * pupil lies behind it, and meets a curved retina. Its mean place is no part of that: whoever has the
 * eye is used to where things are. What it does to colours is transverse chromatic aberration's,
 * which needs this. */
#include "simulate/effects/aside.h"
#include "simulate/plan/view.h"

#include <math.h>
#include <stdio.h>

/* Behind the whole eye, unless that is refused: what leaving that out would change here is its own
 * matter (rest_of_eye.c). */
static void ask(const placido_question *question, placido_answer *answer) {
  placido_ocular ocular = {.whole = (question->refused & PLACIDO_GIVES_WHOLE_EYE) == 0};
  double field_deg[2], retina_mm = question->eye->retina_mm;
  if (ocular.whole && placido_ocular_retina(&retina_mm, question->surface, question->eye, &ocular,
                                            NULL) != PLACIDO_OK) {
    ocular.whole = false;
  }
  answer->share = placido_aside_deg(field_deg, question);
  const double half_deg[2] = {field_deg[0] / 2, field_deg[1] / 2};
  placido_aside_turns(answer->strokes->half_x, answer->strokes->half_y, question, &ocular,
                      retina_mm, half_deg);
  double rms_arcmin = placido_aside_turns(answer->strokes->angle_x, answer->strokes->angle_y,
                                          question, &ocular, retina_mm, field_deg);
  answer->strokes->turns = answer->strokes->varies = answer->applies = rms_arcmin > 0;
  snprintf(answer->reason, sizeof answer->reason,
           "where that is seen most, %.1f degrees off the middle, rays are seen %.2g' from where "
           "they are in the middle",
           hypot(field_deg[0], field_deg[1]), rms_arcmin);
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  (void)err;
  view->nodes = view->settings->nodes;
  view->ocular.curved = true;
  return PLACIDO_OK;
}

const placido_effect placido_effect_field = {
  .name = "field",
  .summary = "light from the side passes the cornea elsewhere and meets a curved retina",
  .stage = PLACIDO_STAGE_FIELD,
  .gives = PLACIDO_GIVES_FIELD,
  .ask = ask,
  .apply = apply,
};

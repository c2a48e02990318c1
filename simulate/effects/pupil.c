/* The pupil follows the light of what is looked at, where the eye comes without one.
 *
 * The field that it adapts to is taken to be 60 degrees across, as in Watson and Yellott's
 * examples, and as bright as the picture is on the average. Scenes are cut-outs of some degrees
 * from rooms, streets and skies: were all around them dark, the pupil before a lit monitor would
 * be 6 mm and before a house by day 5 mm, which nobody has seen. */
#include "simulate/effects/coarse.h"
#include "simulate/effects/effect.h"
#include "simulate/models/pupil_diameter.h"

#include <stdio.h>

static const double pi = 3.14159265358979323846;
static const double adapting_field_deg = 60;

/* For the sentence: which age the formula was asked for, where that is not the eye's. */
static const char *age_note(double age_years) {
  return age_years < PLACIDO_PUPIL_YOUNGEST_YEARS  ? ", reckoned as at 20"
         : age_years > PLACIDO_PUPIL_OLDEST_YEARS ? ", reckoned as at 83"
                                                   : "";
}

static void follow_light(placido_eye *eye, const placido_question *question,
                         placido_answer *answer) {
  double age_years = eye->age_years > 0 ? eye->age_years : PLACIDO_EYE_AGE_YEARS;
  double luminance_cd_m2 = question->scene->conditions.luminance_cd_m2 *
                           placido_coarse_mean(question->facts, question->scene);
  double area_deg2 = pi * adapting_field_deg * adapting_field_deg / 4;
  eye->pupil_mm = placido_pupil_diameter_mm(luminance_cd_m2, area_deg2, false, age_years);
  answer->applies = true;
  answer->bound = 1; /* an eye without a pupil sees nothing */
  snprintf(answer->reason, sizeof answer->reason,
           "at %.3g cd/m2, the picture's mean, and %.0f years%s the pupil is %.2f mm",
           luminance_cd_m2, age_years, age_note(age_years), eye->pupil_mm);
}

static int settle(placido_eye *eye, const placido_question *question, enum placido_force force,
                  placido_answer *answer, placido_error *err) {
  const placido_scene *scene = question->scene;
  if (eye->pupil_mm > 0) {
    snprintf(answer->reason, sizeof answer->reason, "the pupil is given: %.3g mm%s", eye->pupil_mm,
             force == PLACIDO_FORCE_ON ? ", and stays" : "");
    return PLACIDO_OK;
  }
  if (force == PLACIDO_FORCE_OFF) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the pupil is neither given nor may it follow the light: expected a "
                             "pupil in mm, or the effect pupil not forced off");
  }
  if (!(scene->conditions.luminance_cd_m2 > 0)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "scene %s: the luminance of its white is not known, so the pupil "
                             "cannot follow it: expected luminance_cd_m2, or a pupil in mm",
                             scene->name);
  }
  follow_light(eye, question, answer);
  return PLACIDO_OK;
}

const placido_effect placido_effect_pupil = {
  .name = "pupil",
  .summary = "the pupil follows the light",
  .stage = PLACIDO_STAGE_PUPIL,
  .gives = PLACIDO_GIVES_PUPIL,
  .settle = settle,
};

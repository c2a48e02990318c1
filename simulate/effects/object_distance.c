/* What is near asks the eye to accommodate, as far as its age lets it; what is nearer or farther
 * than where it looks is out of focus. */
#include "simulate/depth/layers.h"
#include "simulate/effects/effect.h"
#include "simulate/models/accommodation.h"

#include <math.h>
#include <stdio.h>

/* Vergences closer than this are one: the blur between them is beyond any eye. */
static const double same_D = 1e-6;

/* The largest error of focus, with its sign: positive is more power than needed. */
static double find_worst(const placido_facts *facts, double response_D) {
  double near_D = response_D - facts->nearest_D, far_D = response_D - facts->farthest_D;
  return fabs(near_D) > fabs(far_D) ? near_D : far_D;
}

/* The smallest: what lies between the nearest and the farthest may be in focus. */
static double find_best(const placido_facts *facts, double response_D) {
  return response_D - fmin(fmax(response_D, facts->farthest_D), facts->nearest_D);
}

static void tell_ability(char *text, size_t size, double focus_D, double age_years) {
  double most_D = placido_accommodation_amplitude_D(age_years);
  double age = age_years > 0 ? age_years : PLACIDO_EYE_AGE_YEARS;
  if (focus_D <= most_D) {
    snprintf(text, size, "which the eye can at %.0f years", age);
  } else if (most_D > 0) {
    snprintf(text, size, "but at %.0f years the eye accommodates no more than %.2g D", age, most_D);
  } else {
    snprintf(text, size, "but at %.0f years the eye accommodates no more", age);
  }
}

static void tell(placido_answer *answer, const placido_facts *facts, double age_years) {
  char ability[64], *reason = answer->reason;
  const double range_D = facts->nearest_D - facts->farthest_D;
  tell_ability(ability, sizeof ability, facts->focus_D, age_years);
  if (facts->nearest_D <= same_D) {
    snprintf(reason, sizeof answer->reason, "everything is far away");
  } else if (range_D <= same_D && fabs(facts->nearest_D - facts->focus_D) <= same_D) {
    snprintf(reason, sizeof answer->reason, "everything stands at %.3g m and asks for %.2f D, %s",
             1 / facts->nearest_D, facts->nearest_D, ability);
  } else if (facts->focus_D > same_D) {
    snprintf(reason, sizeof answer->reason,
             "the nearest stands %.2f D before the farthest; looking at %.3g m asks for %.2f D, %s",
             range_D, 1 / facts->focus_D, facts->focus_D, ability);
  } else {
    snprintf(reason, sizeof answer->reason,
             "the nearest stands at %.3g m, %.2f D, and the eye looks far away",
             1 / facts->nearest_D, facts->nearest_D);
  }
}

static void ask(const placido_question *question, placido_answer *answer) {
  const placido_facts *facts = question->facts;
  double age_years = question->eye->age_years;
  double response_D = placido_accommodation_response_D(facts->focus_D, age_years);
  double worst_D = find_worst(facts, response_D);
  tell(answer, facts, age_years);
  answer->applies = fabs(worst_D) > same_D;
  if (answer->applies) {
    answer->strokes->defocus_D = worst_D;
    answer->strokes->relief_D = find_best(facts, response_D) - worst_D;
  }
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  return placido_layers_fill(
    view, placido_accommodation_response_D(view->facts->focus_D, view->eye.age_years), err);
}

const placido_effect placido_effect_object_distance = {
  .name = "object-distance",
  .summary = "what is nearer or farther than the eye can focus is blurred",
  .stage = PLACIDO_STAGE_FIELD,
  .ask = ask,
  .apply = apply,
};

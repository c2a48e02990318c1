/* What runs and what is left out. With everything running that applies, effects are asked in turn
 * what the picture without them would differ by, the others running; where that fits into what is
 * left of the tolerance, the effect goes. Each difference is between the picture before and the
 * picture after, so that their sum bounds what all of them together change. */
#include "simulate/plan/plan.h"

#include <math.h>
#include <string.h>

static void join(placido_deliberation *d, placido_strokes *whole, size_t changed) {
  const placido_plan *plan = d->plan;
  *whole = (placido_strokes){.turns = false};
  for (size_t i = 0; i < plan->effects.count; i++) {
    if (d->running[i] != (i == changed)) {
      placido_strokes_add(whole, &d->strokes[i], d->sketch.rays.count);
    }
  }
}

/* The set has changed. */
static void renew(placido_deliberation *d) {
  join(d, &d->set, SIZE_MAX);
  d->drawn = false;
}

void placido_plan_relieve(placido_strokes *strokes) {
  strokes->defocus_D += strokes->relief_D;
  strokes->relief_D = 0;
}

const placido_sketch_otf *placido_plan_transfer(placido_deliberation *d) {
  if (!d->drawn) {
    placido_strokes best = d->set;
    placido_plan_relieve(&best);
    placido_sketch_transfer(&d->otf, &d->sketch, &best);
    d->drawn = true;
  }
  return &d->otf;
}

static bool draws(const placido_strokes *strokes) {
  return strokes->turns || strokes->dims || strokes->lights > 0 || strokes->waves ||
         strokes->shift_x_arcmin != 0 || strokes->shift_y_arcmin != 0 ||
         strokes->defocus_D != 0 || strokes->aperture_arcmin > 0;
}

/* What sets parts of the scene apart is looked at where that is worst, all else where it is best: what
 * is sharp shows most. */
double placido_plan_bound_of(placido_deliberation *d, size_t index) {
  const placido_strokes *strokes = &d->strokes[index];
  const double own = d->answers[index].bound;
  if (!draws(strokes)) {
    return fmin(own, 1);
  }
  placido_sketch_otf worst, other;
  const placido_sketch_otf *before = &worst;
  placido_strokes changed;
  join(d, &changed, index);
  if (strokes->relief_D != 0) {
    placido_sketch_transfer(&worst, &d->sketch, &d->set);
  } else {
    before = placido_plan_transfer(d);
    placido_plan_relieve(&changed);
  }
  placido_sketch_transfer(&other, &d->sketch, &changed);
  double seen = placido_sketch_bound(before, &other, &d->plan->facts, &d->scale);
  if (seen < 1 && d->answers[index].share > 0) {
    seen *= d->answers[index].share;
  }
  return fmin(seen + own, 1);
}

static const placido_effect *row(const placido_deliberation *d, size_t index) {
  return d->plan->effects.rows[index];
}

static enum placido_force force_of(const placido_deliberation *d, size_t index) {
  return d->plan->wish.force[index];
}

/* What running effects, and those decided with the eye, give to others. */
static unsigned given(const placido_deliberation *d, size_t without) {
  unsigned bits = 0;
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    if ((d->running[i] || d->settled[i]) && i != without) {
      bits |= row(d, i)->gives;
    }
  }
  return bits;
}

/* Whether a running effect needs what only this one gives. */
static bool needed(const placido_deliberation *d, size_t index) {
  const unsigned missing = row(d, index)->gives & ~given(d, index);
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    if (i != index && d->running[i] && (row(d, i)->needs & missing) != 0) {
      return true;
    }
  }
  return false;
}

/* The effect to switch on for `missing`: one that is not forced off, else any; the number of
 * effects where none gives it. */
static size_t find_giver(const placido_deliberation *d, unsigned missing) {
  size_t count = d->plan->effects.count, refused = count;
  for (size_t i = 0; i < count; i++) {
    if ((row(d, i)->gives & missing) != 0) {
      if (force_of(d, i) != PLACIDO_FORCE_OFF) {
        return i;
      }
      refused = i;
    }
  }
  return refused;
}

/* An effect whose need is forced off cannot run. */
static int give_up(placido_deliberation *d, size_t index, size_t giver, placido_error *err) {
  const char *lacks = giver < d->plan->effects.count ? row(d, giver)->name : "nothing here";
  if (force_of(d, index) == PLACIDO_FORCE_ON) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "effect %s is forced on and needs %s, which is forced off",
                             row(d, index)->name, lacks);
  }
  d->running[index] = false;
  snprintf(d->answers[index].reason, sizeof d->answers[index].reason,
           "it needs %s, which is forced off", lacks);
  return PLACIDO_OK;
}

/* Switches on what running effects need, and what that needs. */
static int meet_needs(placido_deliberation *d, placido_error *err) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (size_t i = 0; i < d->plan->effects.count; i++) {
      unsigned missing = d->running[i] ? row(d, i)->needs & ~given(d, i) : 0;
      if (missing == 0) {
        continue;
      }
      size_t giver = find_giver(d, missing);
      changed = true;
      if (giver < d->plan->effects.count && force_of(d, giver) != PLACIDO_FORCE_OFF) {
        d->running[giver] = true;
        continue;
      }
      int status = give_up(d, i, giver, err);
      if (status != PLACIDO_OK) {
        return status;
      }
    }
  }
  return PLACIDO_OK;
}

/* The effects that may go, by what they would be worth alone: cheap to find, and near enough. */
static size_t order(placido_deliberation *d, size_t candidates[PLACIDO_EFFECTS_MAX]) {
  bool running[PLACIDO_EFFECTS_MAX];
  double alone[PLACIDO_EFFECTS_MAX];
  size_t count = 0;
  memcpy(running, d->running, sizeof running);
  memset(d->running, 0, sizeof d->running);
  renew(d);
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    if (!running[i] || d->settled[i] || force_of(d, i) == PLACIDO_FORCE_ON) {
      continue;
    }
    size_t at = count++;
    alone[i] = placido_plan_bound_of(d, i);
    for (; at > 0 && alone[candidates[at - 1]] > alone[i]; at--) {
      candidates[at] = candidates[at - 1];
    }
    candidates[at] = i;
  }
  memcpy(d->running, running, sizeof running);
  renew(d);
  return count;
}

/* Leaves out what fits. What another one needs waits until that is gone. */
static void leave_out(placido_deliberation *d) {
  placido_plan *plan = d->plan;
  size_t candidates[PLACIDO_EFFECTS_MAX];
  bool asked[PLACIDO_EFFECTS_MAX] = {false};
  const size_t count = order(d, candidates);
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t k = 0; k < count; k++) {
      size_t i = candidates[k];
      if (asked[i] || needed(d, i)) {
        continue;
      }
      asked[i] = true;
      plan->verdicts[i].bound = placido_plan_bound_of(d, i);
      if (plan->left_out + plan->verdicts[i].bound <= d->tolerance) {
        plan->left_out += plan->verdicts[i].bound;
        d->running[i] = false;
        plan->own[i] = changed = true;
        renew(d);
      }
    }
  }
  for (size_t k = 0; k < count; k++) {
    if (!asked[candidates[k]]) {
      plan->verdicts[candidates[k]].bound = placido_plan_bound_of(d, candidates[k]);
    }
  }
}

/* What a person decided, or what follows from it: the planner only says what it is worth. */
static void weigh_forced(placido_deliberation *d) {
  placido_plan *plan = d->plan;
  for (size_t i = 0; i < plan->effects.count; i++) {
    bool asked = force_of(d, i) == PLACIDO_FORCE_NONE && (d->running[i] || plan->own[i]);
    if (d->answers[i].applies && !d->settled[i] && !asked) {
      plan->verdicts[i].bound = placido_plan_bound_of(d, i);
    }
  }
}

int placido_plan_decide(placido_deliberation *d, placido_error *err) {
  placido_plan *plan = d->plan;
  for (size_t i = 0; i < plan->effects.count; i++) {
    d->running[i] = d->answers[i].applies &&
                    (d->settled[i] || force_of(d, i) != PLACIDO_FORCE_OFF);
    plan->verdicts[i].bound = d->settled[i] ? fmin(d->answers[i].bound, 1) : 0;
  }
  int status = meet_needs(d, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  leave_out(d);
  weigh_forced(d);
  for (size_t i = 0; i < plan->effects.count; i++) {
    plan->verdicts[i].runs = d->running[i];
  }
  return PLACIDO_OK;
}

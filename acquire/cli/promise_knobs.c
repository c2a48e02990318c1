/* The knobs as a table: where each stands in the settings, and what the named points say of it. */
#include "acquire/cli/promise_knobs.h"

#include "acquire/cli/accuracy/setting_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)

/* A field that is 0 was not given. */
static const struct {
  enum accuracy_stage stage;
  const char *name;
  size_t offset;
  bool real;
} knobs[] = {
    {ACCURACY_MIRES, "meridians", FIELD(meridians), false},
    {ACCURACY_MIRES, "filter_px", FIELD(filter_px), true},
    {ACCURACY_FIT, "knot_mm", FIELD(knot_mm), true},
    {ACCURACY_FIT, "degree", FIELD(degree), false},
    {ACCURACY_FIT, "tolerance", FIELD(fit_tolerance), true},
    {ACCURACY_TRACE, "samples", FIELD(samples), false},
    {ACCURACY_ACUITY, "trials", FIELD(trials), false},
};
#define KNOBS (sizeof knobs / sizeof *knobs)

/* The named points: standard is what holds without a name. Knots of 0 are as fine as residuals ask
 * for, which no fixed spacing betters. */
static const struct {
  const char *setting;
  double tolerance; /* of plans; 0: the scene's */
} points[] = {
    [ACCURACY_FAST] = {"meridians=180 filter_px=1 knot_mm=0.75 degree=3 tolerance=0 samples=100 "
                       "trials=1024", 0.1},
    [ACCURACY_STANDARD] = {"meridians=360 filter_px=1 knot_mm=0 degree=5 tolerance=0 samples=400 "
                           "trials=4096", 0},
    [ACCURACY_REFERENCE] = {"meridians=720 filter_px=1 knot_mm=0 degree=5 tolerance=0 "
                            "samples=1600 trials=65536", 0.003},
};

struct choosable promise_choosable(const struct accuracy_settings *asked) {
  struct choosable choosable = {{false}};
  const bool time = asked->max_time_ms > 0 && asked->max_error_um == 0 && asked->max_error_psf == 0;
  const bool shape = time || asked->max_error_um > 0 || asked->max_error_psf > 0;
  choosable.stages[ACCURACY_MIRES] = choosable.stages[ACCURACY_FIT] = shape;
  choosable.stages[ACCURACY_TRACE] = time || asked->max_error_psf > 0;
  choosable.stages[ACCURACY_ACUITY] = time;
  return choosable;
}

static double value_of(const struct settings *settings, size_t knob) {
  const void *field = (const char *)settings + knobs[knob].offset;
  return knobs[knob].real ? *(const double *)field : *(const int *)field;
}

static enum accuracy_name point_of(const struct settings *settings) {
  const enum accuracy_name named = settings->accuracy.named;
  return named == ACCURACY_UNNAMED ? ACCURACY_STANDARD : named;
}

/* Buckets are what a point spread function is given in, and no knob of its accuracy. Rays stay a
 * crosshatch whose light is spread, unless the command line says otherwise: counted ones leave
 * speckle that no error tells of. */
void promise_fix(char *fixed, size_t size, const struct settings *settings,
                 const struct choosable *choosable) {
  const char *point = points[point_of(settings)].setting;
  size_t used = (size_t)snprintf(fixed, size, "pattern=%s light=%s",
                                 ray_pattern_name(settings->rays.pattern),
                                 ray_light_name(settings->rays.light));
  for (size_t i = 0; i < KNOBS && used < size; i++) {
    const double given = value_of(settings, i);
    struct knob knob;
    if (given != 0) {
      used += (size_t)snprintf(fixed + used, size - used, " %s=%.12g", knobs[i].name, given);
    } else if (!choosable->stages[knobs[i].stage] && knob_find(&knob, point, knobs[i].name)) {
      used += (size_t)snprintf(fixed + used, size - used, " %s=%s", knob.name, knob.value);
    }
  }
}

static void set(struct settings *settings, size_t knob, const char *setting) {
  void *field = (char *)settings + knobs[knob].offset;
  struct knob found;
  const double value =
      knob_find(&found, setting, knobs[knob].name) ? knob_number(found.value) : (double)NAN;
  if (value_of(settings, knob) != 0 || !isfinite(value)) {
    return;
  }
  if (knobs[knob].real) {
    *(double *)field = value;
  } else {
    *(int *)field = (int)value;
  }
}

void promise_apply(struct settings *settings, const struct accuracy_choice *choice,
                   const struct choosable *choosable) {
  const enum accuracy_name named = settings->accuracy.named;
  for (size_t i = 0; i < KNOBS; i++) {
    if (choosable->stages[knobs[i].stage]) {
      set(settings, i, choice->setting[knobs[i].stage]);
    } else if (named == ACCURACY_FAST || named == ACCURACY_REFERENCE) {
      set(settings, i, points[named].setting);
    }
  }
  if (named != ACCURACY_UNNAMED && settings->plan.tolerance == 0) {
    settings->plan.tolerance = points[named].tolerance;
  }
}

void promise_each_knob(const struct accuracy_choice *choice,
                       void (*each)(void *user, const char *name, const char *value), void *user) {
  for (size_t i = 0; i < KNOBS; i++) {
    struct knob knob;
    if (knob_find(&knob, choice->setting[knobs[i].stage], knobs[i].name) &&
        knob_number(knob.value) != 0) {
      each(user, knob.name, knob.value);
    }
  }
}

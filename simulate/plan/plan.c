/* A plan: the scene is measured, the eye settled, every effect asked, and what runs decided. */
#include "simulate/plan/plan.h"

#include "base/clock.h"
#include "base/memory.h"
#include "simulate/plan/run.h"
#include "simulate/psf/settle.h"

#include <math.h>
#include <string.h>

static const double usual_bucket_arcmin = 0.5;

/* A wish with every default filled in. */
static int settle_wish(placido_plan_wish *settled, const placido_plan_wish *wish,
                       const placido_scene *scene, placido_error *err) {
  *settled = wish != NULL ? *wish : (placido_plan_wish){.tolerance = 0};
  if (settled->tolerance == 0) {
    settled->tolerance = scene->conditions.tolerance;
  }
  if (settled->bucket_arcmin == 0) {
    settled->bucket_arcmin = usual_bucket_arcmin;
  }
  settled->threads = settled->threads == 0 ? 1 : settled->threads;
  const struct { double value, min, max; const char *name; } ranges[] = {
    {settled->tolerance, 1e-6, 1, "the tolerance"},
    {settled->bucket_arcmin, 0.01, 60, "the bucket (arcmin)"},
    {settled->threads, 1, 256, "threads"},
  };
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
    if (!(ranges[i].value >= ranges[i].min && ranges[i].value <= ranges[i].max)) {
      return placido_error_set(err, PLACIDO_INPUT, "%s is %g, expected %g to %g", ranges[i].name,
                               ranges[i].value, ranges[i].min, ranges[i].max);
    }
  }
  return PLACIDO_OK;
}

/* What only effects look at, and the focus does not. */
static int settle_person(placido_eye *eye, placido_error *err) {
  if (eye->age_years == 0) {
    eye->age_years = PLACIDO_EYE_AGE_YEARS;
  }
  if (!(eye->age_years >= 5 && eye->age_years <= 100)) {
    return placido_error_set(err, PLACIDO_INPUT, "the eye's age is %g years, expected 5 to 100",
                             eye->age_years);
  }
  if ((unsigned)eye->iris > PLACIDO_IRIS_BLUE) {
    return placido_error_set(err, PLACIDO_INPUT, "iris number %d, expected 0 to %d",
                             (int)eye->iris, PLACIDO_IRIS_BLUE);
  }
  return PLACIDO_OK;
}

/* What of the eye is open: a retina that is not given is sought as a sphere is. */
static enum placido_correct sought(const placido_eye *eye) {
  return eye->correct == PLACIDO_CORRECT_NONE && eye->retina_mm == 0 ? PLACIDO_CORRECT_SPHERE
                                                                      : eye->correct;
}

/* What nothing may give. */
static unsigned refused(const placido_plan *plan) {
  unsigned bits = 0;
  for (size_t i = 0; i < plan->effects.count; i++) {
    bits |= plan->wish.force[i] == PLACIDO_FORCE_OFF ? plan->effects.rows[i]->gives : 0;
  }
  return bits;
}

static placido_question question_of(const placido_plan *plan, const placido_deliberation *d) {
  return (placido_question){.surface = plan->surface,
                            .scene = plan->scene,
                            .facts = &plan->facts,
                            .eye = &plan->eye,
                            .open = plan->open,
                            .rays = d != NULL ? &d->sketch.rays : NULL,
                            .bucket_arcmin = plan->wish.bucket_arcmin,
                            .tolerance = plan->wish.tolerance,
                            .refused = refused(plan)};
}

/* What of the eye follows from the scene. */
static int settle_eye(placido_deliberation *d, placido_error *err) {
  placido_plan *plan = d->plan;
  const placido_eye as_given = plan->eye;
  placido_question question = question_of(plan, NULL);
  question.eye = &as_given;
  for (size_t i = 0; i < plan->effects.count; i++) {
    const placido_effect *effect = plan->effects.rows[i];
    if (effect->settle != NULL) {
      int status = effect->settle(&plan->eye, &question, plan->wish.force[i], &d->answers[i], err);
      if (status != PLACIDO_OK) {
        return status;
      }
      d->settled[i] = true;
    }
  }
  if (plan->eye.pupil_mm == 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the pupil is not given, and nothing here says how wide it is: "
                             "expected a pupil in mm");
  }
  return PLACIDO_OK;
}

static int focus_eye(placido_deliberation *d, double fixation_mm[2], placido_notes *notes,
                     placido_error *err) {
  placido_plan *plan = d->plan;
  placido_eye found;
  int64_t start_ns = placido_clock_now_ns();
  int status =
    placido_psf_settle(&found, fixation_mm, plan->surface, &plan->eye, notes, err);
  if (status == PLACIDO_OK) {
    plan->eye = found;
  }
  plan->settling_ns = placido_clock_now_ns() - start_ns;
  return status;
}

static int sketch(placido_deliberation *d, const double fixation_mm[2], placido_error *err) {
  const placido_plan *plan = d->plan;
  if (placido_sketch_trace(&d->sketch, plan->surface, &plan->eye, fixation_mm)) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_QUALITY, "no light comes through the pupil of %g mm",
                           plan->eye.pupil_mm);
}

static void ask(placido_deliberation *d) {
  const placido_question question = question_of(d->plan, d);
  d->scale = (placido_sketch_scale){d->plan->scene->arcmin_per_px, d->plan->wish.bucket_arcmin};
  d->tolerance = PLACIDO_PLAN_LEFT_OUT_SHARE * d->plan->wish.tolerance;
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    d->answers[i].strokes = &d->strokes[i];
    if (d->plan->effects.rows[i]->ask != NULL) {
      d->plan->effects.rows[i]->ask(&question, &d->answers[i]);
    }
  }
}

static void tell(placido_deliberation *d) {
  placido_plan *plan = d->plan;
  plan->settings.cost_ms = placido_plan_cost(d);
  for (size_t i = 0; i < plan->effects.count; i++) {
    placido_verdict *verdict = &plan->verdicts[i];
    verdict->name = plan->effects.rows[i]->name;
    verdict->summary = plan->effects.rows[i]->summary;
    verdict->applies = d->answers[i].applies;
    verdict->force = plan->wish.force[i];
    verdict->cost_ms = placido_plan_cost_of(d, i);
    memcpy(verdict->reason, d->answers[i].reason, sizeof d->answers[i].reason);
  }
}

static int deliberate(placido_deliberation *d, placido_notes *notes, placido_error *err) {
  placido_plan *plan = d->plan;
  double fixation_mm[2];
  int64_t start_ns = placido_clock_now_ns();
  int status = placido_facts_find(&plan->facts, plan->scene, err);
  if (status == PLACIDO_OK) {
    status = settle_eye(d, err);
  }
  if (status == PLACIDO_OK) {
    status = focus_eye(d, fixation_mm, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = sketch(d, fixation_mm, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  ask(d);
  status = placido_plan_decide(d, err);
  if (status == PLACIDO_OK) {
    placido_plan_settle_settings(d);
    tell(d);
  }
  plan->asking_ns = placido_clock_now_ns() - start_ns - plan->settling_ns;
  return status;
}

int placido_plan_of_effects(placido_plan **plan, placido_effects effects,
                            const placido_surface *surface, const placido_eye *eye,
                            const placido_scene *scene, const placido_plan_wish *wish,
                            placido_notes *notes, placido_error *err) {
  placido_plan_wish settled;
  placido_eye aged = *eye;
  placido_deliberation *d = NULL;
  *plan = NULL;
  int status = settle_wish(&settled, wish, scene, err);
  if (status == PLACIDO_OK) {
    status = settle_person(&aged, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_plan *made = placido_memory_new(1, sizeof *made, err);
  d = placido_memory_new(1, sizeof *d, err);
  status = PLACIDO_MEMORY;
  if (made == NULL || d == NULL) {
    goto fail;
  }
  made->surface = surface;
  made->scene = scene;
  made->effects = effects;
  made->wish = settled;
  made->eye = aged;
  made->open = sought(eye);
  d->plan = made;
  d->one_wave = d->three_nodes = -1;
  status = deliberate(d, notes, err);
  if (status != PLACIDO_OK) {
    goto fail;
  }
  placido_memory_free(d);
  *plan = made;
  return PLACIDO_OK;
fail:
  placido_memory_free(d);
  placido_memory_free(made);
  return status;
}

int placido_plan_new(placido_plan **plan, const placido_surface *surface, const placido_eye *eye,
                     const placido_scene *scene, const placido_plan_wish *wish,
                     placido_notes *notes, placido_error *err) {
  placido_effects effects;
  effects.rows = placido_effect_table(&effects.count);
  return placido_plan_of_effects(plan, effects, surface, eye, scene, wish, notes, err);
}

void placido_plan_free(placido_plan *plan) { placido_memory_free(plan); }

const placido_verdict *placido_plan_verdicts(const placido_plan *plan, size_t *count) {
  *count = plan->effects.count;
  return plan->verdicts;
}

const placido_plan_settings *placido_plan_settings_of(const placido_plan *plan) {
  return &plan->settings;
}

const placido_eye *placido_plan_eye(const placido_plan *plan) { return &plan->eye; }

void placido_plan_seconds(const placido_plan *plan, double *asking, double *settling) {
  *asking = 1e-9 * (double)plan->asking_ns;
  *settling = 1e-9 * (double)plan->settling_ns;
}

int placido_plan_run(placido_image *seen, placido_psf *psf, const placido_plan *plan,
                     placido_error *err) {
  const placido_effect *running[PLACIDO_EFFECTS_MAX];
  size_t count = 0;
  for (size_t i = 0; i < plan->effects.count; i++) {
    if (plan->verdicts[i].runs) {
      running[count++] = plan->effects.rows[i];
    }
  }
  const placido_run run = {.surface = plan->surface,
                           .scene = plan->scene,
                           .facts = &plan->facts,
                           .settings = &plan->settings,
                           .eye = &plan->eye,
                           .open = plan->open,
                           .effects = running,
                           .count = count,
                           .threads = plan->wish.threads};
  return placido_view_run(seen, psf, &run, err);
}

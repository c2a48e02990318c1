/* One eye before one scene: with everything on, with everything but one effect, and as planned. */
#include "acquire/cli/bench_effects.h"

#include "acquire/cli/bench_time.h"
#include "simulate/plan/audit.h"

#include <math.h>

/* For which everything is seen at its finest: the least. */
static const double fine = 0.003;

const double bench_tolerances[BENCH_TOLERANCES] = {0.01, 0.003, 0.03};

/* What each effect is worth where all others are on: as coarsely as that may be asked. */
static int weigh(double worth[PLACIDO_EFFECTS_MAX], const placido_audit *finest, int wavelengths,
                 placido_error *err) {
  placido_audit rough = *finest;
  placido_image everything;
  placido_audit_coarsen(&rough, 3, wavelengths);
  int status = placido_audit_see(&everything, &rough, -1, err);
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX && status == PLACIDO_OK; i++) {
    placido_image seen;
    worth[i] = NAN;
    if (placido_audit_has(&rough, i)) {
      status = placido_audit_see(&seen, &rough, (int)i, err);
      if (status == PLACIDO_OK) {
        worth[i] = placido_audit_difference(&everything, &seen);
        placido_image_free(&seen);
      }
    }
  }
  placido_image_free(&everything);
  return status;
}

static int plan(struct bench_planned *planned, const struct bench_look *look,
                const placido_eye *eye, double tolerance, const placido_image *everything,
                placido_error *err) {
  const placido_plan_wish wish = {.tolerance = tolerance,
                                  .bucket_arcmin = look->scene->arcmin_per_px,
                                  .threads = look->threads};
  placido_plan *made;
  placido_image seen;
  double settling_s;
  size_t count;
  int status = placido_plan_new(&made, look->surface, eye, look->scene, &wish, NULL, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double before_s = bench_processor_s();
  status = placido_plan_run(&seen, NULL, made, err);
  planned->planned_s = bench_processor_s() - before_s;
  if (status == PLACIDO_OK) {
    planned->difference = placido_audit_difference(everything, &seen);
    placido_image_free(&seen);
  }
  placido_plan_seconds(made, &planned->asking_s, &settling_s);
  const placido_verdict *verdicts = placido_plan_verdicts(made, &count);
  for (size_t i = 0; i < count; i++) {
    planned->ran[i] = verdicts[i].runs;
    planned->applies[i] = verdicts[i].applies;
    planned->bound[i] = verdicts[i].bound;
  }
  placido_plan_free(made);
  return status;
}

int bench_look_at(struct bench_planned planned[BENCH_TOLERANCES], const struct bench_look *look,
                  size_t count, placido_error *err) {
  const placido_eye eye = {.pupil_mm = look->pupil_mm, .correct = PLACIDO_CORRECT_FULL};
  double worth[PLACIDO_EFFECTS_MAX], before_s = 0, everything_s = 0;
  placido_audit audit;
  placido_image everything = {0};
  int status = placido_audit_new(&audit, look->surface, &eye, look->scene,
                                 look->scene->arcmin_per_px, fine, look->threads, err);
  if (status == PLACIDO_OK) {
    if (look->quick) {
      placido_audit_coarsen(&audit, 3, 3);
    }
    before_s = bench_processor_s();
    status = placido_audit_see(&everything, &audit, -1, err);
    everything_s = bench_processor_s() - before_s;
  }
  if (status == PLACIDO_OK) {
    status = weigh(worth, &audit, look->quick ? 1 : 5, err);
  }
  for (size_t k = 0; k < count && status == PLACIDO_OK; k++) {
    planned[k] = (struct bench_planned){.everything_s = everything_s};
    for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
      planned[k].worth[i] = worth[i];
    }
    status = plan(&planned[k], look, &eye, bench_tolerances[k], &everything, err);
  }
  placido_image_free(&everything);
  placido_audit_free(&audit);
  return status;
}

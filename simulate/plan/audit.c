/* Everything on, and everything but one. */
#include "simulate/plan/audit.h"

#include "simulate/plan/plan.h"
#include "simulate/plan/run.h"

#include <math.h>

int placido_audit_new(placido_audit *audit, const placido_surface *surface, const placido_eye *eye,
                      const placido_scene *scene, double bucket_arcmin, double tolerance,
                      int threads, placido_error *err) {
  placido_plan_wish wish = {.tolerance = tolerance,
                            .bucket_arcmin = bucket_arcmin,
                            .finest = true,
                            .threads = threads};
  *audit = (placido_audit){.everything = NULL};
  for (int i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    wish.force[i] = PLACIDO_FORCE_ON;
  }
  int status = placido_plan_new(&audit->everything, surface, eye, scene, &wish, NULL, err);
  if (status == PLACIDO_OK) {
    audit->settings = *placido_plan_settings_of(audit->everything);
  }
  return status;
}

void placido_audit_free(placido_audit *audit) {
  if (audit != NULL) {
    placido_plan_free(audit->everything);
    *audit = (placido_audit){0};
  }
}

static int lesser(int one, int other) {
  return one < other ? one : other;
}

void placido_audit_coarsen(placido_audit *audit, int nodes, int wavelengths) {
  placido_plan_settings *settings = &audit->settings;
  settings->nodes = lesser(settings->nodes, nodes);
  settings->wavelengths = lesser(settings->wavelengths, wavelengths);
  settings->doubles = false;
}

bool placido_audit_has(const placido_audit *audit, size_t effect) {
  const placido_plan *plan = audit->everything;
  return effect < plan->effects.count && plan->verdicts[effect].runs &&
         plan->effects.rows[effect]->settle == NULL;
}

/* Those of `effects` whose needs the others give; repeated, as one may need another that goes. */
static size_t keep_possible(const placido_effect **effects, size_t count) {
  for (size_t before = count + 1; before != count;) {
    unsigned given = 0;
    size_t kept = 0;
    before = count;
    for (size_t i = 0; i < count; i++) {
      given |= effects[i]->gives;
    }
    for (size_t i = 0; i < count; i++) {
      if ((effects[i]->needs & ~given) == 0) {
        effects[kept++] = effects[i];
      }
    }
    count = kept;
  }
  return count;
}

int placido_audit_see(placido_image *seen, const placido_audit *audit, int without,
                      placido_error *err) {
  const placido_plan *plan = audit->everything;
  const placido_effect *effects[PLACIDO_EFFECTS_MAX];
  size_t count = 0;
  for (size_t i = 0; i < plan->effects.count; i++) {
    if ((int)i != without && plan->verdicts[i].runs) {
      effects[count++] = plan->effects.rows[i];
    }
  }
  const placido_run run = {.surface = plan->surface,
                           .scene = plan->scene,
                           .facts = &plan->facts,
                           .settings = &audit->settings,
                           .eye = &plan->eye,
                           .open = plan->open,
                           .effects = effects,
                           .count = keep_possible(effects, count),
                           .threads = plan->wish.threads};
  return placido_view_run(seen, NULL, &run, err);
}

double placido_audit_difference(const placido_image *one, const placido_image *other) {
  int planes = one->planes < 3 ? one->planes : 3;
  size_t samples = (size_t)one->width_px * (size_t)one->height_px * (size_t)planes;
  double most = 0;
  for (size_t i = 0; i < samples; i++) {
    double apart = fabs(fmin((double)one->data[i], 1) - fmin((double)other->data[i], 1));
    most = apart > most || isnan(apart) ? apart : most;
  }
  return most;
}

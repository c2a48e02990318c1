/* What a plan costs, from how often what it does is done: spreads by nodes, lights, layers and
 * wavelengths, and pictures convolved with them. An effect that makes more of these costs what they
 * all cost with it and would not without.
 *
 * Measured on one core of 2 GHz of a server of 2023, a build for speed, to a third over two eyes,
 * three pupils and tolerances from 0.01 to 0.3; of the right order elsewhere. By waves a spread takes
 * transforms as wide as pupil and window ask for, with the square of both, beside what every one
 * takes; the picture's own transforms are made once a node. */
#include "simulate/plan/plan.h"

#include <math.h>

static const double ray_spread_ms = 0.2, pupil_ms = 2.1; /* of 96 rays across */
static const double wave_spread_ms = 1.9, wave_start_ms = 3.8; /* 4 mm, 257 buckets; and whatever */
static const double transfer_ms = 4.4; /* of 257 buckets, and its share of the picture */
static const double picture_sample_ms = 9e-5;

/* How often things are done. */
typedef struct work {
  bool waves;
  double nodes, lights, wavelengths, layers;
} work;

/* Settings that are not chosen, as nothing that runs asks for them, at their least. */
static work work_of(const placido_deliberation *d, size_t changed) {
  const placido_plan_settings *settings = &d->plan->settings;
  work w = {.nodes = 1, .lights = 1, .wavelengths = 1, .layers = 1};
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    const placido_strokes *strokes = &d->strokes[i];
    if (d->running[i] == (i == changed)) {
      continue;
    }
    w.waves = w.waves || strokes->waves;
    w.nodes = strokes->varies ? fmax(settings->nodes, 3) : w.nodes;
    w.layers = strokes->relief_D != 0 ? fmax(settings->layers, 2) : w.layers;
    if (strokes->lights > 0) {
      w.lights = strokes->lights;
      w.wavelengths = fmax(settings->wavelengths, 5);
    }
  }
  return w;
}

static double spreads_ms(const placido_deliberation *d, size_t changed) {
  const work w = work_of(d, changed);
  const placido_facts *facts = &d->plan->facts;
  const placido_plan_settings *settings = &d->plan->settings;
  double finer = settings->pupil_samples / 96.0, side = 60 / settings->bucket_arcmin;
  double wide = d->sketch.pupil_mm / 4 * settings->buckets / 257;
  double spread_ms = w.waves ? wave_start_ms + wave_spread_ms * wide * wide
                             : ray_spread_ms * finer * finer;
  double window = settings->buckets / 257.0;
  double samples = facts->width_deg * side * facts->height_deg * side * facts->planes;
  return w.nodes * w.nodes *
           (pupil_ms * finer * finer +
            w.lights * w.layers * (w.wavelengths * spread_ms + transfer_ms * window * window)) +
         w.layers * samples * picture_sample_ms;
}

double placido_plan_cost(const placido_deliberation *d) {
  double sum_ms = spreads_ms(d, SIZE_MAX);
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    sum_ms += d->running[i] ? d->answers[i].cost_ms : 0;
  }
  return sum_ms;
}

double placido_plan_cost_of(const placido_deliberation *d, size_t index) {
  double changes_ms = fabs(spreads_ms(d, index) - spreads_ms(d, SIZE_MAX));
  return d->answers[index].cost_ms + changes_ms;
}

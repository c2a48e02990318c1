/* How finely what runs is computed. Each approximation has a part of the tolerance and a rule for
 * the error that it may cause; the coarsest that keeps to its part is taken, or the finest. */
#include "simulate/plan/plan.h"

#include "simulate/eye.h"
#include "simulate/plan/view.h"

#include <math.h>

/* What is farther than half a degree from its image is the glare function's: straylight. */
static const double core_arcmin = 30;

const char *const placido_plan_setting_names[6] = {
  "rays across the pupil", "wavelengths of a light", "layers of depth", "nodes of the field a side",
  "buckets of a spread a side", "bits of precision",
};

enum { SAMPLES, WAVELENGTHS, LAYERS, NODES, BUCKETS, PRECISION };

/* What part of the settings' error each may have beside the others that are at stake: what costs
 * most to refine gets most. */
static const double parts[] = {0.04, 0.28, 0.1, 0.56, 0.04, 0.02};

/* At their finest settings keep to so much of what they may, and to what costs least to refine. */
static const double finest_share = 0.25;
enum { FINEST_NODES = 5 };

/* A number to choose, its candidates in rising order and `least` the first that may be taken.
 * `error` is that of a candidate. */
typedef struct choice {
  const int *candidates;
  int count, least;
  double (*error)(placido_deliberation *d, int candidate);
} choice;

/* How much all settings together may be wrong by: what leaving out has left of the tolerance. */
static double spare(const placido_plan *plan) {
  const double planned = PLACIDO_PLAN_SETTINGS_SHARE * plan->wish.tolerance;
  return plan->wish.finest ? finest_share * planned
                           : fmax(plan->wish.tolerance - plan->left_out, planned);
}

static int choose(placido_deliberation *d, int which, const choice *c, double most) {
  placido_plan *plan = d->plan;
  int at = c->least;
  double error = c->error(d, c->candidates[at]);
  while (error > most && at + 1 < c->count) {
    at++;
    error = c->error(d, c->candidates[at]);
  }
  plan->settings_share[which] = error;
  return c->candidates[at];
}

static double range_of(const placido_facts *facts) {
  double range = 0;
  for (int plane = 0; plane < facts->planes; plane++) {
    range = fmax(range, facts->brightest[plane] - facts->darkest[plane]);
  }
  return range;
}

/* Rays. Within a cell angles are taken to change evenly: its light lies wrong by an eighth of their
 * second difference, which falls with the square of the cells' size, and an edge moved by so much
 * differs by that over the spread's width. Waves follow the wavefront itself between samples, to a
 * higher order: measured, they need a thirtieth. */
static double second_difference(const placido_deliberation *d) {
  const placido_sketch_rays *rays = &d->sketch.rays;
  double sum = 0;
  for (int i = 0; i < rays->count; i++) {
    const placido_sketch_cell *cell = &d->sketch.cells[i];
    if (cell->outer == i || cell->inner == i) {
      continue;
    }
    double x = (double)(rays->angle_x[cell->outer] - 2 * rays->angle_x[i] +
                        rays->angle_x[cell->inner]);
    double y = (double)(rays->angle_y[cell->outer] - 2 * rays->angle_y[i] +
                        rays->angle_y[cell->inner]);
    sum += (double)rays->weight[i] * hypot(x, y);
  }
  return sum;
}

static double width_arcmin(const placido_deliberation *d) {
  const placido_sketch_rays *rays = &d->sketch.rays;
  double sum = 0;
  for (int i = 0; i < rays->count; i++) {
    double x = (double)rays->angle_x[i], y = (double)rays->angle_y[i];
    sum += (double)rays->weight[i] * (x * x + y * y);
  }
  return fmax(sqrt(sum), d->plan->wish.bucket_arcmin);
}

static double samples_error(placido_deliberation *d, int samples) {
  const double coarse = 2 * PLACIDO_SKETCH_RINGS / (double)samples;
  const double of_waves = d->set.waves ? 1 / 30.0 : 1;
  return of_waves * range_of(&d->plan->facts) * second_difference(d) / 8 * coarse * coarse /
         width_arcmin(d);
}

/* What is left of an error that falls with the square of `finer`. Bounds end at white: where light is
 * far above that, one that has reached it says nothing of how much there is to fall. */
static double fallen(const placido_deliberation *d, double error, double finer) {
  bool unknown = error >= 1 && range_of(&d->plan->facts) > 1;
  return unknown ? 1 : error / (finer * finer);
}

/* Wavelengths. What too few of them are wrong by falls with the square of how many there are.
 * Measured against 31, corneas of Q -0.26 from 2 to 8 mm and perfect ones: times their square that is
 * half of what one of them is wrong by, and where that is much, 1.6 times its square. */
static double wavelengths_error(placido_deliberation *d, int wavelengths) {
  if (d->set.lights == 0) {
    return 0;
  }
  if (d->one_wave < 0) {
    placido_strokes one = d->set;
    placido_plan_relieve(&one);
    placido_sketch_otf single;
    for (int light = 0; light < one.lights; light++) {
      placido_wave mean = {.weight = 0};
      for (int i = 0; i < one.light[light].count; i++) {
        const placido_wave *wave = &one.light[light].waves[i];
        mean.weight += wave->weight;
        mean.wavelength_nm += wave->weight * wave->wavelength_nm;
        mean.defocus_D += wave->weight * wave->defocus_D;
      }
      one.light[light] = (placido_sketch_light){.count = 1, .waves = {mean}};
    }
    placido_sketch_transfer(&single, &d->sketch, &one);
    d->one_wave = placido_sketch_bound(placido_plan_transfer(d), &single, &d->plan->facts,
                                       &d->scale);
  }
  double apart = fmax(0.5 * d->one_wave, 1.6 * d->one_wave * d->one_wave);
  return fallen(d, apart, wavelengths);
}

static void average(placido_sketch_otf *otf, const placido_sketch_otf *other) {
  const int count = otf->lights * PLACIDO_SKETCH_DIRECTIONS * PLACIDO_SKETCH_FREQUENCIES;
  float *re = &otf->re[0][0][0], *im = &otf->im[0][0][0];
  for (int i = 0; i < count; i++) {
    re[i] = 0.5f * (re[i] + (&other->re[0][0][0])[i]);
    im[i] = 0.5f * (im[i] + (&other->im[0][0][0])[i]);
  }
}

/* Measured against nine nodes a side: of what the sketch bounds, regular and ablated corneas show
 * 0.1 to 0.25, cones of 2 to 5 mm 0.4 and one of 7 mm 0.85. Half of it is counted, and of the other
 * parts of the error, which are bounds, something is always left (test_effects_grid.c). */
static const double swing_seen = 0.5;

/* Layers. Half-way between two of them light is the mean of what either makes of it: what that misses
 * is most next to the focus. */
static double layers_error(placido_deliberation *d, int layers) {
  const double step_D = (d->plan->facts.nearest_D - d->plan->facts.farthest_D) / layers;
  placido_sketch_otf mean = *placido_plan_transfer(d), next, half;
  placido_strokes there = d->set;
  placido_plan_relieve(&there);
  there.defocus_D += step_D / 2;
  placido_sketch_transfer(&half, &d->sketch, &there);
  there.defocus_D += step_D / 2;
  placido_sketch_transfer(&next, &d->sketch, &there);
  average(&mean, &next);
  return swing_seen * placido_sketch_bound(&mean, &half, &d->plan->facts, &d->scale);
}

/* Nodes. Half-way between two of them the spread is the mean of theirs: with three a side, half-way
 * from the middle to the corner. What that misses falls with the square of the way between nodes. */
static bool varies(const placido_deliberation *d, size_t index) {
  return d->running[index] && d->strokes[index].varies;
}

/* Half-way, or in the middle, in place of where the strokes have their turns. */
static void transfer_nearer(placido_sketch_otf *otf, const placido_deliberation *d, bool half) {
  placido_strokes there = d->set;
  placido_plan_relieve(&there);
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    const placido_strokes *own = &d->strokes[i];
    for (int ray = 0; varies(d, i) && ray < d->sketch.rays.count; ray++) {
      there.angle_x[ray] += (half ? own->half_x[ray] : 0) - own->angle_x[ray];
      there.angle_y[ray] += (half ? own->half_y[ray] : 0) - own->angle_y[ray];
    }
  }
  there.shift_x_arcmin *= half ? 0.5 : 0; /* of colours, which grow with the field */
  there.shift_y_arcmin *= half ? 0.5 : 0;
  placido_sketch_transfer(otf, &d->sketch, &there);
}

/* Sketched in one direction only; over a cone others matter as well. Measured, corneas of six kinds:
 * three nodes a side are wrong by 0.01 to 0.12 of what the field is worth, cones by most. */
static const double field_seen = 0.06;

static double nodes_error(placido_deliberation *d, int nodes) {
  double field = 0;
  if (d->three_nodes < 0) {
    placido_sketch_otf mean = *placido_plan_transfer(d), middle, half;
    transfer_nearer(&middle, d, false);
    transfer_nearer(&half, d, true);
    average(&mean, &middle);
    d->three_nodes = placido_sketch_bound(&mean, &half, &d->plan->facts, &d->scale);
  }
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    field += varies(d, i) ? d->plan->verdicts[i].bound : 0;
  }
  double seen = d->three_nodes >= 1 ? d->three_nodes : swing_seen * d->three_nodes;
  return fallen(d, fmax(seen, field_seen * field), (nodes - 1) / 2.0);
}

/* Buckets. What rays send beyond them counts as missing, though it is put back evenly. What a pupil
 * diffracts farther than the core is not: it is put back, and is part of what the glare function
 * says of such angles. */
static double lost_rays(const placido_deliberation *d, double reach_arcmin) {
  const placido_sketch_rays *rays = &d->sketch.rays;
  double lost = 0, defocus_D = fabs(d->set.defocus_D);
  for (int light = 0; light < d->set.lights; light++) {
    for (int i = 0; i < d->set.light[light].count; i++) {
      defocus_D = fmax(defocus_D, fabs(d->set.light[light].waves[i].defocus_D + d->set.defocus_D));
    }
  }
  const double turn = 1e-3 * defocus_D / PLACIDO_ARCMIN_RAD;
  for (int i = 0; i < rays->count; i++) {
    double x = (double)rays->angle_x[i] + (d->set.turns ? (double)d->set.angle_x[i] : 0);
    double y = (double)rays->angle_y[i] + (d->set.turns ? (double)d->set.angle_y[i] : 0);
    x = fabs(x) + turn * fabs((double)rays->x_mm[i]);
    y = fabs(y) + turn * fabs((double)rays->y_mm[i]);
    lost += fmax(x, y) > reach_arcmin ? (double)rays->weight[i] : 0;
  }
  return lost;
}

static double buckets_error(placido_deliberation *d, int buckets) {
  const double reach_arcmin = buckets / 2 * d->plan->wish.bucket_arcmin;
  if (d->set.waves && reach_arcmin < core_arcmin) {
    return 1;
  }
  return fmin(lost_rays(d, reach_arcmin) * range_of(&d->plan->facts), 1);
}

/* Precision. Single precision rounds the sums of a transform to about 4e-7 of the brightest. */
static double precision_error(placido_deliberation *d, int doubles) {
  double most = 0;
  for (int plane = 0; plane < d->plan->facts.planes; plane++) {
    most = fmax(most, d->plan->facts.brightest[plane]);
  }
  return most * (doubles != 0 ? 1e-15 : 4e-7);
}

static bool has_field(const placido_deliberation *d) {
  bool found = false;
  for (size_t i = 0; i < d->plan->effects.count; i++) {
    found = found || varies(d, i);
  }
  return found;
}

void placido_plan_settle_settings(placido_deliberation *d) {
  static const int samples[] = {96, 128, 160, 192, 256, 384, 512};
  static const int wavelengths[] = {3, 5, 7, 9, 11, 15, 21, PLACIDO_WAVES_MAX};
  static const int layers[] = {2, 4, 8, 16, 32, 64};
  static const int nodes[] = {3, FINEST_NODES, 7, PLACIDO_NODES_SIDE_MAX};
  static const int buckets[] = {17, 33, 65, 129, 257, 385, 513, 769, 1025};
  static const int precisions[] = {0, 1};
  const bool finest = d->plan->wish.finest;
  const bool deep = d->set.defocus_D != 0 &&
                    d->plan->facts.nearest_D > d->plan->facts.farthest_D;
  const struct {
    choice choice;
    bool stake; /* whether it can be wrong */
  } all[] = {
    [SAMPLES] = {{samples, 7, 0, samples_error}, true},
    [WAVELENGTHS] = {{wavelengths, 8, finest ? 7 : 0, wavelengths_error}, d->set.lights > 0},
    [LAYERS] = {{layers, 6, 0, layers_error}, deep},
    [NODES] = {{nodes, 4, finest ? 1 : 0, nodes_error}, has_field(d)},
    [BUCKETS] = {{buckets, 9, 0, buckets_error}, true},
    [PRECISION] = {{precisions, 2, finest ? 1 : 0, precision_error}, true},
  };
  placido_plan_settings *settings = &d->plan->settings;
  int chosen[PRECISION + 1];
  double whole = 0;
  for (int i = 0; i <= PRECISION; i++) {
    whole += all[i].stake ? parts[i] : 0;
  }
  for (int i = 0; i <= PRECISION; i++) {
    chosen[i] = all[i].stake ? choose(d, i, &all[i].choice, spare(d->plan) * parts[i] / whole) : 1;
    settings->bound += d->plan->settings_share[i];
  }
  settings->bucket_arcmin = d->plan->wish.bucket_arcmin;
  settings->pupil_samples = chosen[SAMPLES];
  settings->wavelengths = chosen[WAVELENGTHS];
  settings->layers = chosen[LAYERS];
  settings->nodes = chosen[NODES];
  settings->buckets = chosen[BUCKETS];
  settings->doubles = chosen[PRECISION] != 0;
}

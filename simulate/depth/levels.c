/* Levels of depth: a histogram of vergences falls into stretches, and each is divided evenly. */
#include "simulate/depth/levels.h"

#include <math.h>

enum { BINS = 2048 };

/* How far a stretch may reach, in steps, to be one level. */
static const double flat_steps = 0.25;

/* What vergences lie in each part of their range; empty bins have least above most. */
typedef struct histogram {
  double from_D, bin_D;
  float least[BINS], most[BINS];
} histogram;

/* Vergences without a gap of a step. */
typedef struct stretch {
  double from_D, to_D;
} stretch;

static void fill(histogram *found, const float *depth_D, size_t count) {
  float least = INFINITY, most = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    least = depth_D[i] < least ? depth_D[i] : least;
    most = depth_D[i] > most ? depth_D[i] : most;
  }
  found->from_D = (double)least;
  found->bin_D = (double)(most - least) / BINS;
  for (int i = 0; i < BINS; i++) {
    found->least[i] = INFINITY;
    found->most[i] = -INFINITY;
  }
  for (size_t i = 0; i < count; i++) {
    double place = found->bin_D > 0 ? ((double)depth_D[i] - found->from_D) / found->bin_D : 0;
    int bin = place < BINS ? (int)place : BINS - 1;
    found->least[bin] = fminf(found->least[bin], depth_D[i]);
    found->most[bin] = fmaxf(found->most[bin], depth_D[i]);
  }
}

/* The next stretch from bin `*at` on; false where there is none. */
static bool find_stretch(stretch *found, int *at, const histogram *from, double step_D) {
  bool any = false;
  for (; *at < BINS; (*at)++) {
    if (from->least[*at] > from->most[*at]) {
      continue;
    }
    if (any && (double)from->least[*at] - found->to_D > step_D) {
      return true;
    }
    found->from_D = any ? found->from_D : (double)from->least[*at];
    found->to_D = (double)from->most[*at];
    any = true;
  }
  return any;
}

/* Counts all levels, and keeps those for which there is room. */
static void put(placido_levels *levels, double vergence_D, bool joined) {
  if (levels->count < PLACIDO_LEVELS_MAX) {
    levels->vergence_D[levels->count] = vergence_D;
    levels->joined[levels->count] = joined;
  }
  levels->count++;
}

/* Evenly from one end to before the other, at most a step apart. */
static void divide(placido_levels *levels, double from_D, double to_D) {
  int parts = (int)fmax(ceil((to_D - from_D) / levels->step_D - 1e-6), 1);
  for (int i = 0; i < parts; i++) {
    put(levels, from_D + (to_D - from_D) * i / parts, true);
  }
}

static void cover(placido_levels *levels, const stretch *part, double focus_D) {
  if (part->to_D - part->from_D <= flat_steps * levels->step_D) {
    put(levels, (part->from_D + part->to_D) / 2, false);
    return;
  }
  if (focus_D > part->from_D && focus_D < part->to_D) {
    divide(levels, part->from_D, focus_D);
    divide(levels, focus_D, part->to_D);
  } else {
    divide(levels, part->from_D, part->to_D);
  }
  put(levels, part->to_D, false);
}

static void cut(placido_levels *levels, const histogram *from, double focus_D, double step_D) {
  stretch part;
  int at = 0;
  *levels = (placido_levels){.step_D = step_D};
  while (find_stretch(&part, &at, from, step_D)) {
    cover(levels, &part, focus_D);
  }
}

void placido_levels_choose(placido_levels *levels, const float *depth_D, size_t count,
                           double focus_D, double step_D, int most) {
  const double wider = 1.1;
  const int least_with_focus = 3; /* two ends and one between */
  histogram found;
  if (most < least_with_focus) {
    focus_D = -1;
  }
  fill(&found, depth_D, count);
  cut(levels, &found, focus_D, step_D);
  double range_D = found.bin_D * BINS;
  while (levels->count > most && levels->step_D * flat_steps < range_D) {
    cut(levels, &found, focus_D, levels->step_D * wider);
  }
}

int placido_levels_find(const placido_levels *levels, double vergence_D, float *nearer) {
  int low = 0, high = levels->count - 1;
  while (low < high) { /* the nearest one that is not nearer than this */
    int middle = (low + high + 1) / 2;
    if (levels->vergence_D[middle] <= vergence_D) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  double from_D = levels->vergence_D[low];
  *nearer = 0;
  if (low + 1 == levels->count || vergence_D <= from_D) {
    return low;
  }
  double share = (vergence_D - from_D) / (levels->vergence_D[low + 1] - from_D);
  if (!levels->joined[low]) {
    return share < 0.5 ? low : low + 1;
  }
  *nearer = (float)share;
  return *nearer < 1 ? low : low + 1;
}

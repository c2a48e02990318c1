/* From each edge to the next by the distance that is expected there, stretched as the last few
 * were; a slope of the right sign near that place is the edge. */
#include "acquire/guide/walk.h"

#include <math.h>
#include <stdlib.h>

#define SEARCH 0.42          /* of a gap, to both sides */
#define FAINT 0.22           /* of the innermost edges' slope: below it, there is no mire */
#define STRETCH_RATE 0.25    /* of a new gap in the running mean */
#define MISSES_MAX 1         /* in a row, and the numbers are still sure */
#define WAVER_GAP 0.09       /* of a gap off the neighbours' mean: more than any cornea bends */
#define SPREAD_EDGES 8       /* that tell the usual deviation */
#define BROKEN_MIN 4         /* wavering points of the 5 × 5 around one */
#define WAVER_SPREAD 6.0     /* times the ordinary deviation: more than noise */

/* One meridian on the way. */
struct path {
  const float *grey;
  int samples;
  double step_px, faint;
};

static bool has_samples(const struct path *path, int i) {
  return i >= 2 && i < path->samples - 2 && path->grey[i - 2] >= 0 && path->grey[i + 2] >= 0;
}

static double slope_at(const struct path *path, int i) {
  const float *g = &path->grey[i];
  return (double)(g[1] - g[-1]) + 0.5 * (double)(g[2] - g[-2]);
}

/* The steepest place of that sign within reach of `radius`; NaN where all is flat. */
static double steepest(const struct path *path, double radius_px, double reach_px, double sign,
                       double *slope) {
  const int from = (int)ceil((radius_px - reach_px) / path->step_px);
  const int to = (int)floor((radius_px + reach_px) / path->step_px);
  int best = -1;
  *slope = 0;
  for (int i = from; i <= to; i++) {
    if (has_samples(path, i) && sign * slope_at(path, i) > *slope) {
      *slope = sign * slope_at(path, i);
      best = i;
    }
  }
  if (best < 0 || !has_samples(path, best - 1) || !has_samples(path, best + 1)) {
    return NAN;
  }
  const double before = sign * slope_at(path, best - 1), after = sign * slope_at(path, best + 1);
  const double bend = before - 2 * *slope + after;
  const double fraction = bend < 0 ? 0.5 * (before - after) / bend : 0;
  return (best + fmin(1, fmax(-1, fraction))) * path->step_px;
}

static double gap_at(const placido_guide_walk *walk, int k) {
  const double *e = walk->expected_px;
  return k > 0 ? e[k] - e[k - 1] : e[1] - e[0];
}

/* Whether the picture turns brighter (1) or darker (-1) outwards at an edge. */
static double sign_of(int k, bool first_bright) {
  return (k % 2 == 0) == first_bright ? 1 : -1;
}

static struct path path_of(const placido_guide_polar *polar, int m) {
  return (struct path){.grey = polar->data + (size_t)m * (size_t)polar->samples,
                       .samples = polar->samples,
                       .step_px = polar->step_px};
}

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* The share-th of `count` values, which are reordered. */
static double quantile(float *values, size_t count, double share) {
  if (count == 0) {
    return 0;
  }
  qsort(values, count, sizeof *values, compare_floats);
  return (double)values[(size_t)(share * (double)(count - 1))];
}

/* The ordinary slope of the innermost edges. */
static double usual_slope(const placido_guide_walk *walk, const placido_guide_polar *polar,
                          const placido_guide_inner *inner) {
  float slopes[4 * PLACIDO_GUIDE_MERIDIANS];
  size_t count = 0;
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    const struct path path = path_of(polar, m);
    for (int k = 0; k < 4; k++) {
      double slope;
      const double radius = placido_guide_inner_radius(inner, m, walk->expected_px[k]);
      steepest(&path, radius, SEARCH * inner->scale * gap_at(walk, k),
               sign_of(k, walk->first_bright), &slope);
      slopes[count++] = (float)slope;
    }
  }
  return quantile(slopes, count, 0.5);
}

static void walk_meridian(placido_guide_walk *walk, const struct path *path,
                          const placido_guide_inner *inner, int m) {
  float *row = walk->radius_px + (size_t)m * (size_t)walk->edge_count;
  double at = placido_guide_inner_radius(inner, m, walk->expected_px[0]);
  double stretch = placido_guide_inner_radius(inner, m, walk->expected_px[2]) - at;
  stretch /= walk->expected_px[2] - walk->expected_px[0];
  int misses = 0;
  walk->numbered[m] = walk->edge_count;
  for (int k = 0; k < walk->edge_count; k++) {
    const double gap = gap_at(walk, k);
    at += k > 0 ? stretch * gap : 0;
    double slope;
    const double found =
        steepest(path, at, SEARCH * stretch * gap, sign_of(k, walk->first_bright), &slope);
    if (isnan(found) || slope < path->faint) {
      row[k] = NAN;
      if (++misses > MISSES_MAX && walk->numbered[m] > k) {
        walk->numbered[m] = k;
      }
      continue;
    }
    misses = 0;
    row[k] = (float)found;
    at = found;
    /* Over two gaps: bright bands may look wider than dark ones. */
    if (k >= 2 && !isnan(row[k - 2])) {
      const double ratio = (found - (double)row[k - 2]) / (gap + gap_at(walk, k - 1));
      stretch += STRETCH_RATE * (ratio - stretch);
      stretch = fmin(1.8, fmax(0.4, stretch));
    }
  }
}

static void sum_coverage(placido_guide_walk *walk) {
  double seen[2] = {0, 0}, all[2] = {0, 0};
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    const int half = m >= PLACIDO_GUIDE_MERIDIANS / 2;
    const float *row = walk->radius_px + (size_t)m * (size_t)walk->edge_count;
    for (int k = 0; k < walk->edge_count; k++) {
      const double area = walk->expected_px[k] * gap_at(walk, k);
      all[half] += area;
      seen[half] += isnan(row[k]) ? 0 : area;
    }
  }
  walk->upper = seen[0] / all[0];
  walk->lower = seen[1] / all[1];
  walk->coverage = (seen[0] + seen[1]) / (all[0] + all[1]);
}

/* An edge's distance from the mean of its two neighbours along the mire; NaN where one is missing.
 */
static double deviation(const placido_guide_walk *walk, int m, int k) {
  const int n = PLACIDO_GUIDE_MERIDIANS;
  const size_t edges = (size_t)walk->edge_count;
  const float before = walk->radius_px[(size_t)((m + n - 1) % n) * edges + (size_t)k];
  const float here = walk->radius_px[(size_t)m * edges + (size_t)k];
  const float after = walk->radius_px[(size_t)((m + 1) % n) * edges + (size_t)k];
  return fabs((double)(here - 0.5F * (before + after)));
}

/* A lower quartile tells the noise even where half of the film is broken. */
static double usual_deviation(const placido_guide_walk *walk) {
  float values[PLACIDO_GUIDE_MERIDIANS * SPREAD_EDGES];
  size_t count = 0;
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    for (int j = 0; j < SPREAD_EDGES; j++) {
      const int k = j * (walk->edge_count - 1) / (SPREAD_EDGES - 1);
      const double value = deviation(walk, m, k) / gap_at(walk, k);
      if (!isnan(value)) {
        values[count++] = (float)value;
      }
    }
  }
  return count > 0 ? quantile(values, count, 0.25) : (double)NAN;
}

static double inner_share(const placido_guide_walk *walk) {
  int seen = 0;
  const int edges = walk->edge_count < PLACIDO_GUIDE_PATTERN_EDGES ? walk->edge_count
                                                                   : PLACIDO_GUIDE_PATTERN_EDGES;
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    for (int k = 0; k < edges; k++) {
      seen += !isnan(walk->radius_px[(size_t)m * (size_t)walk->edge_count + (size_t)k]);
    }
  }
  return (double)seen / (PLACIDO_GUIDE_MERIDIANS * edges);
}

/* Marks the edge points that lie off their neighbours. */
static void mark_wavering(placido_guide_walk *walk, double scale) {
  const double limit = fmax(WAVER_GAP * scale, WAVER_SPREAD * walk->roughness);
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    for (int k = 0; k < walk->edge_count; k++) {
      walk->wavers[(size_t)m * (size_t)walk->edge_count + (size_t)k] =
          deviation(walk, m, k) > limit * gap_at(walk, k);
    }
  }
}

static bool is_marked(const placido_guide_walk *walk, int m, int k) {
  const int n = PLACIDO_GUIDE_MERIDIANS;
  return k >= 0 && k < walk->edge_count &&
         walk->wavers[(size_t)((m + n) % n) * (size_t)walk->edge_count + (size_t)k];
}

/* Ripples cross their middle position too: what lies among wavering points counts with them, and a
 * single one (a lash, noise) does not count. */
static bool is_broken(const placido_guide_walk *walk, int m, int k) {
  int marked = 0;
  for (int dm = -2; dm <= 2; dm++) {
    for (int dk = -2; dk <= 2; dk++) {
      marked += is_marked(walk, m + dm, k + dk);
    }
  }
  return marked >= BROKEN_MIN;
}

static void sum_break_up(placido_guide_walk *walk, double scale) {
  double broken = 0, all = 0;
  mark_wavering(walk, scale);
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    const float *row = walk->radius_px + (size_t)m * (size_t)walk->edge_count;
    for (int k = 0; k < walk->edge_count; k++) {
      const double area = walk->expected_px[k] * gap_at(walk, k);
      all += isnan(row[k]) ? 0 : area;
      broken += !isnan(row[k]) && is_broken(walk, m, k) ? area : 0;
    }
  }
  walk->break_up = all > 0 ? broken / all : (double)NAN;
}

void placido_guide_walk_run(placido_guide_walk *walk, const placido_guide_polar *polar,
                            const placido_guide_inner *inner) {
  const double faint = FAINT * usual_slope(walk, polar, inner);
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    struct path path = path_of(polar, m);
    path.faint = faint;
    walk_meridian(walk, &path, inner, m);
  }
  sum_coverage(walk);
  walk->inner = inner_share(walk);
  walk->roughness = usual_deviation(walk);
  sum_break_up(walk, inner->scale);
}

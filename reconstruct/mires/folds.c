/* Folds: edges crowded together where others have no number. */
#include "reconstruct/mires/folds.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define CROWDED 0.45   /* of the usual distance; severe cones without a fold stay above 0.5 */
#define CROWDED_RUN 3  /* meridians abreast, or an edge was measured badly */
#define BESIDE_DEG 4   /* how far about its signs a fold may reach */
#define STRONG 0.5     /* of the numbered edges' mean strength */

/* What one meridian shows; radii between which the signs lie. */
typedef struct sign {
  bool crowded, stray;
  double low_px, high_px;
} sign;

typedef struct search {
  placido_crossings *all;
  int edges;
  float *radii; /* edges × meridians; NaN: not numbered */
  double *gaps; /* to find a median in */
  sign *signs;  /* one a meridian */
} search;

static void widen(sign *s, double low_px, double high_px) {
  s->low_px = fmin(s->low_px, low_px);
  s->high_px = fmax(s->high_px, high_px);
}

static double mean_strength(const placido_crossings *all) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < all->count; i++) {
    if (all->list[i].edge >= 0) {
      sum += fabs(all->list[i].slope);
      count++;
    }
  }
  return count ? sum / (double)count : INFINITY;
}

/* Strong edges without a number between two that have one. */
static void find_stray(search *n, double strong) {
  for (int m = 0; m < n->all->meridians; m++) {
    sign *s = &n->signs[m];
    double inner = NAN, low = NAN, high = NAN;
    *s = (sign){.low_px = INFINITY, .high_px = -INFINITY};
    for (size_t i = n->all->first[m]; i < n->all->first[m + 1]; i++) {
      const placido_crossing *c = &n->all->list[i];
      if (c->edge >= 0) {
        if (!isnan(low)) {
          s->stray = true;
          widen(s, low, high);
        }
        inner = c->radius_px;
        low = high = NAN;
      } else if (!isnan(inner) && fabs(c->slope) > strong) {
        low = isnan(low) ? c->radius_px : low;
        high = c->radius_px;
      }
    }
  }
}

static float gap_at(const search *n, int edge, int meridian) {
  size_t meridians = (size_t)n->all->meridians;
  size_t m = (size_t)((meridian + n->all->meridians) % n->all->meridians);
  const float *inner = n->radii + (size_t)edge * meridians;
  return inner[meridians + m] - inner[m];
}

/* Places where an edge and the next outwards are crowded. */
static void find_crowded(search *n, int edge) {
  int meridians = n->all->meridians;
  size_t count = 0;
  for (int m = 0; m < meridians; m++) {
    float gap = gap_at(n, edge, m);
    if (!isnan(gap)) {
      n->gaps[count++] = (double)gap;
    }
  }
  double most = CROWDED * placido_quantile(n->gaps, count, 0.5);
  for (int m = 0, run = 0; m < meridians + CROWDED_RUN && count; m++) {
    run = (double)gap_at(n, edge, m) < most ? run + 1 : 0;
    for (int i = 0; i < CROWDED_RUN && run >= CROWDED_RUN; i++) {
      int at = (m - i + meridians) % meridians;
      double inner = (double)n->radii[(size_t)edge * (size_t)meridians + (size_t)at];
      n->signs[at].crowded = true;
      widen(&n->signs[at], inner, inner + most);
    }
  }
}

/* What the meridians about one show together. */
static sign around(const search *n, int meridian) {
  int meridians = n->all->meridians, reach = (BESIDE_DEG * meridians + 359) / 360;
  sign sum = {.low_px = INFINITY, .high_px = -INFINITY};
  for (int i = -reach; i <= reach; i++) {
    const sign *s = &n->signs[(meridian + i + meridians) % meridians];
    sum.crowded |= s->crowded;
    sum.stray |= s->stray;
    widen(&sum, s->low_px, s->high_px);
  }
  return sum;
}

static double mark(search *n) {
  int folded = 0;
  for (int m = 0; m < n->all->meridians; m++) {
    sign s = around(n, m);
    if (!s.crowded || !s.stray) {
      continue;
    }
    folded++;
    for (size_t i = n->all->first[m]; i < n->all->first[m + 1]; i++) {
      placido_crossing *c = &n->all->list[i];
      c->folded = c->edge >= 0 && c->radius_px >= s.low_px && c->radius_px <= s.high_px;
    }
  }
  return (double)folded / n->all->meridians;
}

int placido_crossings_folds(placido_crossings *crossings, int edge_count, double *folded,
                            double *stray, placido_error *err) {
  size_t meridians = (size_t)crossings->meridians, cells = (size_t)edge_count * meridians;
  search n = {.all = crossings, .edges = edge_count};
  *folded = *stray = 0;
  n.radii = placido_memory_new(cells, sizeof *n.radii, err);
  n.gaps = placido_memory_new(meridians, sizeof *n.gaps, err);
  n.signs = placido_memory_new(meridians, sizeof *n.signs, err);
  int status = n.radii && n.gaps && n.signs ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    find_stray(&n, STRONG * mean_strength(crossings));
    for (size_t m = 0; m < meridians; m++) {
      *stray += n.signs[m].stray / (double)meridians;
    }
  }
  if (!status && *stray > 0) {
    for (size_t i = 0; i < cells; i++) {
      n.radii[i] = NAN;
    }
    for (size_t i = 0; i < crossings->count; i++) {
      const placido_crossing *c = &crossings->list[i];
      if (c->edge >= 0) {
        n.radii[(size_t)c->edge * meridians + (size_t)c->meridian] = (float)c->radius_px;
      }
    }
    for (int k = 0; k + 1 < edge_count; k++) {
      find_crowded(&n, k);
    }
    *folded = mark(&n);
  }
  placido_memory_free(n.radii);
  placido_memory_free(n.gaps);
  placido_memory_free(n.signs);
  return status;
}

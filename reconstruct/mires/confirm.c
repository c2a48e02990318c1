/* The last look: every numbered crossing against what the sure ones foretell. */
#include "reconstruct/mires/confirm.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/mires/field.h"

#include <math.h>

/* How far from its place a crossing may lie, in periods: so many robust standard deviations of its
 * edge, within these limits. */
#define SPREADS 6
#define DOUBTFUL_LEAST 0.12
#define SURE_LEAST 0.2
#define MOST 0.25

/* Periods by which a crossing lies off its expected place; NaN where nothing is expected. */
static double deviation(const placido_field *f, const placido_crossing *c) {
  double expected = f->expected_px[(size_t)c->edge * (size_t)f->meridians + (size_t)c->meridian];
  return fabs(c->radius_px - expected) / placido_field_period(f, c->edge, c->meridian);
}

/* Each edge's robust standard deviation, from its sure crossings. `rows` holds edges × meridians,
 * `counts` one an edge. */
static void find_spreads(double *spreads, double *rows, size_t *counts, const placido_field *f,
                         const placido_crossings *all) {
  size_t meridians = (size_t)f->meridians;
  for (size_t i = 0; i < all->count; i++) {
    const placido_crossing *c = &all->list[i];
    double off = c->edge >= 0 && !c->doubtful ? deviation(f, c) : NAN;
    if (!isnan(off)) {
      rows[(size_t)c->edge * meridians + counts[c->edge]++] = off;
    }
  }
  for (int k = 0; k < f->edges; k++) {
    double *row = rows + (size_t)k * meridians;
    spreads[k] = counts[k] ? 1.4826 * placido_quantile(row, counts[k], 0.5) : MOST;
  }
}

int placido_crossings_confirm(placido_crossings *crossings, int edge_count,
                              const double *ordinary_px, placido_error *err) {
  placido_field field;
  int status = placido_field_new(&field, edge_count, crossings->meridians, ordinary_px, err);
  if (status) {
    return status;
  }
  size_t edges = (size_t)edge_count;
  double *spreads = placido_memory_new(edges, sizeof *spreads, err);
  double *rows = placido_memory_new(edges * (size_t)crossings->meridians, sizeof *rows, err);
  size_t *counts = placido_memory_new(edges, sizeof *counts, err);
  status = spreads && rows && counts ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < crossings->count; i++) {
      const placido_crossing *c = &crossings->list[i];
      if (c->edge >= 0 && !c->doubtful) {
        placido_field_add(&field, c->edge, c->meridian, c->radius_px);
      }
    }
    status = placido_field_predict(&field, err);
  }
  if (!status) {
    find_spreads(spreads, rows, counts, &field, crossings);
    for (size_t i = 0; i < crossings->count; i++) {
      placido_crossing *c = &crossings->list[i];
      if (c->edge < 0) {
        continue;
      }
      double least = c->doubtful ? DOUBTFUL_LEAST : SURE_LEAST;
      double most = fmax(least, fmin(MOST, SPREADS * spreads[c->edge]));
      if (deviation(&field, c) > most) {
        c->edge = -1;
      }
    }
  }
  placido_field_free(&field);
  placido_memory_free(spreads);
  placido_memory_free(rows);
  placido_memory_free(counts);
  return status;
}

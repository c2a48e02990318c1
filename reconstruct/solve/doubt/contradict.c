/* One point against its neighbours is an outlier. Where most points of a place are against what the
 * rest of the map makes of it, the cornea there is not what the map says: a fold too small for its
 * knots, a scar, something that lies on the eye. */
#include "reconstruct/solve/doubt/contradict.h"

#include "base/memory.h"

#include <math.h>

#define CELL_MM 0.1 /* a place is a cell and those about it */
#define HALF 90     /* cells from the axis to where no cornea is measured any longer */
#define SIDE (2 * HALF + 1)
#define AGAINST 5.0 /* standard deviations off the surface */
#define ENOUGH 6    /* points, or they are strays that came together by chance */

/* What a cell holds. */
struct cell {
  unsigned with, against;
};

static int cell_of(double at_mm) {
  return (int)fmax(1, fmin(SIDE - 2, rint(at_mm / CELL_MM) + HALF));
}

static bool is_somewhere(const placido_sample *s) {
  return isfinite(s->hit.x) && isfinite(s->hit.y) && !isnan(s->residual_px);
}

/* Neighbours of an outlier that were set aside with it, and agree, are no witnesses against. */
static bool is_against(const placido_sample *s, double sigma_px) {
  return !s->used && fabs(s->residual_px * s->noise) > AGAINST * sigma_px;
}

static struct cell about(const struct cell *cells, int column, int row) {
  struct cell sum = {0, 0};
  for (int j = row - 1; j <= row + 1; j++) {
    for (int i = column - 1; i <= column + 1; i++) {
      sum.with += cells[j * SIDE + i].with;
      sum.against += cells[j * SIDE + i].against;
    }
  }
  return sum;
}

int placido_contradict_find(placido_place *places, size_t *found, const placido_sample *samples,
                            size_t count, double sigma_px, placido_error *err) {
  *found = 0;
  struct cell *cells = placido_memory_new((size_t)SIDE * SIDE, sizeof *cells, err);
  if (!cells) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    const placido_sample *s = &samples[i];
    if (is_somewhere(s)) {
      struct cell *cell = &cells[cell_of(s->hit.y) * SIDE + cell_of(s->hit.x)];
      (is_against(s, sigma_px) ? &cell->against : &cell->with)[0]++;
    }
  }
  for (size_t i = 0; i < count; i++) {
    const placido_sample *s = &samples[i];
    if (is_somewhere(s) && is_against(s, sigma_px)) {
      struct cell sum = about(cells, cell_of(s->hit.x), cell_of(s->hit.y));
      if (sum.against >= ENOUGH && sum.against > sum.with) {
        places[(*found)++] = (placido_place){s->hit.x, s->hit.y};
      }
    }
  }
  placido_memory_free(cells);
  return PLACIDO_OK;
}

/* A convex mirror never folds a picture: where edges are mirrored twice the cornea is hollow
 * somewhere, as on the flank of a steep cone. */
#include "reconstruct/solve/doubt/fold.h"

#include "base/memory.h"

#include <math.h>

#define STEEP_D 140.0 /* keratometric; the steepest clinical cones have some 100 */
#define HOLLOW_D 0.0
#define HANDFUL 3

/* Principal curvatures of z(x, y), positive for a cornea's, in keratometric dioptres. */
static void principal_D(const placido_hit *hit, double *least, double *most) {
  double p = hit->p, q = hit->q, w = sqrt(1 + p * p + q * q);
  double mean =
      -((1 + q * q) * hit->xx - 2 * p * q * hit->xy + (1 + p * p) * hit->yy) / (2 * w * w * w);
  double gauss = (hit->xx * hit->yy - hit->xy * hit->xy) / (w * w * w * w);
  double half = sqrt(fmax(0, mean * mean - gauss));
  *least = 337.5 * (mean - half);
  *most = 337.5 * (mean + half);
}

size_t placido_fold_find(placido_place *places, const placido_sample *samples, size_t count,
                         const placido_mires *mires) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    const placido_sample *s = &samples[i];
    bool folded = mires->points[s->point].folded;
    if (!folded && s->used && !isnan(s->residual_px)) {
      double least, most;
      principal_D(&s->hit, &least, &most);
      folded = least < HOLLOW_D || most > STEEP_D;
    }
    if (folded && isfinite(s->hit.x) && isfinite(s->hit.y)) {
      places[n++] = (placido_place){s->hit.x, s->hit.y};
    }
  }
  return n < HANDFUL ? 0 : n;
}

double placido_fold_mask(placido_coverage *coverage, unsigned char *mask,
                         const placido_place *places, size_t count, double reach_mm) {
  const placido_coverage *c = coverage;
  size_t covered = 0, lost = 0;
  int reach = (int)ceil(reach_mm / c->step_mm);
  for (int i = 0; i < c->rows * c->columns; i++) {
    covered += mask[i] != 0;
  }
  for (size_t k = 0; k < count; k++) {
    int column = (int)lrint((places[k].x_mm - c->x0_mm) / c->step_mm);
    int row = (int)lrint((places[k].y_mm - c->y0_mm) / c->step_mm);
    for (int j = row - reach; j <= row + reach; j++) {
      for (int i = column - reach; i <= column + reach; i++) {
        int far = (i - column) * (i - column) + (j - row) * (j - row);
        if (i >= 0 && i < c->columns && j >= 0 && j < c->rows && far <= reach * reach &&
            mask[j * c->columns + i]) {
          mask[j * c->columns + i] = 0;
          lost++;
        }
      }
    }
  }
  return covered ? (double)lost / (double)covered : 0;
}

int placido_fold_hole(double *area_mm2, const placido_coverage *coverage, const unsigned char *mask,
                      placido_error *err) {
  int columns = coverage->columns, rows = coverage->rows;
  size_t cells = (size_t)columns * (size_t)rows, waiting = 0, open = 0;
  unsigned char *seen = placido_memory_new(cells, 1, err);
  size_t *stack = placido_memory_new(cells, sizeof *stack, err);
  *area_mm2 = 0;
  if (!seen || !stack) {
    placido_memory_free(seen);
    placido_memory_free(stack);
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < cells; i++) { /* what is covered counts as seen; the rim is the outside */
    int column = (int)(i % (size_t)columns), row = (int)(i / (size_t)columns);
    bool rim = column == 0 || row == 0 || column == columns - 1 || row == rows - 1;
    seen[i] = mask[i] || rim;
    if (rim && !mask[i]) {
      stack[waiting++] = i;
    }
    open += !mask[i];
  }
  size_t outside = waiting;
  while (waiting) {
    size_t i = stack[--waiting], column = i % (size_t)columns;
    const size_t beside[4] = {column > 0 ? i - 1 : i, column + 1 < (size_t)columns ? i + 1 : i,
                              i >= (size_t)columns ? i - (size_t)columns : i,
                              i + (size_t)columns < cells ? i + (size_t)columns : i};
    for (int k = 0; k < 4; k++) {
      if (!seen[beside[k]]) {
        seen[beside[k]] = 1;
        stack[waiting++] = beside[k];
        outside++;
      }
    }
  }
  *area_mm2 = (double)(open - outside) * coverage->step_mm * coverage->step_mm;
  placido_memory_free(seen);
  placido_memory_free(stack);
  return PLACIDO_OK;
}

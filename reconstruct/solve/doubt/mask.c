/* Morphological closing of the sample points on a 0.05 mm grid (Serra 1982) by discs. */
#include "reconstruct/solve/doubt/mask.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

#define PITCH_MM 0.05
#define FAR 255 /* cells; more is not told apart */
#define REACH_MIN_MM 0.3
#define REACH_MAX_MM 1.0

/* near[i] = how far cell i is from the nearest one of its row whose value is `from`, at most FAR.
 * */
static void search_rows(unsigned char *near, const unsigned char *mask, unsigned char from,
                        int size) {
  for (int row = 0; row < size; row++) {
    const unsigned char *line = mask + row * size;
    unsigned char *out = near + row * size, left = FAR, right = FAR;
    for (int i = 0; i < size; i++) {
      left = (unsigned char)(line[i] == from ? 0 : left < FAR ? left + 1 : FAR);
      out[i] = left;
    }
    for (int i = size - 1; i >= 0; i--) {
      right = (unsigned char)(line[i] == from ? 0 : right < FAR ? right + 1 : FAR);
      out[i] = right < out[i] ? right : out[i];
    }
  }
}

/* grown[i] = 1 where a cell whose value is `from` lies within `reach` cells: the disc is a stack of
 * rows, each reaching as far as the disc is wide there. `near` holds as many cells. */
static void grow(unsigned char *grown, unsigned char *near, const unsigned char *mask,
                 unsigned char from, int size, double reach) {
  int half = (int)reach;
  search_rows(near, mask, from, size);
  memset(grown, 0, (size_t)size * (size_t)size);
  for (int row = 0; row < size; row++) {
    unsigned char *out = grown + row * size;
    for (int dy = row < half ? -row : -half; dy <= half && row + dy < size; dy++) {
      const unsigned char *line = near + (row + dy) * size;
      unsigned char wide = (unsigned char)sqrt(reach * reach - dy * dy);
      for (int i = 0; i < size; i++) {
        out[i] |= line[i] <= wide;
      }
    }
  }
}

/* Half the widest ordinary gap: median distance from the middle of the innermost mire, and of
 * neighbouring edges along a meridian. Samples are ordered by edge, then meridian. */
static int reach_of(double *reach_mm, const placido_sample *samples, size_t count,
                    placido_error *err) {
  double *radii = placido_memory_new(count, sizeof *radii, err);
  if (!radii) {
    return PLACIDO_MEMORY;
  }
  double before = 0, widest = 0;
  for (size_t i = 0; i < count;) {
    const placido_edge *edge = samples[i].edge;
    size_t n = 0;
    for (; i < count && samples[i].edge == edge; i++) {
      if (samples[i].used) {
        double x = samples[i].hit.x, y = samples[i].hit.y;
        radii[n++] = sqrt(x * x + y * y);
      }
    }
    if (n) {
      double here = placido_quantile(radii, n, 0.5);
      widest = fmax(widest, before > 0 ? (here - before) / 2 : here);
      before = here;
    }
  }
  placido_memory_free(radii);
  *reach_mm = fmax(REACH_MIN_MM, fmin(REACH_MAX_MM, 1.15 * widest));
  return PLACIDO_OK;
}

int placido_mask_close(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                       const placido_place *places, size_t count, double reach_mm,
                       placido_error *err) {
  double far = 0;
  int status = PLACIDO_OK;
  *mask = NULL;
  for (size_t i = 0; i < count; i++) {
    far = fmax(far, fmax(fabs(places[i].x_mm), fabs(places[i].y_mm)));
  }
  int half = (int)ceil((far + reach_mm) / PITCH_MM) + 2, size = 2 * half + 1;
  size_t cells = (size_t)size * (size_t)size;
  unsigned char *grown = placido_memory_new(cells, 1, err);
  unsigned char *near = placido_memory_new(cells, 1, err);
  *mask = placido_memory_new(cells, 1, err);
  if (!grown || !near || !*mask) {
    placido_memory_free(*mask);
    *mask = NULL;
    status = PLACIDO_MEMORY;
    goto done;
  }
  for (size_t i = 0; i < count; i++) {
    size_t column = (size_t)(lrint(places[i].x_mm / PITCH_MM) + half);
    size_t row = (size_t)(lrint(places[i].y_mm / PITCH_MM) + half);
    (*mask)[row * (size_t)size + column] = 1;
  }
  const double reach = fmin(reach_mm / PITCH_MM, FAR - 1);
  grow(grown, near, *mask, 1, size, reach);
  grow(*mask, near, grown, 0, size, reach);
  double most = 0;
  for (size_t i = 0; i < cells; i++) {
    (*mask)[i] = !(*mask)[i];
    if ((*mask)[i]) {
      double x = ((double)(i % (size_t)size) - half) * PITCH_MM;
      double y = ((double)(i / (size_t)size) - half) * PITCH_MM;
      most = fmax(most, hypot(x, y));
    }
  }
  *radius_mm = most + PITCH_MM / 2;
  *coverage = (placido_coverage){.x0_mm = -half * PITCH_MM,
                                 .y0_mm = -half * PITCH_MM,
                                 .step_mm = PITCH_MM,
                                 .columns = size,
                                 .rows = size,
                                 .mask = *mask};
done:
  placido_memory_free(grown);
  placido_memory_free(near);
  return status;
}

int placido_mask_new(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                     const placido_sample *samples, size_t count, placido_error *err) {
  double reach;
  size_t used = 0;
  *mask = NULL;
  int status = reach_of(&reach, samples, count, err);
  if (status) {
    return status;
  }
  placido_place *places = placido_memory_new(count, sizeof *places, err);
  if (!places) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used) {
      places[used++] = (placido_place){samples[i].hit.x, samples[i].hit.y};
    }
  }
  status = placido_mask_close(coverage, mask, radius_mm, places, used, reach, err);
  placido_memory_free(places);
  return status;
}

/* Morphological closing of the sample points on a 0.05 mm grid (Serra 1982), by distance
 * transforms. */
#include "reconstruct/solve/mask.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define PITCH_MM 0.05
#define REACH_MIN_MM 0.3
#define REACH_MAX_MM 1.0

/* Squared distances (in cells) to the nearest cell of value `from`, exactly, by the lower envelope
 * of parabolas along rows, then columns (Felzenszwalb and Huttenlocher 2012). One line here. */
static void transform_line(const double *f, double *d, int n, size_t stride, int *v, double *z) {
  int k = 0;
  v[0] = 0;
  z[0] = -INFINITY;
  z[1] = INFINITY;
  for (int q = 1; q < n; q++) {
    double s;
    for (;;) {
      int p = v[k];
      s = ((f[(size_t)q * stride] + (double)q * q) - (f[(size_t)p * stride] + (double)p * p)) /
          (2.0 * (q - p));
      if (s > z[k] || k == 0) {
        break;
      }
      k--;
    }
    if (s <= z[k]) {
      s = z[k];
    }
    v[++k] = q;
    z[k] = s;
    z[k + 1] = INFINITY;
  }
  for (int q = 0, at = 0; q < n; q++) {
    while (z[at + 1] < q) {
      at++;
    }
    d[q] = (double)(q - v[at]) * (q - v[at]) + f[(size_t)v[at] * stride];
  }
}

/* cells[i] = mask[i] == from ? 0 : squared distance to the nearest that is. */
static void transform(const unsigned char *mask, unsigned char from, int size, double *cells,
                      double *line, int *v, double *z) {
  size_t n = (size_t)size;
  for (size_t i = 0; i < n * n; i++) {
    cells[i] = mask[i] == from ? 0 : 1e12;
  }
  for (size_t row = 0; row < n; row++) {
    transform_line(cells + row * n, line, size, 1, v, z);
    for (size_t i = 0; i < n; i++) {
      cells[row * n + i] = line[i];
    }
  }
  for (size_t column = 0; column < n; column++) {
    transform_line(cells + column, line, size, n, v, z);
    for (size_t i = 0; i < n; i++) {
      cells[i * n + column] = line[i];
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
        radii[n++] = hypot(samples[i].hit.x, samples[i].hit.y);
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
  double *distance = placido_memory_new(cells, sizeof *distance, err);
  double *line = placido_memory_new((size_t)size, sizeof *line, err);
  double *z = placido_memory_new((size_t)size + 1, sizeof *z, err);
  int *v = placido_memory_new((size_t)size, sizeof *v, err);
  *mask = placido_memory_new(cells, 1, err);
  if (!distance || !line || !z || !v || !*mask) {
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
  double limit = reach_mm / PITCH_MM * (reach_mm / PITCH_MM);
  transform(*mask, 1, size, distance, line, v, z);
  for (size_t i = 0; i < cells; i++) {
    (*mask)[i] = distance[i] <= limit;
  }
  transform(*mask, 0, size, distance, line, v, z);
  double most = 0;
  for (size_t i = 0; i < cells; i++) {
    (*mask)[i] = distance[i] > limit;
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
  placido_memory_free(distance);
  placido_memory_free(line);
  placido_memory_free(z);
  placido_memory_free(v);
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

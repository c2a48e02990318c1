/* A map's grid, interpolated to a fine lattice: bicubic convolution (Catmull and Rom 1974; Keys
 * 1981, equation 4 with a = -1/2) where all sixteen neighbours are supported, bilinear over the
 * supported ones at the rim. */
#include "report/field.h"

#include "base/memory.h"

#include <math.h>

/* Where a sample of the lattice lies on one axis of the grid. */
typedef struct place {
  int index; /* the grid point before it */
  double share;
  double weights[4]; /* of grid points index - 1 to index + 2 */
} place;

/* The place of sample k of `samples` on an axis of `size` grid points. */
static place find_place(int k, int samples, int size) {
  double position = (k + 0.5) / samples * (size - 1);
  place p = {.index = (int)position};
  double t = position - p.index;
  p.share = t;
  p.weights[0] = 0.5 * t * (-1 + t * (2 - t));
  p.weights[1] = 0.5 * (2 + t * t * (-5 + 3 * t));
  p.weights[2] = 0.5 * t * (1 + t * (4 - 3 * t));
  p.weights[3] = 0.5 * t * t * (t - 1);
  return p;
}

static double value_at(const placido_maps *maps, const double *values, int i, int j) {
  size_t k = (size_t)j * (size_t)maps->size + (size_t)i;
  return maps->valid[k] ? values[k] : NAN;
}

/* The mean of the supported corners by their bilinear weights, where these are at least half of
 * all: that bounds the map by a line that does not follow the grid's steps. */
static double sample_corners(const placido_maps *maps, const double *values, const place *x,
                             const place *y) {
  double sum = 0, weight = 0;
  for (int corner = 0; corner < 4; corner++) {
    int right = corner & 1, up = corner >> 1;
    double value = value_at(maps, values, x->index + right, y->index + up);
    double w = (right ? x->share : 1 - x->share) * (up ? y->share : 1 - y->share);
    if (isfinite(value)) {
      sum += w * value;
      weight += w;
    }
  }
  return weight >= 0.5 ? sum / weight : NAN;
}

/* The four grid rows around y mixed into one, with a NaN column before and two behind, so that
 * every window of four columns exists. */
static void mix_rows(double *row, const placido_maps *maps, const double *values, const place *y) {
  bool whole = y->index >= 1 && y->index + 2 < maps->size;
  row[0] = row[maps->size + 1] = row[maps->size + 2] = NAN;
  for (int i = 0; i < maps->size; i++) {
    double sum = whole ? 0 : NAN;
    for (int k = 0; whole && k < 4; k++) {
      sum += y->weights[k] * value_at(maps, values, i, y->index - 1 + k);
    }
    row[i + 1] = sum;
  }
}

/* How many samples at either end of row `j` lie outside the circle within the square. */
static int outside_circle(int j, int size) {
  double up = 2 * (j + 0.5) / size - 1, half_chord = sqrt(1 - up * up);
  return (int)(0.5 * size * (1 - half_chord));
}

/* `margin` samples at either end stay NaN. */
static void fill_row(float *out, int size, int margin, const place *columns, const double *row,
                     const placido_maps *maps, const double *values, const place *y) {
  for (int i = 0; i < margin; i++) {
    out[i] = out[size - 1 - i] = NAN;
  }
  for (int i = margin; i < size - margin; i++) {
    const place *x = &columns[i];
    const double *window = row + x->index;
    double value = x->weights[0] * window[0] + x->weights[1] * window[1] +
                   x->weights[2] * window[2] + x->weights[3] * window[3];
    out[i] = (float)(isnan(value) ? sample_corners(maps, values, x, y) : value);
  }
}

int placido_map_field_new(placido_map_field *field, const placido_maps *maps, const double *values,
                      int size, placido_error *err) {
  *field = (placido_map_field){0};
  float *out = placido_memory_new((size_t)size * (size_t)size, sizeof *out, err);
  double *row = placido_memory_new((size_t)maps->size + 3, sizeof *row, err);
  place *places = placido_memory_new((size_t)size, sizeof *places, err);
  if (out == NULL || row == NULL || places == NULL) {
    placido_memory_free(out);
    placido_memory_free(row);
    placido_memory_free(places);
    return PLACIDO_MEMORY;
  }
  for (int k = 0; k < size; k++) {
    places[k] = find_place(k, size, maps->size);
  }
  for (int j = 0; j < size; j++) {
    const place *y = &places[size - 1 - j];
    mix_rows(row, maps, values, y);
    fill_row(out + (size_t)j * (size_t)size, size, outside_circle(j, size), places, row, maps,
             values, y);
  }
  placido_memory_free(row);
  placido_memory_free(places);
  *field = (placido_map_field){size, out};
  return PLACIDO_OK;
}

void placido_map_field_free(placido_map_field *field) {
  if (field == NULL) {
    return;
  }
  placido_memory_free(field->values);
  *field = (placido_map_field){0};
}

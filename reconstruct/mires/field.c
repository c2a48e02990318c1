/* Local linear regression (Cleveland, J. Am. Stat. Assoc. 74:829, 1979) of log(radius / ordinary
 * radius), which is smooth over edge and angle on any cornea, however irregular. */
#include "reconstruct/mires/field.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

#define SECTORS 60
#define UNKNOWNS 4 /* value, slopes over edge and sector, step to the other polarity */
#define REACHES 2
#define REACH_MOST 4

/* How far is looked for cells, and how many there must be. */
static const struct {
  int cells, needed;
} reaches[REACHES] = {{2, 8}, {REACH_MOST, 10}};

int placido_field_new(placido_field *field, int edges, int meridians, const double *ordinary_px,
                      placido_error *err) {
  size_t cells = (size_t)edges * SECTORS;
  *field = (placido_field){
      .edges = edges,
      .meridians = meridians,
      .sectors = SECTORS,
      .ordinary_px = placido_memory_new((size_t)edges, sizeof *field->ordinary_px, err),
      .cells = placido_memory_new(cells, sizeof *field->cells, err),
      .log_ratio = placido_memory_new(cells, sizeof *field->log_ratio, err),
      .expected_px =
          placido_memory_new((size_t)edges * (size_t)meridians, sizeof *field->expected_px, err)};
  if (!field->ordinary_px || !field->cells || !field->log_ratio || !field->expected_px) {
    placido_field_free(field);
    return PLACIDO_MEMORY;
  }
  for (int k = 0; k < edges; k++) {
    /* a mire is as wide as the one before it */
    bool seen = isfinite(ordinary_px[k]) || k < 3;
    const double *o = field->ordinary_px;
    field->ordinary_px[k] = seen ? ordinary_px[k] : o[k - 1] + o[k - 2] - o[k - 3];
  }
  return PLACIDO_OK;
}

void placido_field_free(placido_field *field) {
  placido_memory_free(field->ordinary_px);
  placido_memory_free(field->cells);
  placido_memory_free(field->log_ratio);
  placido_memory_free(field->expected_px);
  *field = (placido_field){0};
}

placido_cell *placido_field_cell(const placido_field *field, int edge, int sector) {
  int s = (sector % field->sectors + field->sectors) % field->sectors;
  return &field->cells[edge * field->sectors + s];
}

int placido_field_sector(const placido_field *field, int meridian) {
  return meridian * field->sectors / field->meridians;
}

void placido_field_clear(placido_field *field) {
  memset(field->cells, 0, (size_t)field->edges * (size_t)field->sectors * sizeof *field->cells);
}

void placido_field_add(placido_field *field, int edge, int meridian, double radius_px) {
  int sector = placido_field_sector(field, meridian);
  placido_cell *cell = placido_field_cell(field, edge, sector);
  cell->count++;
  cell->ratio += log(radius_px / field->ordinary_px[edge]);
  cell->offset += (meridian + 0.5) * field->sectors / field->meridians - sector - 0.5;
}

/* Solves the symmetric positive system a x = b for x[0]; `a` holds its lower triangle. */
static double solve_first(double a[UNKNOWNS][UNKNOWNS], double b[UNKNOWNS]) {
  /* elimination from the last unknown upwards leaves the first alone in the first row */
  for (int j = UNKNOWNS - 1; j > 0; j--) {
    for (int i = 0; i < j; i++) {
      double share = a[j][i] / a[j][j];
      for (int k = 0; k <= i; k++) {
        a[i][k] -= share * a[j][k];
      }
      b[i] -= share * b[j];
    }
  }
  return b[0] / a[0][0];
}

/* The value expected in a cell from those within `reach`; NaN where fewer than `needed` hold
 * anything. */
static double regress(const placido_field *field, int edge, int sector, int reach, int needed,
                      const double *bell) {
  double a[UNKNOWNS][UNKNOWNS] = {{0}}, b[UNKNOWNS] = {0};
  int found = 0;
  for (int i = -reach; i <= reach; i++) {
    if (edge + i < 0 || edge + i >= field->edges) {
      continue;
    }
    double other = i % 2 != 0;
    for (int j = -reach; j <= reach; j++) {
      const placido_cell *cell = placido_field_cell(field, edge + i, sector + j);
      if (cell->count == 0) {
        continue;
      }
      found++;
      double weight = bell[i < 0 ? -i : i] * bell[j < 0 ? -j : j] * cell->count;
      double by[UNKNOWNS] = {1, i, j + cell->offset / cell->count, other};
      double value = weight * cell->ratio / cell->count;
      for (int r = 0; r < UNKNOWNS; r++) {
        for (int c = 0; c <= r; c++) {
          a[r][c] += weight * by[r] * by[c];
        }
        b[r] += value * by[r];
      }
    }
  }
  if (found < needed) {
    return NAN;
  }
  for (int r = 1; r < UNKNOWNS; r++) {
    a[r][r] += 0.01 * a[0][0]; /* what the cells do not tell stays near level */
  }
  return solve_first(a, b);
}

/* Radii between the sectors' middles, by linear interpolation. */
static void spread(const placido_field *field, int edge) {
  const float *ratio = field->log_ratio + (size_t)edge * (size_t)field->sectors;
  float *out = field->expected_px + (size_t)edge * (size_t)field->meridians;
  for (int m = 0; m < field->meridians; m++) {
    double at = (m + 0.5) * field->sectors / field->meridians - 0.5;
    int left = (int)floor(at);
    float share = (float)(at - left);
    float a = ratio[(left + field->sectors) % field->sectors];
    float b = ratio[(left + 1) % field->sectors];
    float between = isnan(a) ? b : isnan(b) ? a : a + share * (b - a);
    out[m] = (float)field->ordinary_px[edge] * expf(between);
  }
}

void placido_field_predict(placido_field *field) {
  double bell[REACHES][REACH_MOST + 1];
  for (int l = 0; l < REACHES; l++) {
    for (int i = 0; i <= REACH_MOST; i++) {
      double x = 1.5 * i / reaches[l].cells;
      bell[l][i] = exp(-0.5 * x * x);
    }
  }
  for (int k = 0; k < field->edges; k++) {
    for (int s = 0; s < field->sectors; s++) {
      double value = NAN;
      for (int l = 0; l < REACHES && isnan(value); l++) {
        value = regress(field, k, s, reaches[l].cells, reaches[l].needed, bell[l]);
      }
      field->log_ratio[k * field->sectors + s] = (float)value;
    }
    spread(field, k);
  }
}

double placido_field_period(const placido_field *field, int edge, int meridian) {
  const float *here = field->expected_px + meridian;
  size_t row = (size_t)field->meridians;
  double radius = here[(size_t)edge * row], least = INFINITY;
  if (edge >= 2 && !isnan(here[(size_t)(edge - 2) * row])) {
    least = radius - here[(size_t)(edge - 2) * row];
  }
  if (edge + 2 < field->edges && !isnan(here[(size_t)(edge + 2) * row])) {
    least = fmin(least, here[(size_t)(edge + 2) * row] - radius);
  }
  if (isinf(least)) {
    const double *o = field->ordinary_px;
    int outer = edge > 0 ? edge : 1;
    least = 2 * (o[outer] - o[outer - 1]) * radius / o[edge];
  }
  return least;
}

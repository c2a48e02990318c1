/* Local linear regression (Cleveland, J. Am. Stat. Assoc. 74:829, 1979) of log(radius / ordinary
 * radius), which is smooth over edge and angle on any cornea, however irregular. */
#include "reconstruct/mires/field.h"

#include "base/memory.h"

#include <math.h>
#include <stddef.h>
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

/* Weighted sums over the cells of one edge about a sector: 1, x, x², value and value x, x the
 * distance in sectors. */
typedef struct moments {
  int found;
  double one, x, xx, value, value_x;
} moments;

static moments sum_beside(const placido_field *field, int edge, int sector, int reach,
                          const double *bell) {
  moments sum = {0};
  for (int j = -reach; j <= reach; j++) {
    const placido_cell *cell = placido_field_cell(field, edge, sector + j);
    if (cell->count == 0) {
      continue;
    }
    double bell_here = bell[j < 0 ? -j : j], weight = bell_here * cell->count;
    double x = j + cell->offset / cell->count, value = bell_here * cell->ratio;
    sum.found++;
    sum.one += weight;
    sum.x += weight * x;
    sum.xx += weight * x * x;
    sum.value += value;
    sum.value_x += value * x;
  }
  return sum;
}

/* The value expected in a cell from the sums of the edges about it, `stride` apart; NaN where fewer
 * than `needed` cells hold anything. */
static double regress(const moments *here, int edge, int edges, size_t stride, int reach,
                      int needed, const double *bell) {
  double a[UNKNOWNS][UNKNOWNS] = {{0}}, b[UNKNOWNS] = {0};
  int found = 0;
  for (int i = -reach; i <= reach; i++) {
    if (edge + i < 0 || edge + i >= edges) {
      continue;
    }
    const moments *m = here + i * (ptrdiff_t)stride;
    double weight = bell[i < 0 ? -i : i];
    double one = weight * m->one, x = weight * m->x, value = weight * m->value;
    found += m->found;
    a[0][0] += one;
    a[1][0] += one * i;
    a[1][1] += one * i * i;
    a[2][0] += x;
    a[2][1] += x * i;
    a[2][2] += weight * m->xx;
    b[0] += value;
    b[1] += value * i;
    b[2] += weight * m->value_x;
    if (i % 2 != 0) {
      a[3][0] += one;
      a[3][1] += one * i;
      a[3][2] += x;
      a[3][3] += one;
      b[3] += value;
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

/* Fills log_ratio where it is NaN from cells within a reach. */
static void fill_within(const placido_field *field, moments *sums, int reach, int needed) {
  double bell[REACH_MOST + 1];
  size_t sectors = (size_t)field->sectors;
  for (int i = 0; i <= reach; i++) {
    double x = 1.5 * i / reach;
    bell[i] = exp(-0.5 * x * x);
  }
  for (int k = 0; k < field->edges; k++) {
    for (int s = 0; s < field->sectors; s++) {
      sums[(size_t)k * sectors + (size_t)s] = sum_beside(field, k, s, reach, bell);
    }
  }
  for (int k = 0; k < field->edges; k++) {
    for (int s = 0; s < field->sectors; s++) {
      size_t here = (size_t)k * sectors + (size_t)s;
      if (isnan(field->log_ratio[here])) {
        field->log_ratio[here] =
            (float)regress(sums + here, k, field->edges, sectors, reach, needed, bell);
      }
    }
  }
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

int placido_field_predict(placido_field *field, placido_error *err) {
  size_t cells = (size_t)field->edges * (size_t)field->sectors;
  moments *sums = placido_memory_new(cells, sizeof *sums, err);
  if (!sums) {
    return PLACIDO_MEMORY;
  }
  bool holes = true;
  for (size_t i = 0; i < cells; i++) {
    field->log_ratio[i] = NAN;
  }
  for (int l = 0; l < REACHES && holes; l++) {
    fill_within(field, sums, reaches[l].cells, reaches[l].needed);
    holes = false;
    for (size_t i = 0; i < cells; i++) {
      holes |= isnan(field->log_ratio[i]);
    }
  }
  for (int k = 0; k < field->edges; k++) {
    spread(field, k);
  }
  placido_memory_free(sums);
  return PLACIDO_OK;
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

/* A change δc of the coefficients changes a point's miss by (a B + b B_x + c B_y)·δc, three numbers
 * a point (mirror.h), over the 36 coefficients of its cell. The points of one cell share all
 * coefficients, so their part of the normal matrix is one dense product of their rows. */
#include "reconstruct/solve/engine/assemble.h"

#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

#define CELL PLACIDO_SPLINE_CELL
#define ORDER PLACIDO_SPLINE_ORDER
#define BATCH 64 /* rays that are worked on at a time */
#define TOGETHER 4 /* rows that are multiplied at a time */

double placido_refinement_at_axis(const placido_refinement *r, placido_basis *basis) {
  double value[6];
  placido_grid_basis(r->shape.grid, 0, 0, basis);
  placido_grid_value(r->shape.grid, r->coefficients, basis, value);
  return value[0];
}

/* What a change of the residual is for each coefficient, from those for height and slopes. The
 * pieces of the basis along x and y, and their derivatives, are found side by side. */
PLACIDO_INSIDE void row_of(double row[CELL], double x, double y, double by_z, double by_p,
                           double by_q) {
  double t[2 * ORDER], value[2 * ORDER], slope[2 * ORDER];
  for (int i = 0; i < 2 * ORDER; i++) {
    t[i] = i < ORDER ? x : y;
    value[i] = placido_spline_powers[ORDER - 1][i % ORDER];
    slope[i] = 0;
  }
  for (int n = ORDER - 2; n >= 0; n--) {
    for (int i = 0; i < 2 * ORDER; i++) {
      slope[i] = slope[i] * t[i] + value[i];
      value[i] = value[i] * t[i] + placido_spline_powers[n][i % ORDER];
    }
  }
  for (int j = 0; j < ORDER; j++) {
    double along = by_z * value[ORDER + j] + by_q * slope[ORDER + j];
    double across = by_p * value[ORDER + j];
    for (int i = 0; i < ORDER; i++) {
      row[j * ORDER + i] = along * value[i] + across * slope[i];
    }
  }
}

PLACIDO_INSIDE double weight_of(double residual) {
  return 1 / sqrt(1 + residual * residual * (1 / (PLACIDO_HUBER * PLACIDO_HUBER)));
}

double placido_sample_row(double row[CELL], const placido_sample *s, double sigma_px) {
  double slope = s->slope * sigma_px, steep = slope * s->basis.knot_mm;
  row_of(row, s->basis.x, s->basis.y, s->miss.by_z / slope, s->miss.by_p / steep,
         s->miss.by_q / steep);
  return weight_of(s->residual_px / sigma_px);
}

double placido_sample_weight(const placido_sample *s, double sigma_px) {
  return weight_of(s->residual_px / sigma_px);
}

/* Some rays of a cell. */
struct rows {
  int count;                /* with rows of zeros that fill up the last few taken together */
  double row[BATCH][CELL];  /* times the root of their weights */
  double root[BATCH];       /* of the weights */
  double residual[BATCH];   /* in sigmas, times that root */
};

PLACIDO_WIDE static void find_rows(struct rows *rows, const placido_refinement *r,
                                   const size_t *which, int count) {
  double *const *numbers = r->rays->numbers;
  double share = 1 / r->sigma_px, steep = share / r->shape.grid->knot_mm;
  for (int k = 0; k < count; k++) {
    rows->residual[k] = numbers[PLACIDO_RAY_RESIDUAL_PX][which[k]] * share;
  }
  for (int k = 0; k < count; k++) {
    rows->root[k] = sqrt(weight_of(rows->residual[k]));
    rows->residual[k] *= rows->root[k];
  }
  for (int k = 0; k < count; k++) {
    size_t i = which[k];
    row_of(rows->row[k], numbers[PLACIDO_RAY_PLACE_X][i], numbers[PLACIDO_RAY_PLACE_Y][i],
           rows->root[k] * share * numbers[PLACIDO_RAY_BY_Z][i],
           rows->root[k] * steep * numbers[PLACIDO_RAY_BY_P][i],
           rows->root[k] * steep * numbers[PLACIDO_RAY_BY_Q][i]);
  }
  for (; count % TOGETHER; count++) {
    memset(rows->row[count], 0, sizeof rows->row[count]);
    rows->root[count] = rows->residual[count] = 0;
  }
  rows->count = count;
}

/* Adds rowsᵀ rows to a block's lower triangle, and what else makes its lines whole vectors. */
PLACIDO_WIDE static void add_products(double *restrict block, const struct rows *rows) {
  for (int k = 0; k < rows->count; k += TOGETHER) {
    const double *a = rows->row[k], *b = rows->row[k + 1], *c = rows->row[k + 2];
    const double *d = rows->row[k + 3];
    for (int i = 0; i < CELL; i++) {
      double ai = a[i], bi = b[i], ci = c[i], di = d[i], *line = block + i * CELL;
      int end = (i / 4 + 1) * 4;
      for (int j = 0; j < end; j += 4) {
        for (int v = j; v < j + 4; v++) {
          line[v] += (ai * a[v] + bi * b[v]) + (ci * c[v] + di * d[v]);
        }
      }
    }
  }
}

/* right += Σ pull · row, for a batch's rows. */
PLACIDO_WIDE static void add_pulls(double *restrict right, const struct rows *rows,
                                   const double pulls[BATCH]) {
  for (int k = 0; k < rows->count; k += TOGETHER) {
    const double *a = rows->row[k], *b = rows->row[k + 1], *c = rows->row[k + 2];
    const double *d = rows->row[k + 3], *p = pulls + k;
    for (int i = 0; i < CELL; i++) {
      right[i] += (p[0] * a[i] + p[1] * b[i]) + (p[2] * c[i] + p[3] * d[i]);
    }
  }
}

/* Adds the rays of one cell to the normal equations. */
static void assemble_cell(double *rights, const placido_refinement *r, int column, int row,
                          const void *context) {
  (void)rights;
  (void)context;
  const placido_grid *grid = r->shape.grid;
  const placido_sightlines *rays = r->rays;
  size_t c = (size_t)row * (size_t)grid->cells + (size_t)column, end = rays->starts[c + 1];
  double block[CELL * CELL], right[CELL] = {0};
  struct rows rows;
  if (rays->starts[c] == end) {
    return;
  }
  memset(block, 0, sizeof block);
  for (size_t at = rays->starts[c]; at < end; at += BATCH) {
    int count = end - at < BATCH ? (int)(end - at) : BATCH;
    find_rows(&rows, r, rays->order + at, count);
    add_products(block, &rows);
    for (int k = 0; k < rows.count; k++) {
      rows.residual[k] = -rows.residual[k];
    }
    add_pulls(right, &rows, rows.residual);
  }
  placido_normal_add(r->normal, column, row, block, right);
}

/* The spring at the axis. */
static void assemble_axis(placido_refinement *r) {
  placido_basis basis;
  double off = placido_refinement_at_axis(r, &basis), block[CELL * CELL], right[CELL], values[CELL];
  for (int i = 0; i < CELL; i++) {
    values[i] = basis.y[0][i / ORDER] * basis.x[0][i % ORDER];
    right[i] = -PLACIDO_DISTANCE_WEIGHT * values[i] * off;
    for (int j = 0; j <= i; j++) {
      block[i * CELL + j] = PLACIDO_DISTANCE_WEIGHT * values[i] * values[j];
    }
  }
  placido_normal_add(r->normal, basis.column, basis.row, block, right);
}

/* Calls a function for every cell with threads side by side: those that are ORDER rows apart share
 * no coefficients, and every sum is made in the same order by any number of threads. */
typedef void cell_visitor(double *rights, const placido_refinement *r, int column, int row,
                          const void *context);

static void for_each_cell(double *rights, const placido_refinement *r, cell_visitor *visit,
                          const void *context) {
  int cells = r->shape.grid->cells;
  for (int first = 0; first < ORDER; first++) {
#pragma omp parallel for num_threads(r->threads) schedule(dynamic, 1)
    for (int row = first; row < cells; row += ORDER) {
      for (int column = 0; column < cells; column++) {
        visit(rights, r, column, row, context);
      }
    }
  }
}

void placido_refinement_assemble(placido_refinement *r) {
  placido_sightlines_sort(r->rays, r->shape.grid);
  placido_normal_clear(r->normal);
  for_each_cell(NULL, r, assemble_cell, NULL);
  placido_normal_smooth(r->normal, r->smoothing, r->coefficients);
  assemble_axis(r);
}

/* What is pushed. */
struct push {
  const placido_mires *mires; /* NULL: no edges */
  const double *errors;
  int columns;
};

/* The edges of a batch: rays of one edge stand one behind the other. */
static void push_edges(double *corner, size_t n, const placido_refinement *r,
                       const struct rows *rows, const size_t *which, int count,
                       const placido_mires *mires) {
  const placido_sightlines *rays = r->rays;
  int side = r->shape.grid->side;
  for (int k = 0; k < count;) {
    double sum[CELL] = {0};
    const placido_sample *first = &r->samples[rays->sample[which[k]]];
    for (; k < count && r->samples[rays->sample[which[k]]].edge == first->edge; k++) {
      double pull = rows->root[k] / rays->numbers[PLACIDO_RAY_NOISE][which[k]];
      for (int i = 0; i < CELL; i++) {
        sum[i] += pull * rows->row[k][i];
      }
    }
    double *to = corner + (size_t)mires->points[first->point].edge * n;
    for (int i = 0; i < CELL; i++) {
      to[i / ORDER * side + i % ORDER] += sum[i];
    }
  }
}

static void push_columns(double *corner, size_t n, const placido_refinement *r,
                         const struct rows *rows, const size_t *which, int count,
                         const double *errors, int columns) {
  int side = r->shape.grid->side;
  for (int m = 0; m < columns; m++) {
    double sum[CELL] = {0}, pulls[BATCH] = {0};
    for (int k = 0; k < count; k++) {
      size_t own = r->rays->sample[which[k]] * (size_t)columns + (size_t)m;
      pulls[k] = rows->root[k] * errors[own];
    }
    add_pulls(sum, rows, pulls);
    for (int i = 0; i < CELL; i++) {
      corner[(size_t)m * n + (size_t)(i / ORDER * side + i % ORDER)] += sum[i];
    }
  }
}

/* The rays of one cell: what errors of theirs push its coefficients. */
static void push_cell(double *rights, const placido_refinement *r, int column, int row,
                      const void *context) {
  const struct push *push = context;
  const placido_grid *grid = r->shape.grid;
  size_t c = (size_t)row * (size_t)grid->cells + (size_t)column, end = r->rays->starts[c + 1];
  size_t n = (size_t)grid->side * (size_t)grid->side;
  double *corner = rights + row * grid->side + column;
  size_t edges = push->mires ? (size_t)push->mires->edge_count : 0;
  struct rows rows;
  for (size_t at = r->rays->starts[c]; at < end; at += BATCH) {
    const size_t *which = r->rays->order + at;
    int count = end - at < BATCH ? (int)(end - at) : BATCH;
    find_rows(&rows, r, which, count);
    if (edges) {
      push_edges(corner, n, r, &rows, which, count, push->mires);
    }
    push_columns(corner + edges * n, n, r, &rows, which, count, push->errors, push->columns);
  }
}

void placido_refinement_push(double *rights, const placido_refinement *r,
                             const placido_mires *mires, const double *errors, int columns) {
  const struct push push = {mires, errors, columns};
  placido_sightlines_sort(r->rays, r->shape.grid);
  for_each_cell(rights, r, push_cell, &push);
}

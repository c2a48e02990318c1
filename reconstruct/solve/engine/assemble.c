/* A change δc of the coefficients changes a point's miss by (a B + b B_x + c B_y)·δc, three numbers
 * a point (mirror.h), over the 36 or 16 coefficients of its cell. The points of one cell share all
 * coefficients, so their part of the normal matrix is one dense product of their rows. */
#include "reconstruct/solve/engine/assemble.h"

#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

#define CELL PLACIDO_SPLINE_CELL
#define ORDER PLACIDO_SPLINE_ORDER
#define CUBIC 4 /* the other order */
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
                           double by_q, int order, const double powers[ORDER][ORDER]) {
  double t[2 * ORDER], value[2 * ORDER], slope[2 * ORDER];
  for (int i = 0; i < 2 * order; i++) {
    t[i] = i < order ? x : y;
    value[i] = powers[order - 1][i % order];
    slope[i] = 0;
  }
  for (int n = order - 2; n >= 0; n--) {
    for (int i = 0; i < 2 * order; i++) {
      slope[i] = slope[i] * t[i] + value[i];
      value[i] = value[i] * t[i] + powers[n][i % order];
    }
  }
  for (int j = 0; j < order; j++) {
    double along = by_z * value[order + j] + by_q * slope[order + j];
    double across = by_p * value[order + j];
    for (int i = 0; i < order; i++) {
      row[j * order + i] = along * value[i] + across * slope[i];
    }
  }
}

PLACIDO_INSIDE double weight_of(double residual) {
  return 1 / sqrt(1 + residual * residual * (1 / (PLACIDO_HUBER * PLACIDO_HUBER)));
}

double placido_sample_row(double row[CELL], const placido_sample *s, double sigma_px) {
  double slope = s->slope * sigma_px, steep = slope * s->basis.knot_mm;
  const double by_z = s->miss.by_z / slope, by_p = s->miss.by_p / steep;
  const double by_q = s->miss.by_q / steep;
  if (s->basis.order == ORDER) {
    row_of(row, s->basis.x, s->basis.y, by_z, by_p, by_q, ORDER, placido_spline_powers);
  } else {
    row_of(row, s->basis.x, s->basis.y, by_z, by_p, by_q, CUBIC, placido_spline_powers_cubic);
  }
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

PLACIDO_INSIDE void rows_of(struct rows *rows, const placido_refinement *r, const size_t *which,
                            int count, int order, const double powers[ORDER][ORDER]) {
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
           rows->root[k] * steep * numbers[PLACIDO_RAY_BY_Q][i], order, powers);
  }
  for (; count % TOGETHER; count++) {
    memset(rows->row[count], 0, sizeof rows->row[count]);
    rows->root[count] = rows->residual[count] = 0;
  }
  rows->count = count;
}

PLACIDO_WIDE static void find_rows(struct rows *rows, const placido_refinement *r,
                                   const size_t *which, int count) {
  if (r->shape.grid->order == ORDER) {
    rows_of(rows, r, which, count, ORDER, placido_spline_powers);
  } else {
    rows_of(rows, r, which, count, CUBIC, placido_spline_powers_cubic);
  }
}

PLACIDO_INSIDE void products_of(double *restrict block, const struct rows *rows, int cell) {
  for (int k = 0; k < rows->count; k += TOGETHER) {
    const double *a = rows->row[k], *b = rows->row[k + 1], *c = rows->row[k + 2];
    const double *d = rows->row[k + 3];
    for (int i = 0; i < cell; i++) {
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

/* Adds rowsᵀ rows to a block's lower triangle, and what else makes its lines whole vectors. */
PLACIDO_WIDE static void add_products(double *restrict block, const struct rows *rows, int order) {
  if (order == ORDER) {
    products_of(block, rows, CELL);
  } else {
    products_of(block, rows, CUBIC * CUBIC);
  }
}

PLACIDO_INSIDE void pulls_of(double *restrict right, const struct rows *rows,
                             const double pulls[BATCH], int cell) {
  for (int k = 0; k < rows->count; k += TOGETHER) {
    const double *a = rows->row[k], *b = rows->row[k + 1], *c = rows->row[k + 2];
    const double *d = rows->row[k + 3], *p = pulls + k;
    for (int i = 0; i < cell; i++) {
      right[i] += (p[0] * a[i] + p[1] * b[i]) + (p[2] * c[i] + p[3] * d[i]);
    }
  }
}

/* right += Σ pull · row, for a batch's rows. */
PLACIDO_WIDE static void add_pulls(double *restrict right, const struct rows *rows,
                                   const double pulls[BATCH], int order) {
  if (order == ORDER) {
    pulls_of(right, rows, pulls, CELL);
  } else {
    pulls_of(right, rows, pulls, CUBIC * CUBIC);
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
    add_products(block, &rows, grid->order);
    for (int k = 0; k < rows.count; k++) {
      rows.residual[k] = -rows.residual[k];
    }
    add_pulls(right, &rows, rows.residual, grid->order);
  }
  placido_normal_add(r->normal, column, row, block, right);
}

/* The spring at the axis. */
static void assemble_axis(placido_refinement *r) {
  placido_basis basis;
  double off = placido_refinement_at_axis(r, &basis), block[CELL * CELL], right[CELL], values[CELL];
  const int order = r->shape.grid->order;
  for (int i = 0; i < order * order; i++) {
    values[i] = basis.y[0][i / order] * basis.x[0][i % order];
    right[i] = -PLACIDO_DISTANCE_WEIGHT * values[i] * off;
    for (int j = 0; j <= i; j++) {
      block[i * CELL + j] = PLACIDO_DISTANCE_WEIGHT * values[i] * values[j];
    }
  }
  placido_normal_add(r->normal, basis.column, basis.row, block, right);
}

/* Calls a function for every cell with threads side by side: those that are `order` rows apart
 * share no coefficients, and every sum is made in the same order by any number of threads. */
typedef void cell_visitor(double *rights, const placido_refinement *r, int column, int row,
                          const void *context);

static void for_each_cell(double *rights, const placido_refinement *r, cell_visitor *visit,
                          const void *context) {
  int cells = r->shape.grid->cells, order = r->shape.grid->order;
  for (int first = 0; first < order; first++) {
#pragma omp parallel for num_threads(r->threads) schedule(dynamic, 1)
    for (int row = first; row < cells; row += order) {
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

/* Adds a cell's share to a vector over all coefficients, from the cell's corner on. */
static void add_to_corner(double *corner, const placido_grid *grid, const double sum[CELL]) {
  for (int j = 0; j < grid->order; j++) {
    for (int i = 0; i < grid->order; i++) {
      corner[j * grid->side + i] += sum[j * grid->order + i];
    }
  }
}

/* The edges of a batch: rays of one edge stand one behind the other. */
static void push_edges(double *corner, size_t n, const placido_refinement *r,
                       const struct rows *rows, const size_t *which, int count,
                       const placido_mires *mires) {
  const placido_sightlines *rays = r->rays;
  const int cell = r->shape.grid->order * r->shape.grid->order;
  for (int k = 0; k < count;) {
    double sum[CELL] = {0};
    const placido_sample *first = &r->samples[rays->sample[which[k]]];
    for (; k < count && r->samples[rays->sample[which[k]]].edge == first->edge; k++) {
      double pull = rows->root[k] / rays->numbers[PLACIDO_RAY_NOISE][which[k]];
      for (int i = 0; i < cell; i++) {
        sum[i] += pull * rows->row[k][i];
      }
    }
    add_to_corner(corner + (size_t)mires->points[first->point].edge * n, r->shape.grid, sum);
  }
}

static void push_columns(double *corner, size_t n, const placido_refinement *r,
                         const struct rows *rows, const size_t *which, int count,
                         const double *errors, int columns) {
  for (int m = 0; m < columns; m++) {
    double sum[CELL] = {0}, pulls[BATCH] = {0};
    for (int k = 0; k < count; k++) {
      size_t own = r->rays->sample[which[k]] * (size_t)columns + (size_t)m;
      pulls[k] = rows->root[k] * errors[own];
    }
    add_pulls(sum, rows, pulls, r->shape.grid->order);
    add_to_corner(corner + (size_t)m * n, r->shape.grid, sum);
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

/* Gauss-Newton with Levenberg damping only where the cost would rise: sum of pseudo-Huber losses,
 * third-derivative penalty, and the given distance as a stiff spring.
 *
 * A change δc of the coefficients changes a point's miss by (a B + b B_x + c B_y)·δc, three numbers
 * a point (mirror.h), over the 36 coefficients of its cell. The points of one cell share all
 * coefficients, so their part of the normal matrix is one dense product of their rows. */
#include "reconstruct/solve/refine.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

#define CELL PLACIDO_SPLINE_CELL
#define ORDER PLACIDO_SPLINE_ORDER
#define BATCH PLACIDO_BUNDLE_BATCH
#define TOGETHER 4        /* rows that are multiplied at a time */
#define HUBER 3.0         /* in sigmas: where the loss turns from square to linear */
#define SIGMA_MIN_PX 0.01
#define SIGMA_MAX_PX 5.0
#define NEAR 0.1          /* of the cost: after falls below it the next one is at most */
#define RATE 0.05         /* times as large, where points are well fitted; twice where badly */
#define ROUNDING 1e-7 /* a rise of the cost as small as this is no rise */

int placido_refinement_new(placido_refinement *r, const placido_conicoid *base,
                           const placido_grid *grid, placido_bundle *rays, double smoothing,
                           int steps_max, int threads, placido_error *err) {
  *r = (placido_refinement){.shape = {.base = *base, .grid = grid},
                            .rays = rays,
                            .samples = rays->samples,
                            .count = rays->count,
                            .smoothing = smoothing,
                            .steps_max = steps_max,
                            .threads = threads};
  int status = placido_normal_new(&r->normal, grid, err);
  if (!status) {
    status = placido_bundle_fit_grid(rays, grid, err);
  }
  if (!status) {
    r->coefficients = placido_memory_new((size_t)grid->side * (size_t)grid->side,
                                         sizeof *r->coefficients, err);
    r->work = placido_memory_new(r->count, sizeof *r->work, err);
    status = r->coefficients && r->work ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (status) {
    placido_refinement_free(r);
    return status;
  }
  r->shape.coefficients = r->coefficients;
  return PLACIDO_OK;
}

void placido_refinement_free(placido_refinement *r) {
  placido_normal_free(r->normal);
  placido_memory_free(r->coefficients);
  placido_memory_free(r->work);
  *r = (placido_refinement){0};
}

int placido_refinement_aim(placido_refinement *r, placido_bundle *rays, placido_error *err) {
  double *work = placido_memory_new(rays->count, sizeof *work, err);
  int status = work ? placido_bundle_fit_grid(rays, r->shape.grid, err) : PLACIDO_MEMORY;
  if (status) {
    placido_memory_free(work);
    return status;
  }
  placido_memory_free(r->work);
  r->work = work;
  r->rays = rays;
  r->samples = rays->samples;
  r->count = rays->count;
  r->traced = false;
  return PLACIDO_OK;
}

/* Twice the pseudo-Huber loss of a residual in sigmas. */
static double loss(double residual) {
  double x = residual / HUBER;
  return 2 * HUBER * HUBER * (sqrt(1 + x * x) - 1);
}

/* The spline's value at the axis. */
static double at_axis(const placido_refinement *r, placido_basis *basis) {
  double value[6];
  placido_grid_basis(r->shape.grid, 0, 0, basis);
  placido_grid_value(r->shape.grid, r->coefficients, basis, value);
  return value[0];
}

static void trace(placido_refinement *r) {
  placido_bundle_trace(r->rays, &r->shape, r->threads);
}

/* The cost at the present sigma. Points whose ray misses cost as much as far outliers, so that a
 * step cannot win by losing points. */
static double cost(const placido_refinement *r) {
  const double *residual_px = r->rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  double sum = 0, share = 1 / r->sigma_px;
  for (size_t i = 0; i < r->count; i++) {
    if (r->rays->used[i]) {
      sum += isnan(residual_px[i]) ? loss(100) : loss(residual_px[i] * share);
    }
  }
  placido_basis basis;
  double off = at_axis(r, &basis);
  return sum + PLACIDO_DISTANCE_WEIGHT * off * off +
         r->smoothing * placido_normal_roughness(r->normal, r->coefficients);
}

/* The pieces of the basis at a place in a cell, and their derivatives by the place, side by side. */
PLACIDO_INSIDE void pieces_at(double t, double value[ORDER], double slope[ORDER]) {
  for (int i = 0; i < ORDER; i++) {
    value[i] = placido_spline_powers[ORDER - 1][i];
    slope[i] = 0;
  }
  for (int n = ORDER - 2; n >= 0; n--) {
    for (int i = 0; i < ORDER; i++) {
      slope[i] = slope[i] * t + value[i];
      value[i] = value[i] * t + placido_spline_powers[n][i];
    }
  }
}

/* What a change of the residual is for each coefficient, from those for height and slopes. */
PLACIDO_INSIDE void row_of(double row[CELL], double x, double y, double by_z, double by_p,
                           double by_q) {
  double vx[ORDER], dx[ORDER], vy[ORDER], dy[ORDER];
  pieces_at(x, vx, dx);
  pieces_at(y, vy, dy);
  for (int j = 0, k = 0; j < ORDER; j++) {
    double value = by_z * vy[j] + by_q * dy[j], across = by_p * vy[j];
    for (int i = 0; i < ORDER; i++, k++) {
      row[k] = value * vx[i] + across * dx[i];
    }
  }
}

PLACIDO_INSIDE double weight_of(double residual) {
  return 1 / sqrt(1 + residual * residual * (1 / (HUBER * HUBER)));
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

/* Adds the rays of one cell. */
static void assemble_cell(placido_refinement *r, int column, int row) {
  const placido_grid *grid = r->shape.grid;
  const placido_bundle *rays = r->rays;
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
  double off = at_axis(r, &basis), block[CELL * CELL], right[CELL], values[CELL];
  for (int i = 0; i < CELL; i++) {
    values[i] = basis.y[0][i / ORDER] * basis.x[0][i % ORDER];
    right[i] = -PLACIDO_DISTANCE_WEIGHT * values[i] * off;
    for (int j = 0; j <= i; j++) {
      block[i * CELL + j] = PLACIDO_DISTANCE_WEIGHT * values[i] * values[j];
    }
  }
  placido_normal_add(r->normal, basis.column, basis.row, block, right);
}

/* Cells that are ORDER rows apart share no coefficients: threads may add them side by side, and
 * every sum is made in the same order by any number of threads. */
static void assemble(placido_refinement *r) {
  int cells = r->shape.grid->cells;
  placido_bundle_sort(r->rays, r->shape.grid);
  placido_normal_clear(r->normal);
  for (int first = 0; first < ORDER; first++) {
#pragma omp parallel for num_threads(r->threads) schedule(dynamic, 1)
    for (int row = first; row < cells; row += ORDER) {
      for (int column = 0; column < cells; column++) {
        assemble_cell(r, column, row);
      }
    }
  }
  placido_normal_smooth(r->normal, r->smoothing, r->coefficients);
  assemble_axis(r);
}

/* The rays of one cell: what errors of theirs push its coefficients. */
static void push_cell(double *rights, const placido_refinement *r, int column, int row,
                      const double *errors, int columns) {
  const placido_grid *grid = r->shape.grid;
  const placido_bundle *rays = r->rays;
  size_t c = (size_t)row * (size_t)grid->cells + (size_t)column, end = rays->starts[c + 1];
  size_t n = (size_t)grid->side * (size_t)grid->side;
  struct rows rows;
  for (size_t at = rays->starts[c]; at < end; at += BATCH) {
    find_rows(&rows, r, rays->order + at, end - at < BATCH ? (int)(end - at) : BATCH);
    for (int m = 0; m < columns; m++) {
      double sum[CELL] = {0}, pulls[BATCH];
      double *corner = rights + (size_t)m * n + row * grid->side + column;
      for (int k = 0; k < rows.count; k++) {
        size_t ray = rays->order[at + (size_t)k < end ? at + (size_t)k : end - 1];
        pulls[k] = rows.root[k] * errors[rays->sample[ray] * (size_t)columns + (size_t)m];
      }
      add_pulls(sum, &rows, pulls);
      for (int k = 0; k < CELL; k++) {
        corner[k / ORDER * grid->side + k % ORDER] += sum[k];
      }
    }
  }
}

void placido_refinement_push(double *rights, const placido_refinement *r, const double *errors,
                             int columns) {
  int cells = r->shape.grid->cells;
  placido_bundle_sort(r->rays, r->shape.grid);
  for (int first = 0; first < ORDER; first++) {
#pragma omp parallel for num_threads(r->threads) schedule(dynamic, 1)
    for (int row = first; row < cells; row += ORDER) {
      for (int column = 0; column < cells; column++) {
        push_cell(rights, r, column, row, errors, columns);
      }
    }
  }
}

/* Robust spread of the residuals that count. */
static void rescale(placido_refinement *r) {
  const double *residual_px = r->rays->numbers[PLACIDO_RAY_RESIDUAL_PX];
  size_t n = 0;
  for (size_t i = 0; i < r->count; i++) {
    if (r->rays->used[i] && !isnan(residual_px[i])) {
      r->work[n++] = fabs(residual_px[i]);
    }
  }
  double spread = 1.4826 * placido_quantile(r->work, n, 0.5);
  r->sigma_px = fmax(SIGMA_MIN_PX, fmin(SIGMA_MAX_PX, spread));
}

/* One step down, with as much damping as it needs. Sets *fell to the relative fall of the cost. */
static int descend(placido_refinement *r, double *step, double *fell, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  double before = cost(r), damping = 0;
  assemble(r);
  *fell = 0;
  for (int attempt = 0; attempt < 8; attempt++) {
    int status = placido_normal_solve(r->normal, damping, step, err);
    r->damped = damping > 0;
    if (status) {
      return status;
    }
    for (size_t i = 0; i < n; i++) {
      r->coefficients[i] += step[i];
    }
    trace(r);
    double after = cost(r);
    if (after <= before * (1 + ROUNDING)) {
      *fell = (before - after) / before;
      return PLACIDO_OK;
    }
    for (size_t i = 0; i < n; i++) {
      r->coefficients[i] -= step[i];
    }
    damping = damping > 0 ? damping * 10 : 1e-3;
  }
  trace(r);
  return PLACIDO_OK;
}

void placido_refinement_trace(placido_refinement *r) {
  placido_bundle_hear(r->rays);
  if (!r->traced) {
    trace(r);
    r->traced = true;
  }
  placido_bundle_tell(r->rays);
}

int placido_refinement_run(placido_refinement *r, double settled, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  double *step = placido_memory_new(n, sizeof *step, err);
  int status = step ? PLACIDO_OK : PLACIDO_MEMORY;
  double fell = 1, next = 1; /* of the cost in a step, and what is expected of one more */
  placido_bundle_hear(r->rays);
  if (!r->traced) {
    trace(r);
    r->traced = true;
  }
  for (int i = 0; i < r->steps_max && !status; i++, r->steps++) {
    double sigma_before = r->sigma_px;
    rescale(r);
    bool same_unit = fabs(r->sigma_px / sigma_before - 1) < 0.03;
    if (same_unit && fmin(fell, next) < settled) {
      break;
    }
    double before = fell;
    status = descend(r, step, &fell, err);
    next = fell * (fell < NEAR ? fmax(RATE, i > 0 ? fell / before : 0) : 1);
  }
  placido_bundle_tell(r->rays);
  if (!status && !(fmin(fell, next) < 10 * settled)) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "the surface did not settle within %d steps", r->steps_max);
  }
  if (!status && r->damped) {
    /* a damped factor would make error bars of it that are far too small */
    status = placido_normal_solve(r->normal, 0, step, err);
    r->damped = false;
  }
  placido_memory_free(step);
  return status;
}

void placido_refinement_tell(placido_refinement *r) {
  placido_bundle_tell_all(r->rays, &r->shape, r->threads);
}

/* Gauss-Newton with Levenberg damping only where the cost would rise: sum of pseudo-Huber losses,
 * third-derivative penalty, and the given distance as a stiff spring.
 *
 * A change δc of the coefficients changes a point's miss by (a B + b B_x + c B_y)·δc, three numbers
 * a point (mirror.h), over the 36 coefficients of its cell. The points of one cell share all
 * coefficients, so their part of the normal matrix is one dense block. */
#include "reconstruct/solve/refine.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

#define CELL PLACIDO_SPLINE_CELL
#define BLOCK (CELL * CELL + CELL)
#define HUBER 3.0         /* in sigmas: where the loss turns from square to linear */
#define SIGMA_MIN_PX 0.01
#define SIGMA_MAX_PX 5.0
#define ROUNDING 1e-7 /* a rise of the cost as small as this is no rise */

int placido_refinement_new(placido_refinement *r, const placido_surface *base,
                           const placido_grid *grid, placido_sample *samples, size_t count,
                           double smoothing, int steps_max, int threads, placido_error *err) {
  *r = (placido_refinement){.shape = {.base = base},
                            .samples = samples,
                            .count = count,
                            .smoothing = smoothing,
                            .steps_max = steps_max,
                            .threads = threads};
  size_t cells = (size_t)grid->cells * (size_t)grid->cells;
  int status = placido_normal_new(&r->normal, grid, err);
  if (!status) {
    r->coefficients = placido_memory_new((size_t)grid->side * (size_t)grid->side,
                                         sizeof *r->coefficients, err);
    r->work = placido_memory_new(count, sizeof *r->work, err);
    r->order = placido_memory_new(count + cells + 1, sizeof *r->order, err);
    r->blocks = placido_memory_new(cells, BLOCK * sizeof *r->blocks, err);
    status = r->coefficients && r->work && r->order && r->blocks ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (status) {
    placido_refinement_free(r);
    return status;
  }
  r->shape.grid = grid;
  r->shape.coefficients = r->coefficients;
  return PLACIDO_OK;
}

void placido_refinement_free(placido_refinement *r) {
  placido_normal_free(r->normal);
  placido_memory_free(r->coefficients);
  placido_memory_free(r->work);
  placido_memory_free(r->order);
  placido_memory_free(r->blocks);
  *r = (placido_refinement){0};
}

static bool counts(const placido_sample *s) {
  return s->used && !isnan(s->residual_px);
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
#pragma omp parallel for num_threads(r->threads)
  for (size_t i = 0; i < r->count; i++) {
    placido_sample_trace(&r->samples[i], &r->shape);
  }
}

/* The cost at the present sigma. Points whose ray misses cost as much as far outliers, so that a
 * step cannot win by losing points. */
static double cost(const placido_refinement *r) {
  double sum = 0;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (s->used) {
      sum += isnan(s->residual_px) ? loss(100) : loss(s->residual_px / r->sigma_px);
    }
  }
  placido_basis basis;
  double off = at_axis(r, &basis);
  return sum + PLACIDO_DISTANCE_WEIGHT * off * off +
         r->smoothing * placido_normal_roughness(r->normal, r->coefficients);
}

static size_t cell_of(const placido_sample *s, int cells) {
  return (size_t)s->basis.row * (size_t)cells + (size_t)s->basis.column;
}

/* Counting sort of the used samples by cell; returns where the cells begin. */
static size_t *sort_by_cell(placido_refinement *r) {
  int cells = r->shape.grid->cells;
  size_t count = (size_t)cells * (size_t)cells, *starts = r->order + r->count;
  memset(starts, 0, (count + 1) * sizeof *starts);
  for (size_t i = 0; i < r->count; i++) {
    if (counts(&r->samples[i])) {
      starts[cell_of(&r->samples[i], cells) + 1]++;
    }
  }
  for (size_t c = 0; c < count; c++) {
    starts[c + 1] += starts[c];
  }
  for (size_t i = 0; i < r->count; i++) {
    if (counts(&r->samples[i])) {
      r->order[starts[cell_of(&r->samples[i], cells)]++] = i;
    }
  }
  memmove(starts + 1, starts, count * sizeof *starts);
  starts[0] = 0;
  return starts;
}

double placido_sample_row(double row[CELL], const placido_sample *s, double sigma_px) {
  double slope = s->slope * sigma_px;
  double a = s->miss.by_z / slope, b = s->miss.by_p / slope, c = s->miss.by_q / slope;
  for (int j = 0, k = 0; j < PLACIDO_SPLINE_ORDER; j++) {
    double value = a * s->basis.y[0][j] + c * s->basis.y[1][j], across = b * s->basis.y[0][j];
    for (int i = 0; i < PLACIDO_SPLINE_ORDER; i++, k++) {
      row[k] = value * s->basis.x[0][i] + across * s->basis.x[1][i];
    }
  }
  double x = s->residual_px / sigma_px / HUBER;
  return 1 / sqrt(1 + x * x);
}

/* Adds one sample's row to a cell's block (lower triangle) and right-hand side. */
static void add_row(double *block, const placido_sample *s, double sigma_px) {
  double row[CELL], *right = block + CELL * CELL;
  double weight = placido_sample_row(row, s, sigma_px), residual = s->residual_px / sigma_px;
  for (int i = 0; i < CELL; i++) {
    double left = weight * row[i], *line = block + i * CELL;
    right[i] -= left * residual;
    for (int j = 0; j <= i; j++) {
      line[j] += left * row[j];
    }
  }
}

static void assemble(placido_refinement *r) {
  int cells = r->shape.grid->cells;
  size_t count = (size_t)cells * (size_t)cells;
  const size_t *starts = sort_by_cell(r);
  placido_normal_clear(r->normal);
#pragma omp parallel for num_threads(r->threads) schedule(dynamic, 8)
  for (size_t c = 0; c < count; c++) {
    double *block = r->blocks + c * BLOCK;
    if (starts[c] < starts[c + 1]) {
      memset(block, 0, BLOCK * sizeof *block);
      for (size_t i = starts[c]; i < starts[c + 1]; i++) {
        add_row(block, &r->samples[r->order[i]], r->sigma_px);
      }
    }
  }
  /* added in the order of the cells, so that sums do not depend on the threads */
  for (size_t c = 0; c < count; c++) {
    if (starts[c] < starts[c + 1]) {
      const double *block = r->blocks + c * BLOCK;
      placido_normal_add(r->normal, (int)(c % (size_t)cells), (int)(c / (size_t)cells), block,
                         block + CELL * CELL);
    }
  }
  placido_normal_smooth(r->normal, r->smoothing, r->coefficients);
  placido_basis basis;
  double off = at_axis(r, &basis), block[CELL * CELL], right[CELL];
  for (int i = 0; i < CELL; i++) {
    double bi = basis.y[0][i / PLACIDO_SPLINE_ORDER] * basis.x[0][i % PLACIDO_SPLINE_ORDER];
    right[i] = -PLACIDO_DISTANCE_WEIGHT * bi * off;
    for (int j = 0; j <= i; j++) {
      block[i * CELL + j] = PLACIDO_DISTANCE_WEIGHT * bi *
                            basis.y[0][j / PLACIDO_SPLINE_ORDER] *
                            basis.x[0][j % PLACIDO_SPLINE_ORDER];
    }
  }
  placido_normal_add(r->normal, basis.column, basis.row, block, right);
}

static void rescale(placido_refinement *r) {
  double spread = placido_samples_spread(r->samples, r->count, r->work);
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

int placido_refinement_run(placido_refinement *r, double settled, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  double *step = placido_memory_new(n, sizeof *step, err);
  int status = step ? PLACIDO_OK : PLACIDO_MEMORY;
  double fell = 1;
  if (!r->traced) {
    trace(r);
    r->traced = true;
  }
  for (int i = 0; i < r->steps_max && !status; i++, r->steps++) {
    double sigma_before = r->sigma_px;
    rescale(r);
    bool same_unit = fabs(r->sigma_px / sigma_before - 1) < 0.03;
    if (same_unit && fell < settled) {
      break;
    }
    status = descend(r, step, &fell, err);
  }
  if (!status && !(fell < 10 * settled)) {
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

/* Normal equations on the pattern of a tensor-product spline: two coefficients meet where they are
 * at most `degree` apart both ways. What meets a coefficient is stored as a stencil of rows below
 * it, the same for every coefficient; the factor is a band's, since the order row by row has one.
 * */
#include "reconstruct/solve/engine/normal.h"

#include "base/memory.h"
#include "reconstruct/solve/engine/band.h"
#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

#define REACH PLACIDO_SPLINE_DEGREE /* at most: room in a stencil */
#define WIDE (2 * REACH + 1)
#define STENCIL ((REACH + 1) * WIDE)
#define ORDER PLACIDO_SPLINE_ORDER
#define CUBIC 4 /* the other order */
#define CELL PLACIDO_SPLINE_CELL

struct placido_normal {
  placido_grid grid;
  int count; /* unknowns */
  double *matrix, *penalty; /* count stencils: the sum so far, and the penalty of weight 1 */
  double *right;
  placido_band factor;
};

/* How far apart two coefficients may meet. */
static int degree_of(const placido_grid *grid) {
  return grid->order - 1;
}

/* Where the entry of a column's coefficient and the one (dj, di) from it stands. Of its own row
 * (dj = 0) only what lies ahead counts. */
static size_t slot_of(int column, int dj, int di) {
  return (size_t)column * STENCIL + (size_t)(dj * WIDE + di + REACH);
}

/* One difference operator of third order applied at one place: its coefficients on a 4×4 patch. */
static void patch_of(int a, double patch[16]) {
  static const double difference[4][4] = {
      {1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};
  for (int k = 0; k < 16; k++) {
    patch[k] = difference[a][k % 4] * difference[3 - a][k / 4];
  }
}

static const double binomial[4] = {1, 3, 3, 1};

/* The four operators at every place where they fit, with what each counts; the sum of their squares
 * is the penalty. `visit` gets the patch and the coefficient at its corner. */
typedef void visitor(void *context, const double patch[16], double weight, int corner);

static void for_each_difference(const placido_grid *grid, visitor *visit, void *context) {
  double knot = grid->knot_mm, scale = 1 / (knot * knot * knot * knot);
  for (int a = 0; a < 4; a++) {
    double patch[16];
    patch_of(a, patch);
    for (int row = 0; row + 3 - a < grid->side; row++) {
      for (int column = 0; column + a < grid->side; column++) {
        visit(context, patch, scale * binomial[a], row * grid->side + column);
      }
    }
  }
}

static void add_penalty(void *context, const double patch[16], double weight, int corner) {
  placido_normal *n = context;
  for (int c = 0; c < 16; c++) {
    int at = corner + c / 4 * n->grid.side + c % 4;
    for (int r = c; r < 16 && patch[c] != 0; r++) {
      if (patch[r] != 0) {
        n->penalty[slot_of(at, r / 4 - c / 4, r % 4 - c % 4)] += weight * patch[c] * patch[r];
      }
    }
  }
}

int placido_normal_new(placido_normal **normal, const placido_grid *grid, placido_error *err) {
  placido_normal *n = *normal = placido_memory_new(1, sizeof *n, err);
  if (!n) {
    return PLACIDO_MEMORY;
  }
  n->grid = *grid;
  n->count = grid->side * grid->side;
  size_t count = (size_t)n->count;
  n->matrix = placido_memory_new(count, STENCIL * sizeof *n->matrix, err);
  n->penalty = placido_memory_new(count, STENCIL * sizeof *n->penalty, err);
  n->right = placido_memory_new(count, sizeof *n->right, err);
  int status = placido_band_new(&n->factor, n->count, degree_of(grid) * (grid->side + 1) + 1, err);
  if (status || !n->matrix || !n->penalty || !n->right) {
    placido_normal_free(n);
    *normal = NULL;
    return PLACIDO_MEMORY;
  }
  for_each_difference(grid, add_penalty, n);
  return PLACIDO_OK;
}

void placido_normal_free(placido_normal *normal) {
  if (!normal) {
    return;
  }
  placido_memory_free(normal->matrix);
  placido_memory_free(normal->penalty);
  placido_memory_free(normal->right);
  placido_band_free(&normal->factor);
  placido_memory_free(normal);
}

void placido_normal_clear(placido_normal *normal) {
  size_t count = (size_t)normal->count;
  memset(normal->matrix, 0, count * STENCIL * sizeof *normal->matrix);
  memset(normal->right, 0, count * sizeof *normal->right);
}

/* For an order that is known, loops are written out. */
PLACIDO_INSIDE void add_block(placido_normal *normal, int column, int row, const double *block,
                              const double *right, int order) {
  for (int c = 0; c < order * order; c++) {
    int cj = c / order, ci = c % order, at = (row + cj) * normal->grid.side + column + ci;
    normal->right[at] += right[c];
    for (int rj = cj; rj < order; rj++) {
      double *to = normal->matrix + slot_of(at, rj - cj, -ci);
      const double *from = block + rj * order * CELL + c;
      for (int ri = rj == cj ? ci : 0; ri < order; ri++) {
        to[ri] += from[ri * CELL];
      }
    }
  }
}

void placido_normal_add(placido_normal *normal, int column, int row, const double *block,
                        const double *right) {
  if (normal->grid.order == ORDER) {
    add_block(normal, column, row, block, right, ORDER);
  } else {
    add_block(normal, column, row, block, right, CUBIC);
  }
}

/* An operator's value at one place of the coefficients. */
static double difference_at(const double *coefficients, int side, const double patch[16],
                            int corner) {
  double value = 0;
  for (int k = 0; k < 16; k++) {
    if (patch[k] != 0) {
      value += patch[k] * coefficients[corner + k / 4 * side + k % 4];
    }
  }
  return value;
}

/* What is summed up over the operators' places. */
struct sum {
  const double *coefficients;
  int side;
  double weight, roughness;
  double *right;
};

static void add_gradient(void *context, const double patch[16], double weight, int corner) {
  struct sum *sum = context;
  double pull = sum->weight * weight *
                difference_at(sum->coefficients, sum->side, patch, corner);
  for (int k = 0; k < 16; k++) {
    if (patch[k] != 0) {
      sum->right[corner + k / 4 * sum->side + k % 4] -= pull * patch[k];
    }
  }
}

static void add_square(void *context, const double patch[16], double weight, int corner) {
  struct sum *sum = context;
  double value = difference_at(sum->coefficients, sum->side, patch, corner);
  sum->roughness += weight * value * value;
}

void placido_normal_smooth(placido_normal *normal, double weight, const double *coefficients) {
  struct sum sum = {coefficients, normal->grid.side, weight, 0, normal->right};
  size_t entries = (size_t)normal->count * STENCIL;
  for (size_t i = 0; i < entries; i++) {
    normal->matrix[i] += weight * normal->penalty[i];
  }
  for_each_difference(&normal->grid, add_gradient, &sum);
}

double placido_normal_roughness(const placido_normal *normal, const double *coefficients) {
  struct sum sum = {coefficients, normal->grid.side, 1, 0, NULL};
  for_each_difference(&normal->grid, add_square, &sum);
  return sum.roughness;
}

/* The stencil's rows within the grid, between the matrix or an inverse and a band: which part of a
 * column's row dj there is. */
static void row_limits(const placido_grid *grid, int column, int dj, int *from, int *to) {
  int i = column % grid->side, reach = degree_of(grid);
  *from = dj == 0 ? 0 : -(i < reach ? i : reach);
  *to = grid->side - 1 - i < reach ? grid->side - 1 - i : reach;
}

static int rows_below(const placido_grid *grid, int column) {
  int left = grid->side - 1 - column / grid->side, reach = degree_of(grid);
  return left < reach ? left : reach;
}

static void fill_band(placido_normal *n, double damping) {
  memset(n->factor.entries, 0,
         (size_t)n->factor.padded * n->factor.stride * sizeof *n->factor.entries);
  for (int column = 0; column < n->count; column++) {
    double *to = placido_band_column(&n->factor, column);
    for (int dj = 0; dj <= rows_below(&n->grid, column); dj++) {
      int first, last;
      row_limits(&n->grid, column, dj, &first, &last);
      for (int di = first; di <= last; di++) {
        to[dj * n->grid.side + di] = n->matrix[slot_of(column, dj, di)];
      }
    }
    to[0] *= 1 + damping;
  }
}

int placido_normal_solve(placido_normal *normal, double damping, double *step,
                         placido_error *err) {
  fill_band(normal, damping);
  if (!placido_band_factorise(&normal->factor)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires do not determine the surface: the normal equations are "
                             "singular");
  }
  return placido_normal_solve_more(normal, normal->right, 1, step, err);
}

int placido_normal_solve_more(const placido_normal *normal, const double *right, int count,
                              double *x, placido_error *err) {
  memmove(x, right, (size_t)normal->count * (size_t)count * sizeof *x);
  return placido_band_solve(&normal->factor, x, count, err);
}

int placido_normal_draw(const placido_normal *normal, const double *z, int count, double *x,
                        placido_error *err) {
  memmove(x, z, (size_t)normal->count * (size_t)count * sizeof *x);
  return placido_band_solve_transposed(&normal->factor, x, count, err);
}

double placido_normal_rcond(const placido_normal *normal) {
  double least = INFINITY, most = 0;
  for (int j = 0; j < normal->count; j++) {
    double pivot = *placido_band_column(&normal->factor, j);
    least = fmin(least, pivot);
    most = fmax(most, pivot);
  }
  return least / most * (least / most);
}

int placido_normal_inverse(const placido_normal *normal, double **inverse, placido_error *err) {
  placido_band band;
  double *z = *inverse = placido_memory_new((size_t)normal->count, STENCIL * sizeof *z, err);
  int status = z ? placido_band_inverse(&band, &normal->factor, err) : PLACIDO_MEMORY;
  if (status) {
    placido_memory_free(z);
    *inverse = NULL;
    return status;
  }
  for (int column = 0; column < normal->count; column++) {
    const double *from = placido_band_column(&band, column);
    for (int dj = 0; dj <= rows_below(&normal->grid, column); dj++) {
      int first, last;
      row_limits(&normal->grid, column, dj, &first, &last);
      for (int di = first; di <= last; di++) {
        z[slot_of(column, dj, di)] = from[dj * normal->grid.side + di];
      }
    }
  }
  placido_band_free(&band);
  return PLACIDO_OK;
}

int placido_normal_outer(const placido_normal *normal, const double *x, int count,
                         double **outer, placido_error *err) {
  double *sum = *outer = placido_memory_new((size_t)normal->count, STENCIL * sizeof *sum, err);
  if (!sum) {
    return PLACIDO_MEMORY;
  }
  for (int k = 0; k < count; k++) {
    const double *v = x + (size_t)k * (size_t)normal->count;
    for (int column = 0; column < normal->count; column++) {
      for (int dj = 0; dj <= rows_below(&normal->grid, column); dj++) {
        const double *other = v + column + dj * normal->grid.side;
        int first, last;
        row_limits(&normal->grid, column, dj, &first, &last);
        for (int di = first; di <= last; di++) {
          sum[slot_of(column, dj, di)] += v[column] * other[di];
        }
      }
    }
  }
  return PLACIDO_OK;
}

PLACIDO_INSIDE double variance_of(const placido_normal *normal, const double *inverse, int column,
                                  int row, const double v[CELL], int order) {
  double diagonal = 0, beside = 0;
  for (int c = 0; c < order * order; c++) {
    int cj = c / order, ci = c % order, at = (row + cj) * normal->grid.side + column + ci;
    double own = 0;
    for (int ri = ci + 1; ri < order; ri++) {
      own += v[cj * order + ri] * inverse[slot_of(at, 0, ri - ci)];
    }
    for (int rj = cj + 1; rj < order; rj++) {
      const double *line = inverse + slot_of(at, rj - cj, -ci), *w = v + rj * order;
      double four = (w[0] * line[0] + w[1] * line[1]) + (w[2] * line[2] + w[3] * line[3]);
      own += order == ORDER ? four + (w[4] * line[4] + w[5] * line[5]) : four;
    }
    diagonal += v[c] * v[c] * inverse[slot_of(at, 0, 0)];
    beside += v[c] * own;
  }
  return diagonal + 2 * beside;
}

double placido_normal_variance(const placido_normal *normal, const double *inverse, int column,
                               int row, const double v[CELL]) {
  return normal->grid.order == ORDER ? variance_of(normal, inverse, column, row, v, ORDER)
                                     : variance_of(normal, inverse, column, row, v, CUBIC);
}

PLACIDO_INSIDE void block_of(const placido_normal *normal, const double *inverse, int column,
                             int row, double block[CELL * CELL], int order) {
  for (int c = 0; c < order * order; c++) {
    int cj = c / order, ci = c % order, at = (row + cj) * normal->grid.side + column + ci;
    for (int r = c; r < order * order; r++) {
      double entry = inverse[slot_of(at, r / order - cj, r % order - ci)];
      block[r * CELL + c] = block[c * CELL + r] = entry;
    }
  }
}

void placido_normal_block(const placido_normal *normal, const double *inverse, int column, int row,
                          double block[CELL * CELL]) {
  if (normal->grid.order == ORDER) {
    block_of(normal, inverse, column, row, block, ORDER);
  } else {
    memset(block, 0, CELL * CELL * sizeof *block);
    block_of(normal, inverse, column, row, block, CUBIC);
  }
}

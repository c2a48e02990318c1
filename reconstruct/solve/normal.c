/* Normal equations on the pattern of a tensor-product spline: two coefficients meet where they are
 * at most `degree` apart both ways. The lower triangle is stored by columns. */
#include "reconstruct/solve/normal.h"

#include "base/memory.h"

#include <cholmod.h>
#include <stdlib.h>

#define REACH PLACIDO_SPLINE_DEGREE
#define WIDE (2 * REACH + 1)

struct placido_normal {
  placido_grid grid;
  int count;    /* unknowns */
  int *slot;    /* count * (REACH + 1) * WIDE: index of the entry (dj, di) below a column, or -1 */
  double *right;
  cholmod_common common;
  cholmod_sparse *matrix;
  cholmod_factor *factor;
};

static int slot_of(const placido_normal *n, int column, int dj, int di) {
  return n->slot[((long)column * (REACH + 1) + dj) * WIDE + di + REACH];
}

/* Lays out the pattern: below column (row j, column i) stand (j, i..), then rows j+1 .. j+REACH. */
static void lay_out(placido_normal *n, int *starts, int *rows, int *entries) {
  int side = n->grid.side, at = 0;
  for (int j = 0; j < side; j++) {
    for (int i = 0; i < side; i++) {
      int column = j * side + i;
      if (starts) {
        starts[column] = at;
      }
      for (int dj = 0; dj <= REACH; dj++) {
        for (int di = dj == 0 ? 0 : -REACH; di <= REACH; di++) {
          if (j + dj >= side || i + di < 0 || i + di >= side) {
            continue;
          }
          if (starts) {
            rows[at] = (j + dj) * side + i + di;
            n->slot[((long)column * (REACH + 1) + dj) * WIDE + di + REACH] = at;
          }
          at++;
        }
      }
    }
  }
  if (starts) {
    starts[n->count] = at;
  }
  *entries = at;
}

int placido_normal_new(placido_normal **normal, const placido_grid *grid, placido_error *err) {
  placido_normal *n = *normal = placido_memory_new(1, sizeof *n, err);
  if (!n) {
    return PLACIDO_MEMORY;
  }
  n->grid = *grid;
  n->count = grid->side * grid->side;
  cholmod_start(&n->common);
  n->common.print = 0;
  n->common.supernodal = CHOLMOD_SIMPLICIAL; /* the selected inverse reads its columns */
  n->common.final_ll = 1;
  n->common.nmethods = 1; /* one ordering, so that results do not depend on what is installed */
  n->common.method[0].ordering = CHOLMOD_AMD;
  n->common.postorder = 1;
  int entries;
  lay_out(n, NULL, NULL, &entries);
  n->slot = placido_memory_new((size_t)n->count * (REACH + 1) * WIDE, sizeof *n->slot, err);
  n->right = placido_memory_new((size_t)n->count, sizeof *n->right, err);
  n->matrix = cholmod_allocate_sparse((size_t)n->count, (size_t)n->count, (size_t)entries, 1, 1,
                                      -1, CHOLMOD_REAL, &n->common);
  if (n->slot && n->right && n->matrix) {
    lay_out(n, n->matrix->p, n->matrix->i, &entries);
    n->factor = cholmod_analyze(n->matrix, &n->common);
  }
  if (!n->factor) {
    placido_normal_free(n);
    *normal = NULL;
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory for the normal equations");
  }
  return PLACIDO_OK;
}

void placido_normal_free(placido_normal *normal) {
  if (!normal) {
    return;
  }
  cholmod_free_factor(&normal->factor, &normal->common);
  cholmod_free_sparse(&normal->matrix, &normal->common);
  cholmod_finish(&normal->common);
  placido_memory_free(normal->slot);
  placido_memory_free(normal->right);
  placido_memory_free(normal);
}

void placido_normal_clear(placido_normal *normal) {
  double *x = normal->matrix->x;
  const int *p = normal->matrix->p;
  for (int i = 0; i < p[normal->count]; i++) {
    x[i] = 0;
  }
  for (int i = 0; i < normal->count; i++) {
    normal->right[i] = 0;
  }
}

void placido_normal_add(placido_normal *normal, int column, int row, const double *block,
                        const double *right) {
  double *x = normal->matrix->x;
  for (int c = 0; c < PLACIDO_SPLINE_CELL; c++) {
    int cj = c / PLACIDO_SPLINE_ORDER, ci = c % PLACIDO_SPLINE_ORDER;
    int at = (row + cj) * normal->grid.side + column + ci;
    normal->right[at] += right[c];
    for (int r = c; r < PLACIDO_SPLINE_CELL; r++) {
      int dj = r / PLACIDO_SPLINE_ORDER - cj, di = r % PLACIDO_SPLINE_ORDER - ci;
      x[slot_of(normal, at, dj, di)] += block[r * PLACIDO_SPLINE_CELL + c];
    }
  }
}

/* One difference operator of third order applied at one place: its coefficients on a 4×4 patch. */
static void patch_of(int a, double patch[4][4]) {
  static const double difference[4][4] = {
      {1, 0, 0, 0}, {-1, 1, 0, 0}, {1, -2, 1, 0}, {-1, 3, -3, 1}};
  for (int j = 0; j < 4; j++) {
    for (int i = 0; i < 4; i++) {
      patch[j][i] = difference[a][i] * difference[3 - a][j];
    }
  }
}

/* The operator's value at one place of the coefficients. */
static double difference_at(const placido_normal *n, const double *coefficients, int column,
                            int row, double patch[4][4]) {
  double value = 0;
  for (int k = 0; k < 16; k++) {
    if (patch[k / 4][k % 4] != 0) {
      value += patch[k / 4][k % 4] * coefficients[(row + k / 4) * n->grid.side + column + k % 4];
    }
  }
  return value;
}

static void smooth_at(placido_normal *n, const double *coefficients, int column, int row,
                      double weight, double patch[4][4]) {
  double *x = n->matrix->x;
  int side = n->grid.side;
  double value = difference_at(n, coefficients, column, row, patch);
  for (int c = 0; c < 16; c++) {
    double pc = patch[c / 4][c % 4];
    if (pc == 0) {
      continue;
    }
    int at = (row + c / 4) * side + column + c % 4;
    n->right[at] -= weight * pc * value;
    for (int r = c; r < 16; r++) {
      x[slot_of(n, at, r / 4 - c / 4, r % 4 - c % 4)] += weight * pc * patch[r / 4][r % 4];
    }
  }
}

static const double binomial[4] = {1, 3, 3, 1};

void placido_normal_smooth(placido_normal *normal, double weight, const double *coefficients) {
  double knot = normal->grid.knot_mm, scale = weight / (knot * knot * knot * knot);
  int side = normal->grid.side;
  for (int a = 0; a < 4; a++) {
    double patch[4][4];
    patch_of(a, patch);
    for (int row = 0; row + 3 - a < side; row++) {
      for (int column = 0; column + a < side; column++) {
        smooth_at(normal, coefficients, column, row, scale * binomial[a], patch);
      }
    }
  }
}

double placido_normal_roughness(const placido_normal *normal, const double *coefficients) {
  double knot = normal->grid.knot_mm, sum = 0;
  int side = normal->grid.side;
  for (int a = 0; a < 4; a++) {
    double patch[4][4];
    patch_of(a, patch);
    for (int row = 0; row + 3 - a < side; row++) {
      for (int column = 0; column + a < side; column++) {
        double value = difference_at(normal, coefficients, column, row, patch);
        sum += binomial[a] * value * value;
      }
    }
  }
  return sum / (knot * knot * knot * knot);
}

static void scale_diagonal(placido_normal *n, double factor) {
  double *x = n->matrix->x;
  const int *p = n->matrix->p;
  for (int column = 0; column < n->count; column++) {
    x[p[column]] *= factor;
  }
}

/* One of CHOLMOD's solutions with the last factor, for `count` columns. */
static int solve_columns(placido_normal *normal, int system, const double *right, int count,
                         double *x, placido_error *err) {
  size_t numbers = (size_t)normal->count * (size_t)count;
  cholmod_dense b = {.nrow = (size_t)normal->count,
                     .ncol = (size_t)count,
                     .nzmax = numbers,
                     .d = (size_t)normal->count,
                     .x = (void *)right,
                     .xtype = CHOLMOD_REAL,
                     .dtype = CHOLMOD_DOUBLE};
  cholmod_dense *solution = cholmod_solve(system, normal->factor, &b, &normal->common);
  if (!solution) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory for the normal equations");
  }
  for (size_t i = 0; i < numbers; i++) {
    x[i] = ((double *)solution->x)[i];
  }
  cholmod_free_dense(&solution, &normal->common);
  return PLACIDO_OK;
}

int placido_normal_solve_more(placido_normal *normal, const double *right, int count, double *x,
                              placido_error *err) {
  return solve_columns(normal, CHOLMOD_A, right, count, x, err);
}

int placido_normal_draw(placido_normal *normal, const double *z, int count, double *x,
                        placido_error *err) {
  int status = solve_columns(normal, CHOLMOD_Lt, z, count, x, err);
  return status ? status : solve_columns(normal, CHOLMOD_Pt, x, count, x, err);
}

int placido_normal_solve(placido_normal *normal, double damping, double *step,
                         placido_error *err) {
  scale_diagonal(normal, 1 + damping);
  int done = cholmod_factorize(normal->matrix, normal->factor, &normal->common);
  scale_diagonal(normal, 1 / (1 + damping));
  if (!done || normal->common.status == CHOLMOD_NOT_POSDEF) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires do not determine the surface: the normal equations are "
                             "singular");
  }
  return placido_normal_solve_more(normal, normal->right, 1, step, err);
}

double placido_normal_rcond(placido_normal *normal) {
  return cholmod_rcond(normal->factor, &normal->common);
}

/* The selected inverse on the factor's own pattern, column by column from the last: with A = L Lᵀ
 * and D = diag(L), Z(i,j) = -Σ_k Z(i,k) L(k,j) / L(j,j), Z(j,j) = 1/L(j,j)² - Σ_k Z(j,k) L(k,j) /
 * L(j,j). */
static void select_inverse(const cholmod_factor *f, double *z, double *work, int *position) {
  const int *p = f->p, *rows = f->i, *lengths = f->nz;
  const double *l = f->x;
  int n = (int)f->n;
  for (int i = 0; i < n; i++) {
    position[i] = -1;
  }
  for (int j = n - 1; j >= 0; j--) {
    int start = p[j], count = lengths[j];
    double pivot = l[start];
    for (int a = 1; a < count; a++) {
      position[rows[start + a]] = a;
      work[a] = 0;
    }
    for (int a = 1; a < count; a++) {
      /* what is left of this column's pattern is part of column k's: the pattern of a factor is a
       * clique. Where it is all of it, the two run side by side. */
      int k = rows[start + a], rest = count - a - 1;
      const double *zk = z + p[k] + 1;
      double lkj = l[start + a] / pivot, sum = z[p[k]] * l[start + a];
      if (lengths[k] - 1 == rest) {
        double *below = work + a + 1;
        const double *lower = l + start + a + 1;
        for (int b = 0; b < rest; b++) {
          below[b] -= zk[b] * lkj;
          sum += zk[b] * lower[b];
        }
      } else {
        const int *rows_k = rows + p[k] + 1;
        for (int b = 0, left = rest; left > 0; b++) {
          int at = position[rows_k[b]];
          if (at > 0) {
            work[at] -= zk[b] * lkj;
            sum += zk[b] * l[start + at];
            left--;
          }
        }
      }
      work[a] -= sum / pivot;
    }
    double diagonal = 1 / (pivot * pivot);
    for (int a = 1; a < count; a++) {
      z[start + a] = work[a];
      diagonal -= work[a] * l[start + a] / pivot;
      position[rows[start + a]] = -1;
    }
    z[start] = diagonal;
  }
}

/* Brings the entries from the factor's order back to the matrix's slots. */
static void unpermute(const placido_normal *n, const double *z, int *inverse_order,
                      double *inverse) {
  const int *perm = n->factor->Perm, *fp = n->factor->p, *fi = n->factor->i, *fn = n->factor->nz;
  const int *p = n->matrix->p, *rows = n->matrix->i;
  for (int i = 0; i < n->count; i++) {
    inverse_order[perm[i]] = i;
  }
  for (int column = 0; column < n->count; column++) {
    for (int e = p[column]; e < p[column + 1]; e++) {
      int a = inverse_order[column], b = inverse_order[rows[e]];
      int low = a < b ? a : b, high = a < b ? b : a;
      int from = fp[low], to = fp[low] + fn[low] - 1;
      while (from < to) {
        int middle = (from + to) / 2;
        if (fi[middle] < high) {
          from = middle + 1;
        } else {
          to = middle;
        }
      }
      inverse[e] = z[from];
    }
  }
}

int placido_normal_inverse(placido_normal *normal, double **inverse, placido_error *err) {
  size_t count = (size_t)normal->count;
  size_t entries = (size_t)((const int *)normal->matrix->p)[normal->count];
  *inverse = placido_memory_new(entries, sizeof **inverse, err);
  double *z = placido_memory_new(normal->factor->nzmax, sizeof *z, err);
  double *work = placido_memory_new(count, sizeof *work, err);
  int *position = placido_memory_new(count, sizeof *position, err);
  int status = *inverse && z && work && position ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    select_inverse(normal->factor, z, work, position);
    unpermute(normal, z, position, *inverse);
  } else {
    placido_memory_free(*inverse);
    *inverse = NULL;
  }
  placido_memory_free(z);
  placido_memory_free(work);
  placido_memory_free(position);
  return status;
}

int placido_normal_outer(const placido_normal *normal, const double *x, int count,
                         double **outer, placido_error *err) {
  const int *p = normal->matrix->p, *rows = normal->matrix->i;
  double *sum = *outer = placido_memory_new((size_t)p[normal->count], sizeof *sum, err);
  if (!sum) {
    return PLACIDO_MEMORY;
  }
  for (int k = 0; k < count; k++) {
    const double *v = x + (size_t)k * (size_t)normal->count;
    for (int column = 0; column < normal->count; column++) {
      for (int e = p[column]; e < p[column + 1]; e++) {
        sum[e] += v[column] * v[rows[e]];
      }
    }
  }
  return PLACIDO_OK;
}

double placido_normal_variance(const placido_normal *normal, const double *inverse, int column,
                               int row, const double v[PLACIDO_SPLINE_CELL]) {
  double sum = 0;
  for (int c = 0; c < PLACIDO_SPLINE_CELL; c++) {
    int cj = c / PLACIDO_SPLINE_ORDER, ci = c % PLACIDO_SPLINE_ORDER;
    int at = (row + cj) * normal->grid.side + column + ci;
    sum += v[c] * v[c] * inverse[slot_of(normal, at, 0, 0)];
    for (int r = c + 1; r < PLACIDO_SPLINE_CELL; r++) {
      int dj = r / PLACIDO_SPLINE_ORDER - cj, di = r % PLACIDO_SPLINE_ORDER - ci;
      sum += 2 * v[c] * v[r] * inverse[slot_of(normal, at, dj, di)];
    }
  }
  return sum;
}

/* Banded Cholesky, a panel of columns at a time (Golub and Van Loan, Matrix Computations, 4.3.5):
 * for the fit's few hundred unknowns a band is at least as fast as a sparse factor, since all of
 * its loops run over neighbouring numbers; and it needs no ordering. */
#include "reconstruct/solve/engine/band.h"

#include "base/memory.h"
#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

#define PANEL PLACIDO_BAND_PANEL

int placido_band_new(placido_band *band, int count, int width, placido_error *err) {
  *band = (placido_band){.count = count, .width = width};
  band->padded = (count + width + 2 * PANEL - 1) / PANEL * PANEL;
  band->stride = (size_t)(width + PANEL);
  band->entries = placido_memory_new((size_t)band->padded * band->stride, sizeof *band->entries,
                                     err);
  return band->entries ? PLACIDO_OK : PLACIDO_MEMORY;
}

void placido_band_free(placido_band *band) {
  placido_memory_free(band->entries);
  *band = (placido_band){0};
}

double *placido_band_column(const placido_band *band, int j) {
  return band->entries + (size_t)j * band->stride;
}

/* Factorises a panel's own columns. */
PLACIDO_WIDE static bool factorise_panel(const placido_band *band, int first) {
  for (int k = 0; k < PANEL; k++) {
    double *column = placido_band_column(band, first + k);
    int rows = band->width + PANEL - 1 - k;
    for (int m = 0; m < k; m++) {
      const double *before = placido_band_column(band, first + m) + k - m;
      double factor = before[0];
      for (int i = 0; i < rows; i++) {
        column[i] -= factor * before[i];
      }
    }
    if (!(column[0] > 0)) {
      return false;
    }
    double pivot = sqrt(column[0]), share = 1 / pivot;
    column[0] = pivot;
    for (int i = 1; i < rows; i++) {
      column[i] *= share;
    }
  }
  return true;
}

/* target += Σ factors[k] · sources[k], the sources a panel's worth. */
PLACIDO_WIDE static void combine(double *restrict target, const double *const sources[PANEL],
                                 const double factors[PANEL], int rows) {
  const double *a = sources[0], *b = sources[1], *c = sources[2], *d = sources[3];
  const double *e = sources[4], *f = sources[5], *g = sources[6], *h = sources[7];
  double fa = factors[0], fb = factors[1], fc = factors[2], fd = factors[3];
  double fe = factors[4], ff = factors[5], fg = factors[6], fh = factors[7];
  for (int i = 0; i < rows; i++) {
    target[i] += ((fa * a[i] + fb * b[i]) + (fc * c[i] + fd * d[i])) +
                 ((fe * e[i] + ff * f[i]) + (fg * g[i] + fh * h[i]));
  }
}

static bool factorise(placido_band *band) {
  for (int first = 0; first < band->count; first += PANEL) {
    if (!factorise_panel(band, first)) {
      return false;
    }
    int end = first + PANEL - 1 + band->width; /* the panel's last row, and one */
    for (int target = first + PANEL; target < end; target++) {
      const double *sources[PANEL];
      double factors[PANEL];
      for (int k = 0; k < PANEL; k++) {
        sources[k] = placido_band_column(band, first + k) + target - first - k;
        factors[k] = -sources[k][0];
      }
      combine(placido_band_column(band, target), sources, factors, end - target);
    }
  }
  return true;
}

bool placido_band_factorise(placido_band *band) {
  for (int j = band->count; j < band->padded; j++) {
    memset(placido_band_column(band, j), 0, band->stride * sizeof(double));
    *placido_band_column(band, j) = 1;
  }
  return factorise(band);
}

/* Σ a[i] b[i] as eight sums side by side. */
PLACIDO_WIDE static double product_of(const double *a, const double *b, int count) {
  double sums[PANEL] = {0}, sum = 0;
  for (int i = 0; i < count; i += PANEL) {
    for (int s = 0; s < PANEL; s++) {
      sums[s] += a[i + s] * b[i + s];
    }
  }
  for (int s = 0; s < PANEL; s++) {
    sum += sums[s];
  }
  return sum;
}

/* L y = b. */
PLACIDO_WIDE static void forward(const placido_band *factor, double *restrict x) {
  for (int j = 0; j < factor->count; j++) {
    const double *restrict column = placido_band_column(factor, j);
    double y = x[j] /= column[0];
    for (int i = 1; i < factor->width; i++) {
      x[j + i] -= column[i] * y;
    }
  }
}

/* Lᵀ x = y. Beyond its width a column has zeros. */
static void backward(const placido_band *factor, double *x) {
  for (int j = factor->count - 1; j >= 0; j--) {
    const double *column = placido_band_column(factor, j);
    x[j] = (x[j] - product_of(column + 1, x + j + 1, factor->width - 1)) / column[0];
  }
}

static int solve(const placido_band *factor, double *x, int sides, bool both, placido_error *err) {
  size_t n = (size_t)factor->count;
  double *y = placido_memory_new((size_t)factor->padded, sizeof *y, err);
  if (!y) {
    return PLACIDO_MEMORY;
  }
  for (int s = 0; s < sides; s++, x += n) {
    memcpy(y, x, n * sizeof *y);
    if (both) {
      forward(factor, y);
    }
    backward(factor, y);
    memcpy(x, y, n * sizeof *y);
  }
  placido_memory_free(y);
  return PLACIDO_OK;
}

int placido_band_solve(const placido_band *factor, double *x, int sides, placido_error *err) {
  return solve(factor, x, sides, true, err);
}

int placido_band_solve_transposed(const placido_band *factor, double *x, int sides,
                                  placido_error *err) {
  return solve(factor, x, sides, false, err);
}

/* The inverse while it is being found: of every column also what stands above the diagonal, so that
 * columns are whole. */
struct whole {
  double *entries;
  size_t stride;
  int reach; /* to either side of the diagonal: a band's width or more, in whole panels */
};

static double *at(const struct whole *z, int row, int column) {
  return z->entries + (size_t)column * z->stride + (size_t)(row - column + z->reach);
}

/* y = x L11⁻¹ for all rows x of the panel at once: `rows` numbers for every one of its columns. */
PLACIDO_WIDE static void divide_by_corner(double *x, const placido_band *factor, int first,
                                          int rows) {
  for (int k = PANEL - 1; k >= 0; k--) {
    const double *corner = placido_band_column(factor, first + k);
    double *column = x + k * rows, share = 1 / corner[0];
    for (int m = k + 1; m < PANEL; m++) {
      const double *later = x + m * rows;
      double weight = corner[m - k];
      for (int i = 0; i < rows; i++) {
        column[i] -= weight * later[i];
      }
    }
    for (int i = 0; i < rows; i++) {
      column[i] *= share;
    }
  }
}

/* M = L21 L11⁻¹ by columns. */
static void find_ratios(double *ratios, const placido_band *factor, int first, int rows) {
  memset(ratios, 0, (size_t)rows * PANEL * sizeof *ratios);
  for (int k = 0; k < PANEL; k++) {
    memcpy(ratios + k * rows, placido_band_column(factor, first + k) + PANEL - k,
           (size_t)(factor->width - PANEL + k) * sizeof *ratios);
  }
  divide_by_corner(ratios, factor, first, rows);
}

/* product = -Z22 M, where Z22 are the whole columns behind the panel. */
static void multiply(double *product, const struct whole *z, int first, const double *ratios,
                     int rows) {
  memset(product, 0, (size_t)rows * PANEL * sizeof *product);
  for (int c = 0; c < rows; c += PANEL) {
    const double *sources[PANEL];
    for (int k = 0; k < PANEL; k++) {
      sources[k] = at(z, first + PANEL, first + PANEL + c + k);
    }
    for (int s = 0; s < PANEL; s++) {
      double factors[PANEL];
      for (int k = 0; k < PANEL; k++) {
        factors[k] = -ratios[s * rows + c + k];
      }
      combine(product + s * rows, sources, factors, rows);
    }
  }
}

/* Writes the panel's columns, Z21 = -Z22 M and Z11 = L11⁻ᵀ L11⁻¹ - Z21ᵀ M, and their mirror image.
 * */
static void put(const struct whole *z, const placido_band *factor, int first,
                const double *product, const double *ratios) {
  int rows = z->reach;
  double corner[PANEL * PANEL] = {0};
  for (int k = 0; k < PANEL; k++) {
    corner[k * PANEL + k] = 1;
  }
  divide_by_corner(corner, factor, first, PANEL);
  for (int r = 0; r < PANEL; r++) {
    for (int s = 0; s <= r; s++) {
      double sum = -product_of(product + r * rows, ratios + s * rows, rows);
      for (int k = 0; k < PANEL; k++) {
        sum += corner[r * PANEL + k] * corner[s * PANEL + k];
      }
      *at(z, first + r, first + s) = *at(z, first + s, first + r) = sum;
    }
    for (int i = 0; i < factor->width - PANEL + r; i++) {
      *at(z, first + PANEL + i, first + r) = product[r * rows + i];
      *at(z, first + r, first + PANEL + i) = product[r * rows + i];
    }
  }
}

int placido_band_inverse(placido_band *inverse, const placido_band *factor, placido_error *err) {
  int rows = (factor->width + PANEL - 1) / PANEL * PANEL;
  struct whole z = {.stride = 2 * (size_t)rows + 1, .reach = rows};
  int status = placido_band_new(inverse, factor->count, factor->width, err);
  double *work = placido_memory_new((size_t)rows * PANEL, 2 * sizeof *work, err);
  z.entries = placido_memory_new((size_t)(factor->padded + 2 * PANEL), z.stride * sizeof *z.entries,
                                 err);
  if (!status && (!work || !z.entries)) {
    status = PLACIDO_MEMORY;
  }
  /* from the last panel to the first: all that a panel asks for lies behind it within the band */
  for (int first = (factor->count - 1) / PANEL * PANEL; first >= 0 && !status; first -= PANEL) {
    double *ratios = work, *product = work + rows * PANEL;
    find_ratios(ratios, factor, first, rows);
    multiply(product, &z, first, ratios, rows);
    put(&z, factor, first, product, ratios);
  }
  for (int j = 0; j < factor->count && !status; j++) {
    memcpy(placido_band_column(inverse, j), at(&z, j, j), (size_t)factor->width * sizeof(double));
  }
  placido_memory_free(z.entries);
  placido_memory_free(work);
  if (status) {
    placido_band_free(inverse);
  }
  return status;
}

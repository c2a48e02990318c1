/* A B-spline along lines of a tensor grid.
 *
 * f(x, y) = sum_i sum_k c_ik M_i(y) N_k(x): for a line the inner sums over i are taken once for
 * every column of coefficients, and N at every x of the grid once for all lines. A point then costs
 * 3 × 6 products, whatever the height (de Boor, A Practical Guide to Splines, XVII). */
#include "base/dispatch.h"
#include "base/memory.h"
#include "reconstruct/surface/bspline.h"

#include <math.h>
#include <string.h>

#define ORDER PLACIDO_BSPLINE_ORDER
#define BLOCK 8 /* columns that are computed together */

/* Columns that lie in one knot span, up to but not including `end`. */
struct stretch {
  size_t end;
  int span;
};

/* One block: this, the basis functions and after them their slopes, a row each of `room` numbers,
 * NaN where the spline does not reach, and the stretches. */
struct columns {
  size_t room, stretches; /* of the columns and a block more */
  struct stretch *stretch;
  double *value, *slope;
};

static struct columns *lay_out(size_t count, placido_error *err) {
  size_t room = count + BLOCK, each = sizeof(struct stretch) + 2 * ORDER * sizeof(double);
  struct columns *c = placido_memory_new(1, sizeof *c + room * each, err);
  if (c) {
    c->room = room;
    c->value = (double *)(c + 1);
    c->slope = c->value + ORDER * room;
    c->stretch = (struct stretch *)(c->slope + ORDER * room);
  }
  return c;
}

int placido_bspline_columns_new(void **columns, size_t *work, const void *state,
                                const double *x_mm, size_t count, placido_error *err) {
  const placido_bspline *b = state;
  struct columns *c = lay_out(count, err);
  *columns = c;
  *work = 2 * ((size_t)b->x.count + ORDER) + 3 * (count + BLOCK);
  if (!c) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    double basis[3][ORDER];
    bool reached = placido_bspline_reaches(&b->x, x_mm[i]);
    double at_mm = fmin(fmax(x_mm[i], b->x.first), b->x.last); /* spans stay in their order */
    int span = placido_bspline_evaluate(&b->x, at_mm, basis);
    for (size_t k = 0; k < ORDER; k++) { /* beyond the degree they are zero */
      c->value[k * c->room + i] = reached ? basis[0][k] : NAN;
      c->slope[k * c->room + i] = reached ? basis[1][k] : NAN;
    }
    if (c->stretches == 0 || c->stretch[c->stretches - 1].span != span) {
      c->stretch[c->stretches++].span = span;
    }
    c->stretch[c->stretches - 1].end = i + 1;
  }
  return PLACIDO_OK;
}

/* The inner sums for the coefficients' columns from `begin` to before `end`: of the values along y
 * to `f`, of their slopes to `fy`. */
PLACIDO_WIDE
static void contract(double *restrict f, double *restrict fy, const placido_bspline *b, int row,
                     double along_y[3][ORDER], int begin, int end) {
  const double *line = b->coefficients + (size_t)row * (size_t)b->x.count;
  for (int k = begin; k < end; k++) {
    f[k] = along_y[0][0] * line[k];
    fy[k] = along_y[1][0] * line[k];
  }
  for (int i = 1; i <= b->y.degree; i++) {
    line += b->x.count;
    double value = along_y[0][i], slope = along_y[1][i];
    for (int k = begin; k < end; k++) {
      f[k] += value * line[k];
      fy[k] += slope * line[k];
    }
  }
}

/* The outer sums for the columns from `first` to before `last`, always of ORDER products: written
 * out, they become vectors. So that short stretches do too, whole blocks are computed; what lies
 * beyond a stretch's end is written over by the next one, or is room. */
PLACIDO_WIDE
static void sum_up(double *restrict sag, double *restrict sx, double *restrict sy,
                   const double *restrict value, const double *restrict slope, size_t room,
                   const double *restrict f, const double *restrict fy,
                   const struct stretch *stretch, size_t first, size_t last) {
  for (size_t begin = first; begin < last; stretch++) {
    const size_t end = stretch->end < last ? stretch->end : last;
    const double *restrict c = f + stretch->span, *restrict d = fy + stretch->span;
    for (size_t i = begin; i < begin + (end - begin + BLOCK - 1) / BLOCK * BLOCK; i++) {
      const double *n = value + i, *s = slope + i;
      sag[i - first] = c[0] * n[0] + c[1] * n[room] + c[2] * n[2 * room] + c[3] * n[3 * room] +
                       c[4] * n[4 * room] + c[5] * n[5 * room];
      sx[i - first] = c[0] * s[0] + c[1] * s[room] + c[2] * s[2 * room] + c[3] * s[3 * room] +
                      c[4] * s[4 * room] + c[5] * s[5 * room];
      sy[i - first] = d[0] * n[0] + d[1] * n[room] + d[2] * n[2 * room] + d[3] * n[3 * room] +
                      d[4] * n[4 * room] + d[5] * n[5 * room];
    }
    begin = end;
  }
}

PLACIDO_WIDE
static void add(double *restrict to, const double *restrict from, size_t count) {
  for (size_t i = 0; i < count; i++) {
    to[i] += from[i];
  }
}

/* The stretch of column `at`. */
static const struct stretch *stretch_of(const struct columns *c, size_t at) {
  const struct stretch *s = c->stretch;
  while (s->end <= at) {
    s++;
  }
  return s;
}

void placido_bspline_add_line(const void *state, const void *columns, const placido_line *line) {
  const placido_bspline *b = state;
  const struct columns *c = columns;
  if (!placido_bspline_reaches(&b->y, line->y_mm)) {
    for (size_t i = 0; i < line->count; i++) {
      line->sag[i] = line->sx[i] = line->sy[i] = NAN;
    }
    return;
  }
  size_t room = line->count + BLOCK, last = line->first + line->count;
  double *f = line->work, *fy = f + b->x.count + ORDER, *sums = fy + b->x.count + ORDER;
  double along_y[3][ORDER];
  int row = placido_bspline_evaluate(&b->y, line->y_mm, along_y);
  const struct stretch *from = stretch_of(c, line->first);
  int end = stretch_of(c, last - 1)->span + b->x.degree + 1;
  contract(f, fy, b, row, along_y, from->span, end);
  memset(f + end, 0, ORDER * sizeof *f); /* what a lower degree multiplies with zero */
  memset(fy + end, 0, ORDER * sizeof *fy);
  sum_up(sums, sums + room, sums + 2 * room, c->value, c->slope, c->room, f, fy, from, line->first,
         last);
  add(line->sag, sums, line->count);
  add(line->sx, sums + room, line->count);
  add(line->sy, sums + 2 * room, line->count);
}

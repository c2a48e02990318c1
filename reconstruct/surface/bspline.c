/* B-spline: a tensor product of splines of degree 2 to 5 on any knots.
 * The basis functions that are not zero in a knot span are, there, polynomials. They are expanded
 * once by the recurrence of Cox (J. Inst. Maths Applics 10, 134-149, 1972) and de Boor (J. Approx.
 * Theory 6, 50-62, 1972), N_i,p = (x - k_i)/(k_i+p - k_i) N_i,p-1 + (k_i+p+1 - x)/(k_i+p+1 - k_i+1)
 * N_i+1,p-1, in the local coordinate t = (x - span's start)/(span's width). Evaluation is then
 * Horner's rule, with exact derivatives, and a table finds the span without a search. */
#include "reconstruct/surface/bspline.h"

#include "base/memory.h"
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define ORDER PLACIDO_BSPLINE_ORDER
#define DEGREE_MIN 2
#define DEGREE_MAX (ORDER - 1)
#define COUNT_MAX 1024    /* coefficients along one axis */
#define BINS_PER_SPAN 2   /* of the table that finds the span */
#define WIDTH_MIN_MM 1e-6 /* of a knot span that is not empty */

static const char *const other_keys[] = {"degree", "knots_x_mm", "knots_y_mm", "coefficients_mm",
                                         NULL};

/* A knot may be repeated degree times, at either end once more: then the sag has no step. */
static bool check_knots(const char *field, const double *knots, int count, int degree,
                        placido_complaint *complaint) {
  char place[48];
  int knot_count = count + degree + 1;
  for (int i = 0; i < knot_count; i++) {
    double width = i > 0 ? knots[i] - knots[i - 1] : 0;
    snprintf(place, sizeof place, "%s[%d]", field, i);
    if (!isfinite(knots[i])) {
      return placido_part_complain(complaint, place, "is not finite");
    }
    if (width < 0) {
      return placido_part_complain(complaint, place, "%.9g is less than the knot before it, %.9g",
                                   knots[i], knots[i - 1]);
    }
    if (width > 0 && width < WIDTH_MIN_MM) {
      return placido_part_complain(
          complaint, place, "is %.3g mm from the knot before it: 0 or at least %g is expected",
          width, WIDTH_MIN_MM);
    }
    if (i > degree && i < knot_count - 1 && knots[i] == knots[i - degree]) {
      return placido_part_complain(complaint, place, "stands more than %d times", degree);
    }
  }
  return knots[count] > knots[degree] ||
         placido_part_complain(complaint, field, "span no interval: knots %d and %d are equal",
                               degree, count);
}

static bool check_count(const char *field, int count, int degree, placido_complaint *complaint) {
  return (count > degree && count <= COUNT_MAX) ||
         placido_part_complain(complaint, field,
                               "make %d coefficients along the axis, %d to %d are expected", count,
                               degree + 1, COUNT_MAX);
}

static bool check(const placido_part *part, placido_complaint *complaint) {
  int degree = part->as.bspline.degree;
  int columns = part->as.bspline.columns, rows = part->as.bspline.rows;
  if (degree < DEGREE_MIN || degree > DEGREE_MAX) {
    return placido_part_complain(complaint, "degree", "is %d, %d to %d are expected", degree,
                                 DEGREE_MIN, DEGREE_MAX);
  }
  if (!check_count("knots_x_mm", columns, degree, complaint) ||
      !check_count("knots_y_mm", rows, degree, complaint) ||
      !check_knots("knots_x_mm", part->as.bspline.knots_x_mm, columns, degree, complaint) ||
      !check_knots("knots_y_mm", part->as.bspline.knots_y_mm, rows, degree, complaint)) {
    return false;
  }
  for (size_t i = 0; i < (size_t)rows * (size_t)columns; i++) {
    if (!isfinite(part->as.bspline.coefficients_mm[i])) {
      return placido_part_complain(complaint, "coefficients_mm", "element %zu is not finite", i);
    }
  }
  return true;
}

/* target += source * (constant + linear t), polynomials of ORDER coefficients; source has a degree
 * below ORDER - 1. */
static void add_times_linear(double *target, const double *source, double constant, double linear) {
  for (int k = 0; k < ORDER; k++) {
    target[k] += constant * source[k] + (k > 0 ? linear * source[k - 1] : 0);
  }
}

/* The recurrence in the span from knot j to j + 1, in which functions j - degree to j are not zero.
 */
static void expand(placido_bspline_span *span, const double *knots, int j, int degree) {
  double start = knots[j], width = knots[j + 1] - start;
  double now[ORDER][ORDER] = {{1}}; /* [function][power of t] */
  for (int d = 1; d <= degree; d++) {
    double next[ORDER][ORDER] = {{0}};
    for (int b = 0; b <= d; b++) {
      const double *k = knots + (j - d + b);
      if (b > 0) {
        double range = k[d] - k[0];
        add_times_linear(next[b], now[b - 1], (start - k[0]) / range, width / range);
      }
      if (b < d) {
        double range = k[d + 1] - k[1];
        add_times_linear(next[b], now[b], (k[d + 1] - start) / range, -width / range);
      }
    }
    memcpy(now, next, sizeof now);
  }
  span->start = start;
  span->inverse_width = 1 / width;
  for (int b = 0; b < ORDER; b++) {
    for (int k = 0; k < ORDER; k++) {
      span->power[k][b] = now[b][k];
    }
  }
}

/* The spans from the knot `degree`; walks over empty ones. */
static int walk_to_span(const placido_bspline_axis *axis, double x, int span) {
  const double *end = axis->knots + axis->degree + 1;
  int last = axis->count - axis->degree - 1;
  while (span < last && x >= end[span]) {
    span++;
  }
  return span;
}

static void fill_bins(placido_bspline_axis *axis) {
  int span = 0;
  for (int bin = 0; bin < axis->bins; bin++) {
    span = walk_to_span(axis, axis->first + bin / axis->bins_per_mm, span);
    axis->bin_span[bin] = span;
  }
}

static void free_axis(placido_bspline_axis *axis) {
  placido_memory_free(axis->knots);
  placido_memory_free(axis->spans);
  placido_memory_free(axis->bin_span);
}

static int make_axis(placido_bspline_axis *axis, const double *knots, int count, int degree,
                     placido_error *err) {
  int spans = count - degree;
  size_t knot_count = (size_t)(count + degree + 1);
  axis->degree = degree;
  axis->count = count;
  axis->bins = BINS_PER_SPAN * spans;
  axis->knots = placido_memory_new(knot_count, sizeof *axis->knots, err);
  axis->spans = placido_memory_new((size_t)spans, sizeof *axis->spans, err);
  axis->bin_span = placido_memory_new((size_t)axis->bins, sizeof *axis->bin_span, err);
  if (!axis->knots || !axis->spans || !axis->bin_span) {
    return PLACIDO_MEMORY;
  }
  memcpy(axis->knots, knots, knot_count * sizeof *knots);
  axis->first = knots[degree];
  axis->last = knots[count];
  axis->bins_per_mm = axis->bins / (axis->last - axis->first);
  for (int i = 0; i < spans; i++) {
    if (knots[degree + i + 1] > knots[degree + i]) {
      expand(&axis->spans[i], knots, degree + i, degree);
    }
  }
  fill_bins(axis);
  return PLACIDO_OK;
}

static void release(void *state) {
  placido_bspline *b = state;
  if (b) {
    free_axis(&b->x);
    free_axis(&b->y);
    placido_memory_free(b->coefficients);
    placido_memory_free(b);
  }
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  int columns = part->as.bspline.columns, rows = part->as.bspline.rows;
  int degree = part->as.bspline.degree;
  size_t count = (size_t)columns * (size_t)rows;
  placido_bspline *b = placido_memory_new(1, sizeof *b, err);
  *state = b;
  if (!b) {
    return PLACIDO_MEMORY;
  }
  int status = make_axis(&b->x, part->as.bspline.knots_x_mm, columns, degree, err);
  if (!status) {
    status = make_axis(&b->y, part->as.bspline.knots_y_mm, rows, degree, err);
  }
  if (!status) {
    b->coefficients = placido_memory_new(count, sizeof *b->coefficients, err);
    status = b->coefficients ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (status) {
    release(b);
    *state = NULL;
    return status;
  }
  memcpy(b->coefficients, part->as.bspline.coefficients_mm, count * sizeof *b->coefficients);
  part->as.bspline.knots_x_mm = b->x.knots;
  part->as.bspline.knots_y_mm = b->y.knots;
  part->as.bspline.coefficients_mm = b->coefficients;
  return PLACIDO_OK;
}

int placido_bspline_evaluate(const placido_bspline_axis *axis, double x,
                             double basis[3][ORDER]) {
  int bin = (int)((x - axis->first) * axis->bins_per_mm);
  bin = bin < 0 ? 0 : bin >= axis->bins ? axis->bins - 1 : bin;
  int index = axis->bin_span[bin];
  while (index > 0 && x < axis->knots[axis->degree + index]) { /* a bin's start is rounded */
    index--;
  }
  index = walk_to_span(axis, x, index);
  const placido_bspline_span *span = &axis->spans[index];
  double per_mm = span->inverse_width, t = (x - span->start) * per_mm;
  double f[ORDER] = {0}, first[ORDER] = {0}, half_second[ORDER] = {0};
  for (int k = ORDER - 1; k >= 0; k--) {
    for (int b = 0; b < ORDER; b++) {
      half_second[b] = half_second[b] * t + first[b];
      first[b] = first[b] * t + f[b];
      f[b] = f[b] * t + span->power[k][b];
    }
  }
  for (int b = 0; b < ORDER; b++) {
    basis[0][b] = f[b];
    basis[1][b] = first[b] * per_mm;
    basis[2][b] = 2 * half_second[b] * per_mm * per_mm;
  }
  return index;
}

static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const placido_bspline *b = state;
  if (!placido_bspline_reaches(&b->x, x_mm) || !placido_bspline_reaches(&b->y, y_mm)) {
    return false;
  }
  double along_x[3][ORDER], along_y[3][ORDER];
  int column = placido_bspline_evaluate(&b->x, x_mm, along_x);
  int row = placido_bspline_evaluate(&b->y, y_mm, along_y);
  const double *line = b->coefficients + (size_t)row * (size_t)b->x.count + column;
  for (int i = 0; i <= b->y.degree; i++, line += b->x.count) {
    double f = 0, first = 0, second = 0;
    for (int k = 0; k <= b->x.degree; k++) {
      f += along_x[0][k] * line[k];
      first += along_x[1][k] * line[k];
      second += along_x[2][k] * line[k];
    }
    jet->sag += along_y[0][i] * f;
    jet->sx += along_y[0][i] * first;
    jet->sy += along_y[1][i] * f;
    jet->sxx += along_y[0][i] * second;
    jet->sxy += along_y[1][i] * first;
    jet->syy += along_y[2][i] * f;
  }
  return true;
}

/* The size of the array at path.name. */
static int read_count(size_t *count, const placido_json *json, const char *path, const char *name,
                      placido_error *err) {
  char place[160];
  snprintf(place, sizeof place, "%s.%s", path, name);
  int status = placido_json_count(json, place, count, err);
  if (!status && *count > (size_t)COUNT_MAX * COUNT_MAX) {
    return placido_json_refuse(json, place, err, "has %zu elements, which is too many", *count);
  }
  return status;
}

static int read_array(double *values, size_t count, const placido_json *json, const char *path,
                      const char *name, placido_error *err) {
  char place[160];
  snprintf(place, sizeof place, "%s.%s", path, name);
  return placido_json_numbers(json, place, values, count, err);
}

/* How many coefficients the knots ask for. */
static int read_size(int *coefficients, size_t *knots, int degree, const placido_json *json,
                     const char *path, const char *name, placido_error *err) {
  int status = read_count(knots, json, path, name, err);
  if (status) {
    return status;
  }
  placido_complaint complaint;
  *coefficients = (int)*knots - degree - 1;
  if (!check_count(name, *coefficients, degree, &complaint)) {
    char place[160];
    snprintf(place, sizeof place, "%s.%s", path, name);
    return placido_json_refuse(json, place, err, "%s", complaint.reason);
  }
  return PLACIDO_OK;
}

static int read(placido_part *part, void **storage, const placido_json *json, const char *path,
                placido_error *err) {
  char place[160];
  int degree, columns, rows;
  size_t x_knots, y_knots;
  snprintf(place, sizeof place, "%s.degree", path);
  int status = placido_json_integer(json, place, DEGREE_MIN, DEGREE_MAX, &degree, err);
  if (status || (status = read_size(&columns, &x_knots, degree, json, path, "knots_x_mm", err)) ||
      (status = read_size(&rows, &y_knots, degree, json, path, "knots_y_mm", err))) {
    return status;
  }
  size_t count = (size_t)columns * (size_t)rows;
  double *block = placido_memory_new(x_knots + y_knots + count, sizeof *block, err);
  *storage = block;
  if (!block) {
    return PLACIDO_MEMORY;
  }
  part->as.bspline.degree = degree;
  part->as.bspline.columns = columns;
  part->as.bspline.rows = rows;
  part->as.bspline.knots_x_mm = block;
  part->as.bspline.knots_y_mm = block + x_knots;
  part->as.bspline.coefficients_mm = block + x_knots + y_knots;
  status = read_array(block, x_knots, json, path, "knots_x_mm", err);
  if (!status) {
    status = read_array(block + x_knots, y_knots, json, path, "knots_y_mm", err);
  }
  return status ? status
                : read_array(block + x_knots + y_knots, count, json, path, "coefficients_mm", err);
}

static int write(json_t *object, const placido_part *part) {
  int columns = part->as.bspline.columns, rows = part->as.bspline.rows;
  int more = part->as.bspline.degree + 1;
  return json_object_set_new(object, "degree", json_integer(part->as.bspline.degree)) ||
         json_object_set_new(
             object, "knots_x_mm",
             placido_part_numbers(part->as.bspline.knots_x_mm, (size_t)(columns + more))) ||
         json_object_set_new(
             object, "knots_y_mm",
             placido_part_numbers(part->as.bspline.knots_y_mm, (size_t)(rows + more))) ||
         json_object_set_new(object, "coefficients_mm",
                             placido_part_numbers(part->as.bspline.coefficients_mm,
                                                  (size_t)rows * (size_t)columns));
}

const placido_part_row placido_part_bspline = {
    .name = "bspline",
    .other_keys = other_keys,
    .check = check,
    .prepare = prepare,
    .release = release,
    .add = add,
    .add_line = placido_bspline_add_line,
    .make_columns = placido_bspline_columns_new,
    .read = read,
    .write = write,
};

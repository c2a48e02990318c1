/* Crosshatch: which of its rays are inside the pupil, and the area that each stands for. */
#include "simulate/rays/crosshatch.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

placido_crosshatch placido_crosshatch_of(const placido_eye *eye, int samples) {
  return (placido_crosshatch){
    .samples = samples,
    .rows = 2 * samples - 1,
    .half_cell_mm = eye->pupil_mm / 2 / (samples - 1),
    .x_mm = eye->pupil_x_mm,
    .y_mm = eye->pupil_y_mm,
  };
}

long placido_crosshatch_total(const placido_crosshatch *pattern) {
  long n = pattern->samples;
  return n * n + (n - 1) * (n - 1);
}

int placido_crosshatch_samples(long rays) {
  long n = (long)sqrt((double)rays / 2);
  n = n < 2 ? 2 : n;
  while (n * n + (n - 1) * (n - 1) < rays) {
    n++;
  }
  return (int)n;
}

/* Largest whole number of `parity` (0 or 1) whose square is below `limit`; -1 where none is. */
static long largest_below(long limit, long parity) {
  long k = (long)sqrt((double)limit) + 2;
  k -= (k - parity) % 2 != 0;
  while (k >= 0 && k * k >= limit) {
    k -= 2;
  }
  return k >= 0 ? k : -1;
}

/* A row in half cells: its height, and its rays from -last to last in steps of two. */
typedef struct row_place {
  long height, last; /* last is -1 where there is none */
} row_place;

static row_place find_row(const placido_crosshatch *pattern, int row) {
  long edge = pattern->samples - 1;
  bool nodes = row < pattern->samples;
  long j = nodes ? 2L * row - edge : 2L * (row - pattern->samples) - (edge - 1);
  long parity = (nodes ? edge : edge - 1) % 2;
  return (row_place){j, largest_below(edge * edge - j * j, parity)};
}

void placido_crosshatch_row(const placido_crosshatch *pattern, int row, double *first_x_mm,
                            int *count, double *y_mm) {
  row_place place = find_row(pattern, row);
  *count = place.last < 0 ? 0 : (int)(place.last + 1);
  *first_x_mm = pattern->x_mm - (double)place.last * pattern->half_cell_mm;
  *y_mm = pattern->y_mm + (double)place.height * pattern->half_cell_mm;
}

/* Area of the disc of radius `edge` within [0, x] × [0, y]; odd in both. Where the corner is
 * outside, the rim runs from height y at `straight` to `fall` at the width: a rectangle before it,
 * two triangles to the centre and the sector between them. */
static double area_from_centre(long x, long y, long edge) {
  double sign = (x < 0) == (y < 0) ? 1 : -1, r = (double)edge;
  double width = fmin((double)labs(x), r), height = fmin((double)labs(y), r);
  if (width * width + height * height <= r * r) {
    return sign * width * height;
  }
  double straight = sqrt(r * r - height * height), fall = sqrt(r * r - width * width);
  double sine = (width * height - straight * fall) / (r * r);
  return sign * (straight * height + width * fall + r * r * asin(fmin(sine, 1))) / 2;
}

/* Area inside the disc of the cell of side 2 about (x, y). */
static double area_of_cell(long x, long y, long edge) {
  return area_from_centre(x + 1, y + 1, edge) - area_from_centre(x - 1, y + 1, edge) -
         area_from_centre(x + 1, y - 1, edge) + area_from_centre(x - 1, y - 1, edge);
}

static bool is_inside(long x, long y, long edge) { return x * x + y * y < edge * edge; }

static long inwards(long k) { return k > 0 ? k - 2 : k < 0 ? k + 2 : 0; }

/* Area of the cell about (x, y) where its middle is outside and (to_x, to_y) is the ray that it
 * counts for: the next one inwards along the longer coordinate, else along both. */
static double area_passed_on(long x, long y, long to_x, long to_y, long edge) {
  if (is_inside(x, y, edge)) {
    return 0;
  }
  long next_x = labs(x) >= labs(y) ? inwards(x) : x;
  long next_y = labs(x) >= labs(y) ? y : inwards(y);
  if (!is_inside(next_x, next_y, edge)) {
    next_x = inwards(x);
    next_y = inwards(y);
  }
  return next_x == to_x && next_y == to_y ? area_of_cell(x, y, edge) : 0;
}

/* Area that the ray at (x, y), inside the pupil, stands for. */
static double area_of_ray(long x, long y, long edge) {
  double area = area_of_cell(x, y, edge);
  for (long dy = -2; dy <= 2; dy += 2) {
    for (long dx = -2; dx <= 2; dx += 2) {
      area += dx != 0 || dy != 0 ? area_passed_on(x + dx, y + dy, x, y, edge) : 0;
    }
  }
  return area;
}

/* Whether the rim neither crosses the ray's cell nor leaves a neighbour's middle outside. */
static bool is_whole(long x, long y, long edge) {
  long far_x = labs(x) + 1, far_y = labs(y) + 1;
  return far_x * far_x + far_y * far_y <= edge * edge && is_inside(far_x + 1, far_y + 1, edge);
}

void placido_crosshatch_weights(const placido_crosshatch *pattern, int row, double *weight) {
  const double pi = 3.14159265358979323846;
  row_place place = find_row(pattern, row);
  long edge = pattern->samples - 1;
  /* The least crosshatch has one ray, in the middle, which is all of its light. */
  double share = edge == 1 ? 1 / pi : 1 / (2 * pi * (double)edge * (double)edge);
  long x = -place.last;
  for (; x <= 0 && place.last >= 0 && !is_whole(x, place.height, edge); x += 2) {
    weight[(place.last + x) / 2] = share * area_of_ray(x, place.height, edge);
    weight[(place.last - x) / 2] = weight[(place.last + x) / 2];
  }
  for (long i = (place.last + x) / 2; i <= (place.last - x) / 2; i++) {
    weight[i] = 4 * share;
  }
}

/* Patterns of rays over the pupil's disc.
 *
 * Equal area: Vogel's sunflower, Mathematical Biosciences 44 (1979) 179: ray k of n at the radius
 * sqrt((k + 1/2) / n) and the angle k times the golden one. Quasi-random: the additive recurrence
 * of the plastic number's powers (R2; M. Roberts, The unreasonable effectiveness of quasirandom
 * sequences, 2018), brought from the square to the disc by the concentric map, which keeps areas
 * (Shirley and Chiu, Journal of Graphics Tools 2 (1997) 45). */
#include "simulate/rays/pattern.h"

#include <math.h>

enum { RUN = 256 };

static const double pi = 3.14159265358979323846;

placido_pattern placido_pattern_of(const placido_eye *eye, enum placido_pattern_kind kind,
                                   long rays) {
  placido_pattern pattern = {.kind = kind,
                             .radius_mm = eye->pupil_mm / 2,
                             .x_mm = eye->pupil_x_mm,
                             .y_mm = eye->pupil_y_mm,
                             .total = rays,
                             .runs = (rays - 1) / RUN + 1,
                             .run_max = RUN};
  if (kind == PLACIDO_PATTERN_CROSSHATCH) {
    pattern.crosshatch = placido_crosshatch_of(eye, placido_crosshatch_samples(rays));
    pattern.total = placido_crosshatch_total(&pattern.crosshatch);
    pattern.runs = pattern.crosshatch.rows;
    pattern.run_max = pattern.crosshatch.samples;
  }
  return pattern;
}

int placido_pattern_count(const placido_pattern *pattern, long run) {
  if (pattern->kind == PLACIDO_PATTERN_CROSSHATCH) {
    double x, y;
    int count;
    placido_crosshatch_row(&pattern->crosshatch, (int)run, &x, &count, &y);
    return count;
  }
  long rest = pattern->total - run * RUN;
  return rest < RUN ? (int)rest : RUN;
}

/* Ray k of n in the unit disc. */
static void place_sunflower(long k, long n, double place[2]) {
  const double golden = 2 * pi * 0.381966011250105151795; /* 2 - the golden ratio, of a turn */
  double radius = sqrt(((double)k + 0.5) / (double)n), angle = fmod((double)k * golden, 2 * pi);
  place[0] = radius * cos(angle);
  place[1] = radius * sin(angle);
}

/* The square [-1, 1]² to the unit disc: each quarter's triangles become sectors. */
static void square_to_disc(double x, double y, double place[2]) {
  bool across = fabs(x) > fabs(y);
  double radius = across ? x : y;
  double angle = radius == 0 ? 0 : pi / 4 * (across ? y / x : x / y);
  place[0] = radius * (across ? cos(angle) : sin(angle));
  place[1] = radius * (across ? sin(angle) : cos(angle));
}

static void place_quasi_random(long k, double place[2]) {
  const double g1 = 0.75487766624669276005, g2 = 0.56984029099805326591; /* 1/p, 1/p²: p³ = p + 1 */
  double a = fmod(0.5 + g1 * (double)(k + 1), 1), b = fmod(0.5 + g2 * (double)(k + 1), 1);
  square_to_disc(2 * a - 1, 2 * b - 1, place);
}

static int run_of_crosshatch(const placido_crosshatch *crosshatch, int row, double *x_mm,
                             double *y_mm, double *weight) {
  double first_mm, height_mm;
  int count;
  placido_crosshatch_row(crosshatch, row, &first_mm, &count, &height_mm);
  for (int i = 0; i < count; i++) {
    x_mm[i] = first_mm + 2 * i * crosshatch->half_cell_mm;
    y_mm[i] = height_mm;
  }
  if (weight != NULL) {
    placido_crosshatch_weights(crosshatch, row, weight);
  }
  return count;
}

int placido_pattern_run(const placido_pattern *pattern, long run, double *x_mm, double *y_mm,
                        double *weight) {
  if (pattern->kind == PLACIDO_PATTERN_CROSSHATCH) {
    return run_of_crosshatch(&pattern->crosshatch, (int)run, x_mm, y_mm, weight);
  }
  int count = placido_pattern_count(pattern, run);
  for (int i = 0; i < count; i++) {
    double place[2];
    if (pattern->kind == PLACIDO_PATTERN_EQUAL_AREA) {
      place_sunflower(run * RUN + i, pattern->total, place);
    } else {
      place_quasi_random(run * RUN + i, place);
    }
    x_mm[i] = pattern->x_mm + pattern->radius_mm * place[0];
    y_mm[i] = pattern->y_mm + pattern->radius_mm * place[1];
  }
  for (int i = 0; i < count && weight != NULL; i++) {
    weight[i] = 1 / (double)pattern->total;
  }
  return count;
}

/* Exact points by the phantom's forward trace; the truth analytic. */
#include "tests/stability/fits.h"

#include <stdlib.h>
#include <string.h>

#define STEP_MM 0.2
#define HALF 20
#define LEVEL_MM 1.5
#define LEVEL_STEP_MM 0.05
#define ROOM ((2 * HALF + 1) * (2 * HALF + 1))

fits_eye fits_eye_new(const char *instrument, const placido_part *parts, size_t count,
                      int meridians) {
  fits_eye eye = {0};
  placido_jet jet;
  placido_error err = {0};
  assert_int_equal(placido_phantom_instrument(&eye.instrument, instrument, NULL), PLACIDO_OK);
  int status = placido_surface_new(&eye.truth, 0, 6, parts, count, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(placido_surface_at(eye.truth, 0, 0, &jet));
  eye.axis_z_mm = placido_surface_vertex_z_mm(eye.truth) - jet.sag;
  eye.mires = truth_points(eye.truth, &eye.instrument, meridians, FITS_NOISE_PX, NULL);
  return eye;
}

void fits_eye_free(fits_eye *eye) {
  placido_mires_free(&eye->mires);
  placido_surface_free(eye->truth);
}

double fits_truncation_um(double sixth, double knot_mm) {
  return 1e3 * 5.2 * 2 * 1.32e-3 * pow(knot_mm, 6) * sixth;
}

placido_mires fits_some(const fits_eye *eye, fits_choice *keep, double share) {
  placido_mires some = eye->mires;
  some.points = calloc(eye->mires.count + 1, sizeof *some.points);
  assert_non_null(some.points);
  some.count = 0;
  for (size_t i = 0; i < eye->mires.count; i++) {
    if (!keep || keep(&eye->mires.points[i], i, share)) {
      some.points[some.count++] = eye->mires.points[i];
    }
  }
  return some;
}

placido_fit *fits_of(const fits_eye *eye, placido_mires *mires,
                     const placido_fit_options *options) {
  placido_fit_options o = options ? *options : (placido_fit_options){0};
  placido_mires own = {0};
  placido_error err = {0};
  placido_fit *fit;
  if (!mires) {
    own = fits_some(eye, NULL, 0);
    mires = &own;
  }
  o.axis_z_mm = eye->axis_z_mm;
  int status = placido_fit_new(&fit, mires, &eye->instrument, &o, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  placido_mires_free(&own);
  return fit;
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double axial_D(const placido_jet *jet, double x, double y) {
  double r = hypot(x, y), s = (jet->sx * x + jet->sy * y) / r;
  return 337.5 * s / (r * sqrt(1 + s * s));
}

/* One place of the grid. */
struct place {
  double x, y, error_um, error_D, sigma_um, sigma_D;
};

/* Fills the places of the surface that are covered, or that are not; returns how many. Heights are
 * not levelled yet. */
static size_t look(struct place places[ROOM], const placido_fit *fit, const fits_eye *eye,
                   bool covered, size_t *all) {
  const placido_surface *found = placido_fit_surface(fit);
  double lift = placido_surface_vertex_z_mm(found) - placido_surface_vertex_z_mm(eye->truth);
  size_t n = 0;
  *all = 0;
  for (int k = 0; k < ROOM; k++) {
    struct place p = {.x = (k % (2 * HALF + 1) - HALF) * STEP_MM,
                      .y = (k / (2 * HALF + 1) - HALF) * STEP_MM};
    placido_jet a, b;
    if (hypot(p.x, p.y) > HALF * STEP_MM) {
      continue;
    }
    ++*all;
    if (placido_surface_covered(found, p.x, p.y) == covered &&
        placido_surface_at(found, p.x, p.y, &a) && placido_surface_at(eye->truth, p.x, p.y, &b)) {
      p.error_um = 1e3 * (lift - (a.sag - b.sag));
      bool near = hypot(p.x, p.y) < STEP_MM / 2; /* axial power is 0/0 on the axis */
      p.error_D = near ? 0 : axial_D(&a, p.x, p.y) - axial_D(&b, p.x, p.y);
      placido_fit_sigma_at(fit, p.x, p.y, &p.sigma_um, &p.sigma_D);
      places[n++] = p;
    }
  }
  return n;
}

/* Adds up the height errors of the covered places within a radius. */
static size_t sum_errors(double *sum, const placido_fit *fit, const fits_eye *eye, double radius) {
  const placido_surface *found = placido_fit_surface(fit);
  double lift = placido_surface_vertex_z_mm(found) - placido_surface_vertex_z_mm(eye->truth);
  int half = (int)(radius / LEVEL_STEP_MM);
  size_t n = 0;
  *sum = 0;
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * LEVEL_STEP_MM, y = j * LEVEL_STEP_MM;
      placido_jet a, b;
      if (hypot(x, y) <= radius && placido_surface_covered(found, x, y) &&
          placido_surface_at(found, x, y, &a) && placido_surface_at(eye->truth, x, y, &b)) {
        *sum += 1e3 * (lift - (a.sag - b.sag));
        n++;
      }
    }
  }
  return n;
}

/* The mean height error near the axis, or everywhere where nothing is covered there. */
static double level_of(const placido_fit *fit, const fits_eye *eye) {
  double sum;
  size_t n = sum_errors(&sum, fit, eye, LEVEL_MM);
  if (!n) {
    n = sum_errors(&sum, fit, eye, placido_surface_radius_mm(placido_fit_surface(fit)));
  }
  return n ? sum / (double)n : 0;
}

/* The largest error over its sigma; NaN where one is not a number. */
static double worst_of(struct place *places, size_t n, double level_um, double truncation_um) {
  double worst = 0;
  for (size_t i = 0; i < n; i++) {
    struct place *p = &places[i];
    p->error_um -= level_um;
    double height = fmax(0, fabs(p->error_um) - truncation_um) / p->sigma_um;
    /* a slope's truncation is a height's over the knots (order 5 for order 6): left to elevation
     * where there is any */
    double power = truncation_um > 0 ? 0 : fabs(p->error_D) / p->sigma_D;
    if (!isfinite(height) || !isfinite(power)) {
      return NAN;
    }
    worst = fmax(worst, fmax(height, power));
  }
  return worst;
}

fits_error fits_compare(const placido_fit *fit, const fits_eye *eye) {
  static struct place places[ROOM];
  static double sigmas[ROOM];
  size_t all, n = look(places, fit, eye, true, &all);
  fits_error e = {.points = n, .covered = (double)n / (double)all};
  double level_um = level_of(fit, eye);
  e.over_sigma = worst_of(places, n, level_um, eye->truncation_um);
  for (size_t i = 0; i < n; i++) {
    e.worst_um = fmax(e.worst_um, fabs(places[i].error_um));
    e.rms_um += places[i].error_um * places[i].error_um / (double)n;
    sigmas[i] = places[i].sigma_um;
  }
  e.rms_um = sqrt(e.rms_um);
  qsort(sigmas, n, sizeof *sigmas, by_value);
  e.sigma_um = n ? sigmas[n / 2] : (double)NAN;
  e.open_points = look(places, fit, eye, false, &all);
  e.open_over_sigma = worst_of(places, e.open_points, level_um, eye->truncation_um);
  return e;
}

double fits_bound(size_t points) {
  double low = 0, high = 20, count = 2.0 * (double)points; /* elevation and power */
  while (high - low > 1e-6) {
    double middle = 0.5 * (low + high);
    *(count * erfc(middle / M_SQRT2) > FITS_CHANCE ? &low : &high) = middle;
  }
  return 1.25 * high;
}

double fits_difference(const placido_fit *a, const placido_fit *b) {
  const placido_surface *first = placido_fit_surface(a), *second = placido_fit_surface(b);
  double lift = placido_surface_vertex_z_mm(first) - placido_surface_vertex_z_mm(second);
  double worst = 0;
  for (int k = 0; k < ROOM; k++) {
    double x = (k % (2 * HALF + 1) - HALF) * STEP_MM, y = (k / (2 * HALF + 1) - HALF) * STEP_MM;
    placido_jet p, q;
    double sigma_um, sigma_D;
    if (hypot(x, y) <= HALF * STEP_MM && placido_surface_covered(first, x, y) &&
        placido_surface_at(first, x, y, &p) && placido_surface_at(second, x, y, &q)) {
      placido_fit_sigma_at(a, x, y, &sigma_um, &sigma_D);
      double off = 1e3 * fabs(lift - p.sag + q.sag) / sigma_um;
      worst = isnan(off) ? (double)NAN : fmax(worst, off);
    }
  }
  return worst;
}

void fits_add(const char *name, const placido_fit *fit, const fits_error *e, double more,
              double perturbation, const char *unit) {
  const struct stability_row row = {.name = name,
                                    .condition = placido_fit_summary_get(fit).condition,
                                    .perturbation = perturbation,
                                    .in_unit = unit,
                                    .change = e->over_sigma,
                                    .out_unit = "sigma",
                                    .bound = fits_bound(e->points) + more,
                                    .extended = NAN};
  stability_add(&row);
}

void fits_add_refusal(const char *name, const placido_instrument *instrument, placido_mires *mires,
                      const placido_fit_options *options, int status, const char *says) {
  placido_fit *fit;
  placido_error err = {0};
  int found = placido_fit_new(&fit, mires, instrument, options, NULL, &err);
  if (found != status || !strstr(err.text, says)) {
    print_error("%s: status %d, \"%s\"\n", name, found, err.text);
  }
  assert_int_equal(found, status);
  assert_null(fit);
  assert_non_null(strstr(err.text, says));
  const struct stability_row row = {.name = name,
                                    .condition = NAN,
                                    .perturbation = NAN,
                                    .change = NAN,
                                    .bound = NAN,
                                    .extended = NAN,
                                    .refused = err.text};
  stability_add(&row);
}

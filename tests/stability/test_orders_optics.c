/* Orders of convergence of the optics: of rays and of waves in the samples of the pupil, of
 * quadrature in its nodes. */
#include "order.h"
#include "simulate/wavefront.h"
#include "table.h"
#include "tests/simulate/diffracted.h"
#include "tests/simulate/eyes.h"
#include "tests/support/near.h"

#include <stdio.h>
#include <stdlib.h>

enum { REFINEMENTS = 4 };

/* A Cartesian oval (a conic of Q = -1/n², Descartes) sends all rays from afar through one point; on
 * a retina before it a ray that entered at radius r arrives at r (1 - d / (F - sag)), a known disc.
 * F = R n / (n - 1) is the focus, d the retina's distance from it, both from the apex. */
#define APEX_MM 7.8
#define PUPIL_MM 4.0
#define INDEX 1.3375
#define SHORT_MM 1.0 /* the retina before the focus: a disc of 8 arc minutes radius */

static double focus_mm(void) { return APEX_MM * INDEX / (INDEX - 1); }

/* The disc's transform at a frequency along any direction, by radii that stand for equal light:
 * 20,000 of them leave 1e-9. */
static double exact_transfer(double per_mm) {
  const int count = 20000;
  const double k = 1 / APEX_MM, p = 1 - 1 / (INDEX * INDEX);
  double sum = 0;
  for (int i = 0; i < count; i++) {
    double r2 = (i + 0.5) / count * PUPIL_MM * PUPIL_MM / 4;
    double sag = k * r2 / (1 + sqrt(1 - p * k * k * r2));
    double at_mm = sqrt(r2) * SHORT_MM / (focus_mm() - sag);
    sum += j0(2 * pi * per_mm * at_mm);
  }
  return sum / count;
}

/* The largest error of the PSF's transform along its rows at some frequencies. Buckets are fine:
 * what they alias of a disc so much wider, J1(x)/x at x = 2 pi radius / bucket, is below 1e-5. */
static double transfer_error(const placido_psf *psf) {
  double *line = calloc((size_t)psf->n, sizeof *line), worst = 0, sum = 0;
  for (int i = 0; i < psf->n * psf->n; i++) {
    line[i % psf->n] += psf->values[i];
    sum += psf->values[i];
  }
  for (double cycles = 0.3; cycles < 3; cycles += 0.3) { /* over the disc's radius */
    double per_mm = cycles / (PUPIL_MM / 2 * SHORT_MM / focus_mm()), real = 0, imaginary = 0;
    double bucket_mm = 1e-3 * psf->bucket_um, half = pi * per_mm * bucket_mm;
    for (int i = 0; i < psf->n; i++) {
      double x = 1e-3 * psf->centre_x_um + (i - psf->n / 2) * bucket_mm;
      real += line[i] * cos(2 * pi * per_mm * x);
      imaginary += line[i] * sin(2 * pi * per_mm * x);
    }
    double share = half / sin(half) / sum;
    worst = fmax(worst, hypot(real * share - exact_transfer(per_mm), imaginary * share));
  }
  free(line);
  return worst;
}

static double rays_error(const placido_optics *optics, long *rays) {
  placido_surface *oval = conic(APEX_MM, -1 / (INDEX * INDEX));
  const placido_eye eye = {
      .pupil_mm = PUPIL_MM, .index = INDEX, .retina_mm = focus_mm() - SHORT_MM};
  placido_psf psf = psf_of(oval, &eye, optics);
  double error = transfer_error(&psf);
  *rays = psf.rays_entered;
  placido_psf_free(&psf);
  placido_surface_free(oval);
  return error;
}

/* Light that is spread over its cell's image is right to the second order of the cell: within the
 * pupil, where it stands for a map that is linear there, and at the rim, where cells of the share h
 * of the light count by their area inside but are spread whole, by h beyond. That is order 1 in the
 * rays; how the lattice meets the rim scatters (Gauss' circle) by up to a third of the error. */
static void spread_rays_converge(void **state) {
  (void)state;
  static const int samples[REFINEMENTS] = {24, 40, 68, 116};
  double spacing[REFINEMENTS], errors[REFINEMENTS];
  for (int i = 0; i < REFINEMENTS; i++) {
    long rays;
    const placido_optics optics = {
        .samples = samples[i], .buckets = 1201, .bucket_arcmin = 0.025, .grow = 1};
    errors[i] = rays_error(&optics, &rays);
    spacing[i] = 1 / (double)rays;
  }
  order_add("spread light, transfer by rays", spacing, errors, REFINEMENTS, 1, 0.3);
}

/* Rays that are counted: an N-th of the light too much or too little for each that the rim takes in
 * or leaves out. Rays at random are of order -1/2; of points as even as these the N^1/2 along the
 * rim scatter as much as independent ones at most, which is -3/4; no better than one ray is -1.
 * Four errors of that kind, each the largest of nine, scatter by some 0.1 of an order: 0.5 to 1.1.
 * */
static void counted_rays_converge(enum placido_pattern_kind pattern, const char *name) {
  static const long counts[REFINEMENTS] = {1000, 6000, 36000, 216000};
  double spacing[REFINEMENTS], errors[REFINEMENTS];
  for (int i = 0; i < REFINEMENTS; i++) {
    long rays;
    const placido_optics optics = {.rays = counts[i],
                                   .pattern = pattern,
                                   .light = PLACIDO_LIGHT_COUNTED,
                                   .buckets = 1201,
                                   .bucket_arcmin = 0.025,
                                   .grow = 1};
    errors[i] = rays_error(&optics, &rays);
    spacing[i] = 1 / (double)rays;
  }
  order_add(name, spacing, errors, REFINEMENTS, 0.8, 0.3);
}

static void patterns_converge(void **state) {
  (void)state;
  counted_rays_converge(PLACIDO_PATTERN_CROSSHATCH, "counted crosshatch, transfer by rays");
  counted_rays_converge(PLACIDO_PATTERN_EQUAL_AREA, "counted sunflower, transfer by rays");
  counted_rays_converge(PLACIDO_PATTERN_QUASI_RANDOM, "counted quasi-random, transfer by rays");
}

/* The power series of the modified Bessel function I_n, for arguments of a few units. */
static double bessel_i(int n, double x) {
  double term = 1, sum = 0;
  for (int m = 1; m <= n; m++) {
    term *= x / 2 / m;
  }
  for (int m = 0; m < 60; m++) {
    sum += term;
    term *= x * x / 4 / ((m + 1.0) * (m + 1.0 + n));
  }
  return sum;
}

/* The mean of exp(k x) over the disc is 2 I1(k) / k. Averaged over angles it is g(s) = I0(k
 * sqrt(s)), s = r², whose derivative of order m is at most (k²/4)^m / m! I0(k); Gauss-Legendre with
 * n nodes on (0, 1) errs by (n!)^4 / ((2n + 1) (2n)!^3) of the derivative of order 2n (Davis and
 * Rabinowitz, Methods of Numerical Integration, 2.7). 3n spokes alias I_3n, at most 2 (k/2)^3n /
 * (3n)! I0(k). Every ring squares away more than the one before: no fixed order, but this bound. */
static void quadrature_converges(void **state) {
  (void)state;
  enum { RINGS = 7, COUNT = 3 * RINGS * RINGS };
  static double x[COUNT], y[COUNT], weight[COUNT];
  const double k = 4, exact = 2 * bessel_i(1, k) / k, most = bessel_i(0, k);
  for (int rings = 1; rings <= RINGS; rings++) {
    char name[64];
    double sum = 0, m = 2 * rings;
    placido_disc_quadrature(x, y, weight, rings);
    for (int i = 0; i < 3 * rings * rings; i++) {
      sum += weight[i] * exp(k * x[i]);
    }
    double rule = exp(4 * lgamma(rings + 1) - 3 * lgamma(m + 1)) / (m + 1);
    double bend = pow(k * k / 4, m) / tgamma(m + 1);
    double alias = 2 * pow(k / 2, 3 * rings) / tgamma(3 * rings + 1);
    snprintf(name, sizeof name, "quadrature of exp(4 x), %d rings", rings);
    stability_add(&(struct stability_row){.name = name,
                                          .condition = NAN,
                                          .perturbation = 3 * rings * rings,
                                          .in_unit = "nodes",
                                          .change = fabs(sum - exact),
                                          .out_unit = "off",
                                          .bound = most * (rule * bend + alias + 1e-15),
                                          .extended = NAN});
  }
}

/* A perfect pupil's image in its buckets' middles is (2 J1(v) / v)², v = pi D angle / wavelength.
 * Cells that the rim crosses count by their area inside: that moves light by the square of a cell
 * at most, and a cell stands for light from its middle: second order, as how the lattice meets the
 * rim scatters (above). Single precision leaves 1e-6. */
static void waves_converge(void **state) {
  (void)state;
  static const int samples[REFINEMENTS] = {48, 80, 134, 224};
  double spacing[REFINEMENTS], errors[REFINEMENTS];
  const double pupil_mm = 4, bucket_arcmin = 0.2;
  const placido_wave wave = {.wavelength_nm = green_nm, .weight = 1};
  for (int i = 0; i < REFINEMENTS; i++) {
    const placido_window window = {
        .buckets = 65, .bucket_arcmin = bucket_arcmin, .samples = samples[i], .points = true};
    placido_pupil pupil = pupil_of(pupil_mm, perfect_um, 1);
    double *values = image_of(&pupil, &wave, 1, &window, NULL);
    double edge_mm = bucket_arcmin * arcmin_rad / (1e-6 * green_nm);
    double peak = pi / 4 * pupil_mm * pupil_mm * edge_mm * edge_mm;
    errors[i] = 0;
    for (int k = 0; k < 65 * 65; k++) {
      double angle = bucket_arcmin * arcmin_rad * hypot(k % 65 - 32, k / 65 - 32);
      double v = pi * pupil_mm * angle / (1e-6 * green_nm), airy = v > 0 ? 2 * j1(v) / v : 1;
      errors[i] = fmax(errors[i], fabs(values[k] / peak - airy * airy));
    }
    spacing[i] = 1.0 / samples[i];
    free(values);
    placido_pupil_free(&pupil);
  }
  order_add("perfect pupil's image, by spacing", spacing, errors, REFINEMENTS, 2, 0.5);
}

static void all_orders_are_as_expected(void **state) {
  (void)state;
  assert_int_equal(stability_print("Orders of convergence: optics"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spread_rays_converge),
      cmocka_unit_test(patterns_converge),
      cmocka_unit_test(quadrature_converges),
      cmocka_unit_test(waves_converge),
      cmocka_unit_test(all_orders_are_as_expected),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

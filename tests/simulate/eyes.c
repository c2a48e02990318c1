/* Corneas for tests, and what is measured on their PSFs. */
#include "eyes.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

static const double radius_mm = 4.5;

static placido_surface *make(const placido_part *parts, size_t count) {
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0, radius_mm, parts, count, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return surface;
}

static placido_part biconic(double r1, double r2, double q, double axis_deg) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC};
  part.as.biconic.r1 = r1;
  part.as.biconic.r2 = r2;
  part.as.biconic.q1 = part.as.biconic.q2 = q;
  part.as.biconic.axis_deg = axis_deg;
  return part;
}

placido_surface *toric(double r1_mm, double r2_mm, double q, double axis_deg) {
  placido_part part = biconic(r1_mm, r2_mm, q, axis_deg);
  return make(&part, 1);
}

placido_surface *conic(double r_mm, double q) {
  return toric(r_mm, r_mm, q, 0);
}

placido_surface *keratoconus(double turn_deg) {
  double turn = turn_deg * acos(-1) / 180;
  placido_part parts[2] = {biconic(7.7, 7.55, -0.3, 20 + turn_deg), {.kind = PLACIDO_PART_BUMP}};
  parts[1].as.bump.height_mm = 0.04;
  parts[1].as.bump.sigma_x_mm = 1.25;
  parts[1].as.bump.sigma_y_mm = 1.1;
  parts[1].as.bump.x_mm = 0.5 * cos(turn) + 1.1 * sin(turn);
  parts[1].as.bump.y_mm = 0.5 * sin(turn) - 1.1 * cos(turn);
  parts[1].as.bump.axis_deg = 15 + turn_deg;
  return make(parts, 2);
}

placido_surface *ridged(double index, double slope, double offset_mm, double axis_deg) {
  placido_part parts[2] = {biconic(7.8, 7.8, -1 / (index * index), 0),
                           {.kind = PLACIDO_PART_RIDGE}};
  parts[1].as.ridge.slope = slope;
  parts[1].as.ridge.width_mm = 0.02;
  parts[1].as.ridge.offset_mm = offset_mm;
  parts[1].as.ridge.axis_deg = axis_deg;
  return make(parts, 2);
}

placido_surface *comatic(double index, double coma_um) {
  placido_part parts[2] = {biconic(7.8, 7.8, -1 / (index * index), 0),
                           {.kind = PLACIDO_PART_ZERNIKE}};
  parts[1].as.zernike.radius_mm = radius_mm;
  parts[1].as.zernike.coefficients_um[7] = coma_um;
  return make(parts, 2);
}

placido_surface *cone(double height_mm, double sigma_mm, double x_mm, double y_mm) {
  placido_part parts[2] = {biconic(7.7, 7.55, -0.3, 20), {.kind = PLACIDO_PART_BUMP}};
  parts[1].as.bump.height_mm = height_mm;
  parts[1].as.bump.sigma_x_mm = parts[1].as.bump.sigma_y_mm = sigma_mm;
  parts[1].as.bump.x_mm = x_mm;
  parts[1].as.bump.y_mm = y_mm;
  return make(parts, 2);
}

placido_surface *flat(void) {
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE};
  part.as.zernike.radius_mm = radius_mm;
  return make(&part, 1);
}

placido_psf psf_of(const placido_surface *surface, const placido_eye *eye,
                   const placido_optics *optics) {
  placido_psf psf;
  placido_error err = {0};
  if (placido_psf_new(&psf, NULL, surface, eye, optics, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return psf;
}

moments moments_of(const placido_psf *psf) {
  moments m = {0};
  int half = psf->n / 2;
  for (int i = 0; i < psf->n * psf->n; i++) {
    double value = psf->values[i];
    double c = (i % psf->n - half) * psf->bucket_arcmin;
    double r = (i / psf->n - half) * psf->bucket_arcmin;
    m.sum += value;
    m.column += value * c;
    m.row += value * r;
    m.cc += value * c * c;
    m.cr += value * c * r;
    m.rr += value * r * r;
  }
  m.column /= m.sum;
  m.row /= m.sum;
  m.cc = m.cc / m.sum - m.column * m.column;
  m.cr = m.cr / m.sum - m.column * m.row;
  m.rr = m.rr / m.sum - m.row * m.row;
  return m;
}

placido_eye settled_eye(const placido_surface *surface, placido_eye eye) {
  const placido_optics optics = {.samples = 40, .buckets = 33, .grow = 1};
  placido_eye settled;
  placido_psf psf;
  placido_error err = {0};
  if (placido_psf_new(&psf, &settled, surface, &eye, &optics, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  placido_psf_free(&psf);
  return settled;
}

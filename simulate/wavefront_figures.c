/* What people read off a wavefront's Zernike terms: root mean squares and refraction.
 *
 * The terms are orthonormal, so a root mean square is the root of a sum of squared coefficients
 * (Thibos et al., J. Refract. Surg. 18, S652 (2002)). Refraction in power-vector form, radius r of
 * the pupil in mm: M = -4 sqrt(3) c20 / r², J0 = -2 sqrt(6) c22 / r², J45 = -2 sqrt(6) c2-2 / r²
 * (Thibos, Hong, Bradley and Applegate, J. Vision 4, 329 (2004), eq. 2). */
#include <placido/wavefront.h>

#include "reconstruct/surface/zernike.h"

#include <float.h>
#include <math.h>

static const double radians_per_um = 2 * 3.14159265358979323846 / 0.555;

static double square_pupil(const placido_wavefront *w) {
  return w->eye.pupil_mm * w->eye.pupil_mm / 4;
}

static double rms_from(const placido_wavefront *w, const double *c, int order) {
  double sum = 0;
  for (int j = placido_zernike_count(order - 1); j < w->term_count; j++) {
    sum += c[j] * c[j];
  }
  return sqrt(sum);
}

static double rms_total(const placido_wavefront *w, const double *c) {
  return rms_from(w, c, 2);
}

static double rms_higher(const placido_wavefront *w, const double *c) {
  return rms_from(w, c, 3);
}

static double pair(const double *c, int n, int m) {
  return hypot(c[placido_zernike_index(n, m)], c[placido_zernike_index(n, -m)]);
}

/* Whether a pair is no more than rounding leaves of paths as long as the eye: it has no direction
 * then. */
static bool is_none(const placido_wavefront *w, const double *c, int n, int m) {
  const double longest_um = 1e3 * w->eye.index * w->focus_mm[2];
  return pair(c, n, m) <= 4 * DBL_EPSILON * longest_um;
}

static double spherical(const placido_wavefront *w, const double *c) {
  return w->order < 4 ? (double)NAN : c[placido_zernike_index(4, 0)];
}

static double coma(const placido_wavefront *w, const double *c) {
  return w->order < 3 ? (double)NAN : pair(c, 3, 1);
}

static double coma_axis(const placido_wavefront *w, const double *c) {
  const double degrees = 180 / 3.14159265358979323846;
  double angle = degrees * atan2(c[placido_zernike_index(3, -1)], c[placido_zernike_index(3, 1)]);
  if (w->order < 3 || is_none(w, c, 3, 1)) {
    return NAN;
  }
  return angle < 0 ? angle + 360 : angle;
}

static double trefoil(const placido_wavefront *w, const double *c) {
  return w->order < 3 ? (double)NAN : pair(c, 3, 3);
}

static double mean_power(const placido_wavefront *w, const double *c) {
  return -4 * sqrt(3) * c[placido_zernike_index(2, 0)] / square_pupil(w);
}

/* The curvature of the wavefront at the pupil's centre: -2 / r² times the coefficient of the
 * squared radius, which every term without an angle has a share in. */
static double mean_power_centre(const placido_wavefront *w, const double *c) {
  double sum = 0, powers[PLACIDO_ZERNIKE_POWERS];
  for (int n = 2; n <= w->order; n += 2) {
    placido_zernike_radial(powers, n, 0);
    sum += powers[1] * c[placido_zernike_index(n, 0)];
  }
  return -2 * sum / square_pupil(w);
}

static double power(const placido_wavefront *w, const double *c) {
  return 1000 * w->eye.index / w->focus_mm[2] - mean_power(w, c);
}

static double cross_straight(const placido_wavefront *w, const double *c) {
  return -2 * sqrt(6) * c[placido_zernike_index(2, 2)] / square_pupil(w);
}

static double cross_oblique(const placido_wavefront *w, const double *c) {
  return -2 * sqrt(6) * c[placido_zernike_index(2, -2)] / square_pupil(w);
}

static double clinical(const placido_wavefront *w, const double *c, bool axis) {
  placido_correction lens = {mean_power(w, c), cross_straight(w, c), cross_oblique(w, c)};
  if (is_none(w, c, 2, 2)) {
    lens.j0_D = lens.j45_D = 0;
  }
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(&lens, &sphere_D, &cylinder_D, &axis_deg);
  return axis ? axis_deg : cylinder_D;
}

static double cylinder(const placido_wavefront *w, const double *c) {
  return clinical(w, c, false);
}

static double axis(const placido_wavefront *w, const double *c) {
  return clinical(w, c, true);
}

/* |mean of exp(i 2 pi W / wavelength)|² by the wavefront's own quadrature. */
static double strehl(const placido_wavefront *w, const double *c) {
  double real = 0, imaginary = 0;
  for (size_t i = 0; i < w->count; i++) {
    double opd_um = 0;
    for (int j = 1; j < w->term_count; j++) {
      opd_um += c[j] * w->terms[(size_t)j * w->count + i];
    }
    double angle = radians_per_um * opd_um;
    real += w->weight[i] * cos(angle);
    imaginary += w->weight[i] * sin(angle);
  }
  return real * real + imaginary * imaginary;
}

static const placido_wavefront_figure figures[] = {
    {"rms_total_um", "um", "Root mean square of the terms of order 2 and above.", 0, rms_total},
    {"rms_hoa_um", "um", "Root mean square of the terms of order 3 and above.", 0, rms_higher},
    {"spherical_um", "um", "Spherical aberration: the term (4, 0), positive where the rim has more "
     "power.", 0, spherical},
    {"coma_um", "um", "Coma: root mean square of the terms (3, -1) and (3, 1).", 0, coma},
    {"coma_axis_deg", "deg", "Direction of coma: where the wavefront is ahead; none without coma.",
     360, coma_axis},
    {"trefoil_um", "um", "Trefoil: root mean square of the terms (3, -3) and (3, 3).", 0, trefoil},
    {"power_D", "D", "Power for this pupil: index over the depth of the best focus, "
     "1000 n / mm.", 0, power},
    {"m_D", "D", "Mean sphere against the reference sphere: -4 √3 c20 / r² (Thibos 2004).", 0,
     mean_power},
    {"m_centre_D", "D", "Mean sphere at the pupil's centre: the curvature of all terms without an "
     "angle (Thibos 2004).", 0, mean_power_centre},
    {"j0_D", "D", "Astigmatism, axes 0 and 90: -2 √6 c22 / r² (Thibos 2004).", 0, cross_straight},
    {"j45_D", "D", "Astigmatism, axes 45 and 135: -2 √6 c2-2 / r² (Thibos 2004).", 0, cross_oblique},
    {"cylinder_D", "D", "Minus cylinder that corrects it, of J0 and J45.", 0, cylinder},
    {"axis_deg", "deg", "Axis of that cylinder; none without it.", 180, axis},
    {"strehl_555nm", "", "Strehl ratio at 555 nm towards the reference sphere's centre: |mean of "
     "exp(i 2 π W / wavelength)|².", 0, strehl},
};

const placido_wavefront_figure *placido_wavefront_figures(size_t *count) {
  *count = sizeof figures / sizeof figures[0];
  return figures;
}

double placido_wavefront_difference(const placido_wavefront_figure *figure, double a, double b) {
  return figure->period > 0 ? remainder(a - b, figure->period) : a - b;
}

/* Simulated keratometry: 337.5 over the mean axial radius around the 3 mm circle about the vertex,
 * for the flattest diameter and the one perpendicular to it. The zone is that of the mires 6 to 8
 * of the TMS instruments, 3 mm wide; axial power and both semi-meridians as there. Anchored on the
 * flattest meridian, not on the steepest: on an irregular cornea the two rules differ. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/sigma.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define MERIDIANS 180
#define FIRST_MM 1.3
#define SAMPLES 5 /* along a semi-meridian, 0.1 mm apart */
#define SAMPLES_MIN 3
#define NO_CYLINDER_D 1e-6 /* below it an axis is rounding */
#define UNKNOWN_DEG 51.96  /* standard deviation of an axis that may be anywhere: 180/sqrt(12) */

/* Sums along a line of samples. */
struct sums {
  int count;
  double radius_mm, sigma_D;
};

/* What is measured, and about which line. */
struct place {
  const placido_surface *surface;
  const placido_fit *fit;
  placido_vertex vertex;
};

static struct sums add_semi_meridian(const struct place *place, double angle) {
  struct sums sums = {0};
  for (int i = 0; i < SAMPLES; i++) {
    double r = FIRST_MM + i * 0.1, sigma_z;
    /* the point as seen from the vertex: axial power is about the line through it */
    placido_map_point point = {.x_mm = r * cos(angle), .y_mm = r * sin(angle)};
    double x = place->vertex.x_mm + point.x_mm, y = place->vertex.y_mm + point.y_mm;
    if (placido_surface_covered(place->surface, x, y) &&
        placido_surface_at(place->surface, x, y, &point.jet)) {
      double sigma;
      placido_sigma_at(place->fit, x, y, &sigma_z, &sigma);
      sums.count++;
      sums.radius_mm += PLACIDO_KERATOMETRIC / placido_map_axial(&point);
      sums.sigma_D += sigma * hypot(x, y) / r; /* it goes as the slope's error over the distance */
    }
  }
  return sums;
}

/* Power of a diameter, NaN where a half of it lacks data. Its sigma takes the errors of the samples
 * as fully correlated: an upper bound. */
static double power_along(const struct place *place, double axis_deg, double *sigma_D) {
  double angle = axis_deg * DEGREE;
  struct sums one = add_semi_meridian(place, angle);
  struct sums other = add_semi_meridian(place, angle + 180 * DEGREE);
  *sigma_D = NAN;
  if (one.count < SAMPLES_MIN || other.count < SAMPLES_MIN) {
    return NAN;
  }
  double radius_mm = (one.radius_mm / one.count + other.radius_mm / other.count) / 2;
  *sigma_D = (one.sigma_D / one.count + other.sigma_D / other.count) / 2;
  return PLACIDO_KERATOMETRIC / radius_mm;
}

/* The flattest diameter, refined between whole degrees by the parabola through its neighbours; NaN
 * without data in at least half of the diameters. */
static double find_flattest(const struct place *place) {
  double power[MERIDIANS], sigma;
  int best = -1, count = 0;
  for (int i = 0; i < MERIDIANS; i++) {
    power[i] = power_along(place, i, &sigma);
    count += isfinite(power[i]);
    if (isfinite(power[i]) && (best < 0 || power[i] < power[best])) {
      best = i;
    }
  }
  if (2 * count < MERIDIANS) {
    return NAN;
  }
  double before = power[(best + MERIDIANS - 1) % MERIDIANS], behind = power[(best + 1) % MERIDIANS];
  double bend = before + behind - 2 * power[best];
  double shift = bend > 0 ? 0.5 * (before - behind) / bend : 0;
  return fmod(best + shift + MERIDIANS, MERIDIANS);
}

placido_simk placido_simk_find(const placido_surface *surface, const placido_fit *fit,
                               placido_vertex vertex) {
  struct place place = {surface, NULL, vertex};
  placido_simk simk = {NAN, NAN, NAN, NAN, NAN, NAN};
  double axis_deg = isnan(vertex.x_mm) ? NAN : find_flattest(&place);
  if (isnan(axis_deg)) {
    return simk;
  }
  place.fit = fit;
  simk.flat_D = power_along(&place, axis_deg, &simk.sigma_flat_D);
  simk.steep_D = power_along(&place, axis_deg + 90, &simk.sigma_steep_D);
  if (simk.steep_D - simk.flat_D > NO_CYLINDER_D) {
    simk.flat_axis_deg = axis_deg;
    simk.steep_axis_deg = fmod(axis_deg + 90, MERIDIANS);
  }
  return simk;
}

double placido_index_simk_flat(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->simk.sigma_flat_D;
  return cornea->simk.flat_D;
}

double placido_index_simk_steep(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->simk.sigma_steep_D;
  return cornea->simk.steep_D;
}

/* The errors of the two meridians taken as opposed: an upper bound. */
double placido_index_simk_cylinder(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->simk.sigma_flat_D + cornea->simk.sigma_steep_D;
  return cornea->simk.steep_D - cornea->simk.flat_D;
}

double placido_index_simk_mean(const placido_cornea *cornea, double *sigma) {
  *sigma = (cornea->simk.sigma_flat_D + cornea->simk.sigma_steep_D) / 2;
  return (cornea->simk.steep_D + cornea->simk.flat_D) / 2;
}

/* Power along a meridian is M - C/2 cos 2(angle - axis); an error d of the cross-cylinder turns the
 * axis by d/C radians. */
static double sigma_axis(const placido_cornea *cornea) {
  double sigma, cylinder = placido_index_simk_cylinder(cornea, &sigma);
  double turn = sigma / 2 / cylinder / DEGREE;
  return turn < UNKNOWN_DEG ? turn : isfinite(turn) ? UNKNOWN_DEG : NAN;
}

double placido_index_simk_flat_axis(const placido_cornea *cornea, double *sigma) {
  *sigma = sigma_axis(cornea);
  return cornea->simk.flat_axis_deg;
}

double placido_index_simk_steep_axis(const placido_cornea *cornea, double *sigma) {
  *sigma = sigma_axis(cornea);
  return cornea->simk.steep_axis_deg;
}

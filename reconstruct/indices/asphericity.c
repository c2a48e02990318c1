/* Asphericity: least squares of a toric conicoid over the central 6 mm.
 * a x² + b xy + c y² + p s² + e x + f y + g = 2 s, s the sag, is linear in its coefficients; x²/R +
 * y²/R + (1 + Q) s²/R = 2 s is the conicoid of radius R and asphericity Q, a != c and b its toric
 * term, e, f and g let its apex lie anywhere. (Conic r² = 2 R s - (1 + Q) s²: Baker, Proc. Phys.
 * Soc. 55, 361-364, 1943.) */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/equations.h"
#include "reconstruct/maps/zone.h"

#include <math.h>

#define ZONE_MM 6.0
#define SHARE_MIN 0.7 /* of the zone that data must support */
#define INNER_MM 1.0  /* circles whose powers tell Q */
#define OUTER_MM 3.0

static bool solve(const placido_zone *zone, double u[7]) {
  placido_equations equations = {.unknowns = 7};
  for (size_t i = 0; i < zone->count; i++) {
    double x = zone->points[i][0], y = zone->points[i][1];
    double s = zone->points[0][2] - zone->points[i][2];
    const double row[7] = {x * x, x * y, y * y, s * s, x, y, 1};
    placido_equations_add(&equations, row, 2 * s);
  }
  return placido_equations_solve(&equations, u);
}

/* Moves the origin to the apex, where the tangent plane is perpendicular to the axis: with s = s0 +
 * t there the equation becomes a x² + ... + p t² = 2 (1 - p s0) t. */
static bool read_off(const double u[7], placido_conicoid *conicoid) {
  double a = u[0], b = u[1], c = u[2], p = u[3], e = u[4], f = u[5], g = u[6];
  double determinant = 4 * a * c - b * b;
  double x = (b * f - 2 * c * e) / determinant, y = (b * e - 2 * a * f) / determinant;
  double value = a * x * x + b * x * y + c * y * y + e * x + f * y + g;
  double scale = sqrt(1 - p * value); /* 1 - p s0 with p s0² - 2 s0 + value = 0 */
  conicoid->radius_mm = 2 * scale / (a + c);
  conicoid->q = p / scale * conicoid->radius_mm - 1;
  return determinant > 0 && isfinite(conicoid->q) && conicoid->radius_mm > 0;
}

/* A conic's axial radius is sqrt(R² - Q r²). So R's error is that of the power near the centre, and
 * Q's that of the difference of the squared axial radii at two circles, whose errors are taken as
 * independent. */
static void fill_sigmas(placido_conicoid *conicoid, const placido_surface *surface,
                        const placido_fit *fit) {
  double per_D = conicoid->radius_mm * conicoid->radius_mm / PLACIDO_KERATOMETRIC;
  double inner = per_D * placido_ring_sigma(surface, fit, INNER_MM);
  double outer = per_D * placido_ring_sigma(surface, fit, OUTER_MM);
  conicoid->sigma_radius_mm = inner;
  conicoid->sigma_q =
      2 * conicoid->radius_mm * hypot(inner, outer) / (OUTER_MM * OUTER_MM - INNER_MM * INNER_MM);
}

int placido_conicoid_fit(placido_conicoid *conicoid, const placido_surface *surface,
                         const placido_fit *fit, placido_error *err) {
  *conicoid = (placido_conicoid){NAN, NAN, NAN, NAN};
  placido_zone zone;
  placido_conicoid found;
  double u[7];
  int status = placido_zone_new(&zone, surface, ZONE_MM, err);
  if (status) {
    return status;
  }
  if (zone.diameter_mm == ZONE_MM && zone.count >= SHARE_MIN * (double)zone.sampled &&
      solve(&zone, u) && read_off(u, &found)) {
    *conicoid = found;
    fill_sigmas(conicoid, surface, fit);
  }
  placido_zone_free(&zone);
  return PLACIDO_OK;
}

double placido_index_asphericity(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->conicoid.sigma_q;
  return cornea->conicoid.q;
}

double placido_index_apical_radius(const placido_cornea *cornea, double *sigma) {
  *sigma = cornea->conicoid.sigma_radius_mm;
  return cornea->conicoid.radius_mm;
}

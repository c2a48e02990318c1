/* Asphericity: least squares of a toric conicoid over a zone about the vertex, by area.
 * a x² + b xy + c y² + p s² + e x + f y + g = 2 s, s the sag, is linear in its coefficients; x²/R +
 * y²/R + (1 + Q) s²/R = 2 s is the conicoid of radius R and asphericity Q, a != c and b its toric
 * term, e, f and g let its apex lie anywhere. (Conic r² = 2 R s - (1 + Q) s²: Baker, Proc. Phys.
 * Soc. 55, 361-364, 1943.) */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/equations.h"

#include <math.h>

#define STRIDE 4 /* every fourth semi-meridian will do for seven unknowns */
#define UNKNOWNS 7

static const double zones_mm[PLACIDO_ZONES] = {4.5, 6, 8};

/* The equations of one ring, without its area weight. */
static void add_ring(placido_equations *equations, const placido_cornea *cornea, int ring) {
  const placido_layout *layout = cornea->layout;
  double r = placido_ring_radius(ring);
  for (int a = 0; a < PLACIDO_AZIMUTHS; a += STRIDE) {
    double x = r * layout->cosine[a], y = r * layout->sine[a], s = cornea->sag_mm[ring][a];
    if (isfinite(s)) {
      const double row[UNKNOWNS] = {x * x, x * y, y * y, s * s, x, y, 1};
      placido_equations_add(equations, row, 2 * s);
    }
  }
}

static void add_weighted(placido_equations *sum, const placido_equations *part, double weight) {
  for (int i = 0; i < UNKNOWNS; i++) {
    sum->right[i] += weight * part->right[i];
    for (int k = 0; k <= i; k++) {
      sum->matrix[i][k] += weight * part->matrix[i][k];
    }
  }
}

/* Moves the origin to the apex, where the tangent plane is perpendicular to the axis: with s = s0 +
 * t there the equation becomes a x² + ... + p t² = 2 (1 - p s0) t. */
static placido_conicoid read_off(const double u[UNKNOWNS]) {
  double a = u[0], b = u[1], c = u[2], p = u[3], e = u[4], f = u[5], g = u[6];
  double determinant = 4 * a * c - b * b;
  double x = (b * f - 2 * c * e) / determinant, y = (b * e - 2 * a * f) / determinant;
  double value = a * x * x + b * x * y + c * y * y + e * x + f * y + g;
  double scale = sqrt(1 - p * value); /* 1 - p s0 with p s0² - 2 s0 + value = 0 */
  placido_conicoid found = {.radius_mm = 2 * scale / (a + c)};
  found.q = p / scale * found.radius_mm - 1;
  bool is_cap = determinant > 0 && found.radius_mm > 0 && isfinite(found.q);
  return is_cap ? found : (placido_conicoid){NAN, NAN};
}

static void measure(placido_cornea *cornea) {
  placido_equations rings[PLACIDO_RINGS];
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    rings[ring] = (placido_equations){.unknowns = UNKNOWNS};
    add_ring(&rings[ring], cornea, ring);
  }
  for (int zone = 0; zone < PLACIDO_ZONES; zone++) {
    placido_equations sum = {.unknowns = UNKNOWNS};
    for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
      add_weighted(&sum, &rings[ring], placido_ring_area(ring, 0, zones_mm[zone]));
    }
    double u[PLACIDO_EQUATIONS_MAX];
    cornea->conicoids[zone] =
        placido_equations_solve(&sum, u) ? read_off(u) : (placido_conicoid){NAN, NAN};
  }
}

static double q_4_5(const placido_cornea *cornea) {
  return cornea->conicoids[PLACIDO_ZONE_4_5].q;
}

static double q_6(const placido_cornea *cornea) {
  return cornea->conicoids[PLACIDO_ZONE_6].q;
}

static double q_8(const placido_cornea *cornea) {
  return cornea->conicoids[PLACIDO_ZONE_8].q;
}

static double apical_radius(const placido_cornea *cornea) {
  return cornea->conicoids[PLACIDO_ZONE_6].radius_mm;
}

static double shape_factor_p(const placido_cornea *cornea) {
  return 1 + q_6(cornea);
}

static double shape_factor_e(const placido_cornea *cornea) {
  return -q_6(cornea);
}

static double eccentricity(const placido_cornea *cornea) {
  return sqrt(-q_6(cornea)); /* NaN for an oblate cornea */
}

static const char *why_no_eccentricity(const placido_cornea *cornea) {
  return isfinite(q_6(cornea)) ? "oblate" : PLACIDO_REASON_NOT_COVERED;
}

static const placido_index_row rows[] = {
    {.name = "asphericity_q",
     .unit = "",
     .help = "Asphericity Q of the toric conicoid fitted to the central 6 mm (0 is a sphere, below "
             "0 flattens outwards).",
     .zone_mm = 6,
     .at = q_6},
    {.name = "asphericity_q_4_5mm",
     .unit = "",
     .help = "Asphericity Q of the toric conicoid fitted to the central 4.5 mm.",
     .zone_mm = 4.5,
     .at = q_4_5},
    {.name = "asphericity_q_8mm",
     .unit = "",
     .help = "Asphericity Q of the toric conicoid fitted to the central 8 mm.",
     .zone_mm = 8,
     .at = q_8},
    {.name = "apical_radius_mm",
     .unit = "mm",
     .help = "Mean radius of curvature at the apex of the toric conicoid fitted to the central 6 "
             "mm.",
     .zone_mm = 6,
     .at = apical_radius},
    {.name = "shape_factor_p",
     .unit = "",
     .help = "p = 1 + Q of the central 6 mm: the conic r² = 2 R s - p s².",
     .zone_mm = 6,
     .at = shape_factor_p},
    {.name = "shape_factor_e",
     .unit = "",
     .help = "E = 1 - p = -Q of the central 6 mm (ANSI Z80.23).",
     .zone_mm = 6,
     .at = shape_factor_e},
    {.name = "eccentricity",
     .unit = "",
     .help = "e = sqrt(-Q) of the central 6 mm. An oblate cornea (Q over 0) has none.",
     .zone_mm = 6,
     .at = eccentricity,
     .reason = why_no_eccentricity},
};

const placido_index_group placido_asphericity_group = {measure, rows, sizeof rows / sizeof rows[0]};

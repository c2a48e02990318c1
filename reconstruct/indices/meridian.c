/* Asphericity of the principal meridians: least squares of a conic along a line through the vertex.
 * a r² + p s² + e r + g = 2 s, r negative on the other semi-meridian: the conicoid's equation
 * (asphericity.c) in a plane, its apex anywhere. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/equations.h"

#include <math.h>

#define UNKNOWNS 4

static const double zones_mm[PLACIDO_ZONES] = {4.5, 6, 8};

/* Sags along a semi-meridian, one a ring. */
static void sample(const placido_cornea *cornea, double angle_deg, double sag_mm[PLACIDO_RINGS]) {
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    sag_mm[ring] = placido_cornea_sag(cornea, placido_ring_radius(ring), angle_deg);
  }
}

/* Adds a semi-meridian, by length; the share of it that is supported. */
static double add_half(placido_equations *equations, const double sag_mm[PLACIDO_RINGS],
                       double side, double zone_mm) {
  double found = 0;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double r = side * placido_ring_radius(ring), s = sag_mm[ring];
    double share = zone_mm / 2 / PLACIDO_RING_STEP_MM - ring; /* of the ring within the zone */
    if (share > 0 && isfinite(s)) {
      double weight = sqrt(fmin(share, 1));
      const double row[UNKNOWNS] = {weight * r * r, weight * s * s, weight * r, weight};
      placido_equations_add(equations, row, weight * 2 * s);
      found += fmin(share, 1);
    }
  }
  return found * PLACIDO_RING_STEP_MM / (zone_mm / 2);
}

static placido_conicoid read_off(const double u[UNKNOWNS]) {
  double a = u[0], p = u[1], e = u[2], g = u[3];
  double value = g - e * e / (4 * a);
  double scale = sqrt(1 - p * value);
  placido_conicoid found = {.radius_mm = scale / a};
  found.q = p / scale * found.radius_mm - 1;
  return found.radius_mm > 0 && isfinite(found.q) ? found : (placido_conicoid){NAN, NAN};
}

static void measure_meridian(const placido_cornea *cornea, double axis_deg,
                             placido_conicoid found[PLACIDO_ZONES]) {
  double one[PLACIDO_RINGS], other[PLACIDO_RINGS];
  if (isfinite(axis_deg)) {
    sample(cornea, axis_deg, one);
    sample(cornea, axis_deg + 180, other);
  }
  for (int zone = 0; zone < PLACIDO_ZONES; zone++) {
    placido_equations equations = {.unknowns = UNKNOWNS};
    double u[PLACIDO_EQUATIONS_MAX];
    found[zone] = (placido_conicoid){NAN, NAN};
    if (isfinite(axis_deg) && add_half(&equations, one, 1, zones_mm[zone]) >= PLACIDO_SHARE_MIN &&
        add_half(&equations, other, -1, zones_mm[zone]) >= PLACIDO_SHARE_MIN &&
        placido_equations_solve(&equations, u)) {
      found[zone] = read_off(u);
    }
  }
}

static void measure(placido_cornea *cornea) {
  double axis_deg = cornea->simk.flat_axis_deg;
  measure_meridian(cornea, axis_deg, cornea->flat);
  measure_meridian(cornea, axis_deg + 90, cornea->steep);
}

static double flat_4_5(const placido_cornea *cornea) {
  return cornea->flat[PLACIDO_ZONE_4_5].q;
}

static double flat_6(const placido_cornea *cornea) {
  return cornea->flat[PLACIDO_ZONE_6].q;
}

static double flat_8(const placido_cornea *cornea) {
  return cornea->flat[PLACIDO_ZONE_8].q;
}

static double steep_4_5(const placido_cornea *cornea) {
  return cornea->steep[PLACIDO_ZONE_4_5].q;
}

static double steep_6(const placido_cornea *cornea) {
  return cornea->steep[PLACIDO_ZONE_6].q;
}

static double steep_8(const placido_cornea *cornea) {
  return cornea->steep[PLACIDO_ZONE_8].q;
}

static const char *why_none(const placido_cornea *cornea) {
  bool no_axis = isfinite(cornea->simk.flat_D) && isnan(cornea->simk.flat_axis_deg);
  return no_axis ? PLACIDO_REASON_NO_CYLINDER : PLACIDO_REASON_NOT_COVERED;
}

#define FLAT "Asphericity Q of the conic along the meridian simk_flat_axis_deg, both halves, "
#define STEEP "Asphericity Q of the conic perpendicular to the meridian simk_flat_axis_deg, "

static const placido_index_row rows[] = {
    {.name = "asphericity_q_flat_4_5mm",
     .unit = "",
     .help = FLAT "to 2.25 mm from the vertex.",
     .at = flat_4_5,
     .reason = why_none},
    {.name = "asphericity_q_flat_6mm",
     .unit = "",
     .help = FLAT "to 3 mm from the vertex.",
     .at = flat_6,
     .reason = why_none},
    {.name = "asphericity_q_flat_8mm",
     .unit = "",
     .help = FLAT "to 4 mm from the vertex.",
     .at = flat_8,
     .reason = why_none},
    {.name = "asphericity_q_steep_4_5mm",
     .unit = "",
     .help = STEEP "to 2.25 mm from the vertex.",
     .at = steep_4_5,
     .reason = why_none},
    {.name = "asphericity_q_steep_6mm",
     .unit = "",
     .help = STEEP "to 3 mm from the vertex.",
     .at = steep_6,
     .reason = why_none},
    {.name = "asphericity_q_steep_8mm",
     .unit = "",
     .help = STEEP "to 4 mm from the vertex.",
     .at = steep_8,
     .reason = why_none},
};

const placido_index_group placido_meridian_group = {measure, rows, sizeof rows / sizeof rows[0]};

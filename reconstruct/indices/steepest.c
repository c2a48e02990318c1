/* The steepest place of the cornea, by tangential power. Axial power would not do: where the
 * surface is inclined on the axis it grows without bound towards it. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define STEP_MM 0.1 /* half the grid's; halved with each search */
#define SEARCHES 4

static double tangential(const placido_cornea *cornea, double x_mm, double y_mm) {
  placido_map_point point = {.x_mm = x_mm, .y_mm = y_mm};
  bool within = hypot(x_mm, y_mm) <= PLACIDO_ZONE_MAX_MM / 2 &&
                placido_surface_covered(cornea->surface, x_mm, y_mm) &&
                placido_surface_at(cornea->surface, x_mm, y_mm, &point.jet);
  return within ? placido_map_tangential(&point) : NAN;
}

/* Moves the peak by up to half a step each way, to the top of the parabolas through its four
 * neighbours; it stays where those are not supported, or where nothing is gained. */
static void climb(const placido_cornea *cornea, placido_peak *peak, double step_mm) {
  double x = peak->x_mm, y = peak->y_mm;
  double dx = placido_peak_offset(tangential(cornea, x - step_mm, y), peak->power_D,
                                  tangential(cornea, x + step_mm, y));
  double dy = placido_peak_offset(tangential(cornea, x, y - step_mm), peak->power_D,
                                  tangential(cornea, x, y + step_mm));
  x += dx * step_mm;
  y += dy * step_mm;
  double power = tangential(cornea, x, y);
  if (power > peak->power_D) {
    *peak = (placido_peak){x, y, power};
  }
}

/* The best of the points between the grid's, at the rim of the data too. */
static void look_around(const placido_cornea *cornea, placido_peak *peak) {
  const placido_peak middle = *peak;
  for (int j = -1; j <= 1; j++) {
    for (int i = -1; i <= 1; i++) {
      double x = middle.x_mm + i * STEP_MM, y = middle.y_mm + j * STEP_MM;
      double power = tangential(cornea, x, y);
      if (power > peak->power_D) {
        *peak = (placido_peak){x, y, power};
      }
    }
  }
}

/* The grid's best point was found when the grid was sampled. */
static void measure(placido_cornea *cornea) {
  look_around(cornea, &cornea->steepest);
  for (int i = 0; i < SEARCHES; i++) {
    climb(cornea, &cornea->steepest, STEP_MM / (1 << i));
  }
}

static double power(const placido_cornea *cornea) {
  return cornea->steepest.power_D;
}

static double place_x(const placido_cornea *cornea) {
  return cornea->steepest.x_mm;
}

static double place_y(const placido_cornea *cornea) {
  return cornea->steepest.y_mm;
}

static const char *why_none(const placido_cornea *cornea) {
  (void)cornea;
  return PLACIDO_REASON_NOT_COVERED; /* it needs no vertex */
}

static const placido_index_row rows[] = {
    {.name = "max_tangential_D",
     .unit = "D",
     .help = "Greatest tangential power of the map within the central 8 mm, where data support it: "
             "on a 0.2 mm grid, then by parabolas.",
     .at = power,
     .reason = why_none},
    {.name = "max_tangential_x_mm",
     .unit = "mm",
     .help = "Where max_tangential_D is found: to the right of the axis.",
     .range = PLACIDO_ZONE_MAX_MM,
     .at = place_x,
     .reason = why_none},
    {.name = "max_tangential_y_mm",
     .unit = "mm",
     .help = "Where max_tangential_D is found: upwards of the axis.",
     .range = PLACIDO_ZONE_MAX_MM,
     .at = place_y,
     .reason = why_none},
};

const placido_index_group placido_steepest_group = {measure, rows, sizeof rows / sizeof rows[0]};

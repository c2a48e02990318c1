/* Simulated keratometry: 337.5 over the mean axial radius of the 3 mm circle about the vertex, for
 * the flattest diameter and the one perpendicular to it. The zone is that of the mires 6 to 8 of
 * the TMS instruments (Dingeldein, Klyce & Wilson, Refract. Corneal Surg. 5, 372-378, 1989), 1.2
 * to 1.8 mm from the vertex; axial power and both semi-meridians as there. Anchored on the flattest
 * meridian; the TMS anchors on the steepest, which is told as well: on an irregular cornea the two
 * rules differ. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define DIAMETERS (PLACIDO_AZIMUTHS / 2)
#define STEP_DEG (360.0 / PLACIDO_AZIMUTHS)
#define FIRST_RING 6 /* at 1.3, 1.5 and 1.7 mm */
#define LAST_RING 8
#define SAMPLES_MIN 2      /* of a semi-meridian's */
#define NO_CYLINDER_D 1e-6 /* below it an axis is rounding */

/* Adds up a semi-meridian's axial radii; their mean, NaN where too few are supported. */
static double mean_radius(const double *power, int count) {
  double sum = 0;
  int found = 0;
  for (int i = 0; i < count; i++) {
    if (isfinite(power[i])) {
      sum += PLACIDO_KERATOMETRIC / power[i];
      found++;
    }
  }
  return found >= SAMPLES_MIN ? sum / found : NAN;
}

static double radius_of_sample(const placido_cornea *cornea, int azimuth) {
  double power[LAST_RING - FIRST_RING + 1];
  for (int ring = FIRST_RING; ring <= LAST_RING; ring++) {
    power[ring - FIRST_RING] = cornea->axial_D[ring][azimuth];
  }
  return mean_radius(power, LAST_RING - FIRST_RING + 1);
}

static double radius_along(const placido_cornea *cornea, double angle_deg) {
  double power[LAST_RING - FIRST_RING + 1];
  for (int ring = FIRST_RING; ring <= LAST_RING; ring++) {
    power[ring - FIRST_RING] = placido_cornea_axial(cornea, placido_ring_radius(ring), angle_deg);
  }
  return mean_radius(power, LAST_RING - FIRST_RING + 1);
}

static double power_along(const placido_cornea *cornea, double axis_deg) {
  double one = radius_along(cornea, axis_deg), other = radius_along(cornea, axis_deg + 180);
  return 2 * PLACIDO_KERATOMETRIC / (one + other);
}

/* The diameter with the greatest value of sign * power, between whole steps by the parabola through
 * its neighbours; NaN without data on at least half of the diameters. */
static double find_extreme(const double power[DIAMETERS], double sign) {
  int best = -1, count = 0;
  for (int i = 0; i < DIAMETERS; i++) {
    count += isfinite(power[i]);
    if (isfinite(power[i]) && (best < 0 || sign * power[i] > sign * power[best])) {
      best = i;
    }
  }
  if (2 * count < DIAMETERS) {
    return NAN;
  }
  double shift = placido_peak_offset(power[(best + DIAMETERS - 1) % DIAMETERS], power[best],
                                     power[(best + 1) % DIAMETERS]);
  return fmod((best + shift) * STEP_DEG + 180, 180);
}

static void measure(placido_cornea *cornea) {
  placido_simk *simk = &cornea->simk;
  double power[DIAMETERS];
  for (int i = 0; i < DIAMETERS; i++) {
    power[i] = 2 * PLACIDO_KERATOMETRIC /
               (radius_of_sample(cornea, i) + radius_of_sample(cornea, i + DIAMETERS));
  }
  double flat_deg = find_extreme(power, -1), steep_deg = find_extreme(power, 1);
  *simk = (placido_simk){.flat_axis_deg = NAN, .steep_axis_deg = NAN};
  simk->flat_D = power_along(cornea, flat_deg);
  simk->across_flat_D = power_along(cornea, flat_deg + 90);
  simk->steep_D = power_along(cornea, steep_deg);
  simk->across_steep_D = power_along(cornea, steep_deg + 90);
  if (simk->across_flat_D - simk->flat_D > NO_CYLINDER_D) {
    simk->flat_axis_deg = flat_deg;
  }
  if (simk->steep_D - simk->across_steep_D > NO_CYLINDER_D) {
    simk->steep_axis_deg = steep_deg;
  }
}

static double flat(const placido_cornea *cornea) {
  return cornea->simk.flat_D;
}

static double flat_axis(const placido_cornea *cornea) {
  return cornea->simk.flat_axis_deg;
}

static double across(const placido_cornea *cornea) {
  return cornea->simk.across_flat_D;
}

static double across_axis(const placido_cornea *cornea) {
  return fmod(cornea->simk.flat_axis_deg + 90, 180);
}

static double cylinder(const placido_cornea *cornea) {
  return cornea->simk.across_flat_D - cornea->simk.flat_D;
}

static double mean(const placido_cornea *cornea) {
  return (cornea->simk.across_flat_D + cornea->simk.flat_D) / 2;
}

static double steepest(const placido_cornea *cornea) {
  return cornea->simk.steep_D;
}

static double steepest_axis(const placido_cornea *cornea) {
  return cornea->simk.steep_axis_deg;
}

/* An axis is missing where power is, or where all diameters are alike. */
static const char *why_no_axis(const placido_cornea *cornea) {
  return isfinite(cornea->simk.flat_D) ? PLACIDO_REASON_NO_CYLINDER : PLACIDO_REASON_NOT_COVERED;
}

static const placido_index_row rows[] = {
    {.name = "simk_flat_D",
     .unit = "D",
     .help = "Simulated keratometry, flattest meridian: 337.5 over the mean axial radius at 1.3, "
             "1.5 and 1.7 mm from the vertex, about the line through it along the axis; both "
             "semi-meridians. Needs data on half of the diameters.",
     .at = flat},
    {.name = "simk_flat_axis_deg",
     .unit = "deg",
     .help = "Meridian of simk_flat_D, 0 to 180, from +x (right) towards +y (up).",
     .period = 180,
     .range = 180,
     .at = flat_axis,
     .reason = why_no_axis},
    {.name = "simk_steep_D",
     .unit = "D",
     .help = "Simulated keratometry of the meridian perpendicular to the flattest, by the same "
             "rule.",
     .at = across},
    {.name = "simk_steep_axis_deg",
     .unit = "deg",
     .help = "Meridian of simk_steep_D, perpendicular to the flattest.",
     .period = 180,
     .range = 180,
     .at = across_axis,
     .reason = why_no_axis},
    {.name = "simk_cylinder_D",
     .unit = "D",
     .help = "Corneal astigmatism: simk_steep_D less simk_flat_D.",
     .at = cylinder},
    {.name = "simk_mean_D",
     .unit = "D",
     .help = "Mean of simk_flat_D and simk_steep_D.",
     .at = mean},
    {.name = "min_k_D",
     .unit = "D",
     .help = "MinK: the flattest meridian at any angle. By the rule of simk_flat_D it is the same "
             "figure; under the TMS's rule it is not.",
     .at = flat},
    {.name = "max_k_D",
     .unit = "D",
     .help = "The steepest meridian at any angle, measured as simk_flat_D is: SimK1 of the TMS.",
     .at = steepest},
    {.name = "max_k_axis_deg",
     .unit = "deg",
     .help = "Meridian of max_k_D. On an irregular cornea it is not perpendicular to the flattest.",
     .period = 180,
     .range = 180,
     .at = steepest_axis,
     .reason = why_no_axis},
};

const placido_index_group placido_simk_group = {measure, rows, sizeof rows / sizeof rows[0]};

/* Rabinowitz's indices of keratoconus: inferior-superior difference, skew of the steepest axes,
 * KISA% (Rabinowitz & Rasheed, J. Cataract Refract. Surg. 25, 1327-1335, 1999). */
#include "reconstruct/indices/cornea.h"

#include <math.h>

#define STEP_DEG (360.0 / PLACIDO_AZIMUTHS)
#define QUARTER (PLACIDO_AZIMUTHS / 4)
#define HALF (PLACIDO_AZIMUTHS / 2)
#define IS_MM 3.0    /* from the vertex */
#define NEAR_STEPS 4 /* 5.6 degrees, 0.3 mm */
#define FIRST_RING 4 /* at 0.9 to 2.9 mm: rings 5 to 16 of the TMS */
#define LAST_RING 14
#define SAMPLES_MIN 6     /* of the 11 of a semi-meridian */
#define NO_LOBE_D 1e-6    /* below it a direction is rounding */
#define ONE_LOBE_DEG 90.0 /* power only falls on the other side: KISA% takes it for the skew */

/* Axial power on the circle of I-S, at the angle or, where a lash lies there, nearby. */
static double power_near(const placido_cornea *cornea, double angle_deg) {
  double power = placido_cornea_axial(cornea, IS_MM, angle_deg);
  for (int i = 1; i <= NEAR_STEPS && isnan(power); i++) {
    power = placido_cornea_axial(cornea, IS_MM, angle_deg + i * STEP_DEG);
    if (isnan(power)) {
      power = placido_cornea_axial(cornea, IS_MM, angle_deg - i * STEP_DEG);
    }
  }
  return power;
}

static double inferior_superior(const placido_cornea *cornea) {
  double difference = 0;
  for (int angle = 30; angle <= 150; angle += 30) {
    difference += power_near(cornea, angle + 180) - power_near(cornea, angle);
  }
  return difference / 5;
}

static double mean_along(const placido_cornea *cornea, int azimuth) {
  double sum = 0;
  int count = 0;
  for (int ring = FIRST_RING; ring <= LAST_RING; ring++) {
    if (cornea->layout->covered[ring][azimuth]) {
      sum += cornea->axial_D[ring][azimuth];
      count++;
    }
  }
  return count >= SAMPLES_MIN ? sum / count : NAN;
}

/* Direction, in steps, of the steepest semi-meridian within `reach` steps of `middle`. At an end of
 * that range it stays there. */
static double steepest_near(const double power[PLACIDO_AZIMUTHS], int middle, int reach) {
  int best = -reach;
  for (int i = -reach; i <= reach; i++) {
    int azimuth = (middle + i + PLACIDO_AZIMUTHS) % PLACIDO_AZIMUTHS;
    int best_azimuth = (middle + best + PLACIDO_AZIMUTHS) % PLACIDO_AZIMUTHS;
    if (power[azimuth] > power[best_azimuth]) {
      best = i;
    }
  }
  if (best == -reach || best == reach) {
    return middle + best;
  }
  int azimuth = middle + best + PLACIDO_AZIMUTHS;
  return middle + best +
         placido_peak_offset(power[(azimuth - 1) % PLACIDO_AZIMUTHS],
                             power[azimuth % PLACIDO_AZIMUTHS],
                             power[(azimuth + 1) % PLACIDO_AZIMUTHS]);
}

/* 180 degrees less the angle between the two steep lobes. The lobes are the steepest semi-meridian
 * and the steepest within 90 degrees of its opposite, rather than the steepest of the upper and of
 * the lower half: so astigmatism against the rule, whose lobes lie on the border of these halves,
 * has no skew of 180 degrees. */
static double skew(const placido_cornea *cornea) {
  double power[PLACIDO_AZIMUTHS], least = INFINITY, most = -INFINITY;
  int first = 0;
  for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
    power[a] = mean_along(cornea, a);
    if (isnan(power[a])) {
      return NAN; /* the steepest lobe may hide there */
    }
    least = fmin(least, power[a]);
    most = fmax(most, power[a]);
    first = power[a] > power[first] ? a : first;
  }
  if (most - least < NO_LOBE_D) {
    return NAN;
  }
  double one = first + placido_peak_offset(power[(first + PLACIDO_AZIMUTHS - 1) % PLACIDO_AZIMUTHS],
                                           power[first], power[(first + 1) % PLACIDO_AZIMUTHS]);
  double other = steepest_near(power, (first + HALF) % PLACIDO_AZIMUTHS, QUARTER);
  double between = fabs(remainder(other - one, PLACIDO_AZIMUTHS));
  return fmin((HALF - between) * STEP_DEG, ONE_LOBE_DEG);
}

static void measure(placido_cornea *cornea) {
  cornea->inferior_superior_D = inferior_superior(cornea);
  cornea->srax_deg = skew(cornea);
}

static double is_value(const placido_cornea *cornea) {
  return cornea->inferior_superior_D;
}

static double srax(const placido_cornea *cornea) {
  return cornea->srax_deg < ONE_LOBE_DEG ? cornea->srax_deg : NAN;
}

/* Every factor is at least 1, and NaN where it is missing, which fmax would hide. */
static double factor(double value) {
  return value < 1 ? 1 : value;
}

static double kisa(const placido_cornea *cornea) {
  double cylinder = cornea->simk.across_flat_D - cornea->simk.flat_D;
  return factor(cornea->central_k_D - 47.2) * factor(cornea->inferior_superior_D) *
         factor(cylinder) * factor(cornea->srax_deg) * 100 / 300;
}

static const char *why_no_skew(const placido_cornea *cornea) {
  if (cornea->srax_deg >= ONE_LOBE_DEG) {
    return "one_lobe";
  }
  return placido_layout_share(cornea->layout, 0, 6) == 1 ? PLACIDO_REASON_NO_CYLINDER
                                                         : PLACIDO_REASON_NOT_COVERED;
}

static const placido_index_row rows[] = {
    {.name = "inferior_superior_D",
     .unit = "D",
     .help =
         "I-S: mean axial power of five points 3 mm below the vertex (210 to 330 degrees, every "
         "30) less that of five above (30 to 150); positive where it is steeper below "
         "(Rabinowitz & McDonnell, Refract. Corneal Surg. 5, 400-408, 1989). Suspect over 1.4 "
         "D. Needs all ten points, or data within 5.6 degrees of them.",
     .at = is_value},
    {.name = "srax_deg",
     .unit = "deg",
     .help = "Skew of the steepest radial axes: 180 less the angle between the two steep lobes, by "
             "mean axial power at 0.9 to 2.9 mm. Suspect over 21. Needs every semi-meridian, and "
             "two lobes.",
     .range = 90,
     .at = srax,
     .reason = why_no_skew},
    {.name = "kisa_percent",
     .unit = "%",
     .help = "KISA%: (central_k_D - 47.2) I-S astigmatism SRAX 100/300, every factor at least 1; "
             "SRAX is 90 where there is but one lobe (Rabinowitz & Rasheed 1999). 60 to 100 "
             "suspect, from 100 keratoconus.",
     .at = kisa},
};

const placido_index_group placido_rabinowitz_group = {measure, rows, sizeof rows / sizeof rows[0]};

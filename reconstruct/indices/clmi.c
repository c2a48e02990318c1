/* Cone location and magnitude index (Mahmoud et al., Cornea 27, 480-487, 2008): the steepest disc 2
 * mm wide within the central 8 mm, against the rest of it and against the disc opposite. */
#include "reconstruct/indices/cornea.h"

#include <math.h>

#define PI 3.14159265358979323846
#define DISC_MM 1.0  /* radius */
#define STEP_MM 0.25 /* of the discs' centres outwards */
#define DISTANCES 13 /* 0 to 3 mm, where a disc touches the zone's rim */
#define DIRECTIONS 32
#define FINE_MM 0.1 /* step of the refinements */
#define REFINEMENTS 3
#define PARTS 4 /* of an annulus: a disc's rim cuts it */
#define STRIDE (PLACIDO_AZIMUTHS / DIRECTIONS)
#define NO_CONE_D 1e-6 /* what stands out by less is rounding */

/* Sums over an area: of power times area, and of area. */
struct sums {
  double power, area;
};

/* Half the arc, in azimuths, of the circle of radius r about the vertex that lies within the disc
 * whose centre is `distance` away. */
static double half_arc(double r, double distance) {
  if (distance == 0) {
    return r <= DISC_MM ? PLACIDO_AZIMUTHS / 2.0 : 0;
  }
  double cosine = (r * r + distance * distance - DISC_MM * DISC_MM) / (2 * r * distance);
  return acos(fmax(-1, fmin(1, cosine))) / (2 * PI) * PLACIDO_AZIMUTHS;
}

/* A disc's shape, whatever its direction. */
struct disc {
  double half[PLACIDO_RINGS], weight[PLACIDO_RINGS], area;
};

static struct disc disc_at(double distance_mm) {
  struct disc disc = {{0}, {0}, 0};
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double r = placido_ring_radius(ring);
    for (int i = 0; i < PARTS; i++) { /* the mean over the annulus that the ring stands for */
      double part = r + ((i + 0.5) / PARTS - 0.5) * PLACIDO_RING_STEP_MM;
      disc.half[ring] += half_arc(part, distance_mm) * part / r / PARTS;
    }
    disc.weight[ring] = placido_ring_area(ring, 0, PLACIDO_ZONE_MAX_MM);
    disc.area += 2 * disc.half[ring] * disc.weight[ring];
  }
  return disc;
}

/* The disc in a direction, in azimuths: an azimuth's sample stands for half of one to either side.
 */
static struct sums sum_disc(const placido_cornea *cornea, const struct disc *disc,
                            double direction) {
  struct sums sums = {0};
  double middle = direction + 0.5;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double half = disc->half[ring], weight = disc->weight[ring];
    if (half > 0) {
      sums.power += weight * placido_arcs_sum(&cornea->power, ring, middle - half, middle + half);
      sums.area +=
          weight * placido_arcs_sum(&cornea->layout->support, ring, middle - half, middle + half);
    }
  }
  return sums;
}

static struct sums sum_zone(const placido_cornea *cornea) {
  struct sums sums = {0};
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double weight = placido_ring_area(ring, 0, PLACIDO_ZONE_MAX_MM);
    sums.power += weight * cornea->power.before[ring][PLACIDO_AZIMUTHS];
    sums.area += weight * cornea->layout->support.before[ring][PLACIDO_AZIMUTHS];
  }
  return sums;
}

/* Mean power of a disc; NaN where too little of it is supported. */
static double mean_of(struct sums disc, double area) {
  return disc.area >= PLACIDO_SHARE_MIN * area ? disc.power / disc.area : NAN;
}

/* Mean of a disc less that of the rest of the zone. */
static double stand_out(struct sums disc, double area, struct sums zone) {
  return mean_of(disc, area) - (zone.power - disc.power) / (zone.area - disc.area);
}

struct place {
  double distance_mm, direction;
};

/* The steepest of the discs in steps, then between the steps by parabolas. */
static struct place find_steepest(const placido_cornea *cornea) {
  double power[DISTANCES][DIRECTIONS];
  int best = -1, best_direction = 0;
  for (int i = 0; i < DISTANCES; i++) {
    struct disc disc = disc_at(i * STEP_MM);
    for (int k = 0; k < (i ? DIRECTIONS : 1); k++) {
      power[i][k] = mean_of(sum_disc(cornea, &disc, k * STRIDE), disc.area);
      if (isfinite(power[i][k]) && (best < 0 || power[i][k] > power[best][best_direction])) {
        best = i;
        best_direction = k;
      }
    }
  }
  if (best <= 0) {
    return (struct place){best < 0 ? NAN : 0, 0};
  }
  double top = power[best][best_direction];
  double inner = power[best - 1][best > 1 ? best_direction : 0];
  double outer = best < DISTANCES - 1 ? power[best + 1][best_direction] : NAN;
  double turn = placido_peak_offset(power[best][(best_direction + DIRECTIONS - 1) % DIRECTIONS],
                                    top, power[best][(best_direction + 1) % DIRECTIONS]);
  return (struct place){(best + placido_peak_offset(inner, top, outer)) * STEP_MM,
                        (best_direction + turn) * STRIDE};
}

static double mean_at(const placido_cornea *cornea, struct place place) {
  struct disc disc = disc_at(place.distance_mm);
  return mean_of(sum_disc(cornea, &disc, place.direction), disc.area);
}

/* Moves the disc to the top of the parabolas outwards and around it, so that the place does not
 * depend on which of the steps it was found at. */
static struct place refine(const placido_cornea *cornea, struct place place) {
  double turn = FINE_MM / place.distance_mm / (2 * PI) * PLACIDO_AZIMUTHS;
  struct place inner = {place.distance_mm - FINE_MM, place.direction};
  struct place outer = {place.distance_mm + FINE_MM, place.direction};
  struct place right = {place.distance_mm, place.direction - turn};
  struct place left = {place.distance_mm, place.direction + turn};
  if (!(inner.distance_mm > 0 && outer.distance_mm <= PLACIDO_ZONE_MAX_MM / 2 - DISC_MM)) {
    return place;
  }
  double top = mean_at(cornea, place);
  place.distance_mm +=
      FINE_MM * placido_peak_offset(mean_at(cornea, inner), top, mean_at(cornea, outer));
  place.direction += turn * placido_peak_offset(mean_at(cornea, right), top, mean_at(cornea, left));
  return place;
}

static void measure(placido_cornea *cornea) {
  struct place place = find_steepest(cornea);
  for (int i = 0; i < REFINEMENTS; i++) {
    place = refine(cornea, place);
  }
  struct disc disc = disc_at(place.distance_mm);
  struct sums zone = sum_zone(cornea);
  double m1 = stand_out(sum_disc(cornea, &disc, place.direction), disc.area, zone);
  double m2 =
      stand_out(sum_disc(cornea, &disc, place.direction + PLACIDO_AZIMUTHS / 2.0), disc.area, zone);
  cornea->clmi_D = m1 - fmin(1, place.distance_mm) * m2;
  cornea->cone = (placido_vertex){NAN, NAN};
  if (m1 > NO_CONE_D) {
    double angle = 2 * PI * place.direction / PLACIDO_AZIMUTHS;
    cornea->cone = (placido_vertex){place.distance_mm * cos(angle), place.distance_mm * sin(angle)};
  }
}

static double clmi(const placido_cornea *cornea) {
  return cornea->clmi_D;
}

static double cone_x(const placido_cornea *cornea) {
  return cornea->cone.x_mm;
}

static double cone_y(const placido_cornea *cornea) {
  return cornea->cone.y_mm;
}

static double probability(const placido_cornea *cornea) {
  return 100 / (1 + exp(6.4483 - 2.1319 * cornea->clmi_D));
}

static const char *why_no_cone(const placido_cornea *cornea) {
  return isfinite(cornea->clmi_D) ? "no_cone" : PLACIDO_REASON_NOT_COVERED;
}

static const placido_index_row rows[] = {
    {.name = "clmi_D",
     .unit = "D",
     .help = "Cone location and magnitude index: of axial power, the steepest disc 2 mm wide less "
             "the rest of the central 8 mm, less the same of the disc opposite (times its distance "
             "within 1 mm) (Mahmoud et al., Cornea 27, 480-487, 2008).",
     .zone_mm = 8,
     .at = clmi},
    {.name = "clmi_x_mm",
     .unit = "mm",
     .help = "Centre of the steepest disc: to the right of the vertex.",
     .zone_mm = 8,
     .range = PLACIDO_ZONE_MAX_MM - 2 * DISC_MM,
     .at = cone_x,
     .reason = why_no_cone},
    {.name = "clmi_y_mm",
     .unit = "mm",
     .help = "Centre of the steepest disc: upwards of the vertex.",
     .zone_mm = 8,
     .range = PLACIDO_ZONE_MAX_MM - 2 * DISC_MM,
     .at = cone_y,
     .reason = why_no_cone},
    {.name = "ppk_percent",
     .unit = "%",
     .help =
         "Probability of keratoconus, 100/(1 + exp(6.4483 - 2.1319 clmi_D)). Below 20 normal, to "
         "45 suspect.",
     .zone_mm = 8,
     .at = probability},
};

const placido_index_group placido_clmi_group = {measure, rows, sizeof rows / sizeof rows[0]};

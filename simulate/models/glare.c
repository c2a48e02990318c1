/* The CIE's total glare function: two terms of the optical core, the scatter of the lens with age,
 * and the light through iris and sclera with pigment.
 *
 * CIE 135/1, "Disability glare" (1999), equation 5; J. J. Vos, Clin. Exp. Optom. 86 (2003) 363. */
#include "simulate/models/glare.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

placido_glare placido_glare_of(const placido_eye *eye) {
  static const double pigments[] = {[PLACIDO_IRIS_BROWN] = 0.5,
                                    [PLACIDO_IRIS_DARK] = 0,
                                    [PLACIDO_IRIS_GREEN] = 1,
                                    [PLACIDO_IRIS_BLUE] = 1.2};
  return (placido_glare){
    .age_years = eye->age_years > 0 ? eye->age_years : PLACIDO_EYE_AGE_YEARS,
    .pigment = pigments[eye->iris],
  };
}

/* Fourth power of the age in 70 years. */
static double age_factor(const placido_glare *glare) {
  double age = glare->age_years / 70;
  return age * age * age * age;
}

/* 1 + (angle / width)². */
static double bell(double angle_deg, double width_deg) {
  return 1 + angle_deg * angle_deg * (1 / (width_deg * width_deg));
}

double placido_glare_per_sr(const placido_glare *glare, double angle_deg) {
  double a = age_factor(glare), p = glare->pigment;
  double first = bell(angle_deg, 0.0046), second = bell(angle_deg, 0.045);
  double wide = bell(angle_deg, 0.1), root = sqrt(wide);
  double core = 9.2e6 / (first * sqrt(first)) + 1.5e5 / (second * sqrt(second));
  double scatter = 400 / wide + 3e-8 * angle_deg * angle_deg;
  double pigmented = 1300 / (wide * root) + 0.8 / root;
  double total = (1 - 0.08 * a) * core + (1 + 1.6 * a) * (scatter + p * pigmented) + 2.5e-3 * p;
  return total / (1 + p * (0.0417 + 0.055 * a));
}

/* Simpson's rule over the logarithm of the angle, in which every term is smooth. */
double placido_glare_share(const placido_glare *glare, double from_deg, double to_deg) {
  const double pieces_each = 12; /* a factor of e */
  double length = log(to_deg / from_deg);
  int pieces = 2 * (int)ceil(pieces_each * length / 2);
  double sum = 0;
  for (int i = 0; i <= pieces; i++) {
    double angle_deg = from_deg * exp(length * i / pieces), angle = angle_deg * pi / 180;
    double weight = i == 0 || i == pieces ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * placido_glare_per_sr(glare, angle_deg) * sin(angle) * angle;
  }
  return 2 * pi * sum * length / (3 * pieces);
}

/* Minus the logarithmic slope at the core's rim: about 2.8. */
static double steepness(const placido_glare *glare) {
  const double step = 1e-3;
  double nearer = placido_glare_per_sr(glare, PLACIDO_GLARE_CORE_DEG * (1 - step));
  double farther = placido_glare_per_sr(glare, PLACIDO_GLARE_CORE_DEG * (1 + step));
  return log(nearer / farther) / (2 * step);
}

double placido_glare_veil(const placido_glare *glare, double angle_deg) {
  double angle = angle_deg * pi / 180, part = angle_deg / PLACIDO_GLARE_CORE_DEG;
  double sphere = angle > 0 ? sin(angle) / angle : 1; /* a ring's area, less than on the plane */
  if (angle_deg > PLACIDO_GLARE_END_DEG) {
    return 0;
  }
  if (part >= 1) {
    return sphere * placido_glare_per_sr(glare, angle_deg);
  }
  return sphere * placido_glare_per_sr(glare, PLACIDO_GLARE_CORE_DEG) *
         (1 + steepness(glare) / 2 * (1 - part * part));
}

double placido_glare_veil_share(const placido_glare *glare) {
  double core = PLACIDO_GLARE_CORE_DEG * pi / 180;
  return pi * core * core * placido_glare_per_sr(glare, PLACIDO_GLARE_CORE_DEG) *
           (1 + steepness(glare) / 4) +
         placido_glare_share(glare, PLACIDO_GLARE_CORE_DEG, PLACIDO_GLARE_END_DEG);
}

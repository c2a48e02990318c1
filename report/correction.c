/* A correcting lens as a prescription writes it. */
#include "report/correction.h"

#include "report/number.h"

#include <math.h>
#include <stdio.h>

void placido_correction_write(char text[PLACIDO_CORRECTION_SIZE],
                              const placido_correction *correction) {
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(correction, &sphere_D, &cylinder_D, &axis_deg);
  char sphere[PLACIDO_NUMBER_SIZE], cylinder[PLACIDO_NUMBER_SIZE];
  placido_number_write(sphere, sizeof sphere, sphere_D, 2);
  placido_number_write(cylinder, sizeof cylinder, cylinder_D, 2);
  const char *plus = sphere_D >= 0.005 ? "+" : "";
  if (isfinite(axis_deg)) {
    snprintf(text, PLACIDO_CORRECTION_SIZE, "%s%s D sphere, %s D cylinder × %.0f°", plus, sphere,
             cylinder, axis_deg);
  } else {
    snprintf(text, PLACIDO_CORRECTION_SIZE, "%s%s D sphere, no cylinder", plus, sphere);
  }
}

/* The one place where maps and indices ask the fit for its error bars. */
#include "reconstruct/maps/sigma.h"

#include <math.h>

void placido_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                      double *sigma_axial_D) {
  *sigma_z_um = *sigma_axial_D = NAN;
  if (fit) {
    placido_fit_sigma_at(fit, x_mm, y_mm, sigma_z_um, sigma_axial_D);
  }
}

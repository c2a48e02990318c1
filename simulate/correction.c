/* From power vector to what stands on a prescription.
 *
 * Thibos, Wheeler, Horner, Optom. Vis. Sci. 74 (1997) 367: M = S + C/2, J0 = -C/2 cos 2a,
 * J45 = -C/2 sin 2a, with the minus cylinder C <= 0. */
#include <placido/simulate.h>

#include <math.h>

void placido_correction_clinical(const placido_correction *correction, double *sphere_D,
                                 double *cylinder_D, double *axis_deg) {
  double half = hypot(correction->j0_D, correction->j45_D);
  *sphere_D = correction->m_D + half;
  *cylinder_D = -2 * half;
  if (half == 0) {
    *cylinder_D = 0;
    *axis_deg = NAN;
    return;
  }
  double axis = atan2(correction->j45_D, correction->j0_D) * 90 / acos(-1);
  *axis_deg = axis < 0 ? axis + 180 : axis;
}

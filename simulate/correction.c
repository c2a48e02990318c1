/* Power vectors, what stands on a prescription, and the same lens at another distance.
 *
 * Thibos, Wheeler, Horner, Optom. Vis. Sci. 74 (1997) 367: M = S + C/2, J0 = -C/2 cos 2a,
 * J45 = -C/2 sin 2a. A lens's power matrix is M on the diagonal and a cross-cylinder, whose
 * principal meridians stay where they are when light runs on: its powers there are M + J and M - J,
 * J = hypot(J0, J45), and the matrix F (1 - d F)^-1 has the same meridians (Harris, Optom. Vis. Sci.
 * 73 (1996) 606). */
#include <placido/eye.h>

#include <math.h>

static const double pi = 3.14159265358979323846;

void placido_correction_clinical(const placido_correction *correction, double *sphere_D,
                                 double *cylinder_D, double *axis_deg) {
  double half = hypot(correction->j0_D, correction->j45_D);
  *sphere_D = correction->m_D + half;
  *cylinder_D = half > 0 ? -2 * half : 0;
  *axis_deg = NAN;
  if (half > 0) {
    double axis = atan2(correction->j45_D, correction->j0_D) * 90 / pi;
    axis = axis < 0 ? axis + 180 : axis;
    *axis_deg = axis < 180 ? axis : 0;
  }
}

placido_correction placido_correction_of(double sphere_D, double cylinder_D, double axis_deg) {
  if (cylinder_D == 0) {
    return (placido_correction){.m_D = sphere_D};
  }
  double twice = axis_deg * pi / 90;
  return (placido_correction){.m_D = sphere_D + cylinder_D / 2,
                              .j0_D = -cylinder_D / 2 * cos(twice),
                              .j45_D = -cylinder_D / 2 * sin(twice)};
}

int placido_correction_move(placido_correction *moved, const placido_correction *correction,
                            double nearer_mm, placido_error *err) {
  const placido_correction worn = *correction;
  double half = hypot(worn.j0_D, worn.j45_D), way_m = nearer_mm / 1000, shrunk = 1;
  const double powers[2] = {worn.m_D + half, worn.m_D - half};
  *moved = (placido_correction){.m_D = NAN, .j0_D = NAN, .j45_D = NAN};
  for (int i = 0; i < 2; i++) {
    double left = 1 - way_m * powers[i];
    if (!(left > 0)) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "a lens of %+.2f D has no counterpart %g mm %s the eye: its focus "
                               "lies in between",
                               powers[i], fabs(nearer_mm), nearer_mm > 0 ? "nearer to" : "from");
    }
    shrunk /= left;
  }
  /* mean and half difference of the moved powers, without taking that difference */
  *moved = (placido_correction){.m_D = shrunk * (worn.m_D - way_m * powers[0] * powers[1]),
                                .j0_D = shrunk * worn.j0_D,
                                .j45_D = shrunk * worn.j45_D};
  return PLACIDO_OK;
}

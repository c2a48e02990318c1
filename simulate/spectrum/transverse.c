/* Transverse chromatic aberration: more power moves the image where the chief ray passes beside the
 * achromatic axis, Prentice's rule; L. N. Thibos, A. Bradley, D. L. Still, X. Zhang, P. A. Howarth,
 * Vision Research 30, 33 (1990).
 *
 * The achromatic axis passes through the nodal point. A pupil off the axis has its chief ray beside
 * it by as much; light from the side, which enters through the middle of a pupil that lies in front
 * of the nodal point, by that distance times the sine of its angle. Blue has more power: its image
 * is the smaller one. This is 0.22' a degree between 543 and 842 nm, of which S. Winter et al.
 * (J. Vision 16 (14), 9 (2016)) measured 0.21'. */
#include "simulate/spectrum/spectrum.h"

#include <math.h>

void placido_transverse_shift(double shift_mm[2], const double pupil_mm[2],
                              const double field_deg[2]) {
  const double radians = acos(-1) / 180;
  for (int axis = 0; axis < 2; axis++) {
    shift_mm[axis] = PLACIDO_PUPIL_TO_NODAL_MM * sin(field_deg[axis] * radians) - pupil_mm[axis];
  }
}

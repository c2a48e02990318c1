/* The eye behind the cornea, and what it wears. */
#ifndef PLACIDO_EYE_H
#define PLACIDO_EYE_H

#include <stdbool.h>

/* A thin lens on the cornea, in power-vector form: dioptres, J0 and J45 of its cross-cylinder. */
typedef struct placido_correction {
  double m_D, j0_D, j45_D;
} placido_correction;

/* Sphere, minus-cylinder and axis (0..180) of a power vector; the axis is NaN where the cylinder
 * is zero. Thibos et al. 1997. */
void placido_correction_clinical(const placido_correction *correction, double *sphere_D,
                                 double *cylinder_D, double *axis_deg);

/* The eye behind the cornea: a value. Zero means the default in brackets. */
typedef struct placido_eye {
  double pupil_mm;             /* diameter of the entrance pupil, 0.1 to 12; no default */
  double pupil_x_mm, pupil_y_mm;
  double index;                /* refractive index behind the surface [1.3375] */
  double retina_mm;            /* distance from the surface's point on the axis; [searched] */
  bool correct;                /* search the cross-cylinder too, else use `correction` as it is */
  placido_correction correction;
} placido_eye;

#endif

/* The eye behind the cornea with every default filled in, and its scale: micrometres on the retina
 * to minutes of arc in the visual field. */
#ifndef PLACIDO_SIMULATE_EYE_H
#define PLACIDO_SIMULATE_EYE_H

#include <placido/simulate.h>

#define PLACIDO_ARCMIN_RAD 2.908882086657216e-4 /* pi / 10,800 */

/* The strongest lens: mean sphere, and cross-cylinder. */
enum { PLACIDO_SPHERE_MAX_D = 40, PLACIDO_CROSS_MAX_D = 20 };

/* What the eye's scale and its retina are measured from. */
typedef struct placido_apex {
  double axis_sag_mm; /* sag of the surface's point on the axis */
  double radius_mm;   /* 1 / mean curvature at the pupil's centre; infinite where it is flat */
} placido_apex;

/* Copies `eye` with defaults filled in; retina_mm stays 0 where it is to be searched.
 * Returns PLACIDO_OK, or PLACIDO_INPUT naming the field and its range. */
int placido_eye_settle(placido_eye *settled, const placido_eye *eye, placido_error *err);

/* Copies `optics` with defaults filled in. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_optics_settle(placido_optics *settled, const placido_optics *optics,
                          placido_error *err);

/* Finds the apex. Returns PLACIDO_OK, or PLACIDO_QUALITY where the surface is not defined on the
 * axis or at the pupil's centre. */
int placido_apex_find(placido_apex *apex, const placido_surface *surface, const placido_eye *eye,
                      placido_error *err);

/* Distance from the nodal point to a retina at retina_mm: L - R, R the apical radius, because the
 * centre of a single refracting surface is its nodal point. Where R is more than half of L (a flat
 * or hollow apex has no usable centre) it is L / n, which L - R equals at the paraxial focus. */
double placido_apex_nodal_mm(const placido_apex *apex, double index, double retina_mm);

/* Micrometres on the retina that the optics' bucket subtends. */
double placido_apex_bucket_um(const placido_apex *apex, const placido_optics *optics, double index,
                              double retina_mm);

#endif

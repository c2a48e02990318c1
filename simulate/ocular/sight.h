/* A direction of the field, everything about it decided: how light comes in, through what it goes,
 * and what its landing points mean. */
#ifndef PLACIDO_SIMULATE_SIGHT_H
#define PLACIDO_SIMULATE_SIGHT_H

#include "simulate/ocular/beam.h"
#include "simulate/ocular/navarro.h"
#include "simulate/ocular/ocular.h"

/* A landing point beside the focus X, in the retina's tangent plane, is seen at the angle J⁻¹ X.
 *
 * * J is how the chief ray's landing point follows the direction of the light, in units of a flat
 * picture (the tangent of the angle): so a picture is seen undistorted, and what is spread in it
 * has the picture's scale. With the cornea alone it is that on the axis times the distance from
 * the nodal point, as angles are reckoned there (eye.c). */
typedef struct placido_sight {
  const placido_surface *surface; /* borrowed */
  double axis_sag_mm;
  double pupil_mm, pupil_x_mm, pupil_y_mm;
  placido_incidence incidence;
  placido_navarro behind;
  bool whole;
  double index;                   /* before the retina */
  double from_mm;                 /* whole: depth of the cornea's image, from where rays come */
  double retina_mm, radius_mm;    /* radius 0: flat */
  double focus[3];                /* what paths are reckoned to */
  double across[3], along[3];     /* unit vectors in the retina there */
  double scale[2][2], inverse[2][2]; /* J, mm a radian, and J⁻¹ */
  double chief_mm;                /* path of the chief ray to the focus */
  double chief_sine[2];           /* from the focus to where it comes from */
} placido_sight;

/* `eye` is settled with its retina given; the rest as in ocular.h. PLACIDO_OK or PLACIDO_QUALITY
 * (the chief ray does not arrive). */
int placido_sight_new(placido_sight *sight, const placido_surface *surface,
                      const placido_eye *eye, const placido_ocular *ocular,
                      const double field_deg[2], const double offset_arcmin[2],
                      double wavelength_nm, placido_error *err);

/* Where light through the point (x, y) of the entrance pupil's plane meets the cornea: fills x_mm,
 * y_mm, depth_mm, sx and sy number `at`; NaN where it does not. */
void placido_sight_aim(const placido_sight *sight, const placido_beam *beam, size_t at, double x_mm,
                       double y_mm);

/* The other way: where light that meets the cornea there crosses that plane, from the pupil's
 * centre. */
void placido_sight_entry(const placido_sight *sight, const placido_beam *beam, size_t at,
                         double entry_mm[2]);

/* Leads the rays to the retina; px, py and pz are where they land. */
void placido_sight_land(const placido_sight *sight, const placido_beam *beam);

/* Leads them to where paths are reckoned from: the cornea, or its image behind the lens. */
void placido_sight_depart(const placido_sight *sight, const placido_beam *beam);

/* The angle at which a landing point is seen, radians, from the focus. */
void placido_sight_angle(const placido_sight *sight, const placido_beam *beam, size_t at,
                         double angle[2]);

/* What a departed ray is for the wavefront: its path difference (mm), where it stands in the pupil
 * as seen from the picture (mm), and the difference's slope there. The samples' plane and why: see
 * psf/diffraction_pupil.c, of which this is the like for any direction. */
typedef struct placido_standing {
  double opd_mm, place[2], slope[2];
} placido_standing;

placido_standing placido_sight_stand(const placido_sight *sight, const placido_beam *beam,
                                     size_t at);

#endif

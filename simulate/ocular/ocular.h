/* The eye from the measured cornea to the retina, traced exactly for light from any direction. */
#ifndef PLACIDO_SIMULATE_OCULAR_H
#define PLACIDO_SIMULATE_OCULAR_H

#include <placido/diffraction.h>
#include <placido/eye.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stdbool.h>

#define PLACIDO_ENTRANCE_PUPIL_MM 3.05 /* behind the corneal vertex */
#define PLACIDO_RETINA_RADIUS_MM 12.0  /* Navarro's schematic eye */

/* What is behind the measured cornea; zero is nothing but `eye->index`, as in the seed. */
typedef struct placido_ocular {
  bool whole;              /* posterior cornea and crystalline lens (Navarro) */
  double accommodation_D;  /* of that lens, 0 to 10 */
  bool curved;             /* the retina is a sphere of PLACIDO_RETINA_RADIUS_MM, else flat */
} placido_ocular;

/* Brings the whole eye to its focus: of `eye`, settled for the cornea alone, what `correct` leaves
 * open is sought again for light that the whole eye refracts, by the same measure (focus.h); what
 * is not open stays, and the retina stands where a paraxial ray has the vergence error that it had
 * with the cornea alone. `found` is the eye to trace with, retina_mm being the whole eye's own.
 * Where `ocular` is not whole, `found` is `eye`. PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_ocular_focus(placido_eye *found, const placido_surface *surface,
                         const placido_eye *eye, enum placido_correct correct,
                         const placido_ocular *ocular, placido_error *err);

/* The wavefront over the entrance pupil for light from the direction `field_deg` (x, y, as seen
 * in the instrument's frame: positive x comes from +x), by exact rays from that plane wave to the
 * retina. The samples' plane is in object space: a slope of opd_um along x of 1 um/mm is light
 * seen 1 mrad beside. What opd_um is reckoned against: the chief ray's landing point plus
 * `offset_arcmin`, the same for every direction, so that the picture is not shifted or distorted.
 * With field {0, 0} and an ocular of zeros it is placido_pupil_of_surface's, to rounding.
 * `samples` across the pupil, 0: as many as that takes. wavelength_nm only matters where
 * ocular->whole: media disperse [0: 555]. Free with placido_pupil_free. PLACIDO_OK, PLACIDO_QUALITY,
 * PLACIDO_MEMORY. */
int placido_ocular_pupil(placido_pupil *pupil, const placido_surface *surface,
                         const placido_eye *eye, const placido_ocular *ocular,
                         const double field_deg[2], const double offset_arcmin[2],
                         double wavelength_nm, int samples, int threads, placido_error *err);

/* Where fixation lies beside the chief ray's landing point: where the light of the pupil is densest
 * (focus.h). PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_ocular_fixation(double offset_arcmin[2], const placido_surface *surface,
                            const placido_eye *eye, const placido_ocular *ocular,
                            placido_error *err);

/* The angles at which `count` rays that enter at (x_mm, y_mm) from the pupil's centre are seen,
 * arcmin, against fixation on the axis; NaN where a ray does not arrive. Cheap: for sketches. */
void placido_ocular_angles(float *angle_x, float *angle_y, const float *x_mm, const float *y_mm,
                           int count, const placido_surface *surface, const placido_eye *eye,
                           const placido_ocular *ocular, const double field_deg[2],
                           const double offset_arcmin[2]);

#endif

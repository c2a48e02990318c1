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
#define PLACIDO_RETINA_NODAL_MM 16.56  /* from there to its nodal point: 1000 / 60.4 D */

/* What is behind the measured cornea; zero is nothing but `eye->index`, as in the seed. */
typedef struct placido_ocular {
  bool whole;              /* posterior cornea and crystalline lens (Navarro) */
  double accommodation_D;  /* of that lens, 0 to 10; the light then comes from a point so near to
                              the cornea, directions being those at the cornea */
  bool curved;             /* the retina is a sphere of PLACIDO_RETINA_RADIUS_MM, else flat; of the
                              cornea alone, whose retina is farther from its nodal point, as much
                              larger: it is curved alike over the same angle */
  bool gazes;              /* the point of fixation is sought from gaze_arcmin uphill, else
                              everywhere */
  double gaze_arcmin[2];   /* from the chief ray's landing point; placido_ocular_focus sets both */
} placido_ocular;

/* Where the retina of the whole eye stands: where light near the axis has the vergence error that
 * it has with the cornea alone of `eye`, settled. So what is in focus there is in focus here, but
 * for the rays at the rim. PLACIDO_OK, PLACIDO_QUALITY (5 to 200 mm behind the cornea there is no
 * such place). */
int placido_ocular_retina(double *retina_mm, const placido_surface *surface,
                          const placido_eye *eye, const placido_ocular *ocular,
                          placido_error *err);

/* Brings the whole eye to its focus: `eye` is settled for the cornea alone, and of it what is
 * `open` is sought again for light that the whole eye refracts, by the same measure (focus.h): the
 * sphere, by the retina's place, and the lens's cross-cylinder where that is PLACIDO_CORRECT_FULL.
 * With PLACIDO_CORRECT_NONE nothing is sought, and the retina stands as placido_ocular_retina has
 * it. `found` is the eye to trace with, retina_mm being the whole eye's own. The patient goes on
 * to look with the same light: ocular->gaze_arcmin becomes where that goes which is densest with
 * the cornea alone (of two images, or along a line, another may now be denser by a trifle). Where
 * `ocular` is not whole, `found` is `eye`. PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_ocular_focus(placido_eye *found, placido_ocular *ocular,
                         const placido_surface *surface, const placido_eye *eye,
                         enum placido_correct open, placido_error *err);

/* The wavefront over the entrance pupil for light from the direction `field_deg` (x, y, in the
 * instrument's frame: positive x comes from +x; its tangents are places in a flat picture), by
 * exact rays from that plane wave to the retina. The samples stand for angles as seen: where
 * opd_um falls by 1 um per mm towards +x, light is seen 1 mrad beside, towards where the retina
 * has +x, in the scale of the picture's middle. The chief ray's landing point is seen where the
 * light comes from, so that the picture is not distorted; opd_um is reckoned against that point
 * plus `offset_arcmin`, the same for every direction. With field {0, 0} and an ocular of zeros it
 * is placido_pupil_of_surface's, to rounding, but for its spacing_mm and pupil_mm: there they are
 * those of angles n X / L of a landing point X, here of X / (L - R) as buckets are counted
 * (eye.h), and so n (L - R) / L times as large. `samples` across the pupil, 0: as many as that
 * takes. wavelength_nm only matters where ocular->whole: media disperse [0: 555]. A plan traces at
 * 555 nm for all wavelengths, and its waves bring the chromatic difference of focus (Thibos):
 * Navarro's media alone give 1.34 D in place of 1.23 from 450 to 650 nm. A sample whose ray does
 * not arrive is NaN; where over 5 % are, the pupil is refused. Free with placido_pupil_free.
 * PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_ocular_pupil(placido_pupil *pupil, const placido_surface *surface,
                         const placido_eye *eye, const placido_ocular *ocular,
                         const double field_deg[2], const double offset_arcmin[2],
                         double wavelength_nm, int samples, int threads, placido_error *err);

/* Where fixation lies beside the chief ray's landing point: where the light of the pupil is densest
 * (focus.h), or most so about ocular->gaze_arcmin. How the retina is curved is not looked at.
 * PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
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

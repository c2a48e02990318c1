/* The light of a scene: what it is made of over the wavelengths, and the few of them that stand for
 * it in a simulation. */
#ifndef PLACIDO_SIMULATE_SPECTRUM_H
#define PLACIDO_SIMULATE_SPECTRUM_H

#include "simulate/plan/view.h"

#include <placido/scene.h>

#define PLACIDO_FOCUS_NM 555.0 /* in focus where light has many wavelengths */

#define PLACIDO_ARCMIN_PER_D_MM 3.43774677 /* a milliradian */

/* From the entrance pupil to the nodal point: in the chromatic eye of Thibos et al. (Applied Optics
 * 31, 3594 (1992)) the one is seen 1.57 mm, the other lies 5.55 mm behind the vertex. */
#define PLACIDO_PUPIL_TO_NODAL_MM 3.98

/* Photopic luminous efficiency V, the CIE's colour matching function y of 1931: by the two lobes of
 * Wyman, Sloan and Shirley (J. Computer Graphics Techniques 2 (2), 1 (2013)), within 0.01. */
double placido_luminous_efficiency(double wavelength_nm);

/* Power a nanometre of the light in the picture's planes, in any unit, each plane in its own:
 * `power` has room for `planes`, 1 or 3. Of PLACIDO_SPECTRUM_LINE it is not asked. */
void placido_spectrum_power(double *power, int planes, enum placido_spectrum spectrum,
                            double wavelength_nm);

/* Whether the light has one wavelength only. */
bool placido_spectrum_is_line(const placido_conditions *conditions);

/* The wavelength that is in focus: that of a line, in whose light the eye was refracted, else
 * PLACIDO_FOCUS_NM. It also stands for the light where colour is left out. */
double placido_spectrum_focus_nm(const placido_conditions *conditions);

/* The lights of a picture with so many planes (1: one light; 3, or 4 with alpha: one a colour),
 * each in `wavelengths` waves, 1 to PLACIDO_WAVES_MAX, ordered from blue to red, weighted by power times
 * luminous efficiency; weights sum to 1 and waves do not shift. Of a line it is one light of one
 * wave. Returns how many lights.
 *
 * The light is cut into cells of the focus' scale, closely where there is much of it: with the
 * square root of its density, between what is best for sums of cells' means where the image is a
 * smooth function of focus (the cube root) and where it has a corner, in focus (the density
 * itself). A wave has its cell's share of the light, its mean wavelength and its mean focus against
 * focus_nm. The error falls as wavelengths^-2. Gauss's nodes were tried: the corner spoils them. */
int placido_spectrum_lights(placido_light lights[PLACIDO_VIEW_LIGHTS],
                            const placido_conditions *conditions, int planes, int wavelengths,
                            double focus_nm);

/* How far a wave's image moves on the retina, as the cornea has its x and y (strokes.h), for each
 * dioptre of its defocus_D: millimetres, of which each is 3.438' a dioptre. The pupil's centre is
 * pupil_mm off the axis, and light comes from field_deg (ocular.h). */
void placido_transverse_shift(double shift_mm[2], const double pupil_mm[2],
                              const double field_deg[2]);

#endif

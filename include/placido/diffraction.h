/* Diffraction: the image of a distant point by the wave optics of Fraunhofer, from the optical
 * path differences over a pupil. What a sensor's square buckets receive, not what points in their
 * middles see; for any number of wavelengths. */
#ifndef PLACIDO_DIFFRACTION_H
#define PLACIDO_DIFFRACTION_H

#include <placido/eye.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <placido/wavefront.h>
#include <stdbool.h>
#include <stddef.h>

#define PLACIDO_DIFFRACTION_SAMPLES_MAX 2500 /* across the pupil; a transform takes 32 n² bytes */

/* A round pupil's wavefront on a square grid: sample (column, row) stands at
 * x = (column - (n - 1) / 2) spacing_mm, y = (row - (n - 1) / 2) spacing_mm from its centre, y
 * upwards with the rows. The grid has to follow the wavefront, not its phase: what the transform
 * needs is interpolated (third order) and depends on wavelength and window. */
typedef struct placido_pupil {
  int n;                   /* samples a side, 8 to 8192 */
  double spacing_mm;       /* the grid reaches the pupil's edge: n spacing_mm >= pupil_mm */
  double pupil_mm;         /* diameter */
  const double *opd_um;    /* n * n, rows outer: path of the chief ray less the ray's, positive
                              where light is ahead; NaN: no light comes through there. Next to the
                              edge samples outside the pupil are interpolated with; where they are
                              NaN the wavefront is continued */
  const double *amplitude; /* likewise, of the field: the square root of what a ray counts;
                              NULL: 1 */
} placido_pupil;

/* Light of one wavelength. */
typedef struct placido_wave {
  double wavelength_nm;        /* 100 to 10,000 */
  double weight;               /* of its light, 0 or more; where all sum to 1 so does the PSF */
  double defocus_D;            /* more power for this wavelength, as longitudinal chromatic
                                  aberration gives it: blue has more */
  double x_arcmin, y_arcmin;   /* where its image lies in the window, x with the columns and y
                                  with the rows: transverse chromatic aberration */
} placido_wave;

/* Where the light is caught; zero means the default in brackets. */
typedef struct placido_window {
  int buckets;          /* a side, odd, 3 to 4095 [257] */
  double bucket_arcmin; /* width of a bucket, [0.5]; more than 0 */
  int samples;          /* across the pupil; [chosen for each wavelength] */
  bool points;          /* values in the buckets' middles times their area, not their integrals:
                           only to compare with programs that do so */
  int threads;          /* 1 to 256 [1]; the result does not depend on it */
} placido_window;

/* What was chosen: of the wavelength that needed most. */
typedef struct placido_diffraction_use {
  int samples;          /* across the pupil */
  double period_arcmin; /* at which the sampled pupil repeats the image */
  double share;         /* of all light that lies within the window */
  double light;         /* mean square of the amplitude over the pupil: what the weights count */
} placido_diffraction_use;

/* The image in `values`: buckets * buckets, rows outer, column and row growing with the angle at
 * which light arrives. A ray where the path difference grows with x arrives at negative x. Values
 * are shares of the light that came through the pupil times the wave's weight, summed over the
 * waves. Energy is kept: a wavelength's values carry 1 / wavelength².
 *
 * A pupil sampled every d repeats the image every wavelength / d: d is chosen so that this is wider
 * than the window, and so that the path differs by less than half a wavelength between samples.
 * `use` may be NULL.
 * Returns PLACIDO_OK, PLACIDO_INPUT (an argument out of range, or samples too few for the window
 * or for the wavefront's slope: it would wrap), PLACIDO_QUALITY (no light comes through; the grid
 * is too coarse for the wavefront; more than PLACIDO_DIFFRACTION_SAMPLES_MAX samples would be
 * needed), PLACIDO_MEMORY. Source: J. W. Goodman, Introduction to Fourier Optics, 4.3 and 6.3. */
int placido_diffraction(double *values, placido_diffraction_use *use, const placido_pupil *pupil,
                        const placido_wave *waves, size_t count, const placido_window *window,
                        placido_error *err);

/* A pupil that owns its arrays: free with placido_pupil_free. */

/* The sum of Zernike terms (OSA index, micrometres, over the pupil; `count` of them), on n samples
 * a side [0: as many as the highest order asks for]. PLACIDO_OK, PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_pupil_of_terms(placido_pupil *pupil, double pupil_mm, const double *coefficients_um,
                           int count, int n, placido_error *err);

/* Exact paths from a plane wave through the surface, with the lens that the eye wears, to the
 * point `focus_mm` (x, y, depth behind the surface's point on the axis, 1 to 1000 mm);
 * eye->retina_mm is not looked at. A sample stands for the direction in which its ray reaches the
 * focus: its sine times the focus' depth, from that of the ray through the pupil's centre. Near the
 * axis that is where the ray enters; at the rim of 8 mm it is 3 % more, and pupil_mm is the mean of
 * the rim's. The amplitude has the light that comes in each direction. Where data do not support
 * the surface its continuation stands in; where it is not defined no light comes. `threads` as in a
 * window. PLACIDO_OK, PLACIDO_INPUT, PLACIDO_QUALITY (it is not defined on the axis or at the
 * pupil's centre), PLACIDO_MEMORY. */
int placido_pupil_of_surface(placido_pupil *pupil, const placido_surface *surface,
                             const placido_eye *eye, const double focus_mm[3], int threads,
                             placido_error *err);

void placido_pupil_free(placido_pupil *pupil);

/* `count` wavelengths of equal steps from first_nm to last_nm with the eye's chromatic difference
 * of focus against focus_nm (Thibos et al., Applied Optics 31, 3594 (1992)) and the weights of
 * photopic luminous efficiency (V of the CIE, 1931); weights sum to 1. At least 15 for 400 to
 * 700 nm: seven are over 10 % off in the Strehl ratio. PLACIDO_OK, PLACIDO_INPUT. */
int placido_waves_white(placido_wave *waves, size_t count, double first_nm, double last_nm,
                        double focus_nm, placido_error *err);

/* The eye's refraction at a wavelength less that at focus_nm, dioptres of power: positive in blue,
 * where the eye is myopic. */
double placido_chromatic_defocus(double wavelength_nm, double focus_nm);

#endif

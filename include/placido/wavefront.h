/* The wavefront that a cornea makes of light from a distant point on the axis: optical paths over
 * the pupil against the best reference sphere, as Zernike terms. */
#ifndef PLACIDO_WAVEFRONT_H
#define PLACIDO_WAVEFRONT_H

#include <placido/eye.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <placido/zernike.h>
#include <stdbool.h>
#include <stddef.h>

#define PLACIDO_WAVEFRONT_ORDER_MAX PLACIDO_ZERNIKE_ORDER_MAX
#define PLACIDO_WAVEFRONT_TERMS 136 /* up to order 15 */

/* How it is computed; zero means the default in brackets. */
typedef struct placido_wavefront_options {
  int order;          /* of the highest terms, 2 to 15 [8] */
  int rays;           /* over the pupil, 192 (363 from order 12 on) to 1,000,000; rounded up to
                         3 k² [768] */
  double missing_max; /* share of the pupil that may be without data, below 1 [0.15] */
} placido_wavefront_options;

/* The rays stand at the nodes of a quadrature over the pupil: k circles at Gauss-Legendre nodes in
 * the squared radius, 3 k equal angles. The terms' products are integrated exactly, so that each
 * coefficient is the mean of path difference times term, and the least-squares fit. */
typedef struct placido_wavefront {
  placido_eye eye;      /* every default filled in; retina_mm is the reference sphere's depth */
  int order, term_count;
  double coefficients_um[PLACIDO_WAVEFRONT_TERMS]; /* OSA index; over the eye's pupil */
  double focus_mm[3];   /* centre of the reference sphere: x, y, depth behind the surface's point on
                           the axis */
  double rms_um;        /* of the path differences about their mean */
  double rest_um;       /* rms of what the terms leave */
  double missing;       /* share of the pupil's area where no data support the surface */
  size_t count;         /* rays */
  double *x_mm, *y_mm;  /* where each enters */
  double *weight;       /* its share of the pupil's area; they sum to 1 */
  double *opd_um;       /* path of the chief ray, through the pupil's centre, less the ray's */
  double *terms;        /* term_count rows of count values */
} placido_wavefront;

/* Traces the rays to the reference sphere. Its centre is where the path differences are least in
 * the root mean square over the pupil; where eye->retina_mm is given it has that depth, and only
 * its place across is sought. A path is the depth of the ray's entry, through air, and
 * eye->index times the distance from there to the centre; a correction in `eye` is a thin lens on
 * the cornea (eye->correct is not looked at). Paths are counted so that they are positive where
 * light is ahead of the chief ray's, which makes the spherical aberration of a sphere positive
 * (OSA). Where data do not support the surface its smooth continuation stands in: `missing` is the
 * share of that, and a note says so.
 * Free with placido_wavefront_free. Returns PLACIDO_OK, PLACIDO_INPUT (an argument out of range),
 * PLACIDO_QUALITY (the surface does not fill the pupil, too much is missing, or no focus),
 * PLACIDO_MEMORY. */
int placido_wavefront_new(placido_wavefront *wavefront, const placido_surface *surface,
                          const placido_eye *eye, const placido_wavefront_options *options,
                          placido_notes *notes, placido_error *err);
void placido_wavefront_free(placido_wavefront *wavefront);

/* The coefficients of another surface's wavefront, by the same rays and against the same sphere
 * behind its own point on the axis: for variants of a fit. Returns PLACIDO_OK, PLACIDO_QUALITY
 * (that surface does not fill the pupil), PLACIDO_MEMORY. */
int placido_wavefront_again(double coefficients_um[PLACIDO_WAVEFRONT_TERMS],
                            const placido_wavefront *wavefront, const placido_surface *surface,
                            placido_error *err);

/* A figure made of the coefficients. */
typedef struct placido_wavefront_figure {
  const char *name, *unit;
  const char *help;  /* one sentence with the formula's source */
  double period;     /* of an angle in degrees; 0: no angle */
  double (*at)(const placido_wavefront *wavefront, const double *coefficients_um);
} placido_wavefront_figure;

/* The figures that this build knows, `*count` rows: rms, spherical aberration, coma, refraction
 * ... */
const placido_wavefront_figure *placido_wavefront_figures(size_t *count);

/* Difference of two values of a figure; of angles the shorter way round. */
double placido_wavefront_difference(const placido_wavefront_figure *figure, double a, double b);

/* Zernike terms by least squares through scattered points. */
typedef struct placido_zernike_fit {
  int order, term_count;
  double coefficients[PLACIDO_WAVEFRONT_TERMS]; /* OSA index; unit of the values */
  double rms;        /* root mean square of what the terms leave; below 1e-7 of the values' own it
                        is rounding */
  double condition;  /* of the fit: 1 where the points make the terms orthogonal; error bars of
                        the values grow by at most so much */
  size_t count;      /* points used */
} placido_zernike_fit;

/* Fits all terms up to `order` (0 to 15) to `z` at (x, y) in units of the pupil's radius, each
 * counting by `weight` (NULL: 1; 0 or more). Points outside the unit circle and those where
 * anything is NaN are left out. By normal equations, which the terms' near-orthogonality allows:
 * the result is good to about 1e-16 times the condition squared. Returns PLACIDO_OK, PLACIDO_INPUT
 * (the order), PLACIDO_QUALITY (fewer points than terms, or a condition of over 1e5: the points do
 * not determine the terms), PLACIDO_MEMORY. */
int placido_zernike_fit_points(placido_zernike_fit *fit, int order, const double *x,
                               const double *y, const double *z, const double *weight,
                               size_t count, placido_error *err);

/* The power vector that corrects a wavefront (micrometres, by OSA index, `count` of them) over a
 * pupil of this diameter. Least squares: M = -4 sqrt(3) c20 / r², J0 = -2 sqrt(6) c22 / r², J45
 * likewise; else the curvature at the pupil's centre, to which all terms of frequency 0 and 2 add
 * (Thibos et al., J. Vision 4, 329 (2004)). */
placido_correction placido_terms_refraction(const double *coefficients_um, int count,
                                            double pupil_mm, bool at_centre);

#endif

/* How good an image is: transfer of contrast, encircled energy, moments, Strehl ratios, and all of
 * it through focus. Of a PSF it makes no difference whether rays or waves made it. */
#ifndef PLACIDO_QUALITY_H
#define PLACIDO_QUALITY_H

#include <placido/diffraction.h>
#include <placido/eye.h>
#include <placido/psf.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stddef.h>

#define PLACIDO_MTF_MERIDIANS 4 /* contrast along 0, 45, 90 and 135 degrees */

/* Contrast of gratings after the image, relative to before: the modulus of the PSF's Fourier
 * transform over that at frequency 0, divided by that of a bucket, and 1 at most. What the buckets
 * alias is not undone: of light finer than two buckets (frequencies over 30 / bucket_arcmin c/deg)
 * something comes back below, behind 4 mm and 0.5' up to 0.05 at 30 c/deg. A quarter of that bucket
 * is free of it. */
typedef struct placido_mtf {
  int count;
  double step_cpd;  /* value k is at k step_cpd, cycles per degree */
  double *radial;   /* `count` values: mean over all directions */
  double *meridian[PLACIDO_MTF_MERIDIANS]; /* along 45 k degrees, counter-clockwise from the
                                              patient's right; `count` values each */
} placido_mtf;

/* At `count` (2 or more) frequencies from 0 on, the last of which is at most 30 / bucket_arcmin.
 * Free with placido_mtf_free. PLACIDO_OK, PLACIDO_INPUT, PLACIDO_QUALITY (no light),
 * PLACIDO_MEMORY. */
int placido_mtf_new(placido_mtf *mtf, const placido_psf *psf, int count, double step_cpd,
                    placido_error *err);
void placido_mtf_free(placido_mtf *mtf);

/* Moments of the light that landed, in minutes of arc: x to the patient's right, y up. */
typedef struct placido_moments {
  double sum;           /* share of the light */
  double x, y;          /* of the centroid, from the middle bucket's middle */
  double xx, xy, yy;    /* about the centroid, arcmin²; of diffraction they grow with the window */
  double rms;           /* sqrt(xx + yy) */
} placido_moments;

/* NaN, but for the sum, where no light landed. */
placido_moments placido_psf_moments(const placido_psf *psf);

/* Share of the landed light within `radius_arcmin` of (x, y), light being even within a bucket. */
double placido_encircled_share(const placido_psf *psf, double x_arcmin, double y_arcmin,
                               double radius_arcmin);

/* The radius about the centroid that holds this share (0 to 1) of the landed light, arcmin; NaN
 * where no light landed. */
double placido_encircled_radius(const placido_psf *psf, double share);

/* Strehl ratio in the direction of the reference sphere's centre, exactly: of `count` points that
 * stand for `weight` of the pupil's area and have this amplitude (NULL: 1). */
double placido_strehl(const double *opd_um, const double *amplitude, const double *weight,
                      size_t count, double wavelength_nm);

/* Maréchal's estimate exp(-(2 pi rms / wavelength)²): within 0.01 of the exact ratio above 0.67. */
double placido_strehl_marechal(double rms_um, double wavelength_nm);

/* The highest Strehl ratio of all directions, which with coma is not that of the axis, and where it
 * is (arcmin, growing with column and row as placido_diffraction has it). Within 64 wavelengths per
 * pupil of the axis. Errors as placido_diffraction. */
int placido_strehl_peak(double *strehl, double peak_arcmin[2], const placido_pupil *pupil,
                        double wavelength_nm, placido_error *err);

/* Quality against vergence. Each figure is relative to a perfect eye: 1 at most. */
typedef struct placido_focus_curve {
  int count;
  double *lens_D;         /* thin lens added on the cornea */
  double *peak;           /* fullest bucket over that of the perfect eye */
  double *visual_strehl;  /* OTF weighted by neural contrast sensitivity up to 60 c/deg: VSOTF of
                             Thibos, Hong, Bradley and Applegate, J. Vision 4, 329 (2004) */
  double *mtf_area;       /* under the radial MTF up to 60 c/deg */
} placido_focus_curve;

/* `count` (2 or more) lenses from from_D to to_D before `eye`, in which nothing is left open
 * (placido_psf_new's `found`). The perfect eye has a point for rays and the pupil's diffraction for
 * waves. Free with placido_focus_curve_free. Errors as placido_psf_new. */
int placido_focus_curve_new(placido_focus_curve *curve, const placido_surface *surface,
                            const placido_eye *eye, const placido_optics *optics, double from_D,
                            double to_D, int count, placido_error *err);
void placido_focus_curve_free(placido_focus_curve *curve);

/* Writes focus.csv (docs/formats.md) by way of a temporary name. PLACIDO_OK, PLACIDO_SYSTEM. */
int placido_focus_curve_save_csv(const placido_focus_curve *curve, const char *path,
                                 placido_error *err);

#endif

/* From mires to the cornea: the surface that mirrors the instrument's edges to where they were
 * seen, with the error bars of what it does and does not know. */
#ifndef PLACIDO_RECONSTRUCT_H
#define PLACIDO_RECONSTRUCT_H

#include <placido/mires.h>
#include <placido/surface.h>
#include <placido/uncertainty.h>

/* Opaque: the fitted surface with its covariance. Immutable. */
typedef struct placido_fit placido_fit;

/* Knobs of the fit; zero means the default in brackets. */
typedef struct placido_fit_options {
  double axis_z_mm;       /* z of the cornea at x = y = 0 [0] */
  double axis_z_sigma_mm; /* its standard deviation; 0 means exactly known: taken as it is */
  const placido_uncertainty *geometry; /* of the instrument, independent of axis_z; borrowed. NULL
                             or without modes: its part of the error bars is not known */
  int geometry_modes;     /* so many of its modes count, the strongest ones [all]; each costs
                             about 1 % of the fit's time */
  double knot_mm;         /* knot spacing, 0.15 to 2; [0.5, or finer where residuals ask for it] */
  double smoothing;       /* weight of the third-derivative penalty [1000] */
  int degree;             /* of the spline, 3 or 5 [5] */
  int steps_max;          /* Gauss-Newton steps [40] */
  double tolerance;       /* the last step of Gauss-Newton is one that moves the points' residuals
                             by less than this share of their noise, or after which the next one
                             would, 1e-6 to 1 [0.014, or 0.1 where no point was set aside] */
  int threads;            /* [1]; the result does not depend on it */
  const placido_fit *start; /* of the frame before, of the same eye under the same instrument: the
                             fit starts there, which takes a half of the time, and agrees with one
                             from the beginning to a small part of its error bars. Where it is too
                             far away it is passed over. Borrowed; may be NULL */
} placido_fit_options;

/* How the fit went. */
typedef struct placido_fit_summary {
  double rms_px;            /* of the residuals of the used points */
  double sigma_px;          /* robust standard deviation of an edge point, from the residuals */
  size_t points, points_used;
  int steps;                /* Gauss-Newton steps taken */
  double knot_mm;
  double radius_mm;         /* of the fitted disc */
  double condition;         /* estimate of the normal matrix's condition number */
  double axis_z_mm, axis_z_sigma_mm; /* as given or as solved for */
  bool axis_z_solved;       /* the mires told the distance better than axis_z_sigma_mm of the options:
                               it is the mean of both, weighted by their variances */
} placido_fit_summary;

/* Fits the surface. Sets used and residual_px in `mires`, and corrects numbers that the surface
 * contradicts (with a note); a point for whose new number there is no edge goes. Free with
 * placido_fit_free.
 * Returns PLACIDO_OK, PLACIDO_INPUT (an option out of range, an instrument that is not one in
 * millimetres, a point without number, noise, edge or place in the image, or points out of order or
 * twice), PLACIDO_QUALITY (too few points, no convergence, or no cornea: the sentence says which),
 * PLACIDO_MEMORY. */
int placido_fit_new(placido_fit **fit, placido_mires *mires,
                    const placido_instrument *instrument, const placido_fit_options *options,
                    placido_notes *notes, placido_error *err);
void placido_fit_free(placido_fit *fit);

/* Borrowed until the fit is freed. */
const placido_surface *placido_fit_surface(const placido_fit *fit);
placido_fit_summary placido_fit_summary_get(const placido_fit *fit);

/* Standard deviations at (x, y), 1 sigma: of z (micrometres) against the mean height of the covered
 * part of the central 3 mm, as elevations are compared, and of axial curvature (337.5 dioptres); from
 * edge noise (what edges have in common with it), smoothing and the uncertainty of distance and
 * geometry. The height as a whole is as uncertain as axis_z_sigma_mm. NaN outside the disc. */
void placido_fit_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                          double *sigma_axial_D);

/* What an error bar is made of: the squares of these add up to its square. */
enum placido_sigma_source {
  PLACIDO_SIGMA_NOISE,    /* of the edge points, with the smoothing */
  PLACIDO_SIGMA_DISTANCE, /* axis_z_sigma_mm */
  PLACIDO_SIGMA_GEOMETRY, /* the instrument's */
  PLACIDO_SIGMA_SOURCES
};

typedef struct placido_sigma {
  double z_um, axial_D;
} placido_sigma;

/* The error budget: each source's share of placido_fit_sigma_at, root mean square over the covered
 * part of the central zone, a diameter in mm. The geometry's is NaN where nothing is known of it;
 * all are NaN where nothing of the zone is covered. */
void placido_fit_budget(const placido_fit *fit, double zone_mm,
                        placido_sigma budget[PLACIDO_SIGMA_SOURCES]);

/* What the measurement leaves open, as other corneas. Each variant is the fitted surface moved by
 * an independent step: the squares of what these steps change in any quantity add up to its
 * variance. A source's share is the sum over its own variants. The distance and every mode of the
 * geometry are one variant each (to first order exact); the noise of the edge points stands as
 * PLACIDO_NOISE_VARIANTS draws from its covariance, which gives its share of a sigma to one part in
 * sqrt(2 PLACIDO_NOISE_VARIANTS): one eighth. The draws are the same for every run and machine. */
#define PLACIDO_NOISE_VARIANTS 32

int placido_fit_variant_count(const placido_fit *fit);
enum placido_sigma_source placido_fit_variant_source(const placido_fit *fit, int variant);

/* Variant number `variant` (0 .. count - 1) as a surface, its height on the axis that of the fit but
 * for the distance's. Free with placido_surface_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_fit_variant(placido_surface **surface, const placido_fit *fit, int variant,
                        placido_error *err);

/* Draw number `number` (0 or more) from all that the measurement leaves open together, as a surface:
 * the fitted one moved by noise, distance and every mode of the geometry at once, each by a normal
 * amount of its full size. For quantities that steps do not add up to, as at the best focus, where
 * every step makes the image worse: their variance is the mean square of what draws change (JCGM
 * 101:2008, 7), to one part in sqrt(2 N) of N draws. The same for every run and machine. Free with
 * placido_surface_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_fit_draw(placido_surface **surface, const placido_fit *fit, int number,
                     placido_error *err);

/* The fitted surface as it would be were z on the axis larger by so many mm, to first order in the
 * fit: what the distance variant is by its sigma. Free with placido_surface_free. Returns
 * PLACIDO_OK or PLACIDO_MEMORY. */
int placido_fit_moved(placido_surface **surface, const placido_fit *fit, double distance_mm,
                      placido_error *err);

#endif

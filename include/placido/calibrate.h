/* The instrument's geometry from pictures of balls: calibration, and the daily check. */
#ifndef PLACIDO_CALIBRATE_H
#define PLACIDO_CALIBRATE_H

#include <placido/frame.h>
#include <placido/reconstruct.h>
#include <placido/uncertainty.h>

#define PLACIDO_BALL_VIEWS_MAX 256
#define PLACIDO_BALL_PATH_MAX 1024

/* A picture of a ball, and what is known of the ball beforehand. Views with equal radius_mm show
 * the same ball. */
typedef struct placido_ball_view {
  char path[PLACIDO_BALL_PATH_MAX]; /* of the image or session; what messages call it */
  double radius_mm, radius_sigma_mm;
  double z_mm, z_sigma_mm; /* of the ball's vertex, its point nearest the camera, on the plan's
                              scale, whose zero becomes the instrument's */
  bool held_out;           /* takes no part in the solution, but is measured with it afterwards */
  placido_frame frame;     /* filled by the caller, who frees it */
} placido_ball_view;

/* A plan file `placido-calibration/1` (docs/formats.md). Paths are relative to the plan's own place
 * in the file, and ready to be opened here. */
typedef struct placido_calibration_plan {
  char instrument_path[PLACIDO_BALL_PATH_MAX];
  size_t view_count;
  placido_ball_view *views; /* frames are empty */
} placido_calibration_plan;

/* Free with placido_calibration_plan_free, which frees the views' frames too. Returns PLACIDO_OK,
 * PLACIDO_SYSTEM, PLACIDO_INPUT (file, line and field named), PLACIDO_MEMORY. */
int placido_calibration_plan_load(placido_calibration_plan *plan, const char *path,
                                  placido_notes *notes, placido_error *err);
void placido_calibration_plan_free(placido_calibration_plan *plan);

/* Annuli about the ball's vertex over which the axial power is averaged. */
#define PLACIDO_BALL_ZONES 3
extern const double placido_ball_zone_mm[PLACIDO_BALL_ZONES][2]; /* inner and outer radius */

/* How a ball of known radius was measured. NaN where the surface does not reach. */
typedef struct placido_ball_check {
  double vertex_mm[3];      /* from the radius and the mires */
  double radius_mm;         /* of the sphere nearest to the surface within 8 mm */
  double rms_6_um, rms_8_um; /* of the surface from the known ball, within 6 and 8 mm */
  double power_error_D[PLACIDO_BALL_ZONES]; /* mean axial power less 337.5 / radius */
  double worst_power_D;     /* of those, the one farthest from 0 */
  double mires_rms_px;      /* of the edges from the fitted surface */
} placido_ball_check;

/* A ball of known radius and where it stands: z_mm is of its vertex or, `on_axis`, of its surface
 * on the instrument's axis as axis_z_mm of an eye is. NaN: not known. */
typedef struct placido_ball {
  double radius_mm, z_mm;
  bool on_axis;
} placido_ball;

/* Measures a ball as an eye is measured, and compares; the vertex's x and y come from the mires and
 * the known radius. Where z_mm is NaN the distance comes from there too, and the ball's power is
 * then right on the whole by construction: only its shape is checked. Sets used and residual_px in
 * `mires`. Returns what placido_fit_new returns. */
int placido_ball_check_run(placido_ball_check *check, placido_mires *mires,
                           const placido_instrument *instrument, const placido_ball *ball,
                           int threads, placido_notes *notes, placido_error *err);

/* Knobs; zero means the default in brackets. */
typedef struct placido_calibrate_options {
  int meridians; /* of each picture [360] */
  int threads;   /* [1]; the result does not depend on it */
} placido_calibrate_options;

/* What one view gave. */
typedef struct placido_view_result {
  bool solved;         /* took part; else it was held out, or its mires were not found */
  bool checked;        /* held out, and measured: `check` is filled */
  double vertex_mm[3];
  double z_less_plan_mm;
  double rms_px;
  size_t points;
  placido_ball_check check;
} placido_view_result;

typedef struct placido_ball_result {
  double radius_mm, sigma_mm; /* after the solution */
  double start_mm, start_sigma_mm;
} placido_ball_result;

/* A direction in which the data left the geometry as unknown as it was, or little better. */
typedef struct placido_undetermined {
  double share; /* standard deviation after over before, 0.5 to 1 */
  char text[256]; /* the parameters that make it up */
} placido_undetermined;

#define PLACIDO_UNDETERMINED_MAX 64

typedef struct placido_calibration {
  placido_instrument instrument; /* calibrated */
  placido_uncertainty uncertainty;
  size_t view_count, ball_count;
  placido_view_result *views;  /* in the caller's order */
  placido_ball_result *balls;  /* in the order in which they come up */
  double edge_rms_px[PLACIDO_EDGES_MAX], edge_mean_px[PLACIDO_EDGES_MAX];
  size_t edge_points[PLACIDO_EDGES_MAX];
  double rms_px, sigma_px; /* of the residuals; robust */
  double inflation;        /* how much more an edge errs as a whole than its points would: the
                              covariance is multiplied by it */
  size_t points;
  int steps, rounds;       /* of Levenberg and Marquardt; of finding the mires */
  double condition;        /* of the normal matrix in prior standard deviations */
  int undetermined_count;
  placido_undetermined undetermined[PLACIDO_UNDETERMINED_MAX];
} placido_calibration;

/* What is assumed of a nominal instrument whose file has no "sigma": what a workshop and a data
 * sheet hold. Free with placido_uncertainty_free. */
int placido_calibrate_prior(placido_uncertainty *prior, const placido_instrument *nominal,
                            placido_error *err);

/* Solves camera, mires, balls' radii and positions jointly from the views' frames, starting from
 * `nominal` with the standard deviations `prior->sigma` (0: exactly known). Free with
 * placido_calibration_free. Returns PLACIDO_OK, PLACIDO_INPUT (a frame of the wrong size),
 * PLACIDO_QUALITY (too few usable pictures, or no convergence), PLACIDO_MEMORY. */
int placido_calibrate(placido_calibration *calibration, const placido_instrument *nominal,
                      const placido_uncertainty *prior, const placido_ball_view *views,
                      size_t view_count, const placido_calibrate_options *options,
                      placido_notes *notes, placido_error *err);
void placido_calibration_free(placido_calibration *calibration);

/* Writes `placido-calibration-report/1`, by way of a temporary name. */
int placido_calibration_save(const placido_calibration *calibration,
                             const placido_ball_view *views, const char *path,
                             placido_error *err);

#endif

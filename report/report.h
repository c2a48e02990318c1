/* Figures and the one-page report: what a person looks at. Drawn with cairo. */
#ifndef PLACIDO_REPORT_H
#define PLACIDO_REPORT_H

#include <placido/acuity.h>
#include <placido/difference.h>
#include <placido/ghost.h>
#include <placido/index.h>
#include <placido/map.h>
#include <placido/mires.h>
#include <placido/plan.h>
#include <placido/simulate.h>
#include <placido/wavefront.h>

/* A map with ISO-style colour steps, legend with unit, scale bar, axes with degrees, and what is
 * hatched out as not supported by data. `kind` indexes placido_map_kinds. PNG by way of a
 * temporary name, as everywhere here. */
int placido_figure_map(const placido_maps *maps, int kind, const char *path, placido_error *err);

/* How values get their colours. */
enum placido_scale_mode {
  PLACIDO_SCALE_FIXED,    /* ISO 19980's steps about a fixed value, the smallest that holds the map */
  PLACIDO_SCALE_ABSOLUTE, /* one and the same scale for every eye */
  PLACIDO_SCALE_ADAPTIVE  /* ISO 19980's steps about the map's own middle */
};

/* The same with a scale of one's choice. */
int placido_figure_map_scaled(const placido_maps *maps, int kind, enum placido_scale_mode mode,
                              const char *path, placido_error *err);

/* A difference map with its unit about 0; hatched where it is less than twice its error bar. `names`:
 * how the legend calls the two, the second less the first. */
int placido_figure_difference(const placido_difference *difference,
                              enum placido_difference_kind kind, const char *const names[2],
                              const char *path, placido_error *err);

/* The map of one of the error bars: "sigma_z", or "sigma_NAME" with a kind's name. */
int placido_figure_sigma(const placido_maps *maps, const char *which, const char *path,
                         placido_error *err);

/* The frame with every edge point on it, coloured by edge number, used and unused apart, numbers
 * along one meridian, the centre marked, scale bar (mm on the cornea, from `mm_per_px`). */
int placido_figure_mires(const placido_frame *frame, const placido_mires *mires, double mm_per_px,
                         const char *path, placido_error *err);

/* The frame alone, as PNG, at most `width_px` wide. */
int placido_figure_frame(const placido_frame *frame, int width_px, const char *path,
                         placido_error *err);

/* The PSF as a height field in perspective with axes in minutes of arc, and as a plan beside it. */
int placido_figure_psf(const placido_psf *psf, const char *path, placido_error *err);

/* How good the image is: contours, modulation transfer, encircled energy, and the curves through
 * focus (NULL: figures in their place). */
int placido_figure_quality(const placido_psf *psf, const placido_focus_curve *curve,
                           const char *path, placido_error *err);

/* The wavefront as maps over the pupil, whole and from order 3 on, and its terms as bars with one
 * standard deviation each (`sigma_um` by OSA index; NULL or NaN: not known). */
int placido_figure_wavefront(const placido_wavefront *wavefront, const double *sigma_um,
                             const char *path, placido_error *err);

/* A daily check of the instrument on a ball. NaN: not seen. */
typedef struct placido_drift_point {
  double t_s;                  /* since 1970, UTC */
  double power_D[3], shape_um; /* error of axial power in the inner, middle and outer zone; rms */
  double limit_D, limit_um;
  bool passed;
} placido_drift_point;

/* The checks over time: errors of power and of shape, with their limits; failed ones are marked. */
int placido_figure_drift(const placido_drift_point *points, size_t count, const char *path,
                         placido_error *err);

/* A stage of the examination and its wall time. */
typedef struct placido_stage {
  const char *name;
  double seconds;
} placido_stage;

/* Which effects a picture has, and what it took. */
typedef struct placido_report_plan {
  const placido_verdict *verdicts;
  size_t count; /* 0: the picture was not planned */
  double tolerance, promised; /* of the picture's error: wished for, and what it is at most */
  double planning_s, run_s;
  double predicted_s; /* of the run on one core; NaN: not known */
} placido_report_plan;

/* What one pupil gave: file names are relative to the exam directory. */
typedef struct placido_report_pupil {
  const placido_psf *psf;
  double strehl_g_sigma; /* of its Strehl ratio; 0 or NaN: not known */
  bool automatic; /* the pupil is the one that the scenes' luminance gives */
  const char *psf_picture; /* pupil-4mm/psf.png */
  const char *const *scene_names;
  const char *const *scene_pictures; /* pupil-4mm/tumbling-e.png */
  const placido_report_plan *plans;  /* of the scenes; NULL: none was planned */
  double scene_arcmin_per_px;        /* of the pictures */
  size_t scene_count;
  const placido_acuity *acuities;
  size_t acuity_count; /* 0: neither acuities nor ghosts were asked for */
  const placido_ghosts *ghosts;
} placido_report_pupil;

/* The wavefront through one pupil. `figures` are ordered as placido_wavefront_figures, `sigmas`
 * likewise (NULL: not known). */
typedef struct placido_report_wavefront {
  const placido_wavefront *front;
  const double *figures, *sigmas;
  const char *picture; /* maps/wavefront-6mm.png */
} placido_report_wavefront;

/* Where on the page a map stands, from large and first to small and last. */
enum placido_report_place {
  PLACIDO_PLACE_MAIN,
  PLACIDO_PLACE_FURTHER,
  PLACIDO_PLACE_UNCERTAINTY,
  PLACIDO_PLACES
};

typedef struct placido_report_map {
  const char *picture, *caption; /* name, unit, what it tells */
  enum placido_report_place place;
} placido_report_map;

/* What of an error or of the time was asked for, promised and found; NaN: nothing. */
typedef struct placido_report_limit {
  double asked, promised, found;
} placido_report_limit;

typedef struct placido_report_accuracy {
  placido_report_limit elevation_um, psf, time_ms;
  const char *settings; /* that were chosen, a sentence */
  const char *table;    /* by which, likewise */
} placido_report_accuracy;

/* Everything that the page shows. Pointers are borrowed; NULL or 0 leaves a section out (a
 * simulation without a capture has no mires). */
typedef struct placido_report {
  const char *directory; /* where the pictures are and report.html goes */
  const char *input, *eye, *instrument_name, *software, *created;
  bool calibrated;
  double axis_z_mm, axis_z_sigma_mm;
  const placido_mires *mires;
  const placido_fit_summary *fit;
  const char *capture_picture, *mires_picture;
  const placido_report_accuracy *accuracy; /* NULL: nothing was asked for */
  const placido_sigma *budget; /* PLACIDO_SIGMA_SOURCES of them */
  double budget_zone_mm;
  const char *condition; /* how results answer to errors of what goes in, in words; may be NULL */
  const placido_report_map *maps;
  size_t map_count;
  const placido_index_value *indices;
  size_t index_count;
  const placido_report_wavefront *wavefronts;
  size_t wavefront_count;
  const placido_report_pupil *pupils;
  size_t pupil_count;
  const placido_stage *stages;
  size_t stage_count;
  const placido_notes *notes;
} placido_report;

/* Writes directory/report.html: self-contained (pictures embedded as data URIs), prints on A4.
 * Every string from outside is escaped. */
int placido_report_write(const placido_report *report, placido_error *err);

#endif

/* Figures and the one-page report: what a person looks at. Drawn with cairo. */
#ifndef PLACIDO_REPORT_H
#define PLACIDO_REPORT_H

#include <placido/map.h>
#include <placido/mires.h>
#include <placido/simulate.h>

/* A map with ISO-style colour steps, legend with unit, scale bar, axes with degrees, and what is
 * hatched out as not supported by data. `kind` indexes placido_map_kinds. PNG by way of a
 * temporary name, as everywhere here. */
int placido_figure_map(const placido_maps *maps, int kind, const char *path, placido_error *err);

/* The map of one of the error bars: "sigma_z" or "sigma_axial". */
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

/* What one pupil gave: file names are relative to the exam directory. */
typedef struct placido_report_pupil {
  const placido_psf *psf;
  const char *psf_picture; /* pupil-4mm/psf.png */
  const char *const *scene_names;
  const char *const *scene_pictures; /* pupil-4mm/tumbling-e.png */
  double scene_arcmin_per_px;        /* of the pictures */
  size_t scene_count;
} placido_report_pupil;

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
  const char *const *map_pictures; /* file names, NULL-terminated */
  const char *const *map_captions; /* one a picture: name, unit, what it tells */
  const placido_index_value *indices;
  size_t index_count;
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

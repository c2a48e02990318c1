/* A study: many corneas, each through several pupils before several scenes, as figures and as one
 * page. */
#ifndef PLACIDO_REPORT_STUDY_H
#define PLACIDO_REPORT_STUDY_H

#include <placido/acuity.h>
#include <placido/ghost.h>
#include <placido/map.h>
#include <placido/simulate.h>

#define PLACIDO_STUDY_SCENES_MAX 16
#define PLACIDO_STUDY_FINDINGS_MAX 8

/* Contrast at which lines count as told apart in a picture: a tenth, as photographers have it; at
 * Rayleigh's limit of two points a circular pupil leaves 0.09. */
#define PLACIDO_STUDY_CONTRAST 0.1

/* One cornea through one pupil. Where `failure` says something there is nothing else. */
typedef struct placido_study_cell {
  double pupil_mm;
  char failure[512];
  placido_eye eye; /* with what was found for the best focus */
  placido_acuity acuity;
  char acuity_text[48]; /* "20/35", "worse than 20/1002" */
  /* Smallest stroke from which on bars along the letters' keep PLACIDO_STUDY_CONTRAST, minutes of
   * arc, decimal logarithm: what the picture shows. NaN: not even the largest. */
  double bars_logmar;
  char bars_text[48];
  placido_ghosts ghosts;
  double strehl_g, bucket_arcmin, outside; /* as in placido_psf */
  int buckets;
  long rays_entered, rays_missed;
  bool scenes[PLACIDO_STUDY_SCENES_MAX]; /* whether it is pictured */
} placido_study_cell;

/* One cornea. */
typedef struct placido_study_eye {
  char name[96], folder[112]; /* folder: eyes/NAME */
  const char *group, *note;   /* constants; "" where it is not known */
  char source[1024];          /* file; empty: built in */
  char failure[512];          /* why there is nothing of it; empty: there is */
  double higher_um, coma_like_um; /* rms of the corneal wavefront over 6 mm from order 3 on, and its
                                     odd orders alone; NaN: the cornea does not fill 6 mm */
  double ghost_deg;          /* where the ghost ought to be, as in placido_ghost; NaN: nowhere */
  placido_study_cell *cells; /* one a pupil */
} placido_study_eye;

/* What the seed found of a kind of cornea, looking at pictures, and what the pictures of this study
 * show. Acuities are denominators of 20/x. */
typedef struct placido_study_finding {
  const char *group, *claim;    /* constants */
  double least_pupil_mm;        /* of the cells that it is about */
  double low, high;             /* that count as agreement */
  size_t cells, met;
  double best, worst;           /* infinite: nothing is told apart */
  double observer_best, observer_worst; /* of the ideal observer, who needs no such contrast */
} placido_study_finding;

/* Everything that the page shows; pointers are borrowed. */
typedef struct placido_study {
  const char *software, *created, *source, *test; /* test: how acuity was tested */
  const placido_study_eye *eyes;
  size_t eye_count;
  const double *pupils_mm;
  size_t pupil_count;
  const char *scene_names[PLACIDO_STUDY_SCENES_MAX], *scene_stems[PLACIDO_STUDY_SCENES_MAX];
  size_t scene_count;
  placido_study_finding findings[PLACIDO_STUDY_FINDINGS_MAX];
  size_t finding_count;
  const placido_notes *notes;
} placido_study;

/* A cornea's axial power (about its vertex, where it has one) as a disc without axes, on one and the same scale for every cornea, with
 * circles as large as the pupils. */
int placido_figure_study_map(const placido_maps *maps, const double *pupils_mm, size_t pupil_count,
                             const char *path, placido_error *err);

/* A PSF as height field above its plan, both small. */
int placido_figure_study_psf(const placido_psf *psf, const char *path, placido_error *err);

/* Writes folder/study.html with the pictures that stand in the eyes' folders. */
int placido_report_study_write(const placido_study *study, const char *folder, placido_error *err);

#endif

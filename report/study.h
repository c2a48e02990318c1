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

/* One cornea through one pupil. Where `failure` says something there is nothing else. */
typedef struct placido_study_cell {
  double pupil_mm;
  char failure[512];
  placido_eye eye; /* with what was found for the best focus */
  placido_acuity acuity;
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

/* What the seed found of a kind of cornea, and what this study finds. Acuities are denominators of
 * 20/x. */
typedef struct placido_study_finding {
  const char *group, *claim;    /* constants */
  double least_pupil_mm;        /* of the cells that it is about */
  double low, high;             /* that count as agreement */
  size_t cells, met;
  double best, worst;           /* NaN: no cells */
  bool worst_is_bound;          /* and worse than that */
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

/* "20/35", "worse than 20/1002": at most `size` bytes. */
void placido_study_write_acuity(char *text, size_t size, const placido_acuity *acuity);

/* A cornea's axial power as a disc without axes, on one and the same scale for every cornea, with
 * circles as large as the pupils. */
int placido_figure_study_map(const placido_maps *maps, const double *pupils_mm, size_t pupil_count,
                             const char *path, placido_error *err);

/* A PSF as height field above its plan, both small. */
int placido_figure_study_psf(const placido_psf *psf, const char *path, placido_error *err);

/* Writes folder/study.html with the pictures that stand in the eyes' folders. */
int placido_report_study_write(const placido_study *study, const char *folder, placido_error *err);

#endif

/* What the eye sees: a point spread function a pupil, a plan and a picture a pupil and scene. */
#ifndef PLACIDO_CLI_VIEWS_H
#define PLACIDO_CLI_VIEWS_H

#include "acquire/cli/acuity.h"
#include "acquire/cli/options.h"

#include <placido/plan.h>
#include <placido/simulate.h>

#define VIEWS_MAX (2 * LIST_MAX) /* the pupils given, and one a scene */

/* A scene through one pupil. */
struct sight {
  placido_plan *plan;  /* NULL: none was made */
  double run_s;
  placido_image image; /* encoded as sRGB; no data: it could not be shown, or was not looked at */
};

/* What is seen through one pupil. */
struct view {
  char directory[32]; /* pupil-4mm */
  bool automatic;     /* the pupil follows from the luminance of those scenes that are seen */
  placido_eye eye;                /* with what was searched */
  placido_psf psf;
  double strehl_g_sigma;          /* of psf.strehl_g; NaN: not known */
  double seconds;                 /* that the PSF took */
  placido_focus_curve focus;      /* count 0: it was not asked for */
  struct acuity_view acuity;
  struct sight sights[LIST_MAX];  /* by scene */
};

struct views {
  size_t scene_count;
  placido_scene scenes[LIST_MAX];
  char stems[LIST_MAX][80]; /* the scenes' names as file names */
  size_t count;
  struct view items[VIEWS_MAX];
};

/* The pupil's folder, to a tenth of a millimetre where it was not given. */
void views_name_pupil(char directory[32], double pupil_mm, bool automatic);

/* Prints the generated charts, for the help. */
void views_list_charts(void);

/* Refuses a pupil that stands twice, with STATUS_USAGE: two are the same where they would share a
 * folder. */
int views_check_pupils(const struct number_list *pupils, placido_error *err);

/* Charts are drawn as finely as the PSF's buckets ask for, but no coarser than usual; 0: usual. */
struct settings;
double views_chart_scale(const struct settings *settings);

/* The plan of the first scene that was planned for this pupil; NULL where there is none. */
const placido_plan *views_first_plan(const struct view *view);

void views_free(struct views *views);

#endif

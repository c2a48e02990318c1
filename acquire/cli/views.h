/* What the eye sees: a point spread function a pupil, a picture a pupil and scene. */
#ifndef PLACIDO_CLI_VIEWS_H
#define PLACIDO_CLI_VIEWS_H

#include "acquire/cli/acuity.h"
#include "acquire/cli/options.h"

#include <placido/simulate.h>

struct view {
  char directory[32]; /* pupil-4mm */
  placido_eye eye;                /* with what was searched */
  placido_psf psf;
  double seconds;                 /* that the PSF took */
  placido_focus_curve focus;      /* count 0: it was not asked for */
  struct acuity_view acuity;
  placido_image seen[LIST_MAX];   /* by scene, encoded as sRGB; no data: it could not be shown */
};

struct views {
  size_t scene_count;
  placido_scene scenes[LIST_MAX];
  char stems[LIST_MAX][80]; /* the scenes' names as file names */
  size_t count;
  struct view items[LIST_MAX];
};

/* Prints the generated charts, for the help. */
void views_list_charts(void);

void views_free(struct views *views);

#endif

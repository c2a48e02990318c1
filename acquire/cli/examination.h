/* One examination from its input to its directory: everything that is known about it, and the
 * steps that come to know it. Commands are lists of these steps. */
#ifndef PLACIDO_CLI_EXAMINATION_H
#define PLACIDO_CLI_EXAMINATION_H

#include "acquire/acquire.h"
#include "acquire/cli/combination.h"
#include "acquire/cli/command.h"
#include "acquire/cli/condition.h"
#include "acquire/cli/promise.h"
#include "acquire/cli/views.h"
#include "acquire/cli/wavefront.h"
#include "base/file.h"

#include <placido/device.h>
#include <placido/elevation.h>
#include <placido/index.h>
#include <placido/instrument.h>
#include <placido/map.h>
#include <placido/mires.h>
#include <placido/reconstruct.h>
#include <placido/uncertainty.h>

struct recipe;

/* Zeroed at first; each step fills its part. */
struct examination {
  const struct recipe *recipe;
  const struct settings *settings; /* with what step_promise chose */
  struct outcome *outcome;
  int threads;
  char created[32];
  placido_directory directory;
  struct promise promise; /* step_promise, step_begin, step_outcome */

  /* step_capture */
  placido_device_info source;
  placido_instrument instrument;
  placido_uncertainty geometry; /* the instrument's; without modes where nothing is known of it */
  double axis_z_mm, axis_z_sigma_mm;
  placido_choice choice;
  placido_frame frame; /* no data: there was no capture */
  struct combination combination; /* of several frames; step_mires fills the rest */

  /* step_heights, step_heights_fit: in place of a capture */
  placido_elevation elevation;
  placido_heights_summary heights;

  /* step_mires, step_fit, step_maps */
  placido_mires mires;
  placido_fit *fit;
  placido_surface *loaded;        /* step_surface */
  const placido_surface *surface; /* borrowed from fit, or `loaded` */
  placido_maps maps;
  placido_index_value indices[PLACIDO_INDICES_MAX];
  size_t index_count;

  /* step_wavefront */
  struct wavefronts wavefronts;

  /* step_scenes, step_see */
  struct views views;

  /* step_condition */
  struct conditions conditions;
};

typedef int examination_step(struct examination *examination, placido_error *err);

/* What a command does and how its result is marked. */
struct recipe {
  const char *format; /* of the marker file */
  const char *marker; /* a directory with this file in it may be replaced by a new result */
  examination_step *const *steps; /* NULL-terminated */
};

examination_step step_promise; /* settings for the accuracy or time that is asked for */
examination_step step_begin;   /* the promised time begins */
examination_step step_outcome; /* and ends: what came out */
examination_step step_capture; /* device, instrument, distance, best frame */
examination_step step_surface; /* the surface file named as input, in place of a capture */
examination_step step_mires;
examination_step step_fit;
examination_step step_heights; /* others' heights, in place of a capture */
examination_step step_heights_fit;
examination_step step_maps;   /* maps and indices */
examination_step step_wavefront;
examination_step step_scenes; /* reads what is looked at, before any work */
examination_step step_see;    /* point spread functions, plans and scenes of every pupil */
examination_step step_acuity; /* of every pupil that step_see has seen through */
examination_step step_condition; /* how all that is found answers to errors of what goes in */
examination_step step_save;   /* every file of the directory */

/* Refuses an output that cannot be written, runs the recipe's steps and puts the directory in its
 * place, or leaves nothing behind. */
int examination_run(const struct recipe *recipe, const struct settings *settings,
                    struct outcome *outcome, placido_error *err);

/* Millimetres on the cornea of a pixel of the capture, at the apex. */
double examination_mm_per_px(const struct examination *examination);

#endif

/* What a person may set: one struct for every command, filled from option tables. */
#ifndef PLACIDO_CLI_SETTINGS_H
#define PLACIDO_CLI_SETTINGS_H

#include "acquire/cli/accuracy_settings.h"
#include "acquire/cli/acuity.h"
#include "acquire/cli/exchange_settings.h"
#include "acquire/cli/eye_settings.h"
#include "acquire/cli/map_settings.h"
#include "acquire/cli/options.h"
#include "acquire/cli/plan_settings.h"
#include "acquire/cli/ray_settings.h"
#include "acquire/cli/spread_settings.h"
#include "acquire/cli/take_settings.h"

#include <placido/phantom.h>
#include <placido/simulate.h>

/* A value with its standard deviation; `given` where it stood on the command line. */
struct distance {
  bool given;
  double value_mm, sigma_mm;
};

struct settings {
  const char *verb;   /* what is to be done, where a command can do several things */
  const char *input;  /* INPUT, SURFACE or COMMAND */
  struct text_list more; /* words behind it */
  const char *output; /* -o */
  bool help, json, quiet, timing;
  int threads; /* 0: as many as the machine has */

  /* measuring */
  const char *instrument;
  struct distance axis_z;
  int frame;   /* -1: the best */
  int combine; /* so many frames; 0 and 1: no more than the best */
  double knot_mm, fit_tolerance, filter_px;
  int degree, meridians;
  struct accuracy_settings accuracy;

  struct map_settings maps;
  struct compare_settings compare;

  /* seeing */
  struct number_list pupils_mm; /* PUPIL_AUTO among them: what the luminance gives */
  struct text_list scenes;
  bool allow_coarse;
  double index, bucket_arcmin, retina_mm;
  int samples;
  bool cwhatuc;
  struct ray_settings rays;
  struct acuity_wish acuity;
  int trials;
  struct eye_settings behind; /* the cornea */
  struct spread_settings spread;
  struct plan_settings plan;

  /* the corneal wavefront */
  struct number_list wavefront_mm, wavefront_centre_mm; /* pupils; x and y */
  double wavefront_index; /* 0: `index` */
  int wavefront_order;

  /* phantom */
  const char *eye, *side;
  int frames;
  struct number_list motion, shift_mm;
  placido_disturbance disturbance;

  /* sessions */
  const char *frame_list, *picture_type;

  /* balls */
  double ball_mm, limit_D;
  const char *log;

  /* the accuracy test */
  struct text_list iso_images, iso_objects; /* in pairs; an object is a radius or a file */
  const char *iso_list;
  struct number_list iso_axis_z_mm;

  /* devices */
  bool watch, window, topography;

  /* benchmarks */
  bool quick;

  /* studies */
  const char *study_scenes, *study_eyes; /* names between commas; NULL: the default */

  /* recording */
  struct take_settings take;

  /* others' data */
  struct exchange_settings exchange;

  /* simulated devices */
  const char *face, *serial, *listen, *faults;
  double rate_hz, for_s; /* 0: as the view has it; for ever */
  int pictures;
  bool zip, high_speed;
};

/* The option tables, in the order in which help shows them. */
extern const struct option_group options_general, options_measuring, options_seeing, options_wavefront,
    options_directory, options_phantom, options_devices, options_simulated,
    options_session,
    options_calibrate, options_verify;

/* In accuracy_settings.c: of what measures and sees, measures, sees. */
extern const struct option_group options_accuracy, options_accuracy_measuring,
    options_accuracy_seeing;

/* In eye_settings.c. */
extern const struct option_group options_eye;

/* In exchange_settings.c. */
extern const struct option_group options_import, options_export;

/* In map_settings.c. */
extern const struct option_group options_maps, options_compare;

/* In take_settings.c. */
extern const struct option_group options_take, options_burst;

/* In iso_settings.c. */
extern const struct option_group options_iso;

/* In plan_settings.c, and in plan.c. */
extern const struct option_group options_effects, options_plan;

/* In study_settings.c. */
extern const struct option_group options_study;

/* "Z" or "Z,SIGMA" into a struct distance; without SIGMA it counts as exactly known. */
int parse_distance(void *field, const struct option_row *row, const char *text,
                   placido_error *err);

/* What holds before the command line is read. */
struct settings settings_default(void);

/* Sets how many threads the libraries may use, and returns that number. */
int settings_use_threads(const struct settings *settings);

#endif

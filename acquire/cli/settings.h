/* What a person may set: one struct for every command, filled from option tables. */
#ifndef PLACIDO_CLI_SETTINGS_H
#define PLACIDO_CLI_SETTINGS_H

#include "acquire/cli/options.h"
#include "acquire/cli/take_settings.h"

#include <placido/phantom.h>
#include <placido/simulate.h>

/* A value with its standard deviation; `given` where it stood on the command line. */
struct distance {
  bool given;
  double value_mm, sigma_mm;
};

struct lens {
  bool given;
  placido_correction power;
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
  double knot_mm;
  int meridians;

  /* seeing */
  struct number_list pupils_mm;
  struct text_list scenes;
  double index, bucket_arcmin, retina_mm;
  int samples;
  bool cwhatuc;
  struct lens correction;

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

  /* devices */
  bool watch, window;

  /* benchmarks */
  bool quick;

  /* recording */
  struct take_settings take;

  /* simulated devices */
  const char *face, *serial, *listen, *faults;
  double rate_hz, for_s; /* 0: as the view has it; for ever */
  int pictures;
  bool zip, high_speed;
};

/* The option tables, in the order in which help shows them. */
extern const struct option_group options_general, options_measuring, options_seeing, options_eye,
    options_directory, options_phantom, options_devices, options_simulated,
    options_session,
    options_calibrate, options_verify;

/* In take_settings.c. */
extern const struct option_group options_take, options_burst;

/* "Z" or "Z,SIGMA" into a struct distance; without SIGMA it counts as exactly known. */
int parse_distance(void *field, const struct option_row *row, const char *text,
                   placido_error *err);

/* What holds before the command line is read. */
struct settings settings_default(void);

/* Sets how many threads the libraries may use, and returns that number. */
int settings_use_threads(const struct settings *settings);

#endif

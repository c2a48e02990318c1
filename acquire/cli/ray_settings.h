/* What a person may set about the rays: how they fill the pupil, how light becomes numbers. */
#ifndef PLACIDO_CLI_RAY_SETTINGS_H
#define PLACIDO_CLI_RAY_SETTINGS_H

#include "acquire/cli/options.h"

#include <placido/psf.h>

struct settings;

struct ray_settings {
  enum placido_pattern_kind pattern;
  enum placido_light_kind light;
  double grow; /* 0: the default */
  double wavelength_nm; /* of diffraction; 0: rays */
  double through_focus_D; /* how far a curve goes either way; 0: none */
};

int parse_pattern(void *field, const struct option_row *row, const char *text,
                  placido_error *err);
int parse_light(void *field, const struct option_row *row, const char *text, placido_error *err);

/* A pattern's and a way of counting's name, as on the command line. */
const char *ray_pattern_name(enum placido_pattern_kind pattern);
const char *ray_light_name(enum placido_light_kind light);

/* The optics that are asked for. */
placido_optics ray_settings_read(const struct settings *settings, int threads);

#endif

/* What a person may set about effects: which are forced, how large an error may be, what of the eye
 * only effects ask for. */
#ifndef PLACIDO_CLI_PLAN_SETTINGS_H
#define PLACIDO_CLI_PLAN_SETTINGS_H

#include "acquire/cli/options.h"

#include <placido/plan.h>

struct settings;

struct plan_settings {
  double tolerance; /* 0: the scene's */
  enum placido_force force[PLACIDO_EFFECTS_MAX];
  double age_years; /* 0: the default */
  enum placido_iris iris;
  struct number_list pupils_mm; /* of `placido plan`; none: auto */
};

/* Millimetres or "auto" between commas into a struct number_list; PUPIL_AUTO stands for "auto". */
#define PUPIL_AUTO 0.0
int parse_pupils(void *field, const struct option_row *row, const char *text, placido_error *err);

const char *plan_iris_name(enum placido_iris iris);

/* Refuses what contradicts itself, with STATUS_USAGE. */
int plan_settings_check(const struct settings *settings, placido_error *err);

/* Refuses --pupils auto for a scene of which no luminance is known, with STATUS_USAGE. */
int plan_settings_check_scene(const struct number_list *pupils, const placido_scene *scene,
                              placido_error *err);

placido_plan_wish plan_settings_read(const struct settings *settings, int threads);

/* The largest error that pictures of this scene may have. */
double plan_settings_tolerance(const struct settings *settings, const placido_scene *scene);

/* Prints the effects of this build, for the help. */
void plan_list_effects(void);

#endif

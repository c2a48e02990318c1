/* What an examination promises of accuracy and time before it begins, and what comes out. */
#ifndef PLACIDO_CLI_PROMISE_H
#define PLACIDO_CLI_PROMISE_H

#include "acquire/cli/accuracy/choose.h"
#include "acquire/cli/settings.h"

#include <jansson.h>
#include <placido/eye.h>
#include <placido/plan.h>
#include <placido/reconstruct.h>

struct examination;

struct promise {
  bool made;                     /* something was asked that the table had to answer */
  bool kept_in_table;            /* the table answered: `choice` holds */
  struct settings settings;      /* as they are with what was chosen */
  struct accuracy_choice choice; /* its time is without that of the scenes */
  char created[32], machine[96]; /* of the table */
  bool built_in;                 /* the table is the program's own */
  double table_probe_ms, probe_ms;

  /* while it runs */
  double began_ms, wall_began_ms; /* processor time and clock */
  double pupil_ms;                /* of each pupil still to come: focus and rays */
  double further_ms; /* after the scenes: rays through draws of the surface, condition numbers */
  size_t pupils_left, sights_left;
  double scenes_ms;               /* promised for those that were planned so far */
  bool late;                      /* some scene takes longer than there is time */

  /* what came out */
  double found_ms, found_wall_ms;
  double sigma_um, by_um[PLACIDO_SIGMA_SOURCES]; /* the fit's own error bars, rms over 6 mm */
};

/* The whole run's time that is promised, scenes and all. */
double promise_time_ms(const struct promise *promise);

/* What of the promise goes beside the fit's error bars: a limit on elevation that these alone
 * exceed is not kept. */
bool promise_error_kept(const struct promise *promise);

/* A plan of a scene: as is; or, where the time is limited, with the finest tolerance whose run fits
 * into what is left for it. Errors as placido_plan_new. */
int promise_plan(placido_plan **plan, struct examination *examination, size_t scene,
                 const placido_eye *eye, placido_error *err);

/* A pupil's point spread function was made. */
void promise_pupil_done(struct promise *promise);

/* For exam.json; NULL when memory is out. */
json_t *promise_json(const struct examination *examination);

/* The promised error; NaN where the table or the command does not tell. */
double promise_error(const struct examination *examination, enum accuracy_error error);

/* A sentence each: what was chosen, and by which table. */
void promise_describe(char *settings, char *by, size_t size, const struct promise *promise);

/* A few lines on stdout. */
void promise_print(const struct examination *examination);

#endif

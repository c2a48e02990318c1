/* `placido study`: its parts. */
#ifndef PLACIDO_CLI_STUDY_H
#define PLACIDO_CLI_STUDY_H

#include "acquire/cli/command.h"
#include "acquire/cli/views.h"
#include "base/file.h"
#include "report/study.h"

#include <placido/surface.h>

#define STUDY_EYES_MAX 512

/* Everything about one study. `page` describes what the other fields own. */
struct study {
  const struct settings *settings;
  struct outcome *outcome;
  char created[32], test[96];
  placido_study page;
  placido_study_eye *eyes;
  placido_surface **surfaces; /* one an eye; NULL where it failed */
  size_t eye_count, failed;
  placido_study_cell *cells;  /* of all eyes, pupil by pupil */
  placido_notes *cell_notes;  /* one a cell */
  placido_scene scenes[PLACIDO_STUDY_SCENES_MAX];
  char stems[PLACIDO_STUDY_SCENES_MAX][80];
  size_t scene_count;
  placido_observer *observer;
  placido_directory directory;
};

/* An eye more, named `name` or, where that is taken, with a number behind. */
int study_add(placido_study_eye **eye, struct study *study, const char *name, placido_error *err);

/* The phantom's eyes of the study, or those that --eyes names. */
int study_list_built_in(struct study *study, placido_error *err);

/* The surfaces of a folder, in the order of their names; of an exam its surface.json, of a folder
 * of exams each one's. Files of the project's other formats are passed over. One that cannot be
 * read is listed with its failure. */
int study_list_folder(struct study *study, const char *folder, placido_error *err);

/* Reads the scenes, before any work. */
int study_read_scenes(struct study *study, placido_error *err);

/* Whether `name` stands in a list of names between commas. */
bool study_is_listed(const char *list, const char *name);

/* What is said of the surface itself; writes its map. */
int study_examine_eye(struct study *study, size_t eye, placido_error *err);

/* One eye through one pupil: point spread function, acuity, ghosts and pictures. Cells may be worked
 * on at once. */
int study_examine_cell(struct study *study, size_t eye, size_t pupil, placido_error *err);

/* Holds the built-in eyes against what the seed found. */
void study_find(placido_study *page);

/* Writes study.csv and study.json (docs/formats.md). */
int study_save_csv(const placido_study *page, const char *path, placido_error *err);
/* The same object, a new reference; NULL when memory is out. */
json_t *study_json(const placido_study *page);
int study_save_json(const placido_study *page, const char *path, placido_error *err);

/* In study_figures.c, or where the build cannot draw study_figures_none.c: pictures and page. */
int study_draw_map(const struct study *study, size_t eye, const char *path, placido_error *err);
int study_draw_psf(const placido_psf *psf, const char *folder, placido_error *err);
int study_draw_page(struct study *study, placido_error *err);

#endif

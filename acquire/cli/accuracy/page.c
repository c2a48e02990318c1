/* What is drawn of an accuracy table: a figure for every stage and error that people ask of it. */
#include "acquire/cli/accuracy/page.h"

#include "acquire/cli/accuracy/sentences.h"
#include "acquire/cli/command.h"
#include "base/file.h"
#include "base/memory.h"
#include "report/pareto.h"

#include <math.h>
#include <stdio.h>

#define NAME_SIZE 64
#define SETTING_SIZE 160

static const struct plot {
  enum accuracy_stage stage;
  enum accuracy_error error;
  const char *title;
} plots[] = {
    {ACCURACY_EXAM, ACCURACY_ELEVATION_UM, "Whole examination: the surface"},
    {ACCURACY_EXAM, ACCURACY_PSF_OTF, "Whole examination: the point spread function"},
    {ACCURACY_MIRES, ACCURACY_ELEVATION_UM, "Detection of the mires"},
    {ACCURACY_FIT, ACCURACY_ELEVATION_UM, "Fit of the surface"},
    {ACCURACY_FIT, ACCURACY_PSF_OTF, "Fit of the surface, as the point spread function sees it"},
    {ACCURACY_TRACE, ACCURACY_PSF_OTF, "Trace of the rays"},
    {ACCURACY_PSF, ACCURACY_PSF_OTF, "Point spread function in white light"},
    {ACCURACY_CONVOLUTION, ACCURACY_IMAGE, "Convolution of the scene"},
    {ACCURACY_ACUITY, ACCURACY_LOGMAR, "Acuity"},
};
enum { PLOTS = sizeof plots / sizeof *plots };

static const char *const error_names[ACCURACY_ERRORS] = {
    [ACCURACY_ELEVATION_UM] = "error of elevation, µm rms over 6 mm",
    [ACCURACY_AXIAL_D] = "error of axial power, D rms over 6 mm",
    [ACCURACY_PSF_OTF] = "largest error of the transfer function up to 60 cycles per degree",
    [ACCURACY_IMAGE] = "largest error of the seen chart, relative to white",
    [ACCURACY_LOGMAR] = "error of acuity, logMAR"};

/* A plot's points with the texts that they show. */
struct drawn {
  placido_pareto_point points[PLACIDO_PARETO_POINTS_MAX];
  char settings[PLACIDO_PARETO_POINTS_MAX][SETTING_SIZE];
  char picture[NAME_SIZE];
};

static void take(placido_pareto_section *section, struct drawn *drawn, const struct plot *plot,
                 const struct accuracy_table *table) {
  struct accuracy_point points[PLACIDO_PARETO_POINTS_MAX];
  size_t count =
      accuracy_points_find(points, PLACIDO_PARETO_POINTS_MAX, table, plot->stage, plot->error);
  for (size_t i = 0; i < count; i++) {
    accuracy_setting_say(drawn->settings[i], SETTING_SIZE, points[i].setting);
    drawn->points[i] =
        (placido_pareto_point){points[i].ms, points[i].error, drawn->settings[i]};
  }
  section->pareto = (placido_pareto){.title = plot->title,
                                     .error_name = error_names[plot->error],
                                     .floor = accuracy_floor_find(table, plot->error),
                                     .count = count,
                                     .points = drawn->points};
}

static int draw(const placido_pareto *pareto, const char *folder, const char *name,
                placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, name, err);
  return status == PLACIDO_OK ? placido_figure_pareto(pareto, path, err) : status;
}

static int draw_both(placido_pareto_section *section, struct drawn *drawn,
                     const struct plot *plot, const char *folder, placido_error *err) {
  char vector[NAME_SIZE];
  const char *stage = accuracy_stage_names[plot->stage];
  const char *error = accuracy_error_names[plot->error];
  snprintf(drawn->picture, NAME_SIZE, "accuracy-%s-%s.png", stage, error);
  snprintf(vector, sizeof vector, "accuracy-%s-%s.svg", stage, error);
  section->picture = drawn->picture;
  int status = draw(&section->pareto, folder, drawn->picture, err);
  return status == PLACIDO_OK ? draw(&section->pareto, folder, vector, err) : status;
}

/* A stage's sentences stand at its first plot. */
static void take_sentences(placido_pareto_section *section, size_t plot,
                           const struct accuracy_sentences *sentences) {
  bool first = plot == 0 || plots[plot - 1].stage != plots[plot].stage;
  for (size_t i = 0; i < sentences->count && first; i++) {
    if (sentences->items[i].stage == plots[plot].stage &&
        section->sentence_count < PLACIDO_PARETO_SENTENCES_MAX) {
      section->sentences[section->sentence_count++] = sentences->items[i].text;
    }
  }
}

static int write_all(const struct accuracy_table *table, struct drawn *drawn, const char *folder,
                     placido_error *err) {
  placido_pareto_section sections[PLOTS] = {0};
  struct accuracy_sentences sentences;
  size_t count = 0;
  int status = PLACIDO_OK;
  accuracy_sentences_find(&sentences, table);
  for (size_t i = 0; i < PLOTS && status == PLACIDO_OK; i++) {
    placido_pareto_section *section = &sections[count];
    take(section, &drawn[i], &plots[i], table);
    if (section->pareto.count > 0) {
      take_sentences(section, i, &sentences);
      status = draw_both(section, &drawn[i], &plots[i], folder, err);
      count++;
    }
  }
  const placido_pareto_page page = {.machine = table->machine,
                                    .created = table->created,
                                    .software = PROGRAM_VERSION,
                                    .probe_ms = table->probe_ms,
                                    .sections = sections,
                                    .count = count};
  return status == PLACIDO_OK ? placido_report_pareto_write(&page, folder, err) : status;
}

int accuracy_page_write(const struct accuracy_table *table, const char *folder,
                        placido_error *err) {
  struct drawn *drawn = placido_memory_new(PLOTS, sizeof *drawn, err);
  int status = drawn ? write_all(table, drawn, folder, err) : PLACIDO_MEMORY;
  placido_memory_free(drawn);
  return status;
}

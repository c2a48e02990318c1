/* Runs the steps of a recipe around a directory that appears whole or not at all. */
#include "acquire/cli/examination.h"

#include "acquire/cli/place.h"
#include "acquire/cli/record.h"
#include "base/memory.h"

#include <time.h>

static void note_time(char created[32]) {
  const time_t now = time(NULL);
  struct tm utc;
  if (!gmtime_r(&now, &utc) || strftime(created, 32, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    created[0] = '\0';
  }
}

static int run_steps(struct examination *examination, placido_error *err) {
  for (examination_step *const *step = examination->recipe->steps; *step; step++) {
    const int status = (*step)(examination, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  interrupt_hold(examination->outcome->interrupt);
  const int status = placido_directory_commit(&examination->directory, err);
  interrupt_release(examination->outcome->interrupt, &examination->directory);
  return status;
}

static int make_place(struct examination *examination, placido_error *err) {
  const char *path = examination->settings->output, *marker = examination->recipe->marker;
  int status = place_check(path, marker, err);
  if (status == PLACIDO_OK) {
    interrupt_hold(examination->outcome->interrupt);
    status = placido_directory_create(&examination->directory, path, marker, err);
    interrupt_release(examination->outcome->interrupt, &examination->directory);
  }
  return status;
}

static void examination_free(struct examination *examination) {
  placido_directory_discard(&examination->directory);
  views_free(&examination->views);
  wavefronts_free(&examination->wavefronts);
  placido_maps_free(&examination->maps);
  placido_surface_free(examination->loaded);
  placido_fit_free(examination->fit);
  placido_elevation_free(&examination->elevation);
  placido_mires_free(&examination->mires);
  placido_frame_free(&examination->frame);
  combination_free(&examination->combination);
  placido_uncertainty_free(&examination->geometry);
  placido_memory_free(examination);
}

int examination_run(const struct recipe *recipe, const struct settings *settings,
                    struct outcome *outcome, placido_error *err) {
  struct examination *examination = placido_memory_new(1, sizeof *examination, err);
  if (!examination) {
    return PLACIDO_MEMORY;
  }
  examination->recipe = recipe;
  examination->settings = settings;
  examination->outcome = outcome;
  examination->threads = settings_use_threads(settings);
  note_time(examination->created);
  int status = make_place(examination, err);
  if (status == PLACIDO_OK) {
    status = run_steps(examination, err);
  }
  stages_end(&outcome->stages);
  if (status == PLACIDO_OK) {
    outcome->result = record_result(examination);
    summary_print(examination);
  }
  examination_free(examination);
  return status;
}

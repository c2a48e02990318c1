/* What no knob changes, part by part: only its time. */
#include "acquire/cli/accuracy/stage.h"
#include "acquire/cli/settings.h"
#include "acquire/cli/wavefront.h"
#include "base/memory.h"
#include "simulate/psf/settle.h"

#include <placido/index.h>
#include <placido/map.h>

#include <string.h>

#define MAP_STEP_MM 0.1 /* as an examination's */

struct prepared {
  placido_mires mires;
  placido_fit *fit;
};

static int find_maps(const struct accuracy_trial *trial, const struct prepared *from,
                     placido_error *err) {
  placido_maps maps = {0};
  (void)trial;
  const int status =
      placido_maps_new(&maps, placido_fit_surface(from->fit), from->fit, MAP_STEP_MM, err);
  placido_maps_free(&maps);
  return status;
}

static int find_indices(const struct accuracy_trial *trial, const struct prepared *from,
                        placido_error *err) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count = 0;
  (void)trial;
  return placido_indices_find(values, &count, placido_fit_surface(from->fit), from->fit, err);
}

static int find_rings(const struct accuracy_trial *trial, const struct prepared *from,
                      placido_error *err) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count = 0;
  return placido_indices_of_mires(values, &count, from->fit, &from->mires,
                                  &trial->eye->instrument, err);
}

static int find_wavefronts(const struct accuracy_trial *trial, const struct prepared *from,
                           placido_error *err) {
  struct wavefronts *wavefronts = placido_memory_new(1, sizeof *wavefronts, err);
  if (!wavefronts) {
    return PLACIDO_MEMORY;
  }
  const int status = wavefronts_find(wavefronts, placido_fit_surface(from->fit), from->fit,
                                     trial->bench->settings, NULL, err);
  wavefronts_free(wavefronts);
  placido_memory_free(wavefronts);
  return status;
}

static int find_focus(const struct accuracy_trial *trial, const struct prepared *from,
                      placido_error *err) {
  const placido_eye eye = {.pupil_mm = ACCURACY_PUPIL_MM, .correct = PLACIDO_CORRECT_FULL};
  placido_eye found;
  double fixation_mm[2];
  (void)trial;
  return placido_psf_settle(&found, fixation_mm, placido_fit_surface(from->fit), &eye, NULL, err);
}

static const struct {
  const char *setting;
  int (*find)(const struct accuracy_trial *trial, const struct prepared *from,
              placido_error *err);
} parts[] = {
    {"part=maps", find_maps},
    {"part=indices", find_indices},
    {"part=rings", find_rings},
    {"part=wavefront", find_wavefronts},
    {"part=focus", find_focus},
};
static const char *const settings[] = {"part=maps",      "part=indices", "part=rings",
                                       "part=wavefront", "part=focus",   NULL};

static void release(void *state) {
  struct prepared *prepared = state;
  if (prepared) {
    placido_fit_free(prepared->fit);
    placido_mires_free(&prepared->mires);
    placido_memory_free(prepared);
  }
}

/* Of the surface that an examination usually finds. */
static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  const struct accuracy_knobs usual = {.meridians = 0};
  struct prepared *prepared = *state = placido_memory_new(1, sizeof *prepared, err);
  (void)bench;
  int status = prepared ? accuracy_eye_mires(&prepared->mires, eye, &usual, err) : PLACIDO_MEMORY;
  if (status == PLACIDO_OK) {
    status = accuracy_eye_fit(&prepared->fit, &prepared->mires, eye, &usual, err);
  }
  return status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  struct accuracy_watch watch = {0};
  size_t part = 0;
  int status;
  while (strcmp(parts[part].setting, trial->setting) != 0) {
    part++;
  }
  do {
    accuracy_watch_begin(&watch);
    status = parts[part].find(trial, trial->prepared, err);
    accuracy_watch_end(&watch);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, trial->bench));
  row->ms = watch.least_ms;
  return status;
}

const struct accuracy_measure accuracy_measure_rest = {.stage = ACCURACY_REST,
                                                       .settings = settings,
                                                       .quick = settings,
                                                       .words = true,
                                                       .prepare = prepare,
                                                       .run = run,
                                                       .release = release};

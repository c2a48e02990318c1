/* `placido import`: another topographer's heights as a surface, with maps and indices. */
#include "acquire/cli/examination.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FAR_SIGMAS 10.0 /* a point this far off is worth a word */

int step_heights(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "read");
  const struct settings *settings = examination->settings;
  if (settings->exchange.eye) {
    snprintf(examination->source.eye, sizeof examination->source.eye, "%s",
             settings->exchange.eye);
  }
  return placido_elevation_load(&examination->elevation, settings->input,
                                &settings->exchange.reading, &examination->outcome->notes, err);
}

static void note_far_point(struct examination *examination) {
  const placido_heights_summary *fitted = &examination->heights;
  if (fabs(fitted->worst_um) > FAR_SIGMAS * fitted->sigma_um) {
    const placido_height *point = &examination->elevation.heights[fitted->worst];
    placido_notes_add(&examination->outcome->notes,
                      "the point (%.3f, %.3f) mm of line %d lies %.2f um off the fitted surface, "
                      "which follows the points to %.3f um rms",
                      point->x_mm, point->y_mm, examination->elevation.lines[fitted->worst],
                      fitted->worst_um, fitted->rms_um);
  }
}

int step_heights_fit(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "fit");
  placido_error reason = {0};
  const int status =
      placido_heights_fit(&examination->fit, &examination->heights,
                          examination->elevation.heights, examination->elevation.count,
                          examination->settings->knot_mm, &reason);
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "%s: %s",
                             placido_text_tail(examination->settings->input), reason.text);
  }
  examination->surface = placido_fit_surface(examination->fit);
  note_far_point(examination);
  return PLACIDO_OK;
}

/* What the file's rings give beside heights. */
static int step_rings(struct examination *examination, placido_error *err) {
  return placido_elevation_indices(examination->indices, &examination->index_count,
                                   &examination->elevation, examination->fit, err);
}

static examination_step *const steps[] = {step_heights, step_heights_fit, step_maps, step_rings,
                                          step_wavefront, step_condition, step_save, NULL};

static const struct recipe recipe = {
    .format = "placido-import/1", .marker = "import.json", .steps = steps};

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  return examination_run(&recipe, settings, outcome, err);
}

static const struct option_group *const groups[] = {&options_import, &options_wavefront,
                                                    &options_general, NULL};

const struct command command_import = {
    .name = "import",
    .summary = "Take another topographer's heights: surface, maps, indices.",
    .usage = "FILE -o DIR [OPTION...]",
    .examples = "  placido import N01.txt -o cornea\n"
                "      a CSO topographer's export\n"
                "  placido import heights.csv --unit mm,um --heights down -o cornea\n"
                "      a table of x, y and depth\n"
                "  placido import exam/maps.csv -o again\n",
    .groups = groups,
    .needs_word = "FILE (a CSO export or a table of x, y and z)",
    .needs_output = true,
    .run = run,
};

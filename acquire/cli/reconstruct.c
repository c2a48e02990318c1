/* `placido reconstruct`: from a session or an image to surface, maps and indices. */
#include "acquire/cli/examination.h"

static examination_step *const steps[] = {
    step_promise, step_capture,   step_begin,   step_mires, step_fit,
    step_maps,    step_wavefront, step_condition, step_outcome, step_save, NULL};

static const struct recipe recipe = {
    .format = "placido-reconstruction/1", .marker = "reconstruction.json", .steps = steps};

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  return examination_run(&recipe, settings, outcome, err);
}

static const struct option_group *const groups[] = {
    &options_directory, &options_accuracy_measuring, &options_measuring, &options_maps,
    &options_wavefront, &options_general, NULL};

const struct command command_reconstruct = {
    .name = "reconstruct",
    .summary = "Measure the cornea only: mires, surface, maps, indices, wavefront.",
    .usage = "INPUT -o DIR [OPTION...]",
    .examples = "  placido reconstruct eye.session -o cornea\n"
                "  placido reconstruct eye.png --instrument cone.json --axis-z 0 -o cornea\n"
                "      --axis-z without a standard deviation: the distance is known exactly\n",
    .groups = groups,
    .needs_word = "INPUT (a session, an image or a device's URI)",
    .needs_output = true,
    .run = run,
};

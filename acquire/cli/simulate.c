/* `placido simulate`: what an eye with a given surface sees. */
#include "acquire/cli/examination.h"

static examination_step *const steps[] = {step_scenes, step_surface, step_see, step_save, NULL};

static const struct recipe recipe = {
    .format = "placido-simulation/1", .marker = "simulation.json", .steps = steps};

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  return examination_run(&recipe, settings, outcome, err);
}

static const struct option_group *const groups[] = {&options_directory, &options_seeing,
                                                    &options_eye, &options_general, NULL};

const struct command command_simulate = {
    .name = "simulate",
    .summary = "Simulate what an eye with a given corneal surface sees.",
    .usage = "SURFACE.json -o DIR [OPTION...]",
    .examples =
        "  placido simulate exam/surface.json --pupils 2,4,8 -o seen\n"
        "  placido simulate eye.json --pupils 4 --correction 0,0,0 -o seen\n"
        "      without a lens: only the retina's distance is searched\n"
        "  placido simulate eye.json --pupils 6 --retina 24 --correction -2.5,-0.75,90 -o seen\n"
        "      nothing is searched\n",
    .groups = groups,
    .list = views_list_charts,
    .needs_word = "SURFACE.json (placido-surface/1)",
    .needs_output = true,
    .run = run,
};

/* `placido simulate`: what an eye with a given surface sees. */
#include "acquire/cli/examination.h"

static examination_step *const steps[] = {step_promise, step_scenes, step_surface, step_begin, step_see,
                                          step_acuity,  step_outcome, step_save, NULL};

static const struct recipe recipe = {
    .format = "placido-simulation/1", .marker = "simulation.json", .steps = steps};

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  return examination_run(&recipe, settings, outcome, err);
}

static const struct option_group *const groups[] = {&options_directory, &options_accuracy_seeing, &options_seeing,
                                                    &options_effects, &options_eye,
                                                    &options_general, NULL};

const struct command command_simulate = {
    .name = "simulate",
    .summary = "Simulate what an eye with a given corneal surface sees.",
    .usage = "SURFACE.json -o DIR [OPTION...]",
    .examples =
        "  placido simulate exam/surface.json --pupils 2,4,8 -o seen\n"
        "  placido simulate eye.json --pupils 4 --correct sphere -o seen\n"
        "      without a cylinder: only the retina's distance is searched\n"
        "  placido simulate eye.json --axial-length 25.1 -o seen\n"
        "      the lens that this eye of known length needs\n"
        "  placido simulate eye.json --axial-length 25.1 --correct none -o seen\n"
        "      and what it sees without one\n"
        "  placido simulate eye.json --axial-length 25.1 --wear \"-2.5 -0.75 90 @12\" -o seen\n"
        "      and with these spectacles: nothing is searched\n"
        "  placido simulate eye.json --scene street --pupils auto --age 70 --iris blue -o seen\n"
        "      through the pupil that the street's light gives at 70\n",
    .groups = groups,
    .list = views_list_charts,
    .needs_word = "SURFACE.json (placido-surface/1)",
    .needs_output = true,
    .run = run,
};

/* `placido exam`: from a session or an image to surface, maps, simulated vision and a report. */
#include "acquire/cli/examination.h"

static examination_step *const steps[] = {
    step_promise, step_scenes,    step_capture, step_begin,  step_mires,   step_fit,
    step_maps,    step_wavefront, step_see,     step_acuity, step_condition, step_outcome,
    step_save,    NULL};

static const struct recipe recipe = {
    .format = "placido-exam/1", .marker = "exam.json", .steps = steps};

/* Who reads an examination counts on 257 buckets a side; growing must be asked for. */
static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct settings exam = *settings;
  if (exam.rays.grow == 0) {
    exam.rays.grow = 1;
  }
  return examination_run(&recipe, &exam, outcome, err);
}

static const struct option_group *const groups[] = {
    &options_directory, &options_accuracy, &options_measuring, &options_maps, &options_wavefront, &options_seeing,
    &options_effects, &options_eye, &options_general, NULL};

const struct command command_exam = {
    .name = "exam",
    .summary = "Examine a recorded session or an image: surface, maps, vision, report.",
    .usage = "INPUT -o DIR [OPTION...]",
    .examples =
        "  placido exam eye.session -o exam\n"
        "      the best frame of a session; the result is in exam/report.html\n"
        "  placido exam eye.session --combine 5 -o exam\n"
        "      the five best frames made into one with less noise\n"
        "  placido exam eye.png --instrument cone.json --axis-z 0.02,0.03 -o exam\n"
        "      an image; the cornea was measured 0.02 mm before its nominal place, to 0.03 mm\n"
        "  placido exam eye.session --pupils 3,6 --scene tumbling-e --scene street.json -o exam\n"
        "      what the eye sees through pupils of 3 and 6 mm, of a chart and of a photograph\n",
    .groups = groups,
    .list = views_list_charts,
    .needs_word = "INPUT (a session, an image or a device's URI)",
    .needs_output = true,
    .run = run,
};

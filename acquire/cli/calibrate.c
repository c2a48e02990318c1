/* `placido calibrate`: the instrument's geometry from pictures of balls. */
#include "acquire/cli/ball.h"
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>

#define POWER_LIMIT_D 0.1 /* as of the daily check, placido verify */

struct work {
  const struct settings *settings;
  struct outcome *outcome;
  placido_calibration_plan plan;
  placido_instrument nominal;
  placido_uncertainty prior;
  placido_calibration calibration;
  placido_directory directory;
};

/* The instrument to start from, and what is known of it. */
static int read_nominal(struct work *w, placido_error *err) {
  const char *path = w->plan.instrument_path;
  int status = placido_instrument_load(&w->nominal, path, &w->outcome->notes, err);
  if (status == PLACIDO_OK) {
    status = placido_uncertainty_load(&w->prior, path, err);
  }
  if (status == PLACIDO_OK && !w->prior.sigma) {
    status = placido_calibrate_prior(&w->prior, &w->nominal, err);
  }
  return status;
}

static int read_plan(struct work *w, placido_error *err) {
  stages_next(&w->outcome->stages, "read");
  int status = placido_calibration_plan_load(&w->plan, w->settings->input, &w->outcome->notes,
                                             err);
  if (status == PLACIDO_OK) {
    status = read_nominal(w, err);
  }
  for (size_t i = 0; i < w->plan.view_count && status == PLACIDO_OK; i++) {
    placido_device_info source;
    placido_ball_view *view = &w->plan.views[i];
    status = ball_read(&view->frame, &source, view->path, -1, &w->outcome->notes, err);
  }
  return status;
}

static int solve(struct work *w, placido_error *err) {
  const placido_calibrate_options options = {.meridians = w->settings->meridians,
                                             .threads = settings_use_threads(w->settings)};
  stages_next(&w->outcome->stages, "calibrate");
  return placido_calibrate(&w->calibration, &w->nominal, &w->prior, w->plan.views,
                           w->plan.view_count, &options, &w->outcome->notes, err);
}

static int save(struct work *w, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const char *folder = w->directory.temporary;
  stages_next(&w->outcome->stages, "files");
  int status = placido_path_join(path, folder, "instrument.json", err);
  if (status == PLACIDO_OK) {
    status = placido_uncertainty_save(&w->calibration.uncertainty, &w->calibration.instrument,
                                      path, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, "calibration.json", err);
  }
  if (status == PLACIDO_OK) {
    status = placido_calibration_save(&w->calibration, w->plan.views, path, err);
  }
  return status;
}

static double typical(const double *values, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += values[i] * values[i];
  }
  return sqrt(sum / count);
}

/* What a person should know of the solution; a held-out ball that was missed is a warning too. */
static void tell(const struct work *w) {
  const placido_calibration *c = &w->calibration;
  const struct settings *settings = w->settings;
  const double *sigma = c->uncertainty.sigma;
  const int n = c->instrument.edge_count;
  bool held_out = false;
  say(settings, "%zu edge points of %zu pictures: residual %.3f px rms, %d steps", c->points,
      c->view_count, c->rms_px, c->steps);
  say(settings, "focal length ± %.3g px, camera's distance ± %.3g mm, edges' radii ± %.3g mm, "
      "heights ± %.3g mm",
      sigma[0], sigma[11], typical(sigma + PLACIDO_UNCERTAINTY_CAMERA, n),
      typical(sigma + PLACIDO_UNCERTAINTY_CAMERA + n, n));
  for (int i = 0; i < c->undetermined_count; i++) {
    say(settings, "not determined (%.0f %% of what was known before is left): %s",
        100 * c->undetermined[i].share, c->undetermined[i].text);
  }
  for (size_t i = 0; i < c->view_count; i++) {
    const placido_ball_check *check = &c->views[i].check;
    held_out |= c->views[i].checked;
    if (c->views[i].checked) {
      say(settings, "held out: ball of %g mm measured as %.4f mm, %.3f µm rms over 8 mm, power off "
          "by %+.3f D at most",
          w->plan.views[i].radius_mm, check->radius_mm, check->rms_8_um, check->worst_power_D);
    }
    if (c->views[i].checked && !(fabs(check->worst_power_D) <= POWER_LIMIT_D)) {
      placido_notes_add(&w->outcome->notes,
                        "the ball that was held out is measured %+.3f D off; %g D are usual",
                        check->worst_power_D, POWER_LIMIT_D);
    }
  }
  if (!held_out) {
    placido_notes_add(&w->outcome->notes,
                      "no ball was held out: the calibration is not checked by anything of its "
                      "own kind (\"held_out\": true)");
  }
  say(settings, "%s/instrument.json", settings->output);
}

static int work_steps(struct work *w, placido_error *err) {
  struct interrupt *interrupt = w->outcome->interrupt;
  interrupt_hold(interrupt);
  int status = placido_directory_create(&w->directory, w->settings->output, NULL, err);
  interrupt_release(interrupt, &w->directory);
  if (status == PLACIDO_OK) {
    status = read_plan(w, err);
  }
  if (status == PLACIDO_OK) {
    status = solve(w, err);
  }
  if (status == PLACIDO_OK) {
    status = save(w, err);
  }
  if (status == PLACIDO_OK) {
    interrupt_hold(interrupt);
    status = placido_directory_commit(&w->directory, err);
    interrupt_release(interrupt, &w->directory);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct work w = {.settings = settings, .outcome = outcome};
  int status = work_steps(&w, err);
  stages_end(&outcome->stages);
  if (status == PLACIDO_OK) {
    tell(&w);
    outcome->result = json_pack("{s:o, s:f, s:i}", "output", record_text(settings->output),
                                "rms_px", w.calibration.rms_px, "undetermined",
                                w.calibration.undetermined_count);
  }
  placido_directory_discard(&w.directory);
  placido_calibration_free(&w.calibration);
  placido_uncertainty_free(&w.prior);
  placido_calibration_plan_free(&w.plan);
  return status;
}

static const struct option_group *const groups[] = {&options_calibrate, &options_general, NULL};

const struct command command_calibrate = {
    .name = "calibrate",
    .summary = "Solve the instrument's geometry, with its uncertainty, from pictures of balls.",
    .usage = "PLAN.json -o DIR [OPTION...]",
    .examples =
        "  placido calibrate balls/plan.json -o calibration\n"
        "      writes calibration/instrument.json and calibration/calibration.json, the report\n\n"
        "The plan lists the pictures: three balls or more of known radius, each at five distances\n"
        "or more, up to half a millimetre beside the axis in different directions, and one ball\n"
        "that is held out to check the result:\n"
        "  {\"format\": \"placido-calibration/1\", \"instrument\": \"nominal.json\",\n"
        "   \"pictures\": [\n"
        "    {\"file\": \"a1.png\", \"radius_mm\": 6.5, \"z_mm\": -1.0, \"z_sigma_mm\": 0.005},\n"
        "    {\"file\": \"d1.png\", \"radius_mm\": 8.1, \"z_mm\": 0, \"z_sigma_mm\": 0.005,\n"
        "     \"held_out\": true}]}\n",
    .groups = groups,
    .needs_word = "PLAN.json",
    .needs_output = true,
    .run = run,
};

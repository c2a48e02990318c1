/* `placido verify`: the daily check on a ball of known radius, and its log. */
#include "acquire/cli/ball.h"
#include "acquire/cli/command.h"
#include "acquire/cli/figures.h"
#include "acquire/cli/record.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* Elevation that a power error amounts to within 8 mm, rms about the mean: the sag's change
 * ρ²/2 · D/337.5 has the standard deviation (4 mm)²/2 · D/337.5 / sqrt(12) over a disc. */
#define UM_PER_D (1000.0 * 16 / 2 / 337.5 / 3.4641016151377544)

struct work {
  const struct settings *settings;
  struct outcome *outcome;
  placido_frame frame;
  placido_device_info source;
  placido_instrument instrument;
  placido_mires mires;
  placido_ball ball;
  placido_ball_check check;
  struct ball_record record;
};

static int read_instrument(struct work *w, placido_error *err) {
  const char *own = w->source.instrument_path, *given = w->settings->instrument;
  if (!given && own[0] == '\0') {
    return placido_error_set(err, STATUS_USAGE,
                             "give the topographer's geometry with --instrument FILE");
  }
  int status = placido_instrument_load(&w->instrument, given ? given : own, &w->outcome->notes,
                                       err);
  if (status == PLACIDO_OK && !w->instrument.calibrated) {
    placido_notes_add(&w->outcome->notes,
                      "the geometry of \"%s\" is nominal, not calibrated (placido calibrate)",
                      w->instrument.name);
  }
  return status;
}

/* The command line goes before the session; without either the mires tell. */
static void decide_distance(struct work *w) {
  const struct distance *asked = &w->settings->axis_z;
  w->ball = (placido_ball){.radius_mm = w->settings->ball_mm,
                           .z_mm = asked->given ? asked->value_mm : w->source.axis_z_mm,
                           .on_axis = true};
  if (isnan(w->ball.z_mm)) {
    placido_notes_add(&w->outcome->notes,
                      "the ball's distance is not known and taken from its radius: only its shape "
                      "is checked, not its power as a whole (--axis-z)");
  }
}

static int measure(struct work *w, placido_error *err) {
  const int threads = settings_use_threads(w->settings);
  const placido_mires_options options = {.threads = threads};
  placido_notes *notes = &w->outcome->notes;
  stages_next(&w->outcome->stages, "read");
  int status = ball_read(&w->frame, &w->source, w->settings->input, w->settings->frame, notes, err);
  if (status == PLACIDO_OK) {
    status = read_instrument(w, err);
  }
  if (status == PLACIDO_OK) {
    decide_distance(w);
    stages_next(&w->outcome->stages, "mires");
    status = placido_mires_find(&w->mires, &w->frame, &w->instrument, &options, notes, err);
  }
  if (status == PLACIDO_OK) {
    stages_next(&w->outcome->stages, "fit");
    status = placido_ball_check_run(&w->check, &w->mires, &w->instrument, &w->ball, threads,
                                    notes, err);
  }
  return status;
}

static void judge(struct work *w) {
  const placido_ball_check *check = &w->check;
  struct ball_record *r = &w->record;
  const double limit = w->settings->limit_D;
  *r = (struct ball_record){.t_s = (double)time(NULL),
                            .ball_mm = w->ball.radius_mm,
                            .z_mm = check->vertex_mm[2],
                            .z_given = !isnan(w->ball.z_mm),
                            .radius_mm = check->radius_mm,
                            .rms_6_um = check->rms_6_um,
                            .rms_8_um = check->rms_8_um,
                            .mires_rms_px = check->mires_rms_px,
                            .limit_D = limit,
                            .limit_um = limit * UM_PER_D};
  memcpy(r->power_D, check->power_error_D, sizeof r->power_D);
  /* a zone that was not seen is NaN and does not pass */
  r->passed = fabs(check->worst_power_D) <= limit && check->rms_8_um <= r->limit_um;
}

/* "verify.csv" into "verify.png". */
static void drift_path(char *out, size_t size, const char *log) {
  size_t length = strlen(log);
  bool csv = length > 4 && strcmp(log + length - 4, ".csv") == 0;
  snprintf(out, size, "%.*s.png", (int)(csv ? length - 4 : length), log);
}

static int keep(struct work *w, placido_error *err) {
  char picture[PLACIDO_PATH_MAX];
  const char *log = w->settings->log;
  struct ball_record *records = NULL;
  size_t count, odd;
  stages_next(&w->outcome->stages, "log");
  int status = ball_log_append(log, &w->record, w->instrument.name, w->settings->input, err);
  if (status == PLACIDO_OK) {
    status = ball_log_read(&records, &count, &odd, log, err);
  }
  if (status == PLACIDO_OK && odd > 0) {
    placido_notes_add(&w->outcome->notes, "%zu lines of %s cannot be read and are not drawn", odd,
                      log);
  }
  if (status == PLACIDO_OK) {
    drift_path(picture, sizeof picture, log);
    status = figures_drift(records, count, picture, &w->outcome->notes, err);
  }
  placido_memory_free(records);
  return status;
}

static void tell(const struct work *w) {
  const struct ball_record *r = &w->record;
  const struct settings *settings = w->settings;
  say(settings, "ball of %g mm: measured %.4f mm, %.3f µm rms within 6 mm, %.3f within 8 mm (limit "
      "%.2f)", r->ball_mm, r->radius_mm, r->rms_6_um, r->rms_8_um, r->limit_um);
  for (int k = 0; k < PLACIDO_BALL_ZONES; k++) {
    say(settings, "  %g to %g mm from the vertex: axial power %+.3f D off (limit %g)",
        placido_ball_zone_mm[k][0], placido_ball_zone_mm[k][1], r->power_D[k], r->limit_D);
  }
  say(settings, "%s", r->passed ? "passed" : "FAILED");
}

static json_t *result_of(const struct work *w) {
  const struct ball_record *r = &w->record;
  json_t *zones = json_array();
  for (int k = 0; k < PLACIDO_BALL_ZONES; k++) {
    json_array_append_new(zones, isfinite(r->power_D[k]) ? json_real(r->power_D[k]) : json_null());
  }
  const double values[] = {r->radius_mm, r->rms_6_um, r->rms_8_um, r->z_mm};
  json_t *numbers[4];
  for (int i = 0; i < 4; i++) {
    numbers[i] = isfinite(values[i]) ? json_real(values[i]) : json_null();
  }
  return json_pack("{s:b, s:f, s:o, s:o, s:o, s:o, s:b, s:o, s:f, s:f}", "passed", (int)r->passed,
                   "ball_mm", r->ball_mm, "radius_mm", numbers[0], "rms_6_um", numbers[1],
                   "rms_8_um", numbers[2], "z_mm", numbers[3], "z_given", (int)r->z_given,
                   "power_error_D", zones, "limit_D", r->limit_D, "limit_um", r->limit_um);
}

static int conclude(struct work *w, placido_error *err) {
  judge(w);
  int status = w->settings->log ? keep(w, err) : PLACIDO_OK;
  stages_end(&w->outcome->stages);
  w->outcome->result = result_of(w);
  tell(w);
  if (status == PLACIDO_OK && !w->record.passed) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "the ball is not measured as it is: axial power %+.3f D off (limit "
                               "%g), shape %.2f µm rms (limit %.2f)",
                               w->check.worst_power_D, w->record.limit_D, w->record.rms_8_um,
                               w->record.limit_um);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  if (!(settings->ball_mm > 0)) {
    return placido_error_set(err, STATUS_USAGE, "say how large the ball is with --ball MM");
  }
  struct work *w = placido_memory_new(1, sizeof *w, err);
  if (!w) {
    return PLACIDO_MEMORY;
  }
  w->settings = settings;
  w->outcome = outcome;
  int status = measure(w, err);
  if (status == PLACIDO_OK) {
    status = conclude(w, err);
  }
  placido_mires_free(&w->mires);
  placido_frame_free(&w->frame);
  placido_memory_free(w);
  return status;
}

static const struct option_group *const groups[] = {&options_verify, &options_general, NULL};

const struct command command_verify = {
    .name = "verify",
    .summary = "Check the instrument on a ball of known radius: passed or failed, with a log.",
    .usage = "INPUT --ball MM [OPTION...]",
    .examples =
        "  placido verify v4l2:/dev/video0 --instrument instrument.json --ball 7.8 --axis-z 0 \\\n"
        "      --log verify.csv\n"
        "      adds a line to verify.csv and draws verify.png, its drift; exit code 0 or 4\n"
        "  placido verify ball.session --ball 7.8\n",
    .groups = groups,
    .needs_word = "INPUT",
    .run = run,
};

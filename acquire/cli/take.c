/* `placido record`: from a device into a session, at the camera's full rate. */
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "acquire/cli/subject.h"
#include "acquire/cli/terminal.h"
#include "acquire/taking.h"
#include "base/file.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define REPLUG_S 10 /* to put a plug that was kicked out back in */
#define SHOW_NS 200000000LL
#define BURST_FRAMES 8
#define WARM_UP_FRAMES 2 /* the one being exposed while the light is switched, and one to be sure */
#define READY_SCORE 0.5
#define READY_HOLD_S 0.5
#define READY_REST_S 2.0

/* A recording, from the command line to its summary. */
struct work {
  const struct settings *settings;
  struct outcome *outcome;
  placido_device *device, *light, *pedal; /* light and pedal may be one */
  placido_guide *guide;
  const char *instrument_path; /* borrowed */
  struct terminal terminal;
  struct timespec shown;
  bool shows, has_shown;
};

static int check_bursts(const struct take_settings *take, placido_error *err) {
  if (take->triggers == 0 && (take->burst > 0 || take->bursts > 0)) {
    return placido_error_set(err, STATUS_USAGE, "--%s: say what starts a burst with --trigger",
                             take->burst > 0 ? "burst" : "bursts");
  }
  if (take->triggers & PLACIDO_TRIGGER_PEDAL && !take->pedal) {
    return placido_error_set(err, STATUS_USAGE, "--trigger pedal: say which one with --pedal");
  }
  if (take->pedal && !(take->triggers & PLACIDO_TRIGGER_PEDAL)) {
    return placido_error_set(err, STATUS_USAGE, "--pedal: it starts bursts with --trigger pedal");
  }
  return PLACIDO_OK;
}

static int check_output(const char *path, placido_error *err) {
  if (!subject_has_ending(path, ".session")) {
    return placido_error_set(err, STATUS_USAGE, "-o %s: NAME.session was expected", path);
  }
  return access(path, F_OK) != 0 ? PLACIDO_OK
                                 : placido_error_set(err, PLACIDO_SYSTEM,
                                                     "%s exists: not overwritten",
                                                     placido_text_tail(path));
}

static int open_pedal_and_light(struct work *work, placido_error *err) {
  const struct take_settings *take = &work->settings->take;
  placido_notes *notes = &work->outcome->notes;
  double level;
  int status = PLACIDO_OK;
  if (take->light) {
    status = placido_device_open(&work->light, take->light, notes, err);
  }
  if (status == PLACIDO_OK && take->light) {
    status = placido_device_get(work->light, "light", &level, err);
  }
  if (status == PLACIDO_OK && take->pedal && take->light && !strcmp(take->pedal, take->light)) {
    work->pedal = work->light;
  } else if (status == PLACIDO_OK && take->pedal) {
    status = placido_device_open(&work->pedal, take->pedal, notes, err);
  }
  return status;
}

static int open_guide(struct work *work, const placido_instrument *instrument,
                      placido_error *err) {
  const struct take_settings *take = &work->settings->take;
  const bool wanted = take->guide || take->triggers & PLACIDO_TRIGGER_AUTO;
  return wanted ? placido_guide_new(&work->guide, instrument, err) : PLACIDO_OK;
}

static int open_instrument(struct work *work, placido_error *err) {
  const placido_device_info *info = placido_device_info_get(work->device);
  placido_instrument instrument;
  work->instrument_path =
      work->settings->instrument ? work->settings->instrument : info->instrument_path;
  if (work->instrument_path[0] == '\0') {
    return placido_error_set(err, STATUS_USAGE,
                             "%.200s does not know the topographer's geometry: give it with "
                             "--instrument FILE",
                             info->uri);
  }
  const int status =
      placido_instrument_load(&instrument, work->instrument_path, &work->outcome->notes, err);
  return status == PLACIDO_OK ? open_guide(work, &instrument, err) : status;
}

static int open_all(struct work *work, placido_error *err) {
  int status =
      placido_device_open(&work->device, work->settings->input, &work->outcome->notes, err);
  if (status == PLACIDO_OK) {
    status = placido_device_patience_set(work->device, REPLUG_S, err);
  }
  if (status == PLACIDO_OK) {
    status = open_instrument(work, err);
  }
  return status == PLACIDO_OK ? open_pedal_and_light(work, err) : status;
}

static void close_all(struct work *work) {
  placido_guide_free(work->guide);
  placido_device_close(work->device);
  if (work->pedal != work->light) {
    placido_device_close(work->pedal);
  }
  placido_device_close(work->light);
}

static void stamp(char created[32]) {
  const time_t now = time(NULL);
  struct tm utc;
  created[0] = '\0';
  if (gmtime_r(&now, &utc)) {
    strftime(created, 32, "%Y-%m-%dT%H:%M:%SZ", &utc);
  }
}

static placido_session_info describe(const struct work *work) {
  const struct settings *settings = work->settings;
  const placido_device_info *device = placido_device_info_get(work->device);
  placido_session_info info = {.axis_z_mm = device->axis_z_mm,
                               .axis_z_sigma_mm = device->axis_z_sigma_mm,
                               .codec = settings->take.codec};
  stamp(info.created);
  snprintf(info.eye, sizeof info.eye, "%s", settings->side ? settings->side : device->eye);
  snprintf(info.subject, sizeof info.subject, "%s",
           settings->take.subject ? settings->take.subject : "");
  snprintf(info.driver, sizeof info.driver, "%.*s", (int)strcspn(device->uri, ":"), device->uri);
  memcpy(info.vendor, device->vendor, sizeof info.vendor);
  memcpy(info.model, device->model, sizeof info.model);
  memcpy(info.serial, device->serial, sizeof info.serial);
  memcpy(info.firmware, device->firmware, sizeof info.firmware);
  snprintf(info.software, sizeof info.software, PROGRAM_VERSION);
  if (settings->axis_z.given) {
    info.axis_z_mm = settings->axis_z.value_mm;
    info.axis_z_sigma_mm = settings->axis_z.sigma_mm;
  }
  return info;
}

static bool is_due(struct work *work) {
  struct timespec now = {0};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const long long since_ns = (long long)(now.tv_sec - work->shown.tv_sec) * 1000000000LL +
                             (now.tv_nsec - work->shown.tv_nsec);
  if (work->has_shown && since_ns < SHOW_NS) {
    return false;
  }
  work->shown = now;
  return true;
}

/* How far it is, as one line that is written anew. */
static void show(struct work *work, const placido_taking_view *view) {
  placido_recorder_summary summary = {0};
  if (!work->shows || !is_due(work)) {
    return;
  }
  if (view->recorder) {
    placido_recorder_summary_get(view->recorder, &summary);
  }
  fprintf(stderr, "\r\033[Kplacido: record: %lld frames, %lld dropped, %.1f s",
          (long long)summary.written, (long long)summary.dropped, summary.seconds);
  if (work->settings->take.triggers) {
    fprintf(stderr, ", %d bursts", view->bursts);
  }
  if (view->is_waiting) {
    fputs(" | unplugged", stderr);
  } else if (work->settings->take.guide && view->guidance) {
    fprintf(stderr, " | %3.0f %% %s", 100.0 * view->guidance->score, view->guidance->instruction);
  }
  fflush(stderr);
  work->has_shown = true;
}

/* While the program is stopped nobody would switch the light off. */
static void pause_dark(struct work *work) {
  double level = 0.0;
  if (work->light && placido_device_get(work->light, "light", &level, NULL) == PLACIDO_OK) {
    placido_device_set(work->light, "light", 0.0, NULL);
  }
  terminal_pause(&work->terminal);
  if (level > 0.0) {
    placido_device_set(work->light, "light", level, NULL);
  }
}

static unsigned look(void *user, const placido_taking_view *view) {
  struct work *work = user;
  const unsigned came = terminal_take(&work->terminal);
  if (came & TERMINAL_PAUSE) {
    pause_dark(work);
  }
  show(work, view);
  const bool ends = came & TERMINAL_END || interrupt_is_asked(work->outcome->interrupt);
  return (came & TERMINAL_FIRE ? PLACIDO_TAKING_FIRE : 0u) | (ends ? PLACIDO_TAKING_END : 0u);
}

static placido_trigger_settings trigger_settings(const struct work *work) {
  const struct take_settings *take = &work->settings->take;
  return (placido_trigger_settings){.sources = take->triggers,
                                    .burst = take->burst > 0 ? take->burst : BURST_FRAMES,
                                    .warm_up = take->light ? WARM_UP_FRAMES : 0,
                                    .score_min = READY_SCORE,
                                    .hold_s = READY_HOLD_S,
                                    .rest_s = READY_REST_S,
                                    .bursts = take->bursts};
}

/* From here to the end of the taking no signal ends the program. */
static int take(struct work *work, placido_taking_result *result, placido_error *err) {
  const struct settings *settings = work->settings;
  const placido_taking_settings taking = {.device = work->device,
                                          .light = work->light,
                                          .pedal = work->pedal,
                                          .guide = work->guide,
                                          .path = settings->output,
                                          .instrument_path = work->instrument_path,
                                          .info = describe(work),
                                          .chooses_codec = !settings->take.codec_given,
                                          .queue_bytes = (size_t)settings->take.queue_mb << 20,
                                          .for_s = settings->for_s,
                                          .frames = settings->take.frames,
                                          .trigger = trigger_settings(work),
                                          .look = look,
                                          .user = work};
  work->shows = !settings->quiet && isatty(STDERR_FILENO);
  interrupt_defer(work->outcome->interrupt);
  if (settings->take.triggers & PLACIDO_TRIGGER_KEY) {
    terminal_listen(&work->terminal);
    fputs(work->shows ? "placido: record: space takes a burst, q ends\n" : "", stderr);
  }
  const int status = placido_taking_run(result, &taking, err);
  if (work->has_shown) {
    fputs("\r\033[K", stderr);
  }
  return status;
}

static void tell_json(const struct work *work, const placido_taking_result *result) {
  const placido_recorder_summary *summary = &result->summary;
  json_t *object = json_object();
  json_object_set_new(object, "output", record_text(work->settings->output));
  json_object_set_new(object, "codec", json_string(placido_session_codec_name(result->codec)));
  json_object_set_new(object, "frames", json_integer((json_int_t)summary->written));
  json_object_set_new(object, "seconds", json_real(summary->seconds));
  json_object_set_new(object, "bytes", json_integer((json_int_t)summary->bytes));
  json_object_set_new(object, "bursts", json_integer(result->bursts));
  json_object_set_new(object, "dropped", json_integer((json_int_t)summary->dropped));
  json_object_set_new(object, "missing", json_integer((json_int_t)summary->missing));
  json_object_set_new(object, "damaged", json_integer((json_int_t)summary->damaged));
  json_object_set_new(object, "undecodable", json_integer((json_int_t)result->undecodable));
  json_object_set_new(object, "queue_most", json_integer(summary->queue_most));
  work->outcome->result = object;
}

static void tell(const struct work *work, const placido_taking_result *result) {
  const placido_recorder_summary *summary = &result->summary;
  const char *path = work->settings->output;
  say(work->settings, "%s: %lld frames in %.2f s, %s, %.1f MB", path, (long long)summary->written,
      summary->seconds, placido_session_codec_name(result->codec), (double)summary->bytes * 1e-6);
  if (work->settings->take.triggers) {
    say(work->settings, "%d bursts, the best frame of each is in events.jsonl", result->bursts);
  }
  say(work->settings, "%lld dropped, %lld missing, %lld damaged; at most %d waited",
      (long long)summary->dropped, (long long)summary->missing,
      (long long)(summary->damaged + result->undecodable), summary->queue_most);
  if (result->codec != PLACIDO_CODEC_FFV1) {
    say(work->settings, "placido session pack %s makes it smaller, for keeping", path);
  }
}

/* A session without a frame is none. */
static int refuse_empty(const struct work *work, const placido_taking_result *result, int status,
                        placido_error *err) {
  if (result->is_begun) {
    placido_directory empty = {0};
    snprintf(empty.temporary, sizeof empty.temporary, "%s", work->settings->output);
    placido_directory_discard(&empty);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  return result->seen > 0 ? placido_error_set(err, PLACIDO_QUALITY,
                                              "nothing was recorded: no burst was taken")
                          : placido_error_set(err, PLACIDO_INPUT,
                                              "nothing was recorded: %.200s gave no frame",
                                              placido_device_info_get(work->device)->uri);
}

static int conclude(const struct work *work, const placido_taking_result *result, int status,
                    placido_error *err) {
  const placido_recorder_summary *summary = &result->summary;
  if (summary->written == 0) {
    return refuse_empty(work, result, status, err);
  }
  tell_json(work, result);
  tell(work, result);
  if (status != PLACIDO_OK) {
    const placido_error why = *err;
    return placido_error_set(err, status, "%.300s (what came before is in %.150s)", why.text,
                             placido_text_tail(work->settings->output));
  }
  if (summary->dropped + summary->missing > 0) {
    return placido_error_set(err, STATUS_INCOMPLETE,
                             "not every frame was recorded: %lld dropped because disk or encoder "
                             "are too slow, %lld missing by the device's counter (events.jsonl)",
                             (long long)summary->dropped, (long long)summary->missing);
  }
  return PLACIDO_OK;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct work work = {.settings = settings, .outcome = outcome};
  placido_taking_result result = {0};
  int status = check_bursts(&settings->take, err);
  if (status == PLACIDO_OK) {
    status = check_output(settings->output, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_end(&outcome->stages); /* its line gives way to show's, and its thread to Ctrl-Z */
  terminal_open(&work.terminal, false);
  status = open_all(&work, err);
  if (status == PLACIDO_OK) {
    status = take(&work, &result, err);
  }
  terminal_close(&work.terminal);
  if (status == PLACIDO_OK || result.seen > 0) {
    status = conclude(&work, &result, status, err);
  }
  close_all(&work);
  return status;
}

static const struct option_group *const groups[] = {&options_take, &options_burst,
                                                    &options_general, NULL};

const struct command command_record = {
    .name = "record",
    .summary = "Record a device's frames into a session, losslessly and at its full rate.",
    .usage = "DEVICE -o NAME.session [OPTION...]",
    .examples =
        "  placido record v4l2:/dev/video0 --instrument cone.json --eye OD -o eye.session\n"
        "      until Ctrl-C; exit code 5 where frames were dropped or are missing\n"
        "  placido record \"u3v:?exposure_us=2000\" --instrument cone.json --subject P0042 \\\n"
        "      --guide --trigger key --trigger auto --bursts 3 -o eye.session\n"
        "      three bursts, at the space bar or when the eye is held ready\n"
        "  placido record u3v: --instrument cone.json --trigger pedal -o eye.session \\\n"
        "      --pedal \"gpio:/dev/gpiochip0?pedal=!7\" --light \"gpio:/dev/gpiochip0?light=5\"\n"
        "      the light is on while a burst is taken\n"
        "  placido record \"replay:eye.session?speed=1\" -o copy.session\n",
    .groups = groups,
    .needs_word = "DEVICE (a device's URI; placido devices lists them)",
    .needs_output = true,
    .run = run,
};

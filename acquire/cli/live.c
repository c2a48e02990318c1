/* `placido live`: how the instrument has to be moved, frame by frame. */
#include "acquire/cli/live.h"

#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "acquire/cli/subject.h"
#include "acquire/cli/terminal.h"
#include "base/clock.h"

#include <placido/device.h>

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <unistd.h>

#define REPLUG_S 10      /* to put a plug that was kicked out back in */
#define TIMEOUT_MS 200   /* so soon a signal or a key is answered */
#define PATIENCE_S 5.0   /* for a frame of a device that is there */
#define DRAIN_MAX 256    /* frames that wait; a device that has more of them gives them for ever */
#define FIELD(name) offsetof(struct settings, name)

/* A live view, from the command line to its end. */
struct live {
  const struct settings *settings;
  struct outcome *outcome;
  placido_device *device;
  placido_instrument instrument;
  placido_guide *guide;
  placido_frame frame;
  struct live_window *window; /* NULL: none */
  struct live_topography *topography; /* the same */
  struct live_cornea cornea;
  struct terminal terminal;
  struct live_moment moment;
  bool drains;   /* a live source: the newest frame is wanted, not every one */
  bool has_bars; /* standard output is a terminal */
  int64_t started_ns, last_ns;
};

static int open_instrument(struct live *live, placido_error *err) {
  const placido_device_info *info = placido_device_info_get(live->device);
  placido_notes *notes = &live->outcome->notes;
  if (live->settings->instrument) {
    return subject_instrument(&live->instrument, live->settings->instrument, notes, err);
  }
  if (info->instrument_path[0] == '\0') {
    return placido_error_set(err, STATUS_USAGE,
                             "%.200s does not know the topographer's geometry: give it with "
                             "--instrument FILE",
                             info->uri);
  }
  return placido_instrument_load(&live->instrument, info->instrument_path, notes, err);
}

/* A replay as fast as it can be read has no newest frame. */
static bool is_live(placido_device *device) {
  double speed = 0;
  return placido_device_info_get(device)->endless ||
         (placido_device_get(device, "speed", &speed, NULL) == PLACIDO_OK && speed > 0);
}

/* A display is not always there; the terminal's view goes on without. */
static int open_window(struct live *live, placido_error *err) {
  placido_error why = {0};
  const int status = live_window_open(&live->window, &why);
  if (status == PLACIDO_UNSUPPORTED) {
    if (!live->settings->quiet) {
      fprintf(stderr, "placido: warning: --window: %s\n", why.text);
    }
    return PLACIDO_OK;
  }
  return status == PLACIDO_OK ? PLACIDO_OK : placido_error_set(err, status, "%s", why.text);
}

static int open_all(struct live *live, placido_error *err) {
  int status =
      placido_device_open(&live->device, live->settings->input, &live->outcome->notes, err);
  if (status == PLACIDO_OK) {
    status = placido_device_patience_set(live->device, REPLUG_S, err);
  }
  if (status == PLACIDO_OK) {
    status = open_instrument(live, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_guide_new(&live->guide, &live->instrument, err);
  }
  if (status == PLACIDO_OK && live->settings->window) {
    status = open_window(live, err);
  }
  if (status == PLACIDO_OK && live->settings->topography) {
    status = live_topography_open(&live->topography, &live->instrument,
                                  live->settings->axis_z.value_mm, err);
    live->moment.cornea = &live->cornea;
  }
  live->drains = live->device && is_live(live->device);
  return status;
}

static void close_all(struct live *live) {
  live_topography_close(live->topography);
  live_window_close(live->window);
  placido_guide_free(live->guide);
  placido_frame_free(&live->frame);
  placido_device_close(live->device);
}

/* The next frame; PLACIDO_TIMEOUT while there is none, and it is worth to wait on. */
static int take(struct live *live, placido_error *err) {
  int status = placido_device_next(live->device, &live->frame, TIMEOUT_MS, err);
  for (int i = 0; live->drains && status == PLACIDO_OK && i < DRAIN_MAX; i++) {
    const int further = placido_device_next(live->device, &live->frame, 0, err);
    if (further == PLACIDO_TIMEOUT) {
      break;
    }
    live->moment.skipped += further == PLACIDO_OK;
    status = further == PLACIDO_OK || further == PLACIDO_INPUT ? further : status;
    if (further != PLACIDO_OK) {
      break; /* the end comes again next time */
    }
  }
  const int64_t now_ns = placido_clock_now_ns();
  if (status == PLACIDO_INPUT) {
    live->moment.damaged++;
    live->last_ns = now_ns;
    return PLACIDO_TIMEOUT;
  }
  if (status == PLACIDO_OK || placido_device_is_waiting(live->device)) {
    live->last_ns = now_ns;
  }
  if (status == PLACIDO_TIMEOUT && 1e-9 * (double)(now_ns - live->last_ns) > PATIENCE_S) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%.200s gave no frame for %g s",
                             placido_device_info_get(live->device)->uri, PATIENCE_S);
  }
  return status;
}

static int show_text(struct live *live, placido_error *err) {
  const struct settings *settings = live->settings;
  if (settings->json) {
    json_t *row = live_json(&live->moment);
    json_dumpf(row, stdout, JSON_COMPACT | JSON_REAL_PRECISION(17));
    putchar('\n');
    json_decref(row);
  } else if (live->has_bars) {
    live_print_bars(&live->moment, live->instrument.name, live->moment.judged == 1);
  } else if (!settings->quiet) {
    live_print_line(&live->moment);
  }
  return fflush(stdout) == 0 ? PLACIDO_OK
                             : placido_error_set(err, PLACIDO_SYSTEM,
                                                 "standard output cannot be written");
}

/* Has the frame measured. Where every frame is judged, every one is waited for. */
static int measure(struct live *live, placido_error *err) {
  if (!live->topography) {
    return PLACIDO_OK;
  }
  const int status = live_topography_give(live->topography, &live->frame, err);
  if (status == PLACIDO_OK && !live->drains) {
    live_topography_wait_measured(live->topography);
  }
  live_topography_latest(live->topography, &live->cornea);
  return status;
}

static int look(struct live *live, placido_error *err) {
  struct live_moment *moment = &live->moment;
  const int64_t before_ns = placido_clock_now_ns();
  int status = placido_guide_look(live->guide, &live->frame, &moment->guidance, err);
  moment->look_ms = 1e-6 * (double)(placido_clock_now_ns() - before_ns);
  moment->judged++;
  moment->seq = live->frame.seq;
  moment->t_ns = live->frame.t_ns;
  if (status == PLACIDO_OK) {
    status = measure(live, err);
  }
  if (status == PLACIDO_OK) {
    status = show_text(live, err);
  }
  if (status == PLACIDO_OK && live->window) {
    status = live_window_show(live->window, &live->frame, &live->instrument, live->guide, moment,
                              err);
  }
  return status;
}

/* Whether a person, a signal or the command line ends it. */
static bool is_over(struct live *live) {
  const struct settings *settings = live->settings;
  const unsigned came = terminal_take(&live->terminal);
  if (came & TERMINAL_PAUSE) {
    terminal_pause(&live->terminal);
    live->last_ns = placido_clock_now_ns();
  }
  return came & TERMINAL_END || interrupt_is_asked(live->outcome->interrupt) ||
         (settings->take.frames > 0 && live->moment.judged >= settings->take.frames) ||
         (settings->for_s > 0 &&
          1e-9 * (double)(placido_clock_now_ns() - live->started_ns) >= settings->for_s);
}

static int watch(struct live *live, placido_error *err) {
  int status = placido_device_start(live->device, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  live->started_ns = live->last_ns = placido_clock_now_ns();
  while (!is_over(live)) {
    status = take(live, err);
    if (status == PLACIDO_OK) {
      status = look(live, err);
    }
    if (status != PLACIDO_OK && status != PLACIDO_TIMEOUT) {
      break;
    }
  }
  status = status == PLACIDO_END || status == PLACIDO_TIMEOUT ? PLACIDO_OK : status;
  const int stopped = placido_device_stop(live->device, status == PLACIDO_OK ? err : NULL);
  return status == PLACIDO_OK ? stopped : status;
}

/* With the frames that the device's own counter missed. */
static void tell(struct live *live) {
  const struct live_moment *moment = &live->moment;
  placido_device_statistics counts;
  placido_device_statistics_get(live->device, &counts);
  const long long lost = (long long)counts.dropped;
  json_t *result = json_object();
  json_object_set_new(result, "frames", json_integer(moment->judged));
  json_object_set_new(result, "skipped", json_integer(moment->skipped));
  json_object_set_new(result, "lost", json_integer(lost));
  json_object_set_new(result, "damaged", json_integer(moment->damaged));
  if (live->topography) {
    live_topography_wait_measured(live->topography);
    live_topography_latest(live->topography, &live->cornea);
    json_object_set_new(result, "measured", json_integer(live->cornea.count));
    json_object_set_new(result, "corneas", json_integer(live->cornea.corneas));
    say(live->settings, "%ld frames measured, %ld with a surface", live->cornea.count,
        live->cornea.corneas);
  }
  live->outcome->result = result;
  live->outcome->has_json_lines = true;
  say(live->settings, "%ld frames judged, %ld skipped, %lld lost, %ld damaged", moment->judged,
      moment->skipped, lost, moment->damaged);
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct live live = {.settings = settings, .outcome = outcome};
  live.has_bars = !settings->json && !settings->quiet && isatty(STDOUT_FILENO);
  stages_next(&outcome->stages, "open");
  terminal_open(&live.terminal, false);
  int status = open_all(&live, err);
  stages_end(&outcome->stages);
  if (status == PLACIDO_OK) {
    interrupt_defer(outcome->interrupt);
    if (isatty(STDIN_FILENO)) {
      terminal_listen(&live.terminal);
    }
    status = watch(&live, err);
  }
  terminal_close(&live.terminal);
  if (live.guide) {
    tell(&live);
  }
  close_all(&live);
  return status;
}

static const struct option_row rows[] = {
    {"instrument", 0, "NAME|FILE", "The topographer's geometry: a placido-instrument/1 file, or a "
     "built-in one. Needed unless the device brings its own, as a replayed session does.",
     FIELD(instrument), parse_text, 0, 0},
    {"window", 0, NULL, "Show the picture in a window as well, with the mires that are seen.",
     FIELD(window), parse_switch, 0, 0},
    {"topography", 0, NULL, "Measure the newest frame as well while the next ones are looked at: "
     "keratometry in the line of text, the axial map in the window.", FIELD(topography),
     parse_switch, 0, 0},
    {"axis-z", 0, "Z", "With --topography: z of the cornea on the instrument's axis, mm (default "
     "0).", FIELD(axis_z), parse_distance, -100, 100},
    {"frames", 0, "N", "End after so many frames.", FIELD(take.frames), parse_integer, 1, 2e9},
    {"for", 0, "SECONDS", "End after so long (default: at Ctrl-C, q, or the recording's end).",
     FIELD(for_s), parse_number, 0.001, 1e7},
};

static const struct option_group options_live = {"Live view", rows,
                                                 sizeof rows / sizeof rows[0]};

static const struct option_group *const groups[] = {&options_live, &options_general, NULL};

const struct command command_live = {
    .name = "live",
    .summary = "Say how the instrument has to be moved, frame by frame: bars on a terminal, lines "
               "in a file.",
    .usage = "DEVICE [OPTION...]",
    .examples =
        "  placido live v4l2:/dev/video0 --instrument cone.json\n"
        "      \"left 0.3 mm\": move the instrument to your left, as the picture has it\n"
        "  placido live \"u3v:?exposure_us=2000\" --instrument cone.json --window\n"
        "  placido live v4l2:/dev/video0 --instrument cone.json --json --for 10 > aim.jsonl\n"
        "  placido live \"replay:eye.session?speed=1\"\n"
        "  placido live v4l2:/dev/video0 --instrument cone.json --window --topography\n",
    .groups = groups,
    .needs_word = "DEVICE (a device's URI; placido devices lists them)",
    .run = run,
};

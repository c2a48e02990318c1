/* The loop over a device's frames: judge, trigger, light, record. */
#include "acquire/taking.h"

#include "acquire/codec.h"
#include "acquire/scorer.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define TICK_MS 100 /* so long may a key or a Ctrl-C wait */
#define SILENCE_NS 5000000000LL
#define REFRESH_NS 1000000000LL
#define NS_PER_S 1e9

/* The best frame of the burst. */
struct best {
  double score; /* NaN: none yet */
  int64_t index;
  uint64_t seq;
};

struct taking {
  const placido_taking_settings *settings;
  placido_session_info info;
  placido_taking_result *result;
  placido_recorder *recorder;
  placido_trigger trigger;
  placido_frame frame, held; /* held: the first one, until the rate is known */
  bool is_held, ends, source_waits, is_unplugged, is_lit;
  placido_device *pedal; /* NULL: none, or lost */
  unsigned fired;        /* since the last frame */
  int64_t first_t_ns, last_t_ns; /* by the device's time */
  int64_t came_ns;               /* the last frame, by the clock */

  placido_scorer scorer;
  placido_frame_info frame_info; /* exposure and gain */
  int64_t refreshed_ns;
  struct best best;
};

/* Into events.jsonl where there is one yet. Lost memory for an event is no reason to end. */
static void tell(struct taking *taking, int64_t t_ns, const char *name, const char *text) {
  if (taking->recorder) {
    placido_recorder_event(taking->recorder, t_ns, name, text, NULL);
  }
}

static double read_control(placido_device *device, const char *name) {
  double value;
  return placido_device_get(device, name, &value, NULL) == PLACIDO_OK ? value : NAN;
}

static int switch_light(struct taking *taking, bool on, placido_error *err) {
  placido_device *light = taking->settings->light;
  if (!light) {
    return PLACIDO_OK;
  }
  placido_error why = {0};
  const int status = placido_device_set(light, "light", on ? 1.0 : 0.0, &why);
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "the light cannot be switched %s: %s",
                             on ? "on" : "OFF, look to it", why.text);
  }
  if (on != taking->is_lit) {
    tell(taking, taking->last_t_ns, on ? "light on" : "light off", NULL);
  }
  taking->is_lit = on;
  return PLACIDO_OK;
}

/* The codec that is asked for, or what holds the rate. A source that waits needs no rate. */
static enum placido_session_codec choose_codec(const struct taking *taking,
                                               const placido_frame *frame) {
  const double bytes = (double)frame->height_px * (double)frame->stride_bytes;
  const double bytes_per_s = taking->source_waits ? 0.0 : bytes * taking->info.rate_hz;
  return taking->settings->chooses_codec
             ? placido_codec_choose(bytes_per_s, sysconf(_SC_NPROCESSORS_ONLN))
             : taking->info.codec;
}

static int open_recorder(struct taking *taking, const placido_frame *frame, placido_error *err) {
  const placido_taking_settings *settings = taking->settings;
  if (frame->format == PLACIDO_RGB8) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the device gives colour pictures: a session holds grey ones");
  }
  taking->info.format = frame->format;
  taking->info.bits = frame->bits;
  taking->info.codec = choose_codec(taking, frame);
  taking->result->codec = taking->info.codec;
  const int status = placido_recorder_open(&taking->recorder, settings->path, &taking->info,
                                           settings->instrument_path, settings->queue_bytes, err);
  taking->result->is_begun = status == PLACIDO_OK;
  return status;
}

static void look(struct taking *taking, const placido_frame *frame) {
  const placido_taking_settings *settings = taking->settings;
  if (!settings->look) {
    return;
  }
  const placido_scorer *scorer = &taking->scorer;
  const placido_taking_view view = {.frame = frame,
                                    .guidance = scorer->has_guidance ? &scorer->guidance : NULL,
                                    .recorder = taking->recorder,
                                    .bursts = taking->trigger.bursts_done,
                                    .is_lit = taking->is_lit,
                                    .is_waiting = taking->is_unplugged};
  const unsigned wish = settings->look(settings->user, &view);
  taking->fired |= wish & PLACIDO_TAKING_FIRE ? PLACIDO_TRIGGER_KEY : 0u;
  taking->ends |= (wish & PLACIDO_TAKING_END) != 0;
}

/* What the pedal told since last time. A lost one does not end a recording. */
static int listen_to_pedal(struct taking *taking, placido_error *err) {
  placido_event event;
  int status = PLACIDO_OK;
  while (status == PLACIDO_OK && taking->pedal) {
    status = placido_device_event(taking->pedal, &event, 0, err);
    if (status == PLACIDO_OK && strcmp(event.name, "pedal") == 0) {
      taking->fired |= event.value ? PLACIDO_TRIGGER_PEDAL : 0u;
      tell(taking, event.t_ns, "pedal", event.value ? "pressed" : "released");
    } else if (status == PLACIDO_GONE) {
      taking->pedal = NULL;
      tell(taking, taking->last_t_ns, "pedal lost", NULL);
    }
  }
  return status == PLACIDO_TIMEOUT || status == PLACIDO_GONE ? PLACIDO_OK : status;
}

/* Exposure and gain as the camera has them now: an automatic one changes them. */
static void refresh_info(struct taking *taking) {
  if (taking->refreshed_ns == 0 || taking->came_ns - taking->refreshed_ns > REFRESH_NS) {
    taking->frame_info.exposure_us = read_control(taking->settings->device, "exposure_us");
    taking->frame_info.gain_db = read_control(taking->settings->device, "gain_db");
    taking->refreshed_ns = taking->came_ns;
  }
}

static int record(struct taking *taking, placido_frame *frame, double score, placido_error *err) {
  const int64_t index = placido_recorder_index(taking->recorder);
  const uint64_t seq = frame->seq;
  refresh_info(taking);
  if (taking->source_waits) {
    placido_recorder_wait(taking->recorder, frame);
  }
  const int status = placido_recorder_put(taking->recorder, frame, &taking->frame_info, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const int64_t taken = placido_recorder_index(taking->recorder);
  if (taken > index && !isnan(score) && !(score <= taking->best.score)) {
    taking->best = (struct best){.score = score, .index = index, .seq = seq};
  }
  taking->ends |= taking->settings->frames > 0 && taken >= taking->settings->frames;
  return PLACIDO_OK;
}

static void tell_burst(struct taking *taking, const char *name) {
  char text[64];
  snprintf(text, sizeof text, "index %lld", (long long)placido_recorder_index(taking->recorder));
  tell(taking, taking->last_t_ns, name, text);
}

static void tell_best(struct taking *taking) {
  const struct best *best = &taking->best;
  char text[100];
  if (!isnan(best->score)) {
    snprintf(text, sizeof text, "index %lld, sequence %llu, score %.4f", (long long)best->index,
             (unsigned long long)best->seq, best->score);
    tell(taking, taking->last_t_ns, "best frame", text);
  }
}

static int end_burst(struct taking *taking, placido_error *err) {
  tell_burst(taking, "burst ends");
  tell_best(taking);
  return switch_light(taking, false, err);
}

/* Does what the trigger says. */
static int act(struct taking *taking, const placido_trigger_action *action, placido_frame *frame,
               double score, placido_error *err) {
  int status = PLACIDO_OK;
  if (action->light_on) {
    tell(taking, frame->t_ns, "trigger", placido_trigger_name(action->source));
    status = switch_light(taking, true, err);
  }
  if (action->first) {
    taking->best.score = NAN;
    tell_burst(taking, "burst begins");
  }
  if (status == PLACIDO_OK && action->take) {
    status = record(taking, frame, score, err);
  } else {
    placido_recorder_pass(taking->recorder, frame);
  }
  if (status == PLACIDO_OK && action->last) {
    status = end_burst(taking, err);
  }
  taking->ends |= action->finished;
  return status;
}

static int handle(struct taking *taking, placido_frame *frame, placido_error *err) {
  double score;
  const placido_trigger *trigger = &taking->trigger;
  const bool in_burst = trigger->burst_left > 0 && trigger->warm_left == 0;
  int status = placido_scorer_judge(&taking->scorer, frame, in_burst, &score, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  look(taking, frame);
  if (taking->settings->trigger.sources == 0) {
    return record(taking, frame, score, err);
  }
  const placido_trigger_action action = placido_trigger_frame(
      &taking->trigger, frame->t_ns, placido_scorer_readiness(&taking->scorer), taking->fired);
  taking->fired = 0;
  return act(taking, &action, frame, score, err);
}

/* By the device's time as far as frames have come, then by the clock. */
static bool is_over(const struct taking *taking) {
  const int64_t since_ns = placido_clock_monotonic.now_ns() - taking->came_ns;
  const double elapsed_s = (double)(taking->last_t_ns - taking->first_t_ns + since_ns) / NS_PER_S;
  return taking->settings->for_s > 0 && elapsed_s >= taking->settings->for_s;
}

static int release_held(struct taking *taking, placido_error *err) {
  taking->is_held = false;
  return handle(taking, &taking->held, err);
}

/* The first frame waits for the second, which tells the rate, unless the device does. */
static int begin(struct taking *taking, placido_error *err) {
  placido_frame *frame = &taking->frame;
  const bool is_rate_known = taking->info.rate_hz > 0;
  if (!is_rate_known && !taking->is_held) {
    const placido_frame spare = taking->held;
    taking->held = *frame;
    *frame = spare;
    taking->is_held = true;
    return PLACIDO_OK;
  }
  if (!is_rate_known && frame->seq > taking->held.seq && frame->t_ns > taking->held.t_ns) {
    const double rate_hz = NS_PER_S * (double)(frame->seq - taking->held.seq) /
                           (double)(frame->t_ns - taking->held.t_ns);
    taking->info.rate_hz = round(rate_hz * 100.0) / 100.0;
  }
  int status = open_recorder(taking, frame, err);
  if (status == PLACIDO_OK && taking->settings->trigger.sources == 0) {
    status = switch_light(taking, true, err);
  }
  if (status == PLACIDO_OK && taking->is_held) {
    status = release_held(taking, err);
  }
  return status == PLACIDO_OK && !taking->ends ? handle(taking, frame, err) : status;
}

static int take_frame(struct taking *taking, placido_error *err) {
  const placido_frame *frame = &taking->frame;
  if (taking->result->seen++ == 0) {
    taking->first_t_ns = frame->t_ns;
  }
  taking->last_t_ns = frame->t_ns;
  taking->came_ns = placido_clock_monotonic.now_ns();
  if (is_over(taking)) {
    taking->ends = true;
    return PLACIDO_OK;
  }
  return taking->recorder ? handle(taking, &taking->frame, err) : begin(taking, err);
}

/* No frame came: why, and for how long. */
static int bear_silence(struct taking *taking, placido_error *err) {
  const bool is_unplugged = placido_device_is_waiting(taking->settings->device);
  if (is_unplugged != taking->is_unplugged) {
    tell(taking, taking->last_t_ns, is_unplugged ? "device unplugged" : "device back", NULL);
    taking->is_unplugged = is_unplugged;
  }
  look(taking, NULL);
  taking->ends |= is_over(taking);
  if (!is_unplugged && placido_clock_monotonic.now_ns() - taking->came_ns > SILENCE_NS) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "the device has given no frame for %d seconds",
                             (int)(SILENCE_NS / 1000000000));
  }
  return PLACIDO_OK;
}

static int take_next(struct taking *taking, placido_error *err) {
  int status = placido_device_next(taking->settings->device, &taking->frame, TICK_MS, err);
  if (status == PLACIDO_OK && taking->is_unplugged) {
    taking->is_unplugged = false;
    tell(taking, taking->frame.t_ns, "device back", NULL);
  }
  if (status == PLACIDO_OK) {
    status = take_frame(taking, err);
  } else if (status == PLACIDO_TIMEOUT) {
    status = bear_silence(taking, err);
  } else if (status == PLACIDO_INPUT) {
    taking->result->undecodable++;
    tell(taking, taking->last_t_ns, "frame lost", err->text);
    status = PLACIDO_OK;
  } else if (status == PLACIDO_END) {
    taking->ends = true;
    status = PLACIDO_OK;
  }
  return status == PLACIDO_OK ? listen_to_pedal(taking, err) : status;
}

static int start(struct taking *taking, placido_error *err) {
  const placido_taking_settings *settings = taking->settings;
  int status = settings->pedal ? placido_device_start(settings->pedal, err) : PLACIDO_OK;
  if (status == PLACIDO_OK) {
    taking->pedal = settings->pedal;
    status = placido_device_start(settings->device, err);
  }
  const double rate_hz = read_control(settings->device, "frame_rate_hz");
  taking->info.rate_hz = rate_hz > 0 ? rate_hz : NAN;
  taking->source_waits = read_control(settings->device, "speed") == 0;
  taking->scorer.takes_its_time = taking->source_waits;
  taking->came_ns = placido_clock_monotonic.now_ns();
  return status;
}

/* The first failure is the one that is told; that of the light always. */
static int join_failures(int status, int later, const placido_error *why, placido_error *err) {
  if (later == PLACIDO_OK) {
    return status;
  }
  const placido_error first = *err;
  return status == PLACIDO_OK
             ? placido_error_set(err, later, "%s", why->text)
             : placido_error_set(err, status, "%.240s; and %.240s", first.text, why->text);
}

/* A recording that ends before its second frame. */
static int record_held(struct taking *taking, placido_error *err) {
  if (taking->recorder || !taking->is_held) {
    return PLACIDO_OK;
  }
  const int status = open_recorder(taking, &taking->held, err);
  return status == PLACIDO_OK ? release_held(taking, err) : status;
}

/* A burst that the end has cut off. */
static void tell_cut_burst(struct taking *taking) {
  const placido_trigger *trigger = &taking->trigger;
  if (trigger->burst_left > 0 && trigger->burst_left < trigger->settings.burst) {
    tell_burst(taking, "burst ends");
    tell_best(taking);
  }
}

/* Lights out, whatever `status` says so far, then the rest. */
static int finish(struct taking *taking, int status, placido_error *err) {
  const placido_taking_settings *settings = taking->settings;
  placido_error why = {0};
  const int dark = switch_light(taking, false, &why);
  status = status == PLACIDO_OK ? record_held(taking, err) : status;
  tell_cut_burst(taking);
  status = join_failures(status, dark, &why, err);
  if (status != PLACIDO_OK) {
    tell(taking, taking->last_t_ns, status == PLACIDO_GONE ? "device lost" : "recording failed",
         err->text);
  }
  int ended = placido_device_stop(settings->device, status == PLACIDO_OK ? err : NULL);
  status = status == PLACIDO_OK ? ended : status;
  if (settings->pedal) {
    placido_device_stop(settings->pedal, NULL);
  }
  ended = placido_recorder_close(taking->recorder, &taking->result->summary,
                                 status == PLACIDO_OK ? err : NULL);
  return status == PLACIDO_OK ? ended : status;
}

int placido_taking_run(placido_taking_result *result, const placido_taking_settings *settings,
                       placido_error *err) {
  *result = (placido_taking_result){0};
  placido_error why = {0};
  struct taking taking = {.settings = settings,
                          .info = settings->info,
                          .result = result,
                          .scorer = {.guide = settings->guide},
                          .best = {.score = NAN},
                          .frame_info = {.exposure_us = NAN, .gain_db = NAN}};
  placido_trigger_start(&taking.trigger, &settings->trigger);
  int status = start(&taking, &why);
  while (status == PLACIDO_OK && !taking.ends) {
    status = take_next(&taking, &why);
  }
  status = finish(&taking, status, &why);
  result->bursts = taking.trigger.bursts_done;
  placido_frame_free(&taking.frame);
  placido_frame_free(&taking.held);
  return status == PLACIDO_OK ? PLACIDO_OK : placido_error_set(err, status, "%s", why.text);
}

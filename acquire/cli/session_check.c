/* `placido session check` and `info`: what is in a session, and whether it is whole. */
#include "acquire/cli/record.h"
#include "acquire/cli/session.h"
#include "base/json.h"
#include "base/session/archive.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define BYTES_PER_MB 1e6

static const char *const states[] = {[PLACIDO_FINDING_SOUND] = "sound",
                                     [PLACIDO_FINDING_NOTE] = "note",
                                     [PLACIDO_FINDING_DAMAGE] = "damaged"};

/* What was not recorded is null. */
static void set_text(json_t *object, const char *key, const char *text) {
  json_object_set_new(object, key, text[0] ? record_text(text) : json_null());
}

static void set_integer(json_t *object, const char *key, int64_t value) {
  json_object_set_new(object, key, json_integer((json_int_t)value));
}

static void set_real(json_t *object, const char *key, double value) {
  json_object_set_new(object, key, placido_json_real(value));
}

static json_t *build_device(const placido_session_info *info) {
  json_t *device = json_object();
  set_text(device, "driver", info->driver);
  set_text(device, "vendor", info->vendor);
  set_text(device, "model", info->model);
  set_text(device, "serial", info->serial);
  set_text(device, "firmware", info->firmware);
  return device;
}

static json_t *build_frames(const placido_session_survey *survey) {
  json_t *frames = json_object();
  set_text(frames, "codec", survey->codec);
  set_integer(frames, "width_px", survey->width_px);
  set_integer(frames, "height_px", survey->height_px);
  set_integer(frames, "bits", survey->info.bits);
  set_integer(frames, "count", survey->frames);
  set_integer(frames, "damaged", survey->damaged);
  set_integer(frames, "lines", survey->lines);
  set_integer(frames, "bytes", survey->bytes);
  json_object_set_new(frames, "has_end", json_boolean(survey->is_finished));
  return frames;
}

static json_t *build_clock(const placido_clock_figures *figures) {
  json_t *clock = json_object();
  set_real(clock, "seconds", figures->seconds);
  set_real(clock, "rate_hz", figures->rate_hz);
  set_real(clock, "jitter_ms", figures->jitter_ms);
  set_real(clock, "longest_ms", figures->longest_ms);
  set_integer(clock, "backwards", figures->backwards);
  set_integer(clock, "missing", figures->missing);
  set_integer(clock, "restarts", figures->restarts);
  return clock;
}

static json_t *build_survey(const placido_session_survey *survey, const char *path) {
  json_t *root = json_object();
  set_text(root, "path", path);
  set_text(root, "created", survey->info.created);
  set_text(root, "eye", survey->info.eye);
  set_text(root, "subject", survey->info.subject);
  set_text(root, "software", survey->info.software);
  json_object_set_new(root, "device", build_device(&survey->info));
  set_real(root, "axis_z_mm", survey->info.axis_z_mm);
  set_real(root, "axis_z_sigma_mm", survey->info.axis_z_sigma_mm);
  set_text(root, "instrument", survey->instrument);
  json_object_set_new(root, "calibrated", json_boolean(survey->calibrated));
  json_object_set_new(root, "frames", build_frames(survey));
  json_object_set_new(root, "clock", build_clock(&survey->clock));
  set_integer(root, "events", survey->events);
  return root;
}

static json_t *build_findings(const placido_findings *findings) {
  json_t *list = json_array();
  for (size_t i = 0; i < findings->count; i++) {
    json_t *row = json_object();
    set_text(row, "part", findings->items[i].part);
    set_text(row, "state", states[findings->items[i].state]);
    set_text(row, "text", findings->items[i].text);
    json_array_append_new(list, row);
  }
  return list;
}

int session_check(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_findings findings;
  placido_session_survey survey;
  int status = placido_session_check(&findings, &survey, settings->input, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_end(&outcome->stages);
  outcome->result = build_survey(&survey, settings->input);
  json_object_set_new(outcome->result, "findings", build_findings(&findings));
  json_object_set_new(outcome->result, "sound", json_boolean(findings.damage == 0));
  for (size_t i = 0; i < findings.count; i++) {
    const placido_finding *finding = &findings.items[i];
    say(settings, "%-16s %-8s %s", finding->part, states[finding->state], finding->text);
  }
  if (findings.damage > 0) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "%s is damaged (placido session repair salvages what is whole)",
                             settings->input);
  }
  say(settings, "%s is sound", settings->input);
  return PLACIDO_OK;
}

/* "Vendor Model, serial 7, by v4l2" of what is known. */
static void say_device(const struct settings *settings, const placido_session_info *info) {
  say(settings, "device      %s%s%s%s%s%s%s%s%s", info->vendor, info->vendor[0] ? " " : "",
      info->model[0] ? info->model : "not recorded", info->serial[0] ? ", serial " : "",
      info->serial, info->firmware[0] ? ", firmware " : "", info->firmware,
      info->driver[0] ? ", by " : "", info->driver);
}

static void say_survey(const struct settings *settings, const placido_session_survey *survey) {
  const placido_session_info *info = &survey->info;
  const double samples = (double)survey->frames * survey->width_px * survey->height_px *
                         (info->format == PLACIDO_MONO16 ? 2 : 1);
  say(settings, "recorded    %s, %s%s%s", info->created[0] ? info->created : "when is not known",
      info->eye[0] ? info->eye : "eye not said", info->subject[0] ? ", subject " : "",
      info->subject);
  say_device(settings, info);
  say(settings, "instrument  %s, %scalibrated", survey->instrument,
      survey->calibrated ? "" : "not ");
  say(settings, "frames      %" PRId64 ", %d x %d, %d bit%s", survey->frames, survey->width_px,
      survey->height_px, info->bits, survey->is_finished ? "" : ", without a proper end");
  say(settings, "stored      %s, %.1f MB, %.0f %% of the samples", survey->codec,
      (double)survey->bytes / BYTES_PER_MB, 100 * (double)survey->bytes / fmax(samples, 1));
  if (!isnan(survey->clock.seconds)) {
    say(settings, "time        %.3f s, %.2f frames/s, %" PRId64 " of the camera's frames missing",
        survey->clock.seconds, survey->clock.rate_hz, survey->clock.missing);
  }
  say(settings, "events      %" PRId64, survey->events);
}

int session_info(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_session_survey survey;
  const int status =
      placido_session_survey_take(&survey, settings->input, &outcome->notes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_end(&outcome->stages);
  outcome->result = build_survey(&survey, settings->input);
  json_object_del(json_object_get(outcome->result, "frames"), "damaged"); /* not looked at */
  say_survey(settings, &survey);
  return PLACIDO_OK;
}

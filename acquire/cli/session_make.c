/* `placido session pack`, `repair` and `export`: what makes something new out of a session. */
#include "acquire/cli/record.h"
#include "acquire/cli/session.h"
#include "base/session/archive.h"

#include <inttypes.h>
#include <string.h>

#define BYTES_PER_MB 1e6

static json_t *begin_result(const struct settings *settings) {
  json_t *result = json_object();
  json_object_set_new(result, "output",
                      record_text(settings->output ? settings->output : settings->input));
  return result;
}

static void set_integer(json_t *object, const char *key, int64_t value) {
  json_object_set_new(object, key, json_integer((json_int_t)value));
}

/* Makes the directory that takes the output's place at the end. */
static int open_workshop(placido_directory *workshop, const struct settings *settings,
                         struct outcome *outcome, placido_error *err) {
  interrupt_hold(outcome->interrupt);
  const int status = placido_directory_create(workshop, settings->output, NULL, err);
  interrupt_release(outcome->interrupt, workshop);
  return status;
}

/* Puts it there where `status` is good; else nothing is left of it. */
static int close_workshop(placido_directory *workshop, struct outcome *outcome, int status,
                          placido_error *err) {
  interrupt_hold(outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_directory_commit(workshop, err);
  }
  placido_directory_discard(workshop);
  interrupt_release(outcome->interrupt, workshop);
  return status;
}

static int pack_in_place(placido_pack_summary *summary, const struct settings *settings,
                         struct outcome *outcome, placido_error *err) {
  placido_directory workshop;
  int lock;
  interrupt_hold(outcome->interrupt);
  int status = placido_pack_begin(&lock, &workshop, settings->input, err);
  interrupt_release(outcome->interrupt, &workshop);
  if (status == PLACIDO_OK) {
    status = placido_pack_video(summary, settings->input, workshop.temporary, err);
  }
  interrupt_hold(outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_pack_commit(&workshop, settings->input, err);
  }
  placido_directory_discard(&workshop);
  interrupt_release(outcome->interrupt, &workshop);
  placido_pack_end(lock);
  return status;
}

static int pack_elsewhere(placido_pack_summary *summary, const struct settings *settings,
                          struct outcome *outcome, placido_error *err) {
  placido_directory workshop;
  int status = open_workshop(&workshop, settings, outcome, err);
  if (status == PLACIDO_OK) {
    status = placido_pack_video(summary, settings->input, workshop.temporary, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_pack_rest(settings->input, workshop.temporary, &outcome->notes, err);
  }
  return close_workshop(&workshop, outcome, status, err);
}

int session_pack(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_pack_summary summary = {0};
  bool needed;
  int status = placido_pack_is_needed(&needed, settings->input, err);
  if (status == PLACIDO_OK && !needed && !settings->output) {
    outcome->result = begin_result(settings);
    json_object_set_new(outcome->result, "packed", json_false());
    say(settings, "%s is FFV1 with checksums already", settings->input);
    return PLACIDO_OK;
  }
  if (status == PLACIDO_OK) {
    status = settings->output ? pack_elsewhere(&summary, settings, outcome, err)
                              : pack_in_place(&summary, settings, outcome, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_end(&outcome->stages);
  outcome->result = begin_result(settings);
  json_object_set_new(outcome->result, "packed", json_true());
  set_integer(outcome->result, "frames", summary.frames);
  set_integer(outcome->result, "bytes_before", summary.bytes_before);
  set_integer(outcome->result, "bytes_after", summary.bytes_after);
  say(settings, "%s: %" PRId64 " frames, each compared; %.1f MB became %.1f MB",
      settings->output ? settings->output : settings->input, summary.frames,
      (double)summary.bytes_before / BYTES_PER_MB, (double)summary.bytes_after / BYTES_PER_MB);
  return PLACIDO_OK;
}

static void tell_repair(const placido_repair_summary *summary, const struct settings *settings,
                        struct outcome *outcome) {
  char lost[200];
  placido_ranges_text(lost, sizeof lost, &summary->lost);
  stages_end(&outcome->stages);
  json_t *result = outcome->result = begin_result(settings);
  set_integer(result, "kept", summary->kept);
  set_integer(result, "damaged", placido_ranges_total(&summary->lost));
  json_object_set_new(result, "damaged_frames", record_text(lost));
  set_integer(result, "cut_off", summary->cut_off);
  set_integer(result, "bad_lines", summary->bad_lines);
  set_integer(result, "bad_events", summary->bad_events);
  json_object_set_new(result, "description_kept", json_boolean(summary->has_description));
  say(settings, "%s: %" PRId64 " frames kept", settings->output, summary->kept);
  if (summary->lost.count > 0) {
    say(settings, "lost: %" PRId64 " frames that are damaged (%s)",
        placido_ranges_total(&summary->lost), lost);
  }
  if (summary->cut_off > 0) {
    say(settings, "lost: %" PRId64 " frames at the end, which never reached the disk",
        summary->cut_off);
  }
  if (summary->bad_lines > 0) {
    say(settings, "lost: %" PRId64 " lines of frames.jsonl", summary->bad_lines);
  }
  if (summary->bad_events > 0) {
    say(settings, "lost: %" PRId64 " lines of events.jsonl", summary->bad_events);
  }
  if (!summary->has_description) {
    say(settings, "lost: session.json (whose eye, when, with what)");
  }
}

int session_repair(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_directory workshop, session;
  placido_repair_summary summary = {0};
  int status = open_workshop(&workshop, settings, outcome, err);
  session = workshop; /* a session is made as a new folder, which the workshop is not any more */
  if (status == PLACIDO_OK) {
    status = placido_path_join(session.temporary, workshop.temporary, "session", err);
  }
  if (status == PLACIDO_OK) {
    status = placido_session_repair(&summary, settings->input, session.temporary,
                                    settings->instrument, &outcome->notes, err);
  }
  interrupt_hold(outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_directory_commit(&session, err);
  }
  placido_directory_discard(&workshop);
  interrupt_release(outcome->interrupt, &workshop);
  if (status == PLACIDO_OK) {
    tell_repair(&summary, settings, outcome);
  }
  placido_repair_summary_free(&summary);
  return status;
}

static int choose_type(enum placido_export_type *type, const char *name, placido_error *err) {
  *type = name && strcmp(name, "tiff") == 0 ? PLACIDO_EXPORT_TIFF : PLACIDO_EXPORT_PNG;
  return !name || *type == PLACIDO_EXPORT_TIFF || strcmp(name, "png") == 0
             ? PLACIDO_OK
             : placido_error_set(err, STATUS_USAGE, "--type %s: png or tiff was expected", name);
}

static int choose_frames(placido_ranges *wanted, const char *list, placido_error *err) {
  placido_error reason = {0};
  const int status = list ? placido_ranges_parse(wanted, list, &reason) : PLACIDO_OK;
  return status == PLACIDO_OK
             ? PLACIDO_OK
             : placido_error_set(err, status == PLACIDO_INPUT ? STATUS_USAGE : status,
                                 "--frames %s", reason.text);
}

int session_export(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_directory workshop = {0};
  placido_ranges wanted = {0};
  enum placido_export_type type;
  int64_t count = 0;
  int status = choose_type(&type, settings->picture_type, err);
  if (status == PLACIDO_OK) {
    status = choose_frames(&wanted, settings->frame_list, err);
  }
  if (status == PLACIDO_OK) {
    status = open_workshop(&workshop, settings, outcome, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_session_export(&count, settings->input, workshop.temporary, &wanted, type,
                                    &outcome->notes, err);
    status = close_workshop(&workshop, outcome, status, err);
  }
  placido_ranges_free(&wanted);
  if (status == PLACIDO_OK) {
    stages_end(&outcome->stages);
    outcome->result = begin_result(settings);
    set_integer(outcome->result, "frames", count);
    say(settings, "%s: %" PRId64 " frames", settings->output, count);
  }
  return status;
}

/* Whether a session is what was recorded: every file, every frame, and whether they fit. */
#include "base/session/check.h"

#include "base/session/describe.h"
#include "base/session/disk.h"
#include "base/session/events_log.h"
#include "base/text.h"

#include <placido/instrument.h>

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void placido_check_find(placido_check *check, enum placido_finding_state state, const char *part,
                        const char *format, ...) {
  placido_findings *findings = check->findings;
  findings->damage += state == PLACIDO_FINDING_DAMAGE;
  if (findings->count == PLACIDO_FINDINGS_MAX) {
    return;
  }
  placido_finding *finding = &findings->items[findings->count++];
  finding->state = state;
  snprintf(finding->part, sizeof finding->part, "%s", part);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(finding->text, sizeof finding->text, format, arguments);
  placido_text_line(finding->text);
  va_end(arguments);
}

static void find_notes(placido_check *check, const char *part, placido_notes *notes) {
  for (size_t i = 0; i < notes->count; i++) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, part, "%s", notes->lines[i]);
  }
  placido_notes_clear(notes);
}

int placido_check_settle(placido_check *check, const char *part, int status,
                         const placido_error *reason, placido_error *err) {
  if (status == PLACIDO_INPUT || status == PLACIDO_SYSTEM) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, part, "%s", reason->text);
    return PLACIDO_OK;
  }
  return status ? placido_error_set(err, status, "%s", reason->text) : PLACIDO_OK;
}

static int check_description(placido_check *check, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_session_info info;
  placido_notes notes = {0};
  placido_error reason = {0};
  int status = placido_path_join(path, check->path, "session.json", err);
  if (status) {
    return status;
  }
  status = placido_session_describe_load(&info, path, &notes, &reason);
  if (!status) {
    check->survey->info = info;
    placido_check_find(check, PLACIDO_FINDING_SOUND, "session.json", "%s%s%s",
                       info.eye[0] ? info.eye : "eye not said", info.created[0] ? ", " : "",
                       info.created);
  }
  find_notes(check, "session.json", &notes);
  return placido_check_settle(check, "session.json", status, &reason, err);
}

/* After the frames, whose size it must have. */
static int check_instrument(placido_check *check, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_instrument instrument;
  placido_notes notes = {0};
  placido_error reason = {0};
  int status = placido_path_join(path, check->path, "instrument.json", err);
  if (status) {
    return status;
  }
  status = placido_instrument_load(&instrument, path, &notes, &reason);
  find_notes(check, "instrument.json", &notes);
  if (status) {
    return placido_check_settle(check, "instrument.json", status, &reason, err);
  }
  placido_session_survey *survey = check->survey;
  snprintf(survey->instrument, sizeof survey->instrument, "%s", instrument.name);
  survey->calibrated = instrument.calibrated;
  const int width_px = instrument.width_px, height_px = instrument.height_px;
  if (survey->width_px > 0 && (survey->width_px != width_px || survey->height_px != height_px)) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, "instrument.json",
                       "is for %d x %d pixels, the frames have %d x %d", width_px, height_px,
                       survey->width_px, survey->height_px);
  } else {
    placido_check_find(check, PLACIDO_FINDING_SOUND, "instrument.json", "%s, %s", instrument.name,
                       instrument.calibrated ? "calibrated" : "not calibrated");
  }
  return PLACIDO_OK;
}

static int check_events(placido_check *check, placido_error *err) {
  placido_events_log log;
  if (!placido_disk_has(check->path, "events.jsonl")) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, "events.jsonl", "is missing");
    return PLACIDO_OK;
  }
  int status = placido_events_log_load(&log, check->path, err);
  if (status) {
    return status;
  }
  check->survey->events = (int64_t)json_array_size(log.lines);
  if (log.bad > 0) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, "events.jsonl",
                       "%zu bad lines; the first is line %zu", log.bad, log.first_bad);
  } else {
    placido_check_find(check, PLACIDO_FINDING_SOUND, "events.jsonl", "%" PRId64 " lines",
                       check->survey->events);
  }
  placido_events_log_free(&log);
  return PLACIDO_OK;
}

/* What has no business in a session. */
static void check_strangers(placido_check *check) {
  static const char *const known[] = {
      ".",           "..",           "session.json",    "frames.mkv",
      "events.jsonl", "frames.jsonl", "instrument.json", "truth-surface.json"};
  DIR *listing = opendir(check->path);
  for (struct dirent *entry; listing && (entry = readdir(listing));) {
    bool is_known = false;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
      is_known = is_known || strcmp(entry->d_name, known[i]) == 0;
    }
    if (strcmp(entry->d_name, PLACIDO_PACK_FOLDER) == 0) {
      placido_check_find(check, PLACIDO_FINDING_NOTE, "folder",
                         "%s is of a packing that goes on or was stopped", entry->d_name);
    } else if (!is_known) {
      placido_check_find(check, PLACIDO_FINDING_NOTE, "folder", "%.200s is no part of a session",
                         entry->d_name);
    }
  }
  if (listing) {
    closedir(listing);
  }
}

int placido_session_check(placido_findings *findings, placido_session_survey *survey,
                          const char *path, placido_error *err) {
  *findings = (placido_findings){0};
  *survey = (placido_session_survey){
      .info = {.rate_hz = NAN, .axis_z_mm = NAN, .axis_z_sigma_mm = NAN},
      .clock = {.seconds = NAN, .rate_hz = NAN, .jitter_ms = NAN, .longest_ms = NAN}};
  placido_check check = {.findings = findings, .survey = survey, .path = path};
  int status = placido_disk_check_folder(path, err);
  if (!status) {
    status = check_description(&check, err);
  }
  if (!status) {
    status = placido_check_frames(&check, err);
  }
  if (!status) {
    status = check_instrument(&check, err);
  }
  if (!status) {
    status = check_events(&check, err);
  }
  if (!status) {
    check_strangers(&check);
  }
  placido_session_reader_close(check.reader);
  placido_ranges_free(&check.damaged);
  placido_ranges_free(&check.unlisted);
  placido_clock_free(&check.clock);
  return status;
}

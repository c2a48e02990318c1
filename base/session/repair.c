/* Out of a torn session a sound one: every frame that is whole, in order, with what is known of
 * it. */
#include "base/session/archive.h"
#include "base/session/describe.h"
#include "base/session/disk.h"
#include "base/session/events_log.h"
#include "base/session/lines.h"
#include "base/session/reader.h"
#include "base/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct repairing {
  placido_repair_summary *summary;
  const char *path, *target;
  char instrument_path[PLACIDO_PATH_MAX];
  placido_session_reader *reader;
  placido_session_writer *writer; /* opened by the first whole frame, which has the format */
  int64_t end;                    /* one more than the last frame's number in the video */
  int64_t last_t_ns;
} repairing;

static int start(repairing *repair, const placido_frame *first, placido_error *err) {
  placido_session_info info = *placido_session_reader_info(repair->reader);
  info.format = first->format;
  info.bits = first->bits;
  info.codec = PLACIDO_CODEC_FFV1;
  return placido_session_writer_create(&repair->writer, repair->target, &info,
                                       repair->instrument_path, err);
}

static int keep(repairing *repair, const placido_frame *frame, placido_error *err) {
  const placido_frame_info info = placido_session_reader_frame_info(repair->reader);
  int status = repair->writer ? PLACIDO_OK : start(repair, frame, err);
  if (!status) {
    status = placido_session_writer_append(repair->writer, frame, &info, err);
  }
  repair->summary->kept += status == PLACIDO_OK;
  repair->last_t_ns = frame->t_ns;
  return status;
}

static int keep_frames(repairing *repair, placido_error *err) {
  placido_frame frame = {0};
  int status = PLACIDO_OK;
  while (!status) {
    status = placido_session_reader_next(repair->reader, &frame, err);
    if (status == PLACIDO_END) {
      break;
    }
    repair->end = placido_session_reader_frame_info(repair->reader).index + 1;
    if (!status) {
      status = keep(repair, &frame, err);
    } else if (status == PLACIDO_INPUT) {
      status = placido_ranges_add(&repair->summary->lost, repair->end - 1, err);
    }
  }
  placido_frame_free(&frame);
  if (status == PLACIDO_END && repair->summary->kept == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s has no frame that is whole",
                             placido_text_tail(repair->path));
  }
  return status == PLACIDO_END ? PLACIDO_OK : status;
}

static void count_lines(repairing *repair) {
  const placido_frames_log *log = placido_session_reader_log(repair->reader);
  repair->summary->bad_lines = (int64_t)log->bad;
  for (size_t i = 0; i < log->count; i++) {
    repair->summary->cut_off += log->frames[i].index >= repair->end;
  }
}

/* The events that are sound, and one that says what was done. */
static int keep_events(repairing *repair, placido_error *err) {
  placido_events_log log;
  placido_lines lines = {0};
  int status = placido_events_log_load(&log, repair->path, err);
  if (!status) {
    status = placido_lines_create(&lines, repair->target, "events.jsonl", err);
  }
  for (size_t i = 0; !status && i < json_array_size(log.lines); i++) {
    status = placido_lines_append(&lines, json_incref(json_array_get(log.lines, i)), err);
  }
  if (!status) {
    char text[300], lost[200];
    placido_ranges_text(lost, sizeof lost, &repair->summary->lost);
    snprintf(text, sizeof text,
             "%" PRId64 " frames kept; damaged: %s; cut off at the end: %" PRId64,
             repair->summary->kept, lost[0] ? lost : "none", repair->summary->cut_off);
    status = placido_lines_append(
        &lines, json_pack("{s:I, s:s, s:s}", "t_ns", (json_int_t)repair->last_t_ns, "event",
                          "repaired", "text", text), err);
  }
  if (!status) {
    status = placido_lines_sync(&lines, err);
  }
  repair->summary->bad_events = (int64_t)log.bad;
  const int closed = placido_lines_close(&lines, status ? NULL : err);
  placido_events_log_free(&log);
  return status ? status : closed;
}

/* session.json as it was, with whatever else stands in it, and files that are not ours. */
static int keep_rest(const repairing *repair, placido_notes *notes, placido_error *err) {
  static const char *const except[] = {"session.json", "instrument.json",   "frames.mkv",
                                       "frames.jsonl", "events.jsonl",      PLACIDO_PACK_FOLDER,
                                       NULL};
  char from[PLACIDO_PATH_MAX], to[PLACIDO_PATH_MAX];
  int status = placido_path_join(from, repair->path, "session.json", err);
  if (!status) {
    status = placido_path_join(to, repair->target, "session.json", err);
  }
  if (!status && repair->summary->has_description) {
    status = placido_disk_copy(to, from, err);
  }
  if (!status) {
    status = placido_disk_copy_folder(repair->target, repair->path, except, notes, err);
  }
  return status ? status : placido_disk_sync(repair->target, err);
}

/* The new session is read once more; its log has the checksum of every frame as it was read from
 * the old one. */
static int verify(const repairing *repair, placido_error *err) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  int64_t count = 0;
  int status = placido_session_reader_open(&reader, repair->target, NULL, err);
  for (; !status; count += status == PLACIDO_OK) {
    status = placido_session_reader_next(reader, &frame, err);
  }
  placido_session_reader_close(reader);
  placido_frame_free(&frame);
  if (status == PLACIDO_END && count != repair->summary->kept) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "%s: %" PRId64 " frames were written, %" PRId64 " come back",
                             placido_text_tail(repair->target), repair->summary->kept, count);
  }
  return status == PLACIDO_END ? PLACIDO_OK : status;
}

static int choose_instrument(repairing *repair, const char *instrument_path, placido_error *err) {
  if (!instrument_path && !placido_disk_has(repair->path, "instrument.json")) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s has no instrument.json: give the instrument's file",
                             placido_text_tail(repair->path));
  }
  if (instrument_path && snprintf(repair->instrument_path, PLACIDO_PATH_MAX, "%s",
                                  instrument_path) >= PLACIDO_PATH_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "the instrument's path is too long");
  }
  return instrument_path ? PLACIDO_OK
                         : placido_path_join(repair->instrument_path, repair->path,
                                             "instrument.json", err);
}

static bool has_sound_description(const char *folder) {
  char path[PLACIDO_PATH_MAX];
  placido_session_info info;
  return placido_path_join(path, folder, "session.json", NULL) == PLACIDO_OK &&
         placido_session_describe_load(&info, path, NULL, NULL) == PLACIDO_OK;
}

int placido_session_repair(placido_repair_summary *summary, const char *path, const char *target,
                           const char *instrument_path, placido_notes *notes,
                           placido_error *err) {
  *summary = (placido_repair_summary){0};
  repairing repair = {.summary = summary, .path = path, .target = target};
  int status = placido_session_reader_open_torn(&repair.reader, path, notes, err);
  if (!status) {
    summary->has_description = has_sound_description(path);
    status = choose_instrument(&repair, instrument_path, err);
  }
  if (!status) {
    status = keep_frames(&repair, err);
  }
  if (!status) {
    count_lines(&repair);
  }
  const int closed = placido_session_writer_close(repair.writer, status ? NULL : err);
  status = status ? status : closed;
  if (!status) {
    status = keep_events(&repair, err);
  }
  if (!status) {
    status = keep_rest(&repair, notes, err);
  }
  if (!status) {
    status = verify(&repair, err);
  }
  placido_session_reader_close(repair.reader);
  return status;
}

void placido_repair_summary_free(placido_repair_summary *summary) {
  placido_ranges_free(&summary->lost);
}

/* Whether the frames of a session are what was recorded, and its log and clock fit them. */
#include "base/session/check.h"

#include "base/session/disk.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define VIDEO "frames.mkv"
#define LOG "frames.jsonl"

static int open_frames(placido_check *check, placido_error *err) {
  placido_error reason = {0};
  int status = placido_session_reader_open_torn(&check->reader, check->path, NULL, &reason);
  if (status) {
    return placido_check_settle(check, VIDEO, status, &reason, err);
  }
  placido_session_survey *survey = check->survey;
  const placido_video_reader *video = placido_session_reader_video(check->reader);
  const int said_bits = survey->info.bits;
  const enum placido_format said = survey->info.format;
  survey->info = *placido_session_reader_info(check->reader);
  survey->is_finished = placido_session_reader_is_finished(check->reader);
  survey->bytes = placido_disk_size(check->path, VIDEO);
  snprintf(survey->codec, sizeof survey->codec, "%s", placido_video_reader_codec_name(video));
  if (!survey->is_finished) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, VIDEO,
                       "has no proper end: the recording was cut off");
  }
  if (said_bits > 0 && said != survey->info.format) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, VIDEO,
                       "has %d-bit samples, session.json says %d", survey->info.bits, said_bits);
  }
  return PLACIDO_OK;
}

static int take_frame(placido_check *check, const placido_frame *frame, placido_error *err) {
  const placido_frame_info info = placido_session_reader_frame_info(check->reader);
  const placido_frames_log *log = placido_session_reader_log(check->reader);
  check->survey->width_px = frame->width_px;
  check->survey->height_px = frame->height_px;
  check->flagged += (info.flags & (PLACIDO_FRAME_TRUNCATED | PLACIDO_FRAME_CORRUPT)) != 0;
  check->unsummed += !info.has_crc32;
  int status = placido_clock_add(&check->clock, &info, err);
  if (!status && log->count > 0 && !placido_frames_log_find(log, info.index)) {
    status = placido_ranges_add(&check->unlisted, info.index, err);
  }
  return status;
}

static int read_frames(placido_check *check, placido_error *err) {
  placido_frame frame = {0};
  int status = PLACIDO_OK;
  while (!status) {
    status = placido_session_reader_next(check->reader, &frame, err);
    check->survey->frames += status != PLACIDO_END;
    if (!status) {
      status = take_frame(check, &frame, err);
    } else if (status == PLACIDO_INPUT) {
      const placido_frame_info info = placido_session_reader_frame_info(check->reader);
      status = placido_ranges_add(&check->damaged, info.index, err);
    }
  }
  placido_frame_free(&frame);
  check->survey->damaged = placido_ranges_total(&check->damaged);
  return status == PLACIDO_END ? PLACIDO_OK : status;
}

static void judge_frames(placido_check *check) {
  const placido_session_survey *survey = check->survey;
  const bool summed =
      placido_video_reader_has_checksums(placido_session_reader_video(check->reader));
  char text[160];
  if (survey->damaged > 0) {
    placido_ranges_text(text, sizeof text, &check->damaged);
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, VIDEO,
                       "%" PRId64 " of %" PRId64 " frames are damaged or missing: %s",
                       survey->damaged, survey->frames, text);
  } else if (survey->frames == 0) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, VIDEO, "has no frame");
  } else {
    placido_check_find(check, PLACIDO_FINDING_SOUND, VIDEO,
                       "%" PRId64 " frames, %d x %d, %d bit, %s", survey->frames, survey->width_px,
                       survey->height_px, survey->info.bits, survey->codec);
  }
  if (!summed && check->unsummed > 0) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, VIDEO,
                       "%" PRId64 " frames have no checksum: damage in them need not show",
                       check->unsummed);
  }
  if (check->flagged > 0) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, VIDEO,
                       "%" PRId64 " frames came truncated or corrupt from the camera",
                       check->flagged);
  }
}

/* Lines beyond the video's end: frames that were recorded and did not reach the disk. */
static int64_t count_beyond(const placido_check *check) {
  const placido_frames_log *log = placido_session_reader_log(check->reader);
  int64_t beyond = 0;
  for (size_t i = 0; i < log->count; i++) {
    beyond += log->frames[i].index >= check->survey->frames;
  }
  return beyond;
}

static int judge_log(placido_check *check, placido_error *err) {
  if (!placido_disk_has(check->path, LOG)) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, LOG,
                       "is missing: times and numbers are those of the video");
    return PLACIDO_OK;
  }
  char path[PLACIDO_PATH_MAX], text[160];
  placido_frames_log log;
  placido_notes notes = {0};
  int status = placido_path_join(path, check->path, LOG, err);
  if (!status) {
    status = placido_frames_log_load(&log, path, &notes, err);
  }
  if (status) {
    return status;
  }
  check->survey->lines = (int64_t)log.count;
  const int64_t beyond = count_beyond(check);
  if (log.bad > 0) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, LOG, "%zu bad lines; the first: %.160s",
                       log.bad, notes.count > 0 ? notes.lines[0] : "");
  }
  if (beyond > 0) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, LOG,
                       "%" PRId64 " frames that it has are not in the video: its end is lost",
                       beyond);
  }
  if (check->unlisted.count > 0) {
    placido_ranges_text(text, sizeof text, &check->unlisted);
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, LOG, "%" PRId64 " frames have no line: %s",
                       placido_ranges_total(&check->unlisted), text);
  }
  if (log.bad == 0 && beyond == 0 && check->unlisted.count == 0) {
    placido_check_find(check, PLACIDO_FINDING_SOUND, LOG, "%zu lines", log.count);
  }
  placido_frames_log_free(&log);
  placido_notes_clear(&notes);
  return PLACIDO_OK;
}

static int judge_clock(placido_check *check, placido_error *err) {
  placido_clock_figures *clock = &check->survey->clock;
  placido_ranges gaps = {0};
  char text[160];
  int status = placido_clock_read(clock, &check->clock, &gaps, err);
  placido_ranges_text(text, sizeof text, &gaps);
  if (clock->missing > 0) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, "sequence",
                       "%" PRId64 " frames of the camera's were not recorded, before %s",
                       clock->missing, text);
  }
  if (clock->restarts > 0) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, "sequence",
                       "the camera's counter began anew %" PRId64 " times", clock->restarts);
  }
  if (clock->missing == 0 && clock->restarts == 0) {
    placido_check_find(check, PLACIDO_FINDING_SOUND, "sequence", "without a gap");
  }
  if (clock->backwards > 0) {
    placido_check_find(check, PLACIDO_FINDING_DAMAGE, "clock",
                       "the time does not go forward %" PRId64 " times", clock->backwards);
  } else if (isnan(clock->seconds)) {
    placido_check_find(check, PLACIDO_FINDING_NOTE, "clock", "times are not known");
  } else {
    placido_check_find(check, PLACIDO_FINDING_SOUND, "clock",
                       "%.3f s, %.2f frames/s, jitter %.3f ms (rms), longest step %.1f ms",
                       clock->seconds, clock->rate_hz, clock->jitter_ms, clock->longest_ms);
  }
  placido_ranges_free(&gaps);
  return status;
}

int placido_check_frames(placido_check *check, placido_error *err) {
  int status = open_frames(check, err);
  if (status || !check->reader) {
    return status;
  }
  status = read_frames(check, err);
  if (!status) {
    judge_frames(check);
    status = judge_log(check, err);
  }
  return status ? status : judge_clock(check, err);
}

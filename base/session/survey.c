/* The figures of a session, from what can be read quickly. */
#include "base/session/archive.h"
#include "base/session/disk.h"
#include "base/session/events_log.h"
#include "base/session/reader.h"

#include <placido/instrument.h>

#include <stdio.h>
#include <string.h>

static int survey_instrument(placido_session_survey *survey, const char *path,
                             placido_notes *notes, placido_error *err) {
  placido_instrument instrument;
  int status = placido_instrument_load(&instrument, path, notes, err);
  if (!status) {
    snprintf(survey->instrument, sizeof survey->instrument, "%s", instrument.name);
    survey->calibrated = instrument.calibrated;
  }
  return status;
}

static int survey_events(placido_session_survey *survey, const char *folder, placido_error *err) {
  placido_events_log log;
  int status = placido_events_log_load(&log, folder, err);
  if (!status) {
    survey->events = (int64_t)json_array_size(log.lines);
    placido_events_log_free(&log);
  }
  return status;
}

static int survey_clock(placido_session_survey *survey, const placido_frames_log *log,
                        placido_error *err) {
  placido_clock clock = {0};
  int status = PLACIDO_OK;
  survey->lines = (int64_t)log->count;
  for (size_t i = 0; !status && i < log->count; i++) {
    status = placido_clock_add(&clock, &log->frames[i], err);
  }
  if (!status) {
    status = placido_clock_read(&survey->clock, &clock, NULL, err);
  }
  placido_clock_free(&clock);
  return status;
}

/* The first frame, for its size; where it is damaged, another one's would do, but not be quick. */
static int survey_video(placido_session_survey *survey, placido_session_reader *reader,
                        placido_error *err) {
  placido_video_reader *video = placido_session_reader_video(reader);
  placido_frame frame = {0};
  int64_t index;
  int status = placido_video_reader_next(video, &frame, &index, err);
  survey->width_px = frame.width_px;
  survey->height_px = frame.height_px;
  placido_frame_free(&frame);
  if (status == PLACIDO_MEMORY) {
    return status;
  }
  while (status != PLACIDO_END) {
    survey->frames++;
    status = placido_video_reader_skip(video, err);
    if (status && status != PLACIDO_END) {
      return status;
    }
  }
  return PLACIDO_OK;
}

int placido_session_survey_take(placido_session_survey *survey, const char *path,
                                placido_notes *notes, placido_error *err) {
  *survey = (placido_session_survey){0};
  placido_session_reader *reader;
  int status = placido_session_reader_open(&reader, path, notes, err);
  if (status) {
    return status;
  }
  survey->info = *placido_session_reader_info(reader);
  survey->is_finished = placido_session_reader_is_finished(reader);
  survey->bytes = placido_disk_size(path, "frames.mkv");
  snprintf(survey->codec, sizeof survey->codec, "%s",
           placido_video_reader_codec_name(placido_session_reader_video(reader)));
  status = survey_instrument(survey, placido_session_reader_instrument(reader), notes, err);
  if (!status) {
    status = survey_events(survey, path, err);
  }
  if (!status) {
    status = survey_clock(survey, placido_session_reader_log(reader), err);
  }
  if (!status) {
    status = survey_video(survey, reader, err);
  }
  placido_session_reader_close(reader);
  return status;
}

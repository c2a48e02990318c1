/* A recorded examination, read: session.json, the video, and the log of its frames put together. */
#include <placido/session.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/session/checksum.h"
#include "base/session/describe.h"
#include "base/session/disk.h"
#include "base/session/matroska.h"
#include "base/session/reader.h"
#include "base/text.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

struct placido_session_reader {
  placido_session_info info;
  char instrument_path[PLACIDO_PATH_MAX], video_path[PLACIDO_PATH_MAX];
  placido_frames_log log;
  placido_video_reader *video;
  bool is_finished; /* the video has its end */

  placido_frame_info last;   /* of the frame given or refused last */
  placido_frame_info anchor; /* the last one with a line, from which times are counted on */
  int64_t anchor_stream_ns;  /* the anchor's time in the video */
  bool has_anchor;
  int64_t lost; /* frames that the video skipped without a trace */

  int64_t untold;      /* of those, how many are still to be refused */
  placido_frame held;  /* the frame behind them */
  bool is_held;
};

/* The path of a file that a session must have. */
static int require(char *out, const char *folder, const char *name, placido_error *err) {
  int status = placido_path_join(out, folder, name, err);
  if (!status && access(out, F_OK) != 0) {
    status = placido_error_set(err, PLACIDO_INPUT, "%s is not a whole session: it has no %s",
                               placido_text_tail(folder), name);
  }
  return status;
}

static int read_description(placido_session_reader *reader, const char *folder,
                            placido_notes *notes, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = require(path, folder, "session.json", err);
  if (!status) {
    status = placido_session_describe_load(&reader->info, path, notes, err);
  }
  if (!status) {
    status = require(reader->instrument_path, folder, "instrument.json", err);
  }
  return status;
}

static int read_log(placido_session_reader *reader, const char *folder, placido_notes *notes,
                    placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, "frames.jsonl", err);
  return status ? status : placido_frames_log_load(&reader->log, path, notes, err);
}

/* 10- and 12-bit samples may stand in gray16le: the video tells two bytes, session.json how many of
 * their bits are used. In all else the video is right. */
static void settle_format(placido_session_info *info, const placido_video_reader *video,
                          const char *path, placido_notes *notes) {
  enum placido_format format;
  int bits;
  if (!placido_video_reader_format(video, &format, &bits)) {
    return;
  }
  if (info->bits > 0 && info->format != format) {
    placido_notes_add(notes, "%s has %d-bit samples, which is not what session.json says",
                      placido_text_tail(path), bits);
  }
  if (info->bits == 0 || info->format != format || bits < 16) {
    info->format = format;
    info->bits = bits;
  }
}

static int open_video(placido_session_reader *reader, const char *folder, placido_notes *notes,
                      placido_error *err) {
  int status = require(reader->video_path, folder, "frames.mkv", err);
  if (!status) {
    status = placido_disk_check_regular(reader->video_path, err);
  }
  if (!status) {
    status = placido_matroska_check_end(&reader->is_finished, reader->video_path, err);
  }
  if (!status) {
    status = placido_video_reader_open(&reader->video, reader->video_path, err);
  }
  if (status) {
    return status;
  }
  if (!reader->is_finished) {
    placido_notes_add(notes, "%s has no proper end (was the recording cut off?): its whole frames "
                             "are used",
                      placido_text_tail(reader->video_path));
  }
  reader->info.codec = placido_video_reader_codec(reader->video);
  settle_format(&reader->info, reader->video, reader->video_path, notes);
  if (isnan(reader->info.rate_hz)) {
    reader->info.rate_hz = placido_video_reader_rate_hz(reader->video);
  }
  return PLACIDO_OK;
}

/* What the description would have told is then told by the video, or not known. */
static int read_description_if_sound(placido_session_reader *reader, const char *folder,
                                     placido_notes *notes, placido_error *err) {
  placido_error reason = {0};
  int status = read_description(reader, folder, notes, &reason);
  if (status == PLACIDO_INPUT) {
    placido_notes_add(notes, "%s", reason.text);
    reader->info =
        (placido_session_info){.rate_hz = NAN, .axis_z_mm = NAN, .axis_z_sigma_mm = NAN};
    return PLACIDO_OK;
  }
  return status ? placido_error_set(err, status, "%s", reason.text) : PLACIDO_OK;
}

static int open_reader(placido_session_reader **reader, const char *path, bool torn,
                       placido_notes *notes, placido_error *err) {
  *reader = NULL;
  placido_session_reader *opened = placido_memory_new(1, sizeof *opened, err);
  if (!opened) {
    return PLACIDO_MEMORY;
  }
  int status = placido_disk_check_folder(path, err);
  if (!status) {
    status = torn ? read_description_if_sound(opened, path, notes, err)
                  : read_description(opened, path, notes, err);
  }
  if (!status) {
    status = read_log(opened, path, notes, err);
  }
  if (!status) {
    status = open_video(opened, path, notes, err);
  }
  if (status) {
    placido_session_reader_close(opened);
    return status;
  }
  *reader = opened;
  return PLACIDO_OK;
}

int placido_session_reader_open(placido_session_reader **reader, const char *path,
                                placido_notes *notes, placido_error *err) {
  return open_reader(reader, path, false, notes, err);
}

int placido_session_reader_open_torn(placido_session_reader **reader, const char *path,
                                     placido_notes *notes, placido_error *err) {
  return open_reader(reader, path, true, notes, err);
}

const placido_frames_log *placido_session_reader_log(const placido_session_reader *reader) {
  return &reader->log;
}

placido_video_reader *placido_session_reader_video(const placido_session_reader *reader) {
  return reader->video;
}

bool placido_session_reader_is_finished(const placido_session_reader *reader) {
  return reader->is_finished;
}

const placido_session_info *placido_session_reader_info(const placido_session_reader *reader) {
  return &reader->info;
}

const char *placido_session_reader_instrument(const placido_session_reader *reader) {
  return reader->instrument_path;
}

/* Sets `last` for a frame that was read, with its time in the video. */
static void describe_frame(placido_session_reader *reader, int64_t index, int64_t stream_ns) {
  const placido_frame_info *line = placido_frames_log_find(&reader->log, index);
  if (line) {
    reader->last = reader->anchor = *line;
    reader->anchor_stream_ns = stream_ns;
    reader->has_anchor = true;
    return;
  }
  reader->last = (placido_frame_info){.index = index,
                                      .t_ns = stream_ns,
                                      .seq = (uint64_t)index,
                                      .exposure_us = NAN,
                                      .gain_db = NAN};
  if (reader->has_anchor) {
    const placido_frame_info *anchor = &reader->anchor;
    reader->last.t_ns = anchor->t_ns + stream_ns - reader->anchor_stream_ns;
    reader->last.seq = anchor->seq + (uint64_t)(index - anchor->index);
  }
}

/* The same for one that could not be read: without a line its time is not known. */
static void describe_lost(placido_session_reader *reader, int64_t index) {
  const placido_frame_info *line = placido_frames_log_find(&reader->log, index);
  reader->last = line ? *line
                      : (placido_frame_info){.index = index,
                                             .seq = (uint64_t)index,
                                             .exposure_us = NAN,
                                             .gain_db = NAN};
}

static void fill_frame(const placido_session_reader *reader, placido_frame *frame) {
  frame->t_ns = reader->last.t_ns;
  frame->seq = reader->last.seq;
  frame->flags = reader->last.flags;
  if (reader->info.bits > 0 && frame->format == reader->info.format) {
    frame->bits = reader->info.bits;
  }
}

static int refuse_missing(placido_session_reader *reader, placido_error *err) {
  const int64_t index = reader->last.index + 1;
  reader->untold--;
  describe_lost(reader, index);
  return placido_error_set(err, PLACIDO_INPUT, "%s: frame %lld is missing",
                           placido_text_tail(reader->video_path), (long long)index);
}

/* The samples are not those of the frame's line. Where they are those of a later one, damage made
 * the demuxer skip frames: they are refused one by one, so that every frame keeps its number. More
 * than there are lines are not believed to be lost: a damaged line may have any number. */
static int settle_mismatch(placido_session_reader *reader, placido_frame *frame, uint32_t crc32,
                           placido_error *err) {
  const int64_t index = reader->last.index;
  const placido_frame_info *line =
      placido_frames_log_find_checksum(&reader->log, index + 1, crc32);
  if (!line || (uint64_t)(line->index - index) > reader->log.count) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: frame %lld is damaged (its checksum is not "
                                                 "that of frames.jsonl)",
                             placido_text_tail(reader->video_path), (long long)index);
  }
  reader->untold = line->index - index;
  reader->lost += reader->untold;
  placido_frame_free(&reader->held);
  reader->held = *frame;
  reader->is_held = true;
  *frame = (placido_frame){0};
  reader->last.index = index - 1;
  return refuse_missing(reader, err);
}

static void give_held(placido_session_reader *reader, placido_frame *frame) {
  placido_frame_free(frame);
  *frame = reader->held;
  reader->held = (placido_frame){0};
  reader->is_held = false;
  describe_frame(reader, reader->last.index + 1, frame->t_ns);
  fill_frame(reader, frame);
}

int placido_session_reader_next(placido_session_reader *reader, placido_frame *frame,
                                placido_error *err) {
  if (reader->untold > 0) {
    return refuse_missing(reader, err);
  }
  if (reader->is_held) {
    give_held(reader, frame);
    return PLACIDO_OK;
  }
  int64_t index;
  int status = placido_video_reader_next(reader->video, frame, &index, err);
  if (status == PLACIDO_END) {
    return status;
  }
  if (status) {
    describe_lost(reader, index + reader->lost);
    return status;
  }
  describe_frame(reader, index + reader->lost, frame->t_ns);
  if (reader->last.has_crc32) {
    const uint32_t crc32 = placido_frame_checksum(frame);
    if (crc32 != reader->last.crc32) {
      return settle_mismatch(reader, frame, crc32, err);
    }
  }
  fill_frame(reader, frame);
  return PLACIDO_OK;
}

placido_frame_info placido_session_reader_frame_info(const placido_session_reader *reader) {
  return reader->last;
}

int placido_session_reader_rewind(placido_session_reader *reader, placido_error *err) {
  /* Opened anew: a torn file has no index to seek by. */
  placido_video_reader *again;
  int status = placido_video_reader_open(&again, reader->video_path, err);
  if (!status) {
    placido_video_reader_close(reader->video);
    reader->video = again;
    reader->has_anchor = reader->is_held = false;
    reader->lost = reader->untold = 0;
  }
  return status;
}

void placido_session_reader_close(placido_session_reader *reader) {
  if (!reader) {
    return;
  }
  placido_video_reader_close(reader->video);
  placido_frame_free(&reader->held);
  placido_frames_log_free(&reader->log);
  placido_memory_free(reader);
}

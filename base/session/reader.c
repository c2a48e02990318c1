/* A recorded examination, read: session.json, the video, and the log of its frames put together. */
#include <placido/session.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/session/describe.h"
#include "base/session/frames_log.h"
#include "base/session/matroska.h"
#include "base/session/video.h"
#include "base/text.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct placido_session_reader {
  placido_session_info info;
  char instrument_path[PLACIDO_PATH_MAX], video_path[PLACIDO_PATH_MAX];
  placido_frames_log log;
  placido_video_reader *video;
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

static int check_folder(const char *path, placido_error *err) {
  struct stat found;
  int cause = stat(path, &found) != 0 ? errno : S_ISDIR(found.st_mode) ? 0 : ENOTDIR;
  if (cause) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot open the session %s: %s",
                             placido_text_tail(path), strerror(cause));
  }
  return PLACIDO_OK;
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

/* The demuxer would wait for ever at a pipe. */
static int check_regular(const char *path, placido_error *err) {
  struct stat found;
  if (stat(path, &found) == 0 && !S_ISREG(found.st_mode)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s is not a regular file",
                             placido_text_tail(path));
  }
  return PLACIDO_OK;
}

static int open_video(placido_session_reader *reader, const char *folder, placido_notes *notes,
                      placido_error *err) {
  bool finished;
  int status = require(reader->video_path, folder, "frames.mkv", err);
  if (!status) {
    status = check_regular(reader->video_path, err);
  }
  if (!status) {
    status = placido_matroska_check_end(&finished, reader->video_path, err);
  }
  if (!status) {
    status = placido_video_reader_open(&reader->video, reader->video_path, err);
  }
  if (status) {
    return status;
  }
  if (!finished) {
    placido_notes_add(notes, "%s has no proper end (was the recording cut off?): its whole frames "
                             "are used",
                      placido_text_tail(reader->video_path));
  }
  settle_format(&reader->info, reader->video, reader->video_path, notes);
  if (isnan(reader->info.rate_hz)) {
    reader->info.rate_hz = placido_video_reader_rate_hz(reader->video);
  }
  return PLACIDO_OK;
}

int placido_session_reader_open(placido_session_reader **reader, const char *path,
                                placido_notes *notes, placido_error *err) {
  *reader = NULL;
  placido_session_reader *opened = placido_memory_new(1, sizeof *opened, err);
  if (!opened) {
    return PLACIDO_MEMORY;
  }
  int status = check_folder(path, err);
  if (!status) {
    status = read_description(opened, path, notes, err);
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

const placido_session_info *placido_session_reader_info(const placido_session_reader *reader) {
  return &reader->info;
}

const char *placido_session_reader_instrument(const placido_session_reader *reader) {
  return reader->instrument_path;
}

int placido_session_reader_next(placido_session_reader *reader, placido_frame *frame,
                                placido_error *err) {
  int64_t index;
  int status = placido_video_reader_next(reader->video, frame, &index, err);
  if (status) {
    return status;
  }
  const placido_frame_info *line = placido_frames_log_find(&reader->log, index);
  frame->seq = line ? line->seq : (uint64_t)index;
  frame->flags = line ? line->flags : 0;
  if (line) {
    frame->t_ns = line->t_ns;
  }
  if (reader->info.bits > 0 && frame->format == reader->info.format) {
    frame->bits = reader->info.bits;
  }
  return PLACIDO_OK;
}

int placido_session_reader_rewind(placido_session_reader *reader, placido_error *err) {
  /* Opened anew: a torn file has no index to seek by. */
  placido_video_reader *again;
  int status = placido_video_reader_open(&again, reader->video_path, err);
  if (!status) {
    placido_video_reader_close(reader->video);
    reader->video = again;
  }
  return status;
}

void placido_session_reader_close(placido_session_reader *reader) {
  if (!reader) {
    return;
  }
  placido_video_reader_close(reader->video);
  placido_frames_log_free(&reader->log);
  placido_memory_free(reader);
}

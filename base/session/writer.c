/* A recorded examination, written as it happens: nothing waits for the end of the recording. */
#include <placido/session.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/session/checksum.h"
#include "base/session/describe.h"
#include "base/session/disk.h"
#include "base/session/frames_log.h"
#include "base/session/lines.h"
#include "base/session/video.h"
#include "base/text.h"

#include <placido/instrument.h>

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define SYNC_S 0.5

struct placido_session_writer {
  char folder[PLACIDO_PATH_MAX];
  enum placido_format format;
  int width_px, height_px; /* of the first frame; 0 before it */
  double rate_hz;
  enum placido_session_codec codec;
  int64_t count;
  struct timespec synced;
  placido_video_writer *video; /* opened by the first frame, which has the size */
  placido_lines frames, events;
};

/* The copy shows what was calibrated. */
static int copy_instrument(const char *folder, const char *instrument_path, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, "instrument.json", err);
  return status ? status : placido_disk_copy(path, instrument_path, err);
}

static int write_description(const char *folder, const placido_session_info *info,
                             placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, "session.json", err);
  if (!status) {
    status = placido_session_describe_save(info, path, err);
  }
  return status ? status : placido_disk_sync(path, err);
}

static int check_arguments(const placido_session_info *info, const char *instrument_path,
                           placido_error *err) {
  bool wide = info->format == PLACIDO_MONO16;
  if ((!wide && info->format != PLACIDO_MONO8) || info->bits < 8 ||
      info->bits > (wide ? 16 : 8)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a session holds grey frames of 8 or 16 bit (asked for: %d bits)",
                             info->bits);
  }
  if (info->codec >= PLACIDO_CODEC_OTHER) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a session is recorded as ffv1, ffvhuff or raw, not in another codec");
  }
  placido_instrument instrument;
  return placido_instrument_load(&instrument, instrument_path, NULL, err);
}

static int fill_folder(placido_session_writer *writer, const placido_session_info *info,
                       const char *instrument_path, placido_error *err) {
  int status = copy_instrument(writer->folder, instrument_path, err);
  if (!status) {
    status = placido_lines_create(&writer->frames, writer->folder, "frames.jsonl", err);
  }
  if (!status) {
    status = placido_lines_create(&writer->events, writer->folder, "events.jsonl", err);
  }
  if (!status) {
    status = write_description(writer->folder, info, err);
  }
  return status ? status : placido_disk_sync(writer->folder, err);
}

/* Removes a folder that holds nothing but what fill_folder makes. */
static void remove_folder(const char *folder) {
  static const char *const names[] = {"instrument.json", "frames.jsonl", "events.jsonl",
                                      "session.json"};
  char path[PLACIDO_PATH_MAX];
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    if (!placido_path_join(path, folder, names[i], NULL)) {
      unlink(path);
    }
  }
  rmdir(folder);
}

int placido_session_writer_create(placido_session_writer **writer, const char *path,
                                  const placido_session_info *info, const char *instrument_path,
                                  placido_error *err) {
  *writer = NULL;
  placido_session_writer *created = placido_memory_new(1, sizeof *created, err);
  if (!created) {
    return PLACIDO_MEMORY;
  }
  created->format = info->format;
  created->rate_hz = info->rate_hz;
  created->codec = info->codec;
  int status = check_arguments(info, instrument_path, err);
  if (!status && snprintf(created->folder, sizeof created->folder, "%s", path) >=
                     (int)sizeof created->folder) {
    status = placido_error_set(err, PLACIDO_INPUT, "the session's path is too long");
  }
  if (!status && mkdir(path, 0777) != 0) {
    status = placido_error_set(err, PLACIDO_SYSTEM, "cannot create the session %s: %s",
                               placido_text_tail(path), strerror(errno));
  }
  if (status) {
    placido_memory_free(created);
    return status;
  }
  status = fill_folder(created, info, instrument_path, err);
  if (status) {
    placido_session_writer_close(created, NULL);
    remove_folder(path);
    return status;
  }
  *writer = created;
  return PLACIDO_OK;
}

static int check_frame(const placido_session_writer *writer, const placido_frame *frame,
                       placido_error *err) {
  if (frame->format != writer->format) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the frame's format is not the session's (%s samples are expected)",
                             writer->format == PLACIDO_MONO16 ? "16-bit grey" : "8-bit grey");
  }
  if (writer->video &&
      (frame->width_px != writer->width_px || frame->height_px != writer->height_px)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a frame of %d x %d pixels in a session of %d x %d", frame->width_px,
                             frame->height_px, writer->width_px, writer->height_px);
  }
  return PLACIDO_OK;
}

static int start_video(placido_session_writer *writer, const placido_frame *first,
                       placido_error *err) {
  const placido_video_options options = {
      .codec = writer->codec, .rate_hz = writer->rate_hz, .origin_ns = first->t_ns};
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, writer->folder, "frames.mkv", err);
  if (!status) {
    status = placido_video_writer_open(&writer->video, path, &options, first, err);
  }
  writer->width_px = first->width_px;
  writer->height_px = first->height_px;
  return status;
}

/* Video and logs go to the disk twice a second: what stands in the system's memory survives a crash
 * of ours, but no power cut. */
static int synchronise_frames(placido_session_writer *writer, placido_error *err) {
  struct timespec now = {0};
  clock_gettime(CLOCK_MONOTONIC, &now);
  double elapsed_s = difftime(now.tv_sec, writer->synced.tv_sec) +
                     (double)(now.tv_nsec - writer->synced.tv_nsec) * 1e-9;
  if (elapsed_s < SYNC_S) {
    return PLACIDO_OK;
  }
  writer->synced = now;
  int status = placido_video_writer_sync(writer->video, err);
  if (!status) {
    status = placido_lines_sync(&writer->frames, err);
  }
  return status ? status : placido_lines_sync(&writer->events, err);
}

int placido_session_writer_append(placido_session_writer *writer, const placido_frame *frame,
                                  const placido_frame_info *frame_info, placido_error *err) {
  int status = check_frame(writer, frame, err);
  if (!status && !writer->video) {
    status = start_video(writer, frame, err);
  }
  if (!status) {
    status = placido_video_writer_append(writer->video, frame, err);
  }
  if (status) {
    return status;
  }
  placido_frame_info line = {.index = writer->count++,
                             .t_ns = frame->t_ns,
                             .seq = frame->seq,
                             .exposure_us = frame_info ? frame_info->exposure_us : NAN,
                             .gain_db = frame_info ? frame_info->gain_db : NAN,
                             .flags = frame->flags,
                             .has_crc32 = true,
                             .crc32 = placido_frame_checksum(frame)};
  status = placido_lines_append(&writer->frames, placido_frames_log_line(&line), err);
  return status ? status : synchronise_frames(writer, err);
}

int placido_session_writer_event(placido_session_writer *writer, int64_t t_ns, const char *name,
                                 const char *text, placido_error *err) {
  json_t *line = text ? json_pack("{s:I, s:s, s:s}", "t_ns", (json_int_t)t_ns, "event", name,
                                  "text", text)
                      : json_pack("{s:I, s:s}", "t_ns", (json_int_t)t_ns, "event", name);
  return placido_lines_append(&writer->events, line, err);
}

int placido_session_writer_close(placido_session_writer *writer, placido_error *err) {
  if (!writer) {
    return PLACIDO_OK;
  }
  int status = placido_video_writer_close(writer->video, err);
  int closed = placido_lines_close(&writer->frames, status ? NULL : err);
  status = status ? status : closed;
  closed = placido_lines_close(&writer->events, status ? NULL : err);
  status = status ? status : closed;
  placido_memory_free(writer);
  return status;
}

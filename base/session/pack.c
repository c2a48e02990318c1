/* What was recorded in haste becomes FFV1 for keeping. The fast copy goes only when every frame of
 * the new one was decoded again and found equal. */
#include "base/session/archive.h"
#include "base/session/checksum.h"
#include "base/session/disk.h"
#include "base/session/reader.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define VIDEO "frames.mkv"

static int refuse_damaged(const char *path, const char *what, placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s: %s: not packed (placido session repair makes a sound session of "
                           "what is whole)",
                           placido_text_tail(path), what);
}

int placido_pack_is_needed(bool *needed, const char *path, placido_error *err) {
  placido_session_reader *reader;
  placido_frame frame = {0};
  *needed = true;
  int status = placido_session_reader_open(&reader, path, NULL, err);
  if (status) {
    return status;
  }
  status = placido_session_reader_next(reader, &frame, err);
  if (!status) {
    const placido_video_reader *video = placido_session_reader_video(reader);
    *needed = placido_video_reader_codec(video) != PLACIDO_CODEC_FFV1 ||
              !placido_video_reader_has_checksums(video) ||
              !placido_session_reader_is_finished(reader);
  } else if (status == PLACIDO_INPUT || status == PLACIDO_END) {
    status = refuse_damaged(path, status == PLACIDO_END ? "has no frame" : "a frame is damaged",
                            err);
  }
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
  return status;
}

/* The old video, and the new one. */
typedef struct packing {
  placido_session_reader *reader; /* what is known of the old one's frames */
  placido_video_reader *from;
  char from_path[PLACIDO_PATH_MAX], to_path[PLACIDO_PATH_MAX];
  placido_frame frame, again;
  int64_t count;
} packing;

/* The next frame of the old video, which must be whole. */
static int take(packing *pack, placido_error *err) {
  int64_t index;
  int status = placido_video_reader_next(pack->from, &pack->frame, &index, err);
  if (status == PLACIDO_INPUT) {
    char what[64];
    snprintf(what, sizeof what, "frame %" PRId64 " is damaged", index);
    return refuse_damaged(pack->from_path, what, err);
  }
  return status;
}

static int append(packing *pack, placido_video_writer **writer, placido_error *err) {
  if (!*writer) {
    /* The stream's own times and depth stay as they are, whoever wrote it. */
    const placido_video_options options = {.codec = PLACIDO_CODEC_FFV1,
                                           .bits = pack->frame.bits,
                                           .rate_hz = placido_video_reader_rate_hz(pack->from)};
    int status = placido_video_writer_open(writer, pack->to_path, &options, &pack->frame, err);
    if (status) {
      return status;
    }
  }
  return placido_video_writer_append(*writer, &pack->frame, err);
}

static int encode(packing *pack, placido_error *err) {
  placido_video_writer *writer = NULL;
  int status = placido_video_reader_open(&pack->from, pack->from_path, err);
  while (!status) {
    status = take(pack, err);
    if (!status) {
      status = append(pack, &writer, err);
      pack->count++;
    }
  }
  status = status == PLACIDO_END ? PLACIDO_OK : status;
  if (!status && pack->count == 0) {
    status = refuse_damaged(pack->from_path, "has no frame", err);
  }
  const int closed = placido_video_writer_close(writer, status ? NULL : err);
  placido_video_reader_close(pack->from);
  pack->from = NULL;
  status = status ? status : closed;
  return status ? status : placido_disk_sync(pack->to_path, err);
}

static int refuse_change(const packing *pack, int64_t index, const char *what,
                         placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM,
                           "%s: frame %" PRId64 " would not be kept exactly (%s): not packed",
                           placido_text_tail(pack->from_path), index, what);
}

static bool are_equal(const placido_frame *a, const placido_frame *b) {
  bool equal = a->width_px == b->width_px && a->height_px == b->height_px &&
               a->format == b->format && a->bits == b->bits;
  const size_t size = (size_t)a->width_px * placido_format_bytes(a->format);
  for (int y = 0; equal && y < a->height_px; y++) {
    equal = memcmp(a->data + (size_t)y * a->stride_bytes, b->data + (size_t)y * b->stride_bytes,
                   size) == 0;
  }
  return equal;
}

/* One frame of both, and of the log. */
static int compare(packing *pack, int64_t index, placido_error *err) {
  const placido_frame_info *line =
      placido_frames_log_find(placido_session_reader_log(pack->reader), index);
  if (!are_equal(&pack->frame, &pack->again)) {
    return refuse_change(pack, index, "its samples", err);
  }
  if (!line && pack->frame.t_ns != pack->again.t_ns) {
    return refuse_change(pack, index, "its time", err);
  }
  if (line && line->has_crc32 && line->crc32 != placido_frame_checksum(&pack->again)) {
    return refuse_damaged(pack->from_path, "a frame is not the one that was recorded", err);
  }
  return PLACIDO_OK;
}

static int verify(packing *pack, placido_error *err) {
  placido_video_reader *to = NULL;
  int64_t index = 0;
  int status = placido_video_reader_open(&pack->from, pack->from_path, err);
  if (!status) {
    status = placido_video_reader_open(&to, pack->to_path, err);
  }
  while (!status) {
    status = placido_video_reader_next(to, &pack->again, &index, err);
    if (!status) {
      status = take(pack, err);
      status = status == PLACIDO_END ? refuse_change(pack, index, "it is one too many", err)
                                     : status;
    }
    if (!status) {
      status = compare(pack, index, err);
    }
  }
  if (status == PLACIDO_END) {
    status = index == pack->count && placido_video_reader_has_checksums(to)
                 ? PLACIDO_OK
                 : refuse_change(pack, index, "it is missing", err);
  }
  placido_video_reader_close(to);
  placido_video_reader_close(pack->from);
  pack->from = NULL;
  return status;
}

/* The session is whole as far as can be told without decoding: its video has an end, and the log no
 * frame that the video has not. */
static int check_ends(const packing *pack, const char *path, placido_error *err) {
  if (!placido_session_reader_is_finished(pack->reader)) {
    return refuse_damaged(path, "its video has no proper end", err);
  }
  const placido_frames_log *log = placido_session_reader_log(pack->reader);
  if (log->bad > 0) {
    return refuse_damaged(path, "frames.jsonl has bad lines", err);
  }
  if (log->count > 0 && log->frames[log->count - 1].index >= pack->count) {
    return refuse_damaged(path, "frames.jsonl has frames that the video has not", err);
  }
  return PLACIDO_OK;
}

int placido_pack_video(placido_pack_summary *summary, const char *path, const char *folder,
                       placido_error *err) {
  *summary = (placido_pack_summary){0};
  packing pack = {0};
  int status = placido_path_join(pack.from_path, path, VIDEO, err);
  if (!status) {
    status = placido_path_join(pack.to_path, folder, VIDEO, err);
  }
  if (!status) {
    status = placido_session_reader_open(&pack.reader, path, NULL, err);
  }
  if (!status) {
    pack.count = INT64_MAX; /* not known yet */
    status = check_ends(&pack, path, err);
    pack.count = 0;
  }
  if (!status) {
    status = encode(&pack, err);
  }
  if (!status) {
    status = check_ends(&pack, path, err);
  }
  if (!status) {
    status = verify(&pack, err);
  }
  summary->frames = pack.count;
  summary->bytes_before = placido_disk_size(path, VIDEO);
  summary->bytes_after = placido_disk_size(folder, VIDEO);
  placido_session_reader_close(pack.reader);
  placido_frame_free(&pack.frame);
  placido_frame_free(&pack.again);
  return status;
}

int placido_pack_rest(const char *path, const char *folder, placido_notes *notes,
                      placido_error *err) {
  static const char *const except[] = {VIDEO, PLACIDO_PACK_FOLDER, NULL};
  int status = placido_disk_copy_folder(folder, path, except, notes, err);
  return status ? status : placido_disk_sync(folder, err);
}

/* Whoever holds the lock is alone, so what lies there is of one that was killed. The system takes
 * the lock from a process that ends, however it ends. */
static int take_lock(int *lock, const char *path, placido_error *err) {
  *lock = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (*lock < 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot open the session %s: %s",
                             placido_text_tail(path), strerror(errno));
  }
  if (flock(*lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s is being packed by another process",
                             placido_text_tail(path));
  }
  return PLACIDO_OK;
}

int placido_pack_begin(int *lock, placido_directory *workshop, const char *path,
                       placido_error *err) {
  *workshop = (placido_directory){0};
  *lock = -1;
  char folder[PLACIDO_PATH_MAX], video[PLACIDO_PATH_MAX];
  int status = placido_path_join(folder, path, PLACIDO_PACK_FOLDER, err);
  if (!status) {
    status = placido_path_join(video, folder, VIDEO, err);
  }
  if (!status) {
    status = take_lock(lock, path, err);
  }
  if (status) {
    return status;
  }
  unlink(video); /* of a packing that was killed; mkdir tells where this is not enough */
  rmdir(folder);
  if (mkdir(folder, 0777) != 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot make %s: %s", placido_text_tail(folder),
                             strerror(errno));
  }
  memcpy(workshop->temporary, folder, sizeof workshop->temporary);
  return PLACIDO_OK;
}

int placido_pack_commit(placido_directory *workshop, const char *path, placido_error *err) {
  char from[PLACIDO_PATH_MAX], to[PLACIDO_PATH_MAX];
  int status = placido_path_join(from, workshop->temporary, VIDEO, err);
  if (!status) {
    status = placido_path_join(to, path, VIDEO, err);
  }
  if (!status && rename(from, to) != 0) {
    status = placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(to),
                               strerror(errno));
  }
  return status ? status : placido_disk_sync(path, err);
}

void placido_pack_end(int lock) {
  if (lock >= 0) {
    close(lock);
  }
}

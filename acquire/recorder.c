/* A thread that writes what waits: frames and events, which others hand over without waiting. */
#include "acquire/recorder.h"

#include "acquire/waiting.h"
#include "base/file.h"
#include "base/memory.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define QUEUE_BYTES_DEFAULT ((size_t)256 << 20)
#define DAMAGE (PLACIDO_FRAME_TRUNCATED | PLACIDO_FRAME_CORRUPT)

/* Frames dropped one after the other, told as one event when the run is over. */
struct drops {
  int64_t count, t_ns;
  uint64_t first_seq, last_seq;
};

struct placido_recorder {
  pthread_t thread;
  pthread_mutex_t lock;      /* guards everything below but writer and path */
  pthread_cond_t wake, room; /* something waits; something was written */
  placido_session_writer *writer; /* the thread's own, from open to close */
  char *path;
  size_t queue_bytes;
  placido_waiting waiting;
  bool ending;
  placido_error failure; /* of the writer; status PLACIDO_OK: none */

  /* What came. */
  struct drops drops;
  uint64_t last_seq;
  int64_t first_t_ns, last_t_ns, taken;
  bool any_seen;
  placido_recorder_summary summary; /* less bytes and seconds */
};

/* The lock is held where a function's name ends in _locked, before and after. */
static void note_failure_locked(placido_recorder *recorder, int status, const placido_error *err) {
  if (status != PLACIDO_OK) {
    recorder->failure = *err;
    recorder->failure.status = status;
  }
}

static void write_event_locked(placido_recorder *recorder) {
  placido_waiting_event *event = placido_waiting_event_take(&recorder->waiting);
  const bool failed = recorder->failure.status != PLACIDO_OK;
  placido_error err = {0};
  pthread_mutex_unlock(&recorder->lock);
  const int status = failed ? PLACIDO_OK
                            : placido_session_writer_event(recorder->writer, event->t_ns,
                                                           event->name, event->text, &err);
  placido_waiting_event_free(event);
  pthread_mutex_lock(&recorder->lock);
  note_failure_locked(recorder, status, &err);
}

/* After a failure nothing is written any more: what waits is dropped. */
static void write_frame_locked(placido_recorder *recorder) {
  placido_waiting_frame *item = placido_waiting_frame_take(&recorder->waiting);
  const bool failed = recorder->failure.status != PLACIDO_OK;
  placido_error err = {0};
  pthread_mutex_unlock(&recorder->lock);
  const int status = failed ? PLACIDO_OK
                            : placido_session_writer_append(recorder->writer, &item->frame,
                                                            item->has_info ? &item->info : NULL,
                                                            &err);
  pthread_mutex_lock(&recorder->lock);
  note_failure_locked(recorder, status, &err);
  if (failed || status != PLACIDO_OK) {
    recorder->summary.dropped++;
  } else {
    recorder->summary.written++;
    recorder->summary.damaged += (item->frame.flags & DAMAGE) != 0;
  }
  placido_waiting_frame_give_back(&recorder->waiting, item);
  pthread_cond_signal(&recorder->room);
}

/* The thread. Events go first: they are few, and tell of what waits. */
static void *write_all(void *user) {
  placido_recorder *recorder = user;
  pthread_mutex_lock(&recorder->lock);
  while (!recorder->ending || recorder->waiting.first || recorder->waiting.first_event) {
    if (recorder->waiting.first_event) {
      write_event_locked(recorder);
    } else if (recorder->waiting.first) {
      write_frame_locked(recorder);
    } else {
      pthread_cond_wait(&recorder->wake, &recorder->lock);
    }
  }
  pthread_mutex_unlock(&recorder->lock);
  return NULL;
}

/* Signals are for the threads that know what to do with them. */
static int start_thread(placido_recorder *recorder, placido_error *err) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  const int code = pthread_create(&recorder->thread, NULL, write_all, recorder);
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  return code == 0 ? PLACIDO_OK
                   : placido_error_set(err, PLACIDO_SYSTEM, "cannot start a thread to record: %s",
                                       strerror(code));
}

static void end_thread(placido_recorder *recorder) {
  pthread_mutex_lock(&recorder->lock);
  recorder->ending = true;
  pthread_cond_signal(&recorder->wake);
  pthread_mutex_unlock(&recorder->lock);
  pthread_join(recorder->thread, NULL);
}

static void free_recorder(placido_recorder *recorder) {
  placido_waiting_free(&recorder->waiting);
  pthread_cond_destroy(&recorder->room);
  pthread_cond_destroy(&recorder->wake);
  pthread_mutex_destroy(&recorder->lock);
  placido_memory_free(recorder->path);
  placido_memory_free(recorder);
}

int placido_recorder_open(placido_recorder **recorder, const char *path,
                          const placido_session_info *info, const char *instrument_path,
                          size_t queue_bytes, placido_error *err) {
  *recorder = NULL;
  placido_recorder *opened = placido_memory_new(1, sizeof *opened, err);
  if (!opened) {
    return PLACIDO_MEMORY;
  }
  pthread_mutex_init(&opened->lock, NULL);
  pthread_cond_init(&opened->wake, NULL);
  pthread_cond_init(&opened->room, NULL);
  opened->queue_bytes = queue_bytes > 0 ? queue_bytes : QUEUE_BYTES_DEFAULT;
  opened->path = placido_memory_string(path, err);
  int status = opened->path ? start_thread(opened, err) : PLACIDO_MEMORY;
  if (status != PLACIDO_OK) {
    free_recorder(opened);
    return status;
  }
  /* The thread first: a session that cannot be filled is then never made. It looks at the writer
   * when something waits, which is later. */
  status = placido_session_writer_create(&opened->writer, path, info, instrument_path, err);
  if (status != PLACIDO_OK) {
    end_thread(opened);
    free_recorder(opened);
    return status;
  }
  *recorder = opened;
  return PLACIDO_OK;
}

static int add_event_locked(placido_recorder *recorder, int64_t t_ns, const char *name,
                            const char *text, placido_error *err) {
  const int status = placido_waiting_event_add(&recorder->waiting, t_ns, name, text, err);
  pthread_cond_signal(&recorder->wake);
  return status;
}

int placido_recorder_event(placido_recorder *recorder, int64_t t_ns, const char *name,
                           const char *text, placido_error *err) {
  pthread_mutex_lock(&recorder->lock);
  const int status = add_event_locked(recorder, t_ns, name, text, err);
  pthread_mutex_unlock(&recorder->lock);
  return status;
}

static bool has_room_locked(const placido_recorder *recorder, const placido_frame *frame) {
  const size_t held = recorder->waiting.held_bytes;
  return held == 0 || (held <= recorder->queue_bytes &&
                       placido_waiting_bytes(frame) <= recorder->queue_bytes - held);
}

/* Frames that the device's counter skips never came here. */
static int count_missing_locked(placido_recorder *recorder, const placido_frame *frame,
                                placido_error *err) {
  const bool skips = recorder->any_seen && frame->seq > recorder->last_seq &&
                     frame->seq - recorder->last_seq > 1;
  const int64_t missing = skips ? (int64_t)(frame->seq - recorder->last_seq - 1) : 0;
  recorder->any_seen = true;
  recorder->last_seq = frame->seq;
  if (missing == 0) {
    return PLACIDO_OK;
  }
  char text[100];
  recorder->summary.missing += missing;
  snprintf(text, sizeof text, "%lld before sequence %llu: the device's counter skips them",
           (long long)missing, (unsigned long long)frame->seq);
  return add_event_locked(recorder, frame->t_ns, "frames missing", text, err);
}

static void drop_locked(placido_recorder *recorder, const placido_frame *frame) {
  struct drops *drops = &recorder->drops;
  if (drops->count++ == 0) {
    drops->t_ns = frame->t_ns;
    drops->first_seq = frame->seq;
  }
  drops->last_seq = frame->seq;
  recorder->summary.dropped++;
}

static int tell_drops_locked(placido_recorder *recorder, placido_error *err) {
  const struct drops drops = recorder->drops;
  if (drops.count == 0) {
    return PLACIDO_OK;
  }
  char text[120];
  recorder->drops = (struct drops){0};
  snprintf(text, sizeof text, "%lld, sequence %llu to %llu: the disk or the encoder is too slow",
           (long long)drops.count, (unsigned long long)drops.first_seq,
           (unsigned long long)drops.last_seq);
  return add_event_locked(recorder, drops.t_ns, "frames dropped", text, err);
}

static int take_locked(placido_recorder *recorder, placido_frame *frame,
                       const placido_frame_info *frame_info, placido_error *err) {
  const int64_t t_ns = frame->t_ns;
  int status = tell_drops_locked(recorder, err);
  if (status == PLACIDO_OK) {
    status = placido_waiting_frame_add(&recorder->waiting, frame, frame_info, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  if (recorder->taken++ == 0) {
    recorder->first_t_ns = t_ns;
  }
  recorder->last_t_ns = t_ns;
  if (recorder->waiting.count > recorder->summary.queue_most) {
    recorder->summary.queue_most = recorder->waiting.count;
  }
  pthread_cond_signal(&recorder->wake);
  return PLACIDO_OK;
}

static int report_locked(const placido_recorder *recorder, placido_error *err) {
  const placido_error *failure = &recorder->failure;
  return failure->status == PLACIDO_OK
             ? PLACIDO_OK
             : placido_error_set(err, failure->status, "%s", failure->text);
}

int placido_recorder_put(placido_recorder *recorder, placido_frame *frame,
                         const placido_frame_info *frame_info, placido_error *err) {
  pthread_mutex_lock(&recorder->lock);
  int status = count_missing_locked(recorder, frame, err);
  if (status == PLACIDO_OK) {
    status = report_locked(recorder, err);
  }
  if (status != PLACIDO_OK || !has_room_locked(recorder, frame)) {
    drop_locked(recorder, frame);
  } else {
    status = take_locked(recorder, frame, frame_info, err);
    recorder->summary.dropped += status != PLACIDO_OK;
  }
  pthread_mutex_unlock(&recorder->lock);
  return status;
}

void placido_recorder_pass(placido_recorder *recorder, const placido_frame *frame) {
  pthread_mutex_lock(&recorder->lock);
  recorder->any_seen = true;
  recorder->last_seq = frame->seq;
  pthread_mutex_unlock(&recorder->lock);
}

void placido_recorder_wait(placido_recorder *recorder, const placido_frame *frame) {
  pthread_mutex_lock(&recorder->lock);
  while (!has_room_locked(recorder, frame)) {
    pthread_cond_wait(&recorder->room, &recorder->lock);
  }
  pthread_mutex_unlock(&recorder->lock);
}

int64_t placido_recorder_index(placido_recorder *recorder) {
  pthread_mutex_lock(&recorder->lock);
  const int64_t index = recorder->taken;
  pthread_mutex_unlock(&recorder->lock);
  return index;
}

void placido_recorder_summary_get(placido_recorder *recorder, placido_recorder_summary *summary) {
  char path[PLACIDO_PATH_MAX];
  struct stat found;
  pthread_mutex_lock(&recorder->lock);
  *summary = recorder->summary;
  summary->seconds = (double)(recorder->last_t_ns - recorder->first_t_ns) * 1e-9;
  pthread_mutex_unlock(&recorder->lock);
  if (placido_path_join(path, recorder->path, "frames.mkv", NULL) == PLACIDO_OK &&
      stat(path, &found) == 0) {
    summary->bytes = (int64_t)found.st_size;
  }
}

int placido_recorder_close(placido_recorder *recorder, placido_recorder_summary *summary,
                           placido_error *err) {
  if (summary) {
    *summary = (placido_recorder_summary){0};
  }
  if (!recorder) {
    return PLACIDO_OK;
  }
  pthread_mutex_lock(&recorder->lock);
  const int told = tell_drops_locked(recorder, err);
  pthread_mutex_unlock(&recorder->lock);
  end_thread(recorder);
  int status = report_locked(recorder, err);
  const int closed =
      placido_session_writer_close(recorder->writer, status == PLACIDO_OK ? err : NULL);
  status = status != PLACIDO_OK ? status : closed != PLACIDO_OK ? closed : told;
  if (summary) {
    placido_recorder_summary_get(recorder, summary);
  }
  free_recorder(recorder);
  return status;
}

/* Pictures from a camera: a ring of transfers, checked piece by piece, started anew where it falls
 * out of step.
 *
 * The camera sends leader, samples and trailer without a mark between, so a single lost byte would
 * shift all that follows: the only cure is to stop the camera, empty the pipe and begin anew. */
#include "drivers/u3v/stream.h"

#include "drivers/u3v/picture.h"
#include "drivers/u3v/wire/registers.h"

#define FAILURES_MAX 3
/* After a second failure: what USB says first of an unplug is not that the camera is gone. */
#define FAILURE_WAIT_MS 100
#define LOOK_EVERY_NS 1000000000
#define GAP_MAX 0x80000000u /* a greater step is the camera beginning to count anew */

static int64_t now_ns(const placido_u3v_stream *stream) {
  const placido_u3v_calls *calls = stream->camera->calls;
  return calls->clock_ns(calls->context);
}

static int is_gone(const placido_u3v_stream *stream, placido_error *err) {
  return placido_error_set(err, PLACIDO_GONE, "the camera %s was unplugged",
                           stream->camera->bootstrap.model);
}

static int enable(placido_u3v_stream *stream, bool is_on, placido_error *err) {
  placido_u3v_camera *camera = stream->camera;
  return placido_u3v_channel_write_u32(&camera->channel,
                                       camera->bootstrap.sirm_address + PLACIDO_SIRM_CONTROL,
                                       is_on ? PLACIDO_SIRM_CONTROL_ENABLE : 0, err);
}

/* Tells a camera that has such a lock that sizes may not change now (or may again). */
static void lock_sizes(placido_u3v_stream *stream, bool is_locked) {
  placido_genicam *features = stream->camera->features;
  placido_feature lock;
  if (placido_genicam_describe(features, "TLParamsLocked", &lock, NULL) == PLACIDO_OK &&
      lock.can_write) {
    placido_genicam_set_integer(features, "TLParamsLocked", is_locked, NULL);
  }
}

/* Off, and nothing pending. Failures are of no consequence: the camera may be gone, and what is
 * held is given back all the same. */
static void halt(placido_u3v_stream *stream) {
  const int status = placido_genicam_execute(stream->camera->features, "AcquisitionStop", NULL);
  stream->is_hung = !placido_u3v_ring_free(stream->ring);
  stream->ring = NULL;
  if (status != PLACIDO_GONE && status != PLACIDO_TIMEOUT) {
    enable(stream, false, NULL);
    lock_sizes(stream, false);
  }
}

/* Sizes agreed and transfers ready, before the camera is switched on. */
static int prepare(placido_u3v_stream *stream, placido_error *err) {
  placido_u3v_camera *camera = stream->camera;
  placido_u3v_layout layout;
  int status = enable(stream, false, err); /* another program may have left it on */
  if (!status) {
    status = placido_u3v_layout_agree(&layout, &camera->channel, camera->bootstrap.sirm_address,
                                      placido_u3v_mode_bytes(stream->mode), err);
  }
  if (!status) {
    status = placido_u3v_ring_new(&stream->ring, camera->calls, camera->pipe, &layout,
                                  stream->buffers, err);
  }
  if (!status) {
    status = placido_u3v_clock_begin(&stream->clock, &camera->channel, err);
  }
  if (!status &&
      camera->calls->reset(camera->pipe, camera->found.stream_in) == PLACIDO_U3V_GONE) {
    status = is_gone(stream, err);
  }
  return status;
}

/* On, with every transfer waiting before the camera begins. */
static int begin(placido_u3v_stream *stream, placido_error *err) {
  int status = prepare(stream, err);
  status = status ? status : enable(stream, true, err);
  if (!status) {
    const enum placido_u3v_end end = placido_u3v_ring_fill(stream->ring);
    status = end == PLACIDO_U3V_GONE ? is_gone(stream, err) : PLACIDO_OK;
    if (!status && end != PLACIDO_U3V_DONE) {
      status = placido_error_set(err, PLACIDO_SYSTEM, "starting the camera %s: %s",
                                 stream->camera->bootstrap.model, placido_u3v_trouble(end));
    }
  }
  if (!status) {
    lock_sizes(stream, true);
    status = placido_genicam_execute(stream->camera->features, "AcquisitionStart", err);
  }
  if (status) {
    halt(stream);
    return status;
  }
  stream->trouble = NULL;
  stream->look_ns = now_ns(stream) + LOOK_EVERY_NS;
  return PLACIDO_OK;
}

int placido_u3v_stream_start(placido_u3v_stream *stream, placido_u3v_camera *camera,
                             const placido_u3v_mode *mode, int buffers, placido_error *err) {
  stream->camera = camera;
  stream->mode = mode;
  stream->buffers = buffers;
  stream->failure_count = 0;
  stream->lost = 0;
  stream->camera_id = UINT64_MAX; /* a first picture of number 0 follows it */
  stream->any_taken = stream->is_restarted = stream->is_hung = false;
  const int status = begin(stream, err);
  if (status) {
    stream->camera = NULL;
  }
  return status;
}

void placido_u3v_stream_stop(placido_u3v_stream *stream) {
  if (stream->camera && !stream->is_hung) {
    halt(stream);
  }
  stream->camera = NULL;
}

/* Ends and begins anew. PLACIDO_SYSTEM for all that may be better at the next attempt. */
static int restart(placido_u3v_stream *stream, placido_error *err) {
  const placido_u3v_calls *calls = stream->camera->calls;
  stream->statistics.restarts++;
  if (stream->ring) {
    stream->lost += placido_u3v_picture_lost(stream->ring, stream->camera_id);
  }
  stream->is_restarted = true;
  if (stream->failure_count > 1) {
    calls->sleep_ms(calls->context, FAILURE_WAIT_MS);
  }
  if (stream->ring) {
    halt(stream);
  }
  if (stream->is_hung) {
    return PLACIDO_SYSTEM;
  }
  const int status = begin(stream, err);
  return !status || status == PLACIDO_GONE || status == PLACIDO_MEMORY ? status : PLACIDO_SYSTEM;
}

/* The picture's number; counts what the camera's counter skipped. After a restart the camera may
 * count on or anew: at least the pictures that were seen to break are lost. */
static uint64_t number(placido_u3v_stream *stream, const placido_u3v_picture *picture) {
  /* Where leader and trailer differ, that one is right which follows the picture before. */
  const uint64_t id = picture->trailer.frame_id == stream->camera_id + 1
                          ? picture->trailer.frame_id
                          : picture->leader.frame_id;
  const uint64_t step = id - stream->camera_id;
  uint64_t gap = stream->any_taken && step >= 1 && step < GAP_MAX ? step - 1 : 0;
  if (stream->is_restarted && gap < stream->lost) {
    gap = stream->lost;
  }
  stream->statistics.dropped += gap;
  stream->next_seq += gap;
  stream->any_taken = true;
  stream->is_restarted = false;
  stream->lost = 0;
  stream->camera_id = id;
  return stream->next_seq++;
}

/* Makes the head a frame and gives its place back to the ring. */
static int give(placido_u3v_stream *stream, const placido_u3v_picture *picture,
                placido_frame *frame, placido_error *err) {
  const int64_t arrival_ns = placido_u3v_ring_head(stream->ring)->arrival_ns;
  const int status = placido_u3v_picture_to_frame(frame, picture, stream->ring, stream->mode, err);
  if (status == PLACIDO_MEMORY) {
    return status;
  }
  const uint64_t seq = number(stream, picture);
  const int64_t t_ns =
      placido_u3v_clock_time(&stream->clock, picture->leader.timestamp_ns, arrival_ns);
  placido_u3v_ring_next(stream->ring);
  stream->look_ns = now_ns(stream) + LOOK_EVERY_NS;
  stream->trouble = picture->trouble;
  if (!stream->trouble) {
    placido_u3v_ring_fill(stream->ring); /* where it fails, it does so again in the next call */
  }
  if (status) {
    stream->statistics.corrupt++;
    return status;
  }
  frame->seq = seq;
  frame->t_ns = t_ns;
  stream->statistics.frames++;
  stream->statistics.corrupt += (frame->flags & PLACIDO_FRAME_CORRUPT) != 0;
  stream->statistics.truncated += (frame->flags & PLACIDO_FRAME_TRUNCATED) != 0;
  return PLACIDO_OK;
}

/* Out of step, for a reason that a person may be told. */
static int fail(placido_u3v_stream *stream, const char *trouble) {
  stream->trouble = trouble;
  return PLACIDO_SYSTEM;
}

/* What silence means: that the camera is gone, that it has forgotten us, or just that. */
static int timed_out(placido_u3v_stream *stream, int timeout_ms, placido_error *err) {
  placido_u3v_camera *camera = stream->camera;
  if (now_ns(stream) >= stream->look_ns) {
    uint32_t control = 0;
    const int status = placido_u3v_channel_read_u32(
        &camera->channel, camera->bootstrap.sirm_address + PLACIDO_SIRM_CONTROL, &control, err);
    stream->look_ns = now_ns(stream) + LOOK_EVERY_NS;
    if (status == PLACIDO_GONE) {
      return is_gone(stream, err);
    }
    if (status || !(control & PLACIDO_SIRM_CONTROL_ENABLE)) {
      return fail(stream, status ? "the camera does not answer" : "the camera switched itself off");
    }
  }
  return placido_error_set(err, PLACIDO_TIMEOUT, "no frame within %d ms", timeout_ms);
}

/* Whether the head is there, at once. PLACIDO_TIMEOUT: not yet. */
static int try_head(placido_u3v_stream *stream, placido_frame *frame, placido_error *err) {
  enum placido_u3v_end end = placido_u3v_ring_fill(stream->ring);
  placido_u3v_picture picture;
  placido_u3v_ring_stamp(stream->ring);
  switch (placido_u3v_picture_look(&picture, stream->ring)) {
  case PLACIDO_U3V_WHOLE:
  case PLACIDO_U3V_EARLY:
    return give(stream, &picture, frame, err);
  case PLACIDO_U3V_LOST:
    return picture.is_gone ? is_gone(stream, err) : fail(stream, picture.trouble);
  default:
    break;
  }
  end = end ? end : placido_u3v_ring_fault(stream->ring);
  if (end == PLACIDO_U3V_GONE) {
    return is_gone(stream, err);
  }
  return end ? fail(stream, placido_u3v_trouble(end)) : PLACIDO_TIMEOUT;
}

/* A picture before the deadline. PLACIDO_SYSTEM: the stream must be started anew. */
static int take(placido_u3v_stream *stream, placido_frame *frame, int64_t deadline_ns,
                int timeout_ms, placido_error *err) {
  const placido_u3v_calls *calls = stream->camera->calls;
  void *pipe = stream->camera->pipe;
  int status = placido_u3v_clock_look(&stream->clock, &stream->camera->channel, err);
  if (status) {
    return status;
  }
  calls->wait(pipe, 0);
  while ((status = try_head(stream, frame, err)) == PLACIDO_TIMEOUT) {
    const int64_t left_ns = deadline_ns - now_ns(stream);
    if (left_ns <= 0) {
      return timed_out(stream, timeout_ms, err);
    }
    /* Rounded up, lest the last wait spins. */
    calls->wait(pipe, (int)((left_ns + 999999) / 1000000));
  }
  return status;
}

int placido_u3v_stream_next(placido_u3v_stream *stream, placido_frame *frame, int timeout_ms,
                            placido_error *err) {
  const int64_t deadline_ns = now_ns(stream) + (int64_t)timeout_ms * 1000000;
  int status;
  do {
    status = stream->trouble ? restart(stream, err) : PLACIDO_OK;
    status = status ? status : take(stream, frame, deadline_ns, timeout_ms, err);
    if (status != PLACIDO_SYSTEM) {
      stream->failure_count = status == PLACIDO_OK ? 0 : stream->failure_count;
      return status;
    }
    stream->failure_count++;
  } while (!stream->is_hung && stream->failure_count <= FAILURES_MAX &&
           now_ns(stream) < deadline_ns);
  if (stream->is_hung) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the system does not give back the transfers of the camera %s: unplug "
                             "it, and start the program anew",
                             stream->camera->bootstrap.model);
  }
  if (stream->failure_count <= FAILURES_MAX) {
    return placido_error_set(err, PLACIDO_TIMEOUT, "no frame within %d ms: %s", timeout_ms,
                             stream->trouble);
  }
  return placido_error_set(err, PLACIDO_SYSTEM, "the camera %s does not recover: %s",
                           stream->camera->bootstrap.model, stream->trouble);
}

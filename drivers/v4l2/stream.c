/* Pictures from a camera: a bounded queue of memory-mapped buffers, or read() where it has none.
 *
 * Any error of DQBUF may be that the camera was unplugged (uvcvideo says EINVAL), so each is
 * followed by the question whether the camera still answers. */
#include "drivers/v4l2/stream.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>

#define FAILURES_MAX 3
/* A suspension shorter than this is the two clocks being read one after the other. */
#define ASLEEP_MIN_NS 100000000
/* Silence behind a damaged picture that means a halt; cameras slower than this are none of ours. */
#define HALT_MIN_NS 1000000000

/* A buffer as the kernel wants it: with its only plane where the camera is multiplanar. */
struct ticket {
  struct v4l2_buffer buffer;
  struct v4l2_plane planes[VIDEO_MAX_PLANES];
};

static int buffer_ioctl(const placido_v4l2_camera *camera, unsigned long request,
                        struct ticket *ticket) {
  ticket->buffer.type = camera->type;
  ticket->buffer.memory = V4L2_MEMORY_MMAP;
  if (camera->is_multiplanar) {
    ticket->buffer.m.planes = ticket->planes;
    ticket->buffer.length = VIDEO_MAX_PLANES;
  }
  return placido_v4l2_ioctl(camera->calls, camera->fd, request, &ticket->buffer);
}

static int request_buffers(const placido_v4l2_camera *camera, uint32_t *count) {
  struct v4l2_requestbuffers request = {
      .count = *count, .type = camera->type, .memory = V4L2_MEMORY_MMAP};
  const int code = placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_REQBUFS, &request);
  *count = request.count;
  return code;
}

/* Maps one buffer. Returns 0 or errno. */
static int map_buffer(placido_v4l2_stream *stream, int index) {
  const placido_v4l2_camera *camera = stream->camera;
  struct ticket ticket = {.buffer = {.index = (uint32_t)index}};
  const int code = buffer_ioctl(camera, VIDIOC_QUERYBUF, &ticket);
  if (code) {
    return code;
  }
  const size_t size = camera->is_multiplanar ? ticket.planes[0].length : ticket.buffer.length;
  const uint32_t offset =
      camera->is_multiplanar ? ticket.planes[0].m.mem_offset : ticket.buffer.m.offset;
  if (size < 1 || size > PLACIDO_V4L2_PICTURE_MAX_BYTES) {
    return EPROTO;
  }
  errno = 0;
  void *bytes = camera->calls->mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, camera->fd,
                                    (off_t)offset);
  if (bytes == MAP_FAILED || !bytes) {
    return errno ? errno : EIO;
  }
  stream->buffers[index] = (placido_v4l2_buffer){.bytes = bytes, .size = size};
  return 0;
}

static int queue_buffer(placido_v4l2_stream *stream, int index) {
  struct ticket ticket = {.buffer = {.index = (uint32_t)index}};
  const int code = buffer_ioctl(stream->camera, VIDIOC_QBUF, &ticket);
  stream->buffers[index].is_queued = code == 0;
  return code;
}

/* Every buffer into the queue, and on. Returns 0 or errno. */
static int switch_on(placido_v4l2_stream *stream) {
  const placido_v4l2_camera *camera = stream->camera;
  int code = 0;
  for (int i = 0; !code && i < stream->buffer_count; i++) {
    code = queue_buffer(stream, i);
  }
  int type = (int)camera->type;
  stream->any_taken = false;
  stream->is_broken = false;
  return code ? code : placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_STREAMON, &type);
}

/* Off; every buffer leaves the queue. */
static int switch_off(placido_v4l2_stream *stream) {
  const placido_v4l2_camera *camera = stream->camera;
  int type = (int)camera->type;
  for (int i = 0; i < stream->buffer_count; i++) {
    stream->buffers[i].is_queued = false;
  }
  return placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_STREAMOFF, &type);
}

static int start_queue(placido_v4l2_stream *stream, int buffers) {
  uint32_t count = (uint32_t)buffers;
  int code = request_buffers(stream->camera, &count);
  if (code) {
    return code;
  }
  if (count < 1 || count > PLACIDO_V4L2_BUFFERS_MAX) {
    return count < 1 ? ENOMEM : EPROTO;
  }
  for (int i = 0; !code && i < (int)count; i++) {
    code = map_buffer(stream, i);
    stream->buffer_count = i + (code == 0);
  }
  return code ? code : switch_on(stream);
}

int placido_v4l2_stream_start(placido_v4l2_stream *stream, const placido_v4l2_camera *camera,
                              const placido_v4l2_mode *mode, int buffers, placido_error *err) {
  stream->camera = camera;
  stream->mode = mode;
  stream->failure_count = 0;
  stream->is_broken = stream->any_taken = false;
  stream->asleep_ns = camera->calls->asleep_ns();
  if (!mode->format->unpack) {
    const int status =
        placido_v4l2_mjpeg_new(&stream->decoder, mode->width_px, mode->height_px, err);
    if (status) {
      stream->camera = NULL;
      return status;
    }
  }
  int code = camera->can_stream ? start_queue(stream, buffers) : EINVAL;
  if (code == EINVAL && camera->can_read && stream->buffer_count == 0) {
    stream->read_buffer = placido_memory_new_aligned(mode->buffer_bytes, err);
    if (!stream->read_buffer) {
      placido_v4l2_stream_stop(stream);
      return PLACIDO_MEMORY;
    }
    code = 0;
  }
  if (code) {
    placido_v4l2_stream_stop(stream);
    return placido_v4l2_camera_failed(camera, "starting", code, err);
  }
  return PLACIDO_OK;
}

void placido_v4l2_stream_stop(placido_v4l2_stream *stream) {
  const placido_v4l2_camera *camera = stream->camera;
  if (!camera) {
    return;
  }
  /* Nothing can be done about a failure here: the camera may be gone, and what is held is given
   * back all the same. */
  if (!stream->read_buffer && camera->can_stream) {
    uint32_t none = 0;
    switch_off(stream);
    for (int i = 0; i < stream->buffer_count; i++) {
      camera->calls->munmap(stream->buffers[i].bytes, stream->buffers[i].size);
      stream->buffers[i] = (placido_v4l2_buffer){0};
    }
    request_buffers(camera, &none);
  }
  placido_memory_free(stream->read_buffer);
  placido_v4l2_mjpeg_free(stream->decoder);
  stream->read_buffer = NULL;
  stream->decoder = NULL;
  stream->buffer_count = 0;
  stream->camera = NULL;
}

/* One picture's bytes, on loan from the queue. */
struct picture {
  const uint8_t *bytes;
  size_t size;
  int index; /* of the buffer to be given back; -1: none */
  int64_t t_ns;
  bool is_bad;
  bool is_numbered;
  uint32_t kernel_seq;
};

/* The kernel's time stamp; the time now where it is of another clock or beyond all reason. */
static int64_t time_of(const placido_v4l2_stream *stream, const struct v4l2_buffer *buffer) {
  const int64_t now = stream->camera->calls->clock_ns();
  if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC ||
      buffer->timestamp.tv_sec < 0 || buffer->timestamp.tv_sec > now / 1000000000 + 1 ||
      buffer->timestamp.tv_usec < 0 || buffer->timestamp.tv_usec > 999999) {
    return now;
  }
  return (int64_t)buffer->timestamp.tv_sec * 1000000000 + buffer->timestamp.tv_usec * 1000;
}

/* Returns 0 or errno; EAGAIN where no picture is there yet. */
static int take_from_queue(placido_v4l2_stream *stream, struct picture *picture) {
  const placido_v4l2_camera *camera = stream->camera;
  struct ticket ticket = {{0}, {{0}}};
  const int code = buffer_ioctl(camera, VIDIOC_DQBUF, &ticket);
  if (code) {
    return code;
  }
  const uint32_t index = ticket.buffer.index;
  if (index >= (uint32_t)stream->buffer_count || !stream->buffers[index].is_queued) {
    return EPROTO;
  }
  placido_v4l2_buffer *buffer = &stream->buffers[index];
  buffer->is_queued = false;
  size_t used = ticket.buffer.bytesused, begin = 0;
  if (camera->is_multiplanar) {
    used = ticket.planes[0].bytesused;
    begin = ticket.planes[0].data_offset;
  }
  used = used < buffer->size ? used : buffer->size;
  begin = begin < used ? begin : used;
  *picture = (struct picture){.bytes = buffer->bytes + begin,
                              .size = used - begin,
                              .index = (int)index,
                              .t_ns = time_of(stream, &ticket.buffer),
                              .is_bad = ticket.buffer.flags & V4L2_BUF_FLAG_ERROR,
                              .is_numbered = true,
                              .kernel_seq = ticket.buffer.sequence};
  return 0;
}

static int take_by_read(placido_v4l2_stream *stream, struct picture *picture) {
  const placido_v4l2_camera *camera = stream->camera;
  errno = 0;
  const ssize_t got =
      camera->calls->read(camera->fd, stream->read_buffer, stream->mode->buffer_bytes);
  if (got < 0 || (size_t)got > stream->mode->buffer_bytes) {
    return got < 0 && errno == EINTR ? EAGAIN : got < 0 && errno ? errno : EPROTO;
  }
  *picture = (struct picture){.bytes = stream->read_buffer,
                              .size = (size_t)got,
                              .index = -1,
                              .t_ns = camera->calls->clock_ns()};
  return 0;
}

/* Waits for a picture until the deadline. Returns 0 (there may be one), ETIMEDOUT or errno. */
static int wait_for_picture(const placido_v4l2_stream *stream, int64_t deadline_ns) {
  const placido_v4l2_calls *calls = stream->camera->calls;
  const int64_t left_ns = deadline_ns - calls->clock_ns();
  /* Rounded up, so that the last wait does not spin; over 24 days poll's int would overflow. */
  const int64_t left_ms = left_ns > 0 ? (left_ns + 999999) / 1000000 : 0;
  struct pollfd file = {.fd = stream->camera->fd, .events = POLLIN};
  errno = 0;
  const int ready = calls->poll(&file, 1, left_ms < 1000000 ? (int)left_ms : 1000000);
  if (ready < 0 && errno != EINTR && errno != EAGAIN) {
    return errno ? errno : EIO;
  }
  if (ready > 0) {
    return 0;
  }
  return calls->clock_ns() >= deadline_ns || left_ms == 0 ? ETIMEDOUT : EAGAIN;
}

/* Starts the queue anew after an error. Returns 0 or errno. */
static int restart(placido_v4l2_stream *stream) {
  if (stream->read_buffer) {
    stream->is_broken = false;
    return 0;
  }
  const int code = switch_off(stream);
  stream->statistics.restarts++;
  return code ? code : switch_on(stream);
}

/* After a suspension of the computer some drivers never fill another buffer. */
static bool was_suspended(placido_v4l2_stream *stream) {
  const int64_t before_ns = stream->asleep_ns;
  stream->asleep_ns = stream->camera->calls->asleep_ns();
  return stream->asleep_ns - before_ns > ASLEEP_MIN_NS;
}

/* Waits for one picture and takes it. Returns 0, ETIMEDOUT or the errno of what failed. */
static int take(placido_v4l2_stream *stream, struct picture *picture, int64_t deadline_ns) {
  for (;;) {
    int code = wait_for_picture(stream, deadline_ns);
    if (code == 0) {
      code = stream->read_buffer ? take_by_read(stream, picture)
                                 : take_from_queue(stream, picture);
      if (code == EAGAIN) {
        /* Ready and yet empty: a nap, or a driver that always says so would burn a core. */
        stream->camera->calls->poll(NULL, 0, 1);
        if (stream->camera->calls->clock_ns() >= deadline_ns) {
          return ETIMEDOUT;
        }
      }
    }
    if (code != EAGAIN) {
      return code;
    }
  }
}

/* The picture's number; counts what the kernel's counter skipped. A counter that stands still or
 * goes back was set anew by the driver: no gap can be told. */
static uint64_t number(placido_v4l2_stream *stream, const struct picture *picture) {
  const uint32_t step = picture->kernel_seq - stream->kernel_seq;
  if (picture->is_numbered && stream->any_taken && step >= 1 && step < 0x80000000u) {
    stream->statistics.dropped += step - 1;
    stream->next_seq += step - 1;
  }
  stream->any_taken = true;
  stream->kernel_seq = picture->kernel_seq;
  return stream->next_seq++;
}

static int make_frame(placido_v4l2_stream *stream, placido_frame *frame,
                      const struct picture *picture, placido_error *err) {
  const placido_v4l2_mode *mode = stream->mode;
  const uint64_t seq = number(stream, picture);
  const int status =
      stream->decoder
          ? placido_v4l2_mjpeg_decode(stream->decoder, frame, picture->bytes, picture->size, err)
          : placido_v4l2_convert(frame, mode->format, mode->width_px, mode->height_px,
                                 picture->bytes, picture->size, mode->stride_bytes, err);
  if (status) {
    stream->statistics.corrupt += status == PLACIDO_INPUT;
    return status;
  }
  frame->seq = seq;
  frame->t_ns = picture->t_ns;
  frame->flags |= picture->is_bad ? PLACIDO_FRAME_CORRUPT : 0;
  stream->statistics.frames++;
  stream->statistics.corrupt += (frame->flags & PLACIDO_FRAME_CORRUPT) != 0;
  stream->statistics.truncated += (frame->flags & PLACIDO_FRAME_TRUNCATED) != 0;
  return PLACIDO_OK;
}

/* Whether a damaged picture was followed by silence: uvcvideo gives nothing more after a stalled
 * endpoint until the queue is started anew. */
static bool has_halted(placido_v4l2_stream *stream) {
  const bool halted =
      stream->mend_at_ns > 0 && stream->camera->calls->clock_ns() >= stream->mend_at_ns;
  if (halted) {
    stream->mend_at_ns = 0;
    stream->is_broken = true;
  }
  return halted;
}

/* What a time-out means: that the camera is gone, that the computer slept, or just that. */
static int timed_out(placido_v4l2_stream *stream, int timeout_ms, placido_error *err) {
  if (!placido_v4l2_camera_is_there(stream->camera)) {
    return placido_v4l2_camera_failed(stream->camera, "waiting for", ETIMEDOUT, err);
  }
  stream->is_broken = stream->is_broken || was_suspended(stream);
  return placido_error_set(err, PLACIDO_TIMEOUT, "no frame within %d ms", timeout_ms);
}

int placido_v4l2_stream_next(placido_v4l2_stream *stream, placido_frame *frame, int timeout_ms,
                             placido_error *err) {
  const int64_t deadline_ns =
      stream->camera->calls->clock_ns() + (int64_t)timeout_ms * 1000000;
  struct picture picture = {.index = -1};
  int code;
  do {
    code = stream->is_broken ? restart(stream) : 0;
    const int64_t mend_at_ns = stream->mend_at_ns;
    const bool may_mend = mend_at_ns > 0 && mend_at_ns < deadline_ns;
    code = code ? code : take(stream, &picture, may_mend ? mend_at_ns : deadline_ns);
    if (code == ETIMEDOUT && has_halted(stream)) {
      continue;
    }
    if (code == ETIMEDOUT) {
      return timed_out(stream, timeout_ms, err);
    }
    stream->is_broken = code != 0;
    stream->failure_count = code ? stream->failure_count + 1 : 0;
  } while (code && stream->failure_count <= FAILURES_MAX &&
           placido_v4l2_camera_is_there(stream->camera));
  if (code) {
    return placido_v4l2_camera_failed(stream->camera, "taking a picture from", code, err);
  }
  stream->mend_at_ns =
      picture.is_bad ? stream->camera->calls->clock_ns() + HALT_MIN_NS : 0;
  const int status = make_frame(stream, frame, &picture, err);
  if (picture.index >= 0 && queue_buffer(stream, picture.index)) {
    stream->is_broken = true; /* this frame is whole; the next call mends the queue */
  }
  return status;
}

int placido_v4l2_stream_export(const placido_v4l2_stream *stream, int buffer, int *descriptor,
                               placido_error *err) {
  *descriptor = -1;
  if (!stream->camera || buffer < 0 || buffer >= stream->buffer_count) {
    return placido_error_set(err, PLACIDO_INPUT, "buffer %d of a queue of %d", buffer,
                             stream->buffer_count);
  }
  struct v4l2_exportbuffer wish = {
      .type = stream->camera->type, .index = (uint32_t)buffer, .flags = O_CLOEXEC | O_RDONLY};
  const int code =
      placido_v4l2_ioctl(stream->camera->calls, stream->camera->fd, VIDIOC_EXPBUF, &wish);
  if (code || wish.fd < 0) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "the camera %s does not share buffers: %s",
                             stream->camera->card, strerror(code ? code : EBADF));
  }
  *descriptor = wish.fd;
  return PLACIDO_OK;
}

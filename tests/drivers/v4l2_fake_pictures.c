/* A camera played from a script: its buffers, and what comes of every picture. */
#include "tests/drivers/v4l2_fake_inside.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

int fake_request_buffers(struct v4l2_requestbuffers *said) {
  if (!fake.can_stream) {
    return fake_fail(EINVAL);
  }
  if (said->count > 0 && fake.is_streaming) {
    return fake_fail(EBUSY);
  }
  fake.queue_length = 0;
  fake.buffer_count = said->count < 8 ? said->count : 8;
  fake.buffer_size = fake_or_lie((uint32_t)fake.picture_size, fake.lie_length);
  said->count = said->count ? fake_or_lie(fake.buffer_count, fake.lie_count) : 0;
  return 0;
}

int fake_query_buffer(struct v4l2_buffer *said) {
  if (said->index >= fake_or_lie(fake.buffer_count, fake.lie_count)) {
    return fake_fail(EINVAL);
  }
  if (fake.is_multiplanar) {
    said->m.planes[0].length = fake.buffer_size;
    said->m.planes[0].m.mem_offset = said->index * 4096;
    said->length = 1;
  } else {
    said->length = fake.buffer_size;
    said->m.offset = said->index * 4096;
  }
  return 0;
}

int fake_queue(struct v4l2_buffer *said) {
  if (said->index >= fake.buffer_count || fake.buffers[said->index].is_queued) {
    return fake_fail(EINVAL);
  }
  fake.buffers[said->index].is_queued = true;
  fake.queue[fake.queue_length++] = said->index;
  return 0;
}

static const struct fake_event *event_now(void) {
  static const struct fake_event fine;
  return fake.event_next < fake.event_count ? &fake.events[fake.event_next] : &fine;
}

static struct fake_event take_event(void) {
  const struct fake_event event = *event_now();
  fake.event_next += fake.event_next < fake.event_count;
  return event;
}

static void fill(uint8_t *bytes, size_t size) {
  memset(bytes, 0, size);
  if (fake.picture) {
    memcpy(bytes, fake.picture, size < fake.picture_size ? size : fake.picture_size);
  }
}

int fake_dequeue(struct v4l2_buffer *said) {
  if (!fake.is_streaming) {
    return fake_fail(EINVAL);
  }
  if (fake.queue_length == 0 || event_now()->is_silent) {
    return fake_fail(EAGAIN);
  }
  const struct fake_event event = take_event();
  if (event.is_unplug) {
    fake_unplug();
    return fake_fail(EINVAL);
  }
  if (event.code) {
    return fake_fail(event.code);
  }
  const uint32_t index = fake.queue[0];
  fake.queue_length--;
  memmove(fake.queue, fake.queue + 1, fake.queue_length * sizeof *fake.queue);
  fake.buffers[index].is_queued = false;
  if (fake.buffers[index].bytes) {
    fill(fake.buffers[index].bytes, fake.buffer_size);
  }
  fake.sequence += event.skip;
  const uint32_t used = event.is_short ? event.used : fake.buffer_size;
  said->index = event.is_elsewhere ? event.index : index;
  said->flags = event.flags | V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  said->sequence = fake.sequence++;
  said->timestamp.tv_sec = fake.lie_seconds ? fake.lie_seconds : fake.clock_ns / 1000000000;
  said->timestamp.tv_usec = fake.clock_ns % 1000000000 / 1000;
  if (fake.is_multiplanar) {
    said->m.planes[0].bytesused = used;
    said->m.planes[0].data_offset = fake.lie_data_offset;
  } else {
    said->bytesused = used;
  }
  return 0;
}

int fake_stream(bool on) {
  if (on && !fake.can_stream) {
    return fake_fail(EINVAL);
  }
  fake.streamon_count += on;
  fake.is_streaming = on;
  if (on) {
    fake.sequence = 0;
  }
  for (size_t i = 0; !on && i < FAKE_BUFFERS; i++) {
    fake.buffers[i].is_queued = false;
  }
  fake.queue_length = on ? fake.queue_length : 0;
  return 0;
}

int fake_export(struct v4l2_exportbuffer *said) {
  if (fake.cannot_export || said->index >= fake.buffer_count) {
    return fake_fail(ENOTTY);
  }
  said->fd = FAKE_FD_FIRST + 500;
  return 0;
}

void *fake_mmap(void *address, size_t length, int protection, int flags, int fd, off_t offset) {
  (void)address;
  (void)protection;
  (void)flags;
  if (fake_must_fail()) {
    errno = fake.fail_code;
    return MAP_FAILED;
  }
  const size_t index = (size_t)offset / 4096;
  uint8_t *bytes = fake_is_alive(fd) && length == fake.buffer_size && index < FAKE_BUFFERS
                       ? malloc(length)
                       : NULL;
  if (!bytes) {
    errno = fake_is_alive(fd) ? EINVAL : ENODEV;
    return MAP_FAILED;
  }
  fake.buffers[index].bytes = bytes;
  fake.mapped_count++;
  return bytes;
}

int fake_munmap(void *address, size_t length) {
  (void)length;
  for (size_t i = 0; i < FAKE_BUFFERS; i++) {
    if (fake.buffers[i].bytes == address) {
      fake.buffers[i].bytes = NULL;
    }
  }
  free(address);
  fake.mapped_count--;
  return 0;
}

int fake_poll(struct pollfd *files, nfds_t count, int timeout_ms) {
  if (fake_must_fail()) {
    fake.clock_ns += 1000000; /* time goes on, whatever fails */
    return fake_fail(fake.fail_code);
  }
  if (count == 0) {
    fake.clock_ns += (int64_t)timeout_ms * 1000000;
    return 0;
  }
  if (!fake_is_alive(files->fd)) {
    files->revents = POLLERR | POLLHUP;
    return 1;
  }
  const bool has_room = fake.can_stream ? fake.queue_length > 0 : true;
  if (fake.is_always_ready || (has_room && !event_now()->is_silent)) {
    fake.clock_ns += 1000000;
    files->revents = POLLIN;
    return 1;
  }
  fake.clock_ns += (int64_t)timeout_ms * 1000000;
  fake.event_next += event_now()->is_silent;
  return 0;
}

ssize_t fake_read(int fd, void *bytes, size_t size) {
  if (fake_must_fail()) {
    return fake_fail(fake.fail_code);
  }
  if (!fake_is_alive(fd)) {
    return fake_fail(ENODEV);
  }
  const struct fake_event event = take_event();
  if (event.is_unplug) {
    fake_unplug();
    return fake_fail(EIO);
  }
  if (event.code) {
    return fake_fail(event.code);
  }
  const size_t given = event.is_short ? event.used : fake.picture_size;
  const size_t whole = given < size ? given : size;
  fill(bytes, whole);
  return (ssize_t)whole;
}

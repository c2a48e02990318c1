/* A camera played from a script, in the place of the kernel's system calls. */
#include "tests/drivers/v4l2_fake.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))
#define FD_FIRST 100000 /* no descriptor of the process */

struct fake fake;

void fake_reset(void) {
  memset(&fake, 0, sizeof fake);
  fake.card = "Fake camera";
  fake.bus = "usb-fake-1";
  fake.can_stream = fake.has_rate = true;
  fake.offers[0] = (struct fake_offer){V4L2_PIX_FMT_GREY, 8, 4, {60, 30}};
  fake.rate = 30;
  fake.clock_ns = 5000000000;
}

void fake_next(struct fake_event event) {
  if (fake.event_count < FAKE_EVENTS) {
    fake.events[fake.event_count++] = event;
  }
}

void fake_unplug(void) {
  fake.is_gone = true;
  fake.generation++;
  fake.is_streaming = false;
  fake.queue_length = 0;
  for (size_t i = 0; i < FAKE_BUFFERS; i++) {
    fake.buffers[i].is_queued = false;
  }
}

void fake_replug(void) {
  fake.is_gone = false;
  fake.sequence = 0;
}

static int fail(int code) {
  errno = code;
  return -1;
}

/* Counts a call; true where it is to fail. */
static bool must_fail(void) {
  fake.call_count++;
  return fake.fail_at > 0 && (fake.call_count == fake.fail_at ||
                              (fake.fails_for_ever && fake.call_count > fake.fail_at));
}

static bool is_alive(int fd) {
  return fd == FD_FIRST + fake.generation && !fake.is_gone;
}

static int fake_open(const char *path, int flags) {
  if (must_fail()) {
    return fail(fake.fail_code);
  }
  fake.last_open_flags = flags;
  fake.is_second = fake.second_bus && strstr(path, "/dev/video1");
  if (fake.is_gone || (!fake.is_second && !strstr(path, "/dev/video0"))) {
    return fail(ENOENT);
  }
  fake.open_count++;
  return FD_FIRST + fake.generation;
}

static int fake_close(int fd) {
  (void)fd;
  fake.open_count--;
  fake.is_streaming = false;
  return 0;
}

/* Text in a field of fixed size, which need not have an end. */
static void put(void *field, size_t size, const char *text) {
  const size_t length = strlen(text);
  memset(field, 0, size);
  memcpy(field, text, length < size ? length : size);
}

static int query_capabilities(struct v4l2_capability *said) {
  put(said->card, sizeof said->card, fake.card);
  put(said->bus_info, sizeof said->bus_info, fake.is_second ? fake.second_bus : fake.bus);
  memcpy(said->driver, "fake", 5);
  said->device_caps = (fake.is_not_camera        ? V4L2_CAP_META_CAPTURE
                       : fake.is_multiplanar     ? V4L2_CAP_VIDEO_CAPTURE_MPLANE
                                                 : V4L2_CAP_VIDEO_CAPTURE) |
                      (fake.can_stream ? V4L2_CAP_STREAMING : 0) |
                      (fake.can_read ? V4L2_CAP_READWRITE : 0);
  said->capabilities = said->device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

/* The formats in the order of the offers, each once. */
static int enumerate_formats(struct v4l2_fmtdesc *said) {
  uint32_t index = said->index;
  if (fake.lists_never_end) {
    index = 0;
  }
  for (size_t i = 0; i < COUNT(fake.offers) && fake.offers[i].fourcc; i++) {
    if (i > 0 && fake.offers[i].fourcc == fake.offers[i - 1].fourcc) {
      continue;
    }
    if (index-- == 0) {
      said->pixelformat = fake.offers[i].fourcc;
      memset(said->description, 'x', sizeof said->description); /* without an end */
      return 0;
    }
  }
  return fail(EINVAL);
}

static int enumerate_sizes(struct v4l2_frmsizeenum *said) {
  uint32_t index = fake.lists_never_end ? 0 : said->index;
  if (fake.has_size_range && index == 0) {
    said->type = V4L2_FRMSIZE_TYPE_STEPWISE;
    said->stepwise = (struct v4l2_frmsize_stepwise){2, 1 << 20, 2, 2, 1 << 20, 2};
    return 0;
  }
  for (size_t i = 0; !fake.gives_no_sizes && i < COUNT(fake.offers); i++) {
    if (fake.offers[i].fourcc == said->pixel_format && index-- == 0) {
      said->type = V4L2_FRMSIZE_TYPE_DISCRETE;
      said->discrete.width = fake.offers[i].width;
      said->discrete.height = fake.offers[i].height;
      return 0;
    }
  }
  return fail(fake.gives_no_sizes ? ENOTTY : EINVAL);
}

static int enumerate_rates(struct v4l2_frmivalenum *said) {
  for (size_t i = 0; i < COUNT(fake.offers); i++) {
    const struct fake_offer *offer = &fake.offers[i];
    if (offer->fourcc == said->pixel_format && offer->width == said->width &&
        offer->height == said->height && said->index < COUNT(offer->rates) &&
        offer->rates[said->index]) {
      said->type = V4L2_FRMIVAL_TYPE_DISCRETE;
      said->discrete = (struct v4l2_fract){1, offer->rates[said->index]};
      return 0;
    }
  }
  return fail(EINVAL);
}

static uint32_t or_lie(uint32_t truth, uint32_t lie) {
  return lie ? lie : truth;
}

/* Takes the offer of the format whose size is nearest, as drivers do. */
static void settle(uint32_t fourcc, uint32_t width, uint32_t height) {
  const struct fake_offer *best = NULL;
  long best_distance = 0;
  for (size_t i = 0; i < COUNT(fake.offers) && fake.offers[i].fourcc; i++) {
    const struct fake_offer *offer = &fake.offers[i];
    const long distance = labs((long)offer->width - (long)width) +
                          labs((long)offer->height - (long)height) +
                          (offer->fourcc == fourcc ? 0 : 1000000);
    if (!best || distance < best_distance) {
      best = offer;
      best_distance = distance;
    }
  }
  if (best && fake.has_size_range) {
    fake.width = width;
    fake.height = height;
    fake.fourcc = best->fourcc;
  } else if (best) {
    fake.fourcc = or_lie(best->fourcc, fake.lie_fourcc);
    fake.width = or_lie(best->width, fake.lie_width);
    fake.height = or_lie(best->height, fake.lie_height);
  }
  fake.stride = fake.lie_stride;
  fake.size = or_lie((uint32_t)fake.picture_size, fake.lie_size);
}

static int do_format(struct v4l2_format *said, bool sets) {
  if (fake.is_streaming && sets) {
    return fail(EBUSY);
  }
  struct v4l2_pix_format *pix = &said->fmt.pix;
  struct v4l2_pix_format_mplane *planes = &said->fmt.pix_mp;
  if (sets) {
    settle(fake.is_multiplanar ? planes->pixelformat : pix->pixelformat, pix->width, pix->height);
  }
  if (fake.is_multiplanar) {
    planes->width = fake.width;
    planes->height = fake.height;
    planes->pixelformat = fake.fourcc;
    planes->field = V4L2_FIELD_NONE;
    planes->num_planes = (uint8_t)or_lie(1, fake.lie_planes);
    planes->plane_fmt[0].bytesperline = fake.stride;
    planes->plane_fmt[0].sizeimage = fake.size;
  } else {
    *pix = (struct v4l2_pix_format){.width = fake.width,
                                    .height = fake.height,
                                    .pixelformat = fake.fourcc,
                                    .field = V4L2_FIELD_NONE,
                                    .bytesperline = fake.stride,
                                    .sizeimage = fake.size};
  }
  return 0;
}

static int do_rate(struct v4l2_streamparm *said, bool sets) {
  struct v4l2_fract *interval = &said->parm.capture.timeperframe;
  if (!fake.has_rate) {
    return fail(ENOTTY);
  }
  if (sets && fake.is_streaming) {
    return fail(EBUSY);
  }
  if (sets) { /* it can do 30 and 60 */
    fake.rate = 2 * interval->denominator > 90 * interval->numerator ? 60 : 30;
  }
  *interval = (struct v4l2_fract){1, fake.rate};
  return 0;
}

static int request(struct v4l2_requestbuffers *said) {
  if (!fake.can_stream) {
    return fail(EINVAL);
  }
  if (said->count > 0 && fake.is_streaming) {
    return fail(EBUSY);
  }
  fake.queue_length = 0;
  fake.buffer_count = said->count < 8 ? said->count : 8;
  fake.buffer_size = or_lie((uint32_t)fake.picture_size, fake.lie_length);
  said->count = said->count ? or_lie(fake.buffer_count, fake.lie_count) : 0;
  return 0;
}

static int query_buffer(struct v4l2_buffer *said) {
  if (said->index >= or_lie(fake.buffer_count, fake.lie_count)) {
    return fail(EINVAL);
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

static int queue(struct v4l2_buffer *said) {
  if (said->index >= fake.buffer_count || fake.buffers[said->index].is_queued) {
    return fail(EINVAL);
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

static int dequeue(struct v4l2_buffer *said) {
  if (!fake.is_streaming) {
    return fail(EINVAL);
  }
  if (fake.queue_length == 0 || event_now()->is_silent) {
    return fail(EAGAIN);
  }
  const struct fake_event event = take_event();
  if (event.is_unplug) {
    fake_unplug();
    return fail(EINVAL);
  }
  if (event.code) {
    return fail(event.code);
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

static int stream(bool on) {
  if (on && !fake.can_stream) {
    return fail(EINVAL);
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

static int query_control(struct v4l2_query_ext_ctrl *said) {
  const uint32_t after = said->id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
  for (size_t i = 0; i < COUNT(fake.controls); i++) {
    const struct fake_control *control = &fake.controls[i];
    if (control->id > after || (fake.lists_never_end && control->id)) {
      said->id = control->id;
      said->type = control->type;
      said->flags = control->flags;
      said->minimum = control->min;
      said->maximum = control->max;
      said->step = (uint64_t)control->step;
      put(said->name, sizeof said->name, control->name);
      return 0;
    }
  }
  return fail(EINVAL);
}

static struct fake_control *control_of(uint32_t id) {
  for (size_t i = 0; i < COUNT(fake.controls); i++) {
    if (fake.controls[i].id == id) {
      return &fake.controls[i];
    }
  }
  return NULL;
}

static int query_menu(struct v4l2_querymenu *said) {
  const struct fake_control *control = control_of(said->id);
  if (!control || said->index > control->max || said->index == 2) { /* menus have gaps */
    return fail(EINVAL);
  }
  memset(said->name, 0, sizeof said->name);
  memcpy(said->name, said->index ? "Manual" : "Auto", 4 + 2 * (said->index != 0));
  return 0;
}

static int do_control(struct v4l2_ext_controls *all, bool sets) {
  struct v4l2_ext_control *one = &all->controls[0];
  struct fake_control *control = control_of(one->id);
  if (!control || all->count != 1) {
    return fail(EINVAL);
  }
  const struct fake_control *automatic = control_of(V4L2_CID_EXPOSURE_AUTO);
  if (sets && control->id == V4L2_CID_EXPOSURE_ABSOLUTE && automatic && automatic->value != 1) {
    return fail(EACCES);
  }
  const bool is_wide = control->type == V4L2_CTRL_TYPE_INTEGER64;
  if (sets) {
    const int64_t value = is_wide ? one->value64 : one->value;
    control->value = value - (control->step > 1 ? (value - control->min) % control->step : 0);
  }
  if (is_wide) {
    one->value64 = control->value;
  } else {
    one->value = (int32_t)control->value;
  }
  return 0;
}

static int export(struct v4l2_exportbuffer *said) {
  if (fake.cannot_export || said->index >= fake.buffer_count) {
    return fail(ENOTTY);
  }
  said->fd = FD_FIRST + 500;
  return 0;
}

static int fake_ioctl(int fd, unsigned long request_code, void *argument) {
  if (must_fail()) {
    return fail(fake.fail_code);
  }
  if (fd < 0) {
    return fail(EBADF);
  }
  if (!is_alive(fd)) {
    return fail(ENODEV);
  }
  switch (request_code) {
  case VIDIOC_QUERYCAP: return query_capabilities(argument);
  case VIDIOC_ENUM_FMT: return enumerate_formats(argument);
  case VIDIOC_ENUM_FRAMESIZES: return enumerate_sizes(argument);
  case VIDIOC_ENUM_FRAMEINTERVALS: return enumerate_rates(argument);
  case VIDIOC_G_FMT: return do_format(argument, false);
  case VIDIOC_S_FMT: return do_format(argument, true);
  case VIDIOC_G_PARM: return do_rate(argument, false);
  case VIDIOC_S_PARM: return do_rate(argument, true);
  case VIDIOC_REQBUFS: return request(argument);
  case VIDIOC_QUERYBUF: return query_buffer(argument);
  case VIDIOC_QBUF: return queue(argument);
  case VIDIOC_DQBUF: return dequeue(argument);
  case VIDIOC_STREAMON: return stream(true);
  case VIDIOC_STREAMOFF: return stream(false);
  case VIDIOC_QUERY_EXT_CTRL: return query_control(argument);
  case VIDIOC_QUERYMENU: return query_menu(argument);
  case VIDIOC_G_EXT_CTRLS: return do_control(argument, false);
  case VIDIOC_S_EXT_CTRLS: return do_control(argument, true);
  case VIDIOC_EXPBUF: return export(argument);
  default: return fail(ENOTTY);
  }
}

static void *fake_mmap(void *address, size_t length, int protection, int flags, int fd,
                       off_t offset) {
  (void)address;
  (void)protection;
  (void)flags;
  if (must_fail()) {
    errno = fake.fail_code;
    return MAP_FAILED;
  }
  const size_t index = (size_t)offset / 4096;
  uint8_t *bytes =
      is_alive(fd) && length == fake.buffer_size && index < FAKE_BUFFERS ? malloc(length) : NULL;
  if (!bytes) {
    errno = is_alive(fd) ? EINVAL : ENODEV;
    return MAP_FAILED;
  }
  fake.buffers[index].bytes = bytes;
  fake.mapped_count++;
  return bytes;
}

static int fake_munmap(void *address, size_t length) {
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

static int fake_poll(struct pollfd *files, nfds_t count, int timeout_ms) {
  if (must_fail()) {
    fake.clock_ns += 1000000; /* time goes on, whatever fails */
    return fail(fake.fail_code);
  }
  if (count == 0) {
    fake.clock_ns += (int64_t)timeout_ms * 1000000;
    return 0;
  }
  if (!is_alive(files->fd)) {
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

static ssize_t fake_read(int fd, void *bytes, size_t size) {
  if (must_fail()) {
    return fail(fake.fail_code);
  }
  if (!is_alive(fd)) {
    return fail(ENODEV);
  }
  const struct fake_event event = take_event();
  if (event.is_unplug) {
    fake_unplug();
    return fail(EIO);
  }
  if (event.code) {
    return fail(event.code);
  }
  const size_t given = event.is_short ? event.used : fake.picture_size;
  const size_t whole = given < size ? given : size;
  fill(bytes, whole);
  return (ssize_t)whole;
}

static int64_t fake_clock(void) {
  return fake.clock_ns;
}

static int64_t fake_asleep(void) {
  return fake.asleep_ns;
}

const placido_v4l2_calls fake_calls = {
    .open = fake_open,
    .close = fake_close,
    .ioctl = fake_ioctl,
    .mmap = fake_mmap,
    .munmap = fake_munmap,
    .poll = fake_poll,
    .read = fake_read,
    .clock_ns = fake_clock,
    .asleep_ns = fake_asleep,
    .root = "/nowhere",
};

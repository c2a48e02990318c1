/* A camera played from a script, in the place of the kernel's system calls: who it is, what it
 * offers, how it is set. */
#include "tests/drivers/v4l2_fake_inside.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof *(array))

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

int fake_fail(int code) {
  errno = code;
  return -1;
}

bool fake_must_fail(void) {
  fake.call_count++;
  return fake.fail_at > 0 && (fake.call_count == fake.fail_at ||
                              (fake.fails_for_ever && fake.call_count > fake.fail_at));
}

bool fake_is_alive(int fd) {
  return fd == FAKE_FD_FIRST + fake.generation && !fake.is_gone;
}

uint32_t fake_or_lie(uint32_t truth, uint32_t lie) {
  return lie ? lie : truth;
}

/* Whether a path ends with the name of a node. */
static bool is_node(const char *path, int node) {
  char name[32];
  const int length = snprintf(name, sizeof name, "/dev/video%d", node);
  const size_t size = strlen(path);
  return size >= (size_t)length && strcmp(path + size - (size_t)length, name) == 0;
}

static int fake_open(const char *path, int flags) {
  if (fake_must_fail()) {
    return fake_fail(fake.fail_code);
  }
  fake.last_open_flags = flags;
  fake.is_second = fake.second_bus && is_node(path, 1);
  if (fake.is_gone || (!fake.is_second && !is_node(path, fake.node))) {
    return fake_fail(ENOENT);
  }
  fake.open_count++;
  return FAKE_FD_FIRST + fake.generation;
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
  return fake_fail(EINVAL);
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
  return fake_fail(fake.gives_no_sizes ? ENOTTY : EINVAL);
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
  return fake_fail(EINVAL);
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
    fake.fourcc = fake_or_lie(best->fourcc, fake.lie_fourcc);
    fake.width = fake_or_lie(best->width, fake.lie_width);
    fake.height = fake_or_lie(best->height, fake.lie_height);
  }
  fake.stride = fake.lie_stride;
  fake.size = fake_or_lie((uint32_t)fake.picture_size, fake.lie_size);
}

static int do_format(struct v4l2_format *said, bool sets) {
  if (fake.is_streaming && sets) {
    return fake_fail(EBUSY);
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
    planes->num_planes = (uint8_t)fake_or_lie(1, fake.lie_planes);
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
    return fake_fail(ENOTTY);
  }
  if (sets && fake.is_streaming) {
    return fake_fail(EBUSY);
  }
  if (sets) { /* it can do 30 and 60 */
    fake.rate = 2 * interval->denominator > 90 * interval->numerator ? 60 : 30;
  }
  *interval = (struct v4l2_fract){1, fake.rate};
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
  return fake_fail(EINVAL);
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
    return fake_fail(EINVAL);
  }
  memset(said->name, 0, sizeof said->name);
  memcpy(said->name, said->index ? "Manual" : "Auto", 4 + 2 * (said->index != 0));
  return 0;
}

static int do_control(struct v4l2_ext_controls *all, bool sets) {
  struct v4l2_ext_control *one = &all->controls[0];
  struct fake_control *control = control_of(one->id);
  if (!control || all->count != 1) {
    return fake_fail(EINVAL);
  }
  const struct fake_control *automatic = control_of(V4L2_CID_EXPOSURE_AUTO);
  if (sets && control->id == V4L2_CID_EXPOSURE_ABSOLUTE && automatic && automatic->value != 1) {
    return fake_fail(EACCES);
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

static int fake_ioctl(int fd, unsigned long request_code, void *argument) {
  if (fake_must_fail()) {
    return fake_fail(fake.fail_code);
  }
  if (fd < 0) {
    return fake_fail(EBADF);
  }
  if (!fake_is_alive(fd)) {
    return fake_fail(ENODEV);
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
  case VIDIOC_REQBUFS: return fake_request_buffers(argument);
  case VIDIOC_QUERYBUF: return fake_query_buffer(argument);
  case VIDIOC_QBUF: return fake_queue(argument);
  case VIDIOC_DQBUF: return fake_dequeue(argument);
  case VIDIOC_STREAMON: return fake_stream(true);
  case VIDIOC_STREAMOFF: return fake_stream(false);
  case VIDIOC_QUERY_EXT_CTRL: return query_control(argument);
  case VIDIOC_QUERYMENU: return query_menu(argument);
  case VIDIOC_G_EXT_CTRLS: return do_control(argument, false);
  case VIDIOC_S_EXT_CTRLS: return do_control(argument, true);
  case VIDIOC_EXPBUF: return fake_export(argument);
  default: return fake_fail(ENOTTY);
  }
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

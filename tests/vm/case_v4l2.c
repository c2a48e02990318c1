/* The kernel's test camera (vivid) through Placido's driver: modes, pictures, controls, and every
 * error that the kernel can be asked to make.
 *
 *   case_v4l2 v4l2:/dev/videoN
 *
 * No frame rate is asserted: under emulation time is elastic. */
#include <placido/device.h>

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define FRAMES 30
#define TIMEOUT_MS 20000

struct test {
  const char *uri;
  int failures;
};

__attribute__((format(printf, 3, 4))) static void expect(struct test *test, bool is_true,
                                                         const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  printf("%s: ", is_true ? "ok" : "FAILED");
  vprintf(format, arguments);
  printf("\n");
  va_end(arguments);
  test->failures += !is_true;
}

/* Opens the camera with a query behind its address; NULL and a failure where it cannot be. */
static placido_device *open_with(struct test *test, const char *query, placido_notes *notes) {
  char uri[256];
  placido_error err;
  placido_device *device;
  snprintf(uri, sizeof uri, "%s?%s", test->uri, query);
  if (placido_device_open(&device, uri, notes, &err)) {
    expect(test, false, "open %s: %s", uri, err.text);
  }
  return device;
}

static bool has_note(const placido_notes *notes, const char *words) {
  for (size_t i = 0; i < notes->count; i++) {
    if (strstr(notes->lines[i], words)) {
      return true;
    }
  }
  return false;
}

/* What a run of frames looked like. */
struct run {
  int status, frames, corrupt;
  uint64_t skipped;
  bool is_in_order, is_of_size, is_picture;
  char text[512];
};

/* Whether the samples are not all the same. */
static bool has_contrast(const placido_frame *frame) {
  const size_t bytes = (size_t)frame->height_px * frame->stride_bytes;
  return memcmp(frame->data, frame->data + 2, bytes - 2) != 0;
}

/* Takes frames from a started device. */
static struct run take(placido_device *device, int count, int width_px, int height_px, int bits) {
  struct run run = {.is_in_order = true, .is_of_size = true, .is_picture = true};
  placido_frame frame = {0};
  placido_error err = {0};
  uint64_t last_seq = 0;
  int64_t last_ns = 0;
  while (run.frames < count && !run.status) {
    run.status = placido_device_next(device, &frame, TIMEOUT_MS, &err);
    if (run.status) {
      snprintf(run.text, sizeof run.text, "%s", err.text);
      break;
    }
    if (run.frames > 0) {
      run.skipped += frame.seq - last_seq - 1;
      run.is_in_order = run.is_in_order && frame.seq > last_seq && frame.t_ns > last_ns;
    }
    last_seq = frame.seq;
    last_ns = frame.t_ns;
    run.frames++;
    run.corrupt += (frame.flags & PLACIDO_FRAME_CORRUPT) != 0;
    run.is_of_size = run.is_of_size && frame.width_px == width_px && frame.height_px == height_px &&
                     frame.bits == bits;
    run.is_picture = run.is_picture && has_contrast(&frame);
  }
  placido_frame_free(&frame);
  return run;
}

static placido_device_statistics counted(const placido_device *device) {
  placido_device_statistics statistics;
  placido_device_statistics_get(device, &statistics);
  return statistics;
}

static void set(struct test *test, placido_device *device, const char *control, double value) {
  placido_error err;
  if (placido_device_set(device, control, value, &err)) {
    expect(test, false, "%s = %g: %s", control, value, err.text);
  }
}

/* A started camera of 320x180 pixels at 25 frames a second: little enough for any machine. */
static placido_device *start(struct test *test) {
  placido_error err;
  placido_device *device = open_with(test, "size=320x180&fps=25&format=GREY", NULL);
  if (device && placido_device_start(device, &err)) {
    expect(test, false, "start: %s", err.text);
    placido_device_close(device);
    return NULL;
  }
  return device;
}

/* Which modes the tests build upon were seen. */
struct seen {
  bool grey, yuyv, y16, rates;
};

static int see_mode(void *user, const placido_device_mode *mode) {
  struct seen *seen = user;
  const bool is_small = mode->width_min_px == 320 && mode->height_min_px == 180;
  seen->grey = seen->grey || (is_small && strcmp(mode->format, "GREY") == 0);
  seen->yuyv = seen->yuyv || (is_small && strcmp(mode->format, "YUYV") == 0);
  seen->y16 = seen->y16 || (is_small && strcmp(mode->format, "Y16") == 0);
  seen->rates = seen->rates || (is_small && mode->rate_count > 1);
  return 0;
}

static void check_modes(struct test *test) {
  placido_error err = {0};
  struct seen seen = {0};
  placido_device *device = open_with(test, "", NULL);
  if (!device) {
    return;
  }
  const int status = placido_device_modes(device, see_mode, &seen, &err);
  expect(test, !status && seen.grey && seen.yuyv && seen.y16, "lists GREY, YUYV and Y16 %s",
         err.text);
  expect(test, seen.rates, "lists their rates");
  placido_device_close(device);
}

/* A loaded machine may come too late for a picture: then it must be counted, and another run may
 * be whole. */
static void check_format(struct test *test, const char *format, int bits) {
  char query[80];
  snprintf(query, sizeof query, "size=320x180&fps=25&format=%s", format);
  struct run run = {.skipped = 1};
  for (int tries = 0; tries < 3 && run.skipped > 0 && !run.status; tries++) {
    placido_error err;
    placido_device *device = open_with(test, query, NULL);
    if (!device || placido_device_start(device, &err)) {
      expect(test, false, "%s starts", format);
      placido_device_close(device);
      return;
    }
    run = take(device, FRAMES, 320, 180, bits);
    expect(test, run.skipped == counted(device).dropped, "%s: %llu skipped, %llu counted", format,
           (unsigned long long)run.skipped, (unsigned long long)counted(device).dropped);
    placido_device_close(device);
  }
  expect(test, run.frames == FRAMES && run.skipped == 0, "%s: %d frames, none missing %s", format,
         run.frames, run.text);
  expect(test, run.is_of_size && run.is_picture, "%s: 320 x 180 of %d bits, not blank", format,
         bits);
  expect(test, run.is_in_order, "%s: numbers and times grow", format);
}

static void check_formats(struct test *test) {
  check_format(test, "GREY", 8);
  check_format(test, "YUYV", 8);
  check_format(test, "Y16", 16);
}

static void check_negotiation(struct test *test) {
  placido_notes notes = {0};
  placido_device *device = open_with(test, "size=1000x700&format=GREY", &notes);
  expect(test, has_note(&notes, "not 1000 x 700 as asked"), "an odd size is noted");
  placido_notes_clear(&notes);
  placido_device_close(device);
  device = open_with(test, "size=1920x1080&fps=500&format=GREY", &notes);
  expect(test, has_note(&notes, "not 500 as asked"), "an absurd rate is noted");
  placido_notes_clear(&notes);
  placido_device_close(device);
}

static const placido_control *find_control(const placido_device *device, const char *name) {
  size_t count;
  const placido_control *rows = placido_device_controls(device, &count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(rows[i].name, name) == 0) {
      return &rows[i];
    }
  }
  return NULL;
}

static void expect_taken(struct test *test, placido_device *device, const char *control,
                         double value) {
  placido_error err = {0};
  double got = NAN;
  set(test, device, control, value);
  const int status = placido_device_get(device, control, &got, &err);
  expect(test, !status && fabs(got - value) < 0.01, "%s set to %g reads %g %s", control, value, got,
         err.text);
}

static void check_controls(struct test *test) {
  placido_error err = {0};
  placido_device *device = open_with(test, "size=320x180&format=GREY", NULL);
  if (!device) {
    return;
  }
  const placido_control *rate = find_control(device, "frame_rate_hz");
  expect(test, rate && strcmp(rate->unit, "Hz") == 0, "the frame rate is a control in Hz");
  expect_taken(test, device, "frame_rate_hz", 5);
  set(test, device, "gain_automatic", 1);
  expect_taken(test, device, "gain", 77);
  double automatic = NAN;
  placido_device_get(device, "gain_automatic", &automatic, NULL);
  expect(test, automatic == 0, "the camera no longer regulates its gain");
  expect(test, placido_device_set(device, "gain", 1e6, &err) == PLACIDO_INPUT,
         "a gain out of range is refused: %s", err.text);
  placido_device_close(device);
}

/* After an error frames flow on. `restarts` of the stream are to be counted. */
static void flows_on(struct test *test, placido_device *device, const char *what,
                     unsigned restarts) {
  const uint64_t before = counted(device).restarts;
  const struct run run = take(device, 5, 320, 180, 8);
  const uint64_t after = counted(device).restarts;
  expect(test, run.frames == 5 && run.is_in_order && after - before == restarts,
         "%s: %d frames after it, %llu restarts %s", what, run.frames,
         (unsigned long long)(after - before), run.text);
}

static void check_dropped(struct test *test) {
  placido_device *device = start(test);
  if (!device) {
    return;
  }
  set(test, device, "percentage_of_dropped_buffers", 50);
  const struct run run = take(device, FRAMES, 320, 180, 8);
  const placido_device_statistics said = counted(device);
  expect(test, run.frames == FRAMES && run.skipped > 0 && run.skipped == said.dropped,
         "half the pictures dropped: %llu missing, %llu counted %s",
         (unsigned long long)run.skipped, (unsigned long long)said.dropped, run.text);
  set(test, device, "percentage_of_dropped_buffers", 0);
  placido_device_close(device);
}

static void check_flagged(struct test *test) {
  placido_device *device = start(test);
  if (!device) {
    return;
  }
  set(test, device, "inject_v4l2_buf_flag_error", 1);
  const struct run run = take(device, 10, 320, 180, 8);
  expect(test, run.corrupt == 1 && counted(device).corrupt == 1,
         "a damaged picture is flagged (%d) and counted (%llu) %s", run.corrupt,
         (unsigned long long)counted(device).corrupt, run.text);
  placido_device_close(device);
}

static void check_stream_errors(struct test *test) {
  placido_device *device = start(test);
  if (!device) {
    return;
  }
  take(device, 2, 320, 180, 8);
  set(test, device, "inject_fatal_streaming_error", 1);
  flows_on(test, device, "a fatal error of the stream", 1);
  set(test, device, "inject_vidioc_qbuf_error", 1);
  flows_on(test, device, "a buffer that cannot be queued", 1);
  placido_device_close(device);
}

static void check_start_error(struct test *test) {
  placido_error err = {0};
  placido_device *device = open_with(test, "size=320x180&fps=25&format=GREY", NULL);
  if (!device) {
    return;
  }
  set(test, device, "inject_vidioc_streamon_error", 1);
  expect(test, placido_device_start(device, &err) == PLACIDO_SYSTEM, "a start that fails: %s",
         err.text);
  expect(test, placido_device_start(device, &err) == PLACIDO_OK, "the next start succeeds");
  flows_on(test, device, "a start that failed", 0);
  placido_device_close(device);
}

/* Without a queue of buffers the driver falls back to read(). */
static void check_read(struct test *test) {
  placido_error err = {0};
  placido_device *device = open_with(test, "size=320x180&fps=25&format=GREY", NULL);
  if (!device) {
    return;
  }
  set(test, device, "inject_vidioc_reqbufs_error", 1);
  expect(test, placido_device_start(device, &err) == PLACIDO_OK, "no buffers to be had: read() %s",
         err.text);
  const struct run run = take(device, 5, 320, 180, 8);
  expect(test, run.frames == 5 && run.is_of_size && run.is_picture, "%d frames by read() %s",
         run.frames, run.text);
  placido_device_close(device);
}

static void check_exclusive(struct test *test) {
  placido_error err = {0};
  placido_device *first = start(test);
  placido_device *second = NULL;
  char uri[256];
  snprintf(uri, sizeof uri, "%s?size=320x180", test->uri);
  int status = placido_device_open(&second, uri, NULL, &err);
  if (!status) {
    status = placido_device_start(second, &err);
  }
  expect(test, first && status == PLACIDO_SYSTEM && strstr(err.text, "another program uses it"),
         "a camera in use is refused: %s", err.text);
  placido_device_close(second);
  if (first) {
    flows_on(test, first, "a second program", 0);
  }
  placido_device_close(first);
}

/* vivid comes back as soon as everybody has let go of it. */
static void check_unplug(struct test *test) {
  placido_error err = {0};
  placido_device *device = start(test);
  if (!device) {
    return;
  }
  set(test, device, "disconnect", 1);
  const struct run run = take(device, 10, 320, 180, 8);
  expect(test, run.status == PLACIDO_GONE, "unplugged: status %d, %s", run.status, run.text);
  placido_device_stop(device, NULL);
  expect(test, placido_device_start(device, &err) == PLACIDO_OK, "plugged in: started again %s",
         err.text);
  flows_on(test, device, "a replug", 0);
  placido_device_close(device);
}

int main(int count, char **words) {
  static void (*const checks[])(struct test *) = {
      check_modes,     check_formats, check_negotiation,   check_controls,
      check_dropped,   check_flagged, check_stream_errors, check_start_error,
      check_exclusive, check_unplug,  check_read,
  };
  struct test test = {.uri = count > 1 ? words[1] : "v4l2:/dev/video0"};
  setvbuf(stdout, NULL, _IOLBF, 0);
  for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
    checks[i](&test);
  }
  return test.failures ? 1 : 0;
}

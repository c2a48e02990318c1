/* Placido's driver and the simulated camera face to face: the driver's pipe ends in the camera's
 * function, without a kernel between them and with the test's clock. */
#include "drivers/u3v/u3v.h"
#include "gadget/u3v.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define WIDTH 64
#define HEIGHT 48
#define MS INT64_C(1000000)
#define PENDING_MAX 256

static const placido_driver *const driver = &placido_u3v_driver;
static placido_frame scene;
static placido_gadget_faults faults;
static placido_gadget gadget;
static int64_t now_ns;
static placido_u3v_transfer *pending[PENDING_MAX];
static int pending_count;

static const placido_frame *look(void *user, int64_t t_ns) {
  (void)user;
  (void)t_ns;
  return &scene;
}

static enum placido_u3v_end end_of(enum placido_gadget_answer answer) {
  return answer == PLACIDO_GADGET_DONE    ? PLACIDO_U3V_DONE
         : answer == PLACIDO_GADGET_STALL ? PLACIDO_U3V_STALLED
                                          : PLACIDO_U3V_TIMED_OUT;
}

static void pass(int64_t ns) {
  now_ns += ns;
  placido_gadget_tick(&gadget, now_ns);
}

static int pipe_each(void *context, int (*found)(void *user, const placido_u3v_found *device),
                     void *user, placido_error *err) {
  (void)context;
  (void)err;
  const placido_u3v_found device = {.place = "1-1",
                                    .vendor = "Placido",
                                    .model = "simulated",
                                    .serial = "FACE01",
                                    .control_out = 0x01,
                                    .control_in = 0x81,
                                    .stream_interface = 1,
                                    .stream_in = 0x82,
                                    .control_packet_bytes = 1024,
                                    .stream_packet_bytes = 1024,
                                    .speed_mbit = 5000};
  return found(user, &device);
}

static int pipe_open(void *context, void **pipe, const placido_u3v_found *device,
                     placido_error *err) {
  (void)context;
  (void)device;
  (void)err;
  *pipe = &gadget;
  return PLACIDO_OK;
}

static void pipe_close(void *pipe) {
  (void)pipe;
  assert_int_equal(pending_count, 0);
}

static enum placido_u3v_end pipe_write(void *pipe, const uint8_t *bytes, size_t size,
                                       int timeout_ms) {
  (void)timeout_ms;
  uint8_t copy[4096];
  assert_true(size <= sizeof copy);
  memcpy(copy, bytes, size);
  pass(MS / 10);
  return end_of(placido_gadget_transfer(pipe, 0x01, NULL, copy, &size));
}

static enum placido_u3v_end pipe_read(void *pipe, uint8_t *bytes, size_t size, size_t *received,
                                      int timeout_ms) {
  for (int elapsed_ms = 0;; elapsed_ms++) {
    *received = size;
    const enum placido_gadget_answer answer =
        placido_gadget_transfer(pipe, 0x81, NULL, bytes, received);
    if (answer != PLACIDO_GADGET_LATER) {
      return end_of(answer);
    }
    *received = 0;
    if (elapsed_ms >= timeout_ms) {
      return PLACIDO_U3V_TIMED_OUT;
    }
    pass(MS);
  }
}

static enum placido_u3v_end pipe_submit(void *pipe, placido_u3v_transfer *transfer) {
  (void)pipe;
  assert_true(pending_count < PENDING_MAX);
  transfer->is_pending = true;
  transfer->received = 0;
  pending[pending_count++] = transfer;
  return PLACIDO_U3V_DONE;
}

static void end_transfer(int place, enum placido_u3v_end end) {
  pending[place]->end = end;
  pending[place]->is_pending = false;
  pending_count--;
  memmove(pending + place, pending + place + 1, (size_t)(pending_count - place) * sizeof *pending);
}

static void pipe_cancel(void *pipe, placido_u3v_transfer *transfer) {
  (void)pipe;
  for (int i = 0; i < pending_count; i++) {
    if (pending[i] == transfer) {
      end_transfer(i, PLACIDO_U3V_CANCELLED);
      return;
    }
  }
}

/* The oldest pending transfer is served; true where it has ended. */
static bool serve(void) {
  if (pending_count == 0) {
    return false;
  }
  placido_u3v_transfer *transfer = pending[0];
  size_t size = transfer->size;
  const enum placido_gadget_answer answer =
      placido_gadget_transfer(&gadget, 0x82, NULL, transfer->bytes, &size);
  if (answer == PLACIDO_GADGET_LATER) {
    return false;
  }
  transfer->received = answer == PLACIDO_GADGET_DONE ? size : 0;
  end_transfer(0, end_of(answer));
  return true;
}

static void pipe_wait(void *pipe, int timeout_ms) {
  (void)pipe;
  for (int elapsed_ms = 0; !serve() && elapsed_ms < timeout_ms; elapsed_ms++) {
    pass(MS);
  }
}

static void pipe_forget(void *pipe, placido_u3v_transfer *transfer) {
  (void)pipe;
  assert_false(transfer->is_pending);
}

static enum placido_u3v_end pipe_reset(void *pipe, uint8_t endpoint) {
  for (int request = 3; request >= 1; request -= 2) { /* SET_FEATURE, CLEAR_FEATURE: the halt */
    const placido_gadget_setup setup = {
        .request_type = 0x02, .request = (uint8_t)request, .index = endpoint};
    size_t size = 0;
    assert_int_equal(placido_gadget_transfer(pipe, 0, &setup, NULL, &size), PLACIDO_GADGET_DONE);
  }
  return PLACIDO_U3V_DONE;
}

static int64_t pipe_clock_ns(void *context) {
  (void)context;
  return now_ns;
}

static void pipe_sleep_ms(void *context, int duration_ms) {
  (void)context;
  pass(duration_ms * MS);
}

static const placido_u3v_calls calls = {
    .each = pipe_each,
    .open = pipe_open,
    .close = pipe_close,
    .write = pipe_write,
    .read = pipe_read,
    .submit = pipe_submit,
    .cancel = pipe_cancel,
    .wait = pipe_wait,
    .forget = pipe_forget,
    .reset = pipe_reset,
    .clock_ns = pipe_clock_ns,
    .sleep_ms = pipe_sleep_ms,
};

static int set_up(void **state) {
  (void)state;
  memset(&faults, 0, sizeof faults);
  now_ns = 1000 * MS;
  if (placido_frame_resize(&scene, WIDTH, HEIGHT, PLACIDO_MONO8, NULL)) {
    return -1;
  }
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    scene.data[i] = (uint8_t)(i * 37 % 251);
  }
  const placido_gadget_options options = {
      .view = {.look = look, .width_px = WIDTH, .height_px = HEIGHT, .rate_hz = 100},
      .faults = &faults,
      .speed = PLACIDO_GADGET_SUPER,
      .serial = "FACE01"};
  gadget = (placido_gadget){.function = placido_u3v_face.function, .speed = options.speed};
  return placido_u3v_face.open(&gadget.state, &options, NULL);
}

static int tear_down(void **state) {
  (void)state;
  placido_u3v_face.close(gadget.state);
  placido_frame_free(&scene);
  return 0;
}

static void *start(const char *address) {
  void *camera;
  placido_error err = {0};
  if (placido_u3v_open(&camera, address, &calls, NULL, &err) || driver->start(camera, &err)) {
    fail_msg("%s", err.text);
  }
  return camera;
}

static void end(void *camera, placido_frame *frame) {
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  driver->close(camera);
  placido_frame_free(frame);
}

static placido_device_statistics counts_of(const void *camera) {
  placido_device_statistics counts;
  driver->statistics(camera, &counts);
  return counts;
}

static void pictures_come_bit_by_bit(void **state) {
  (void)state;
  void *camera = start("FACE01");
  placido_frame frame = {0};
  for (uint64_t i = 0; i < 50; i++) {
    assert_int_equal(driver->next(camera, &frame, 1000, NULL), PLACIDO_OK);
    assert_int_equal(frame.seq, i);
    assert_int_equal(frame.flags, 0);
    assert_memory_equal(frame.data, scene.data, WIDTH * HEIGHT);
  }
  end(camera, &frame);
}

/* Twelve bits of a scene of eight: its samples times 16, however they were packed on the way. */
static void every_packing_arrives(void **state) {
  (void)state;
  static const char *const formats[] = {"Mono12", "Mono12p", "Mono12Packed"};
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
    char address[64];
    snprintf(address, sizeof address, "FACE01?format=%s", formats[i]);
    void *camera = start(address);
    placido_frame frame = {0};
    assert_int_equal(driver->next(camera, &frame, 1000, NULL), PLACIDO_OK);
    assert_int_equal(frame.bits, 12);
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
      assert_int_equal(((const uint16_t *)(const void *)frame.data)[k] >> 4, scene.data[k]);
    }
    end(camera, &frame);
  }
}

/* Whatever goes wrong, frames flow on, what is damaged says so, and what is whole is right. */
static void every_fault_is_survived(void **state) {
  (void)state;
  void *camera = start("FACE01");
  placido_frame frame = {0};
  for (int fault = 0; fault < PLACIDO_GADGET_FAULTS; fault++) {
    const bool is_of_stream = fault < PLACIDO_GADGET_FAULT_PENDING;
    const placido_device_statistics before = counts_of(camera);
    faults.left[fault] = is_of_stream ? 1 : 0;
    for (int i = 0; i < 20; i++) {
      const int status = driver->next(camera, &frame, 5000, NULL);
      assert_int_equal(status, PLACIDO_OK);
      if (frame.flags == 0) {
        assert_memory_equal(frame.data, scene.data, WIDTH * HEIGHT);
      }
    }
    const placido_device_statistics after = counts_of(camera);
    assert_int_equal(faults.left[fault], 0);
    assert_true(!is_of_stream || after.dropped + after.corrupt + after.truncated + after.restarts >
                                     before.dropped + before.corrupt + before.truncated +
                                         before.restarts);
  }
  end(camera, &frame);
}

/* Commands that are answered late, twice asked for, or by nonsense are asked again. */
static void a_camera_that_answers_badly_is_asked_again(void **state) {
  (void)state;
  static const enum placido_gadget_fault bad[] = {
      PLACIDO_GADGET_FAULT_PENDING, PLACIDO_GADGET_FAULT_SILENT, PLACIDO_GADGET_FAULT_GARBLE};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    faults.left[bad[i]] = 2;
    void *camera = start("FACE01");
    placido_frame frame = {0};
    assert_int_equal(driver->next(camera, &frame, 1000, NULL), PLACIDO_OK);
    assert_int_equal(faults.left[bad[i]], 0);
    end(camera, &frame);
  }
}

/* Resident memory in bytes. */
static long resident(void) {
  FILE *file = fopen("/proc/self/statm", "r");
  long pages = 0;
  assert_non_null(file);
  assert_int_equal(fscanf(file, "%*s %ld", &pages), 1);
  fclose(file);
  return pages * sysconf(_SC_PAGESIZE);
}

/* AddressSanitizer keeps what was freed for a while. */
#ifdef __SANITIZE_ADDRESS__
#define GROWTH_MAX (512L << 20)
#else
#define GROWTH_MAX (1L << 20)
#endif

/* Twenty minutes of the camera's time at full rate, a fault every four seconds. */
static void a_long_day_costs_no_memory(void **state) {
  (void)state;
  void *camera = start("FACE01");
  placido_frame frame = {0};
  const int64_t begin_ns = now_ns;
  int64_t fault_ns = now_ns;
  long settled = 0;
  int fault = 0;
  uint64_t count = 0;
  while (now_ns - begin_ns < 1200 * 1000 * MS) {
    if (now_ns >= fault_ns) {
      faults.left[fault++ % PLACIDO_GADGET_FAULT_PENDING] = 1;
      fault_ns = now_ns + 4000 * MS;
    }
    assert_int_equal(driver->next(camera, &frame, 5000, NULL), PLACIDO_OK);
    if (++count == 10000) {
      settled = resident();
    }
  }
  assert_true(count > 110000);
  assert_int_equal(fault, 300);
  assert_true(resident() - settled < GROWTH_MAX);
  end(camera, &frame);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
  const struct CMUnitTest tests[] = {
      TEST(pictures_come_bit_by_bit),
      TEST(every_packing_arrives),
      TEST(every_fault_is_survived),
      TEST(a_camera_that_answers_badly_is_asked_again),
      TEST(a_long_day_costs_no_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* A session survives a replug: what was unplugged is waited for as long as was asked, found under
 * another number, and numbers and times grow over the gap. */
#include "drivers/device.h"
#include "tests/base/scratch.h"
#include "tests/drivers/v4l2_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* When the plug goes back in, and as which node. */
static struct {
  int64_t at_ns; /* 0: never */
  int node;
} replug;

static const placido_v4l2_calls *calls;

static int64_t now_ns(void) {
  return fake.clock_ns;
}

static void sleep_ms(int duration_ms) {
  assert_true(duration_ms > 0);
  fake.clock_ns += (int64_t)duration_ms * 1000000;
  if (fake.is_gone && replug.at_ns && fake.clock_ns >= replug.at_ns) {
    fake_replug();
    fake.node = replug.node;
  }
}

static const placido_clock played = {.now_ns = now_ns, .sleep_ms = sleep_ms};

static int open_fake(void **state, const char *address, placido_notes *notes,
                     placido_error *err) {
  return placido_v4l2_open(state, address, calls, notes, err);
}

/* The camera of the script through the front door; its driver's row is in `row`. */
static placido_device *open_device(placido_driver *row, const char *address) {
  *row = placido_v4l2_driver;
  row->open = open_fake;
  placido_device *device;
  placido_error err = {0};
  if (placido_device_open_with(&device, row, &played, address, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  return device;
}

static int set_up(void **state) {
  memset(&replug, 0, sizeof replug);
  calls = &fake_calls;
  return reset(state);
}

static void next_is(placido_device *device, placido_frame *frame, int status, const char *said) {
  placido_error err = {0};
  const int got = placido_device_next(device, frame, 1000, &err);
  if (got != status || (said && !strstr(err.text, said))) {
    fail_msg("%d \"%s\" instead of %d \"%s\"", got, err.text, status, said ? said : "");
  }
}

/* The plug was pulled behind the second picture and goes in again after 2.5 s. */
static void frames_flow_on_behind_a_replug(void **state) {
  (void)state;
  have_controls();
  for (int i = 0; i < 2; i++) {
    fake_next((struct fake_event){0});
  }
  fake_next((struct fake_event){.is_unplug = true});
  placido_driver row;
  placido_device *device = open_device(&row, "/dev/video0?gain=55&replug_s=10");
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  placido_frame frame = {0};
  for (int i = 0; i < 2; i++) {
    next_is(device, &frame, PLACIDO_OK, NULL);
    assert_int_equal(frame.seq, i);
  }
  const int64_t before_ns = frame.t_ns;
  replug.at_ns = fake.clock_ns + 2500000000;
  for (int i = 0; i < 2; i++) { /* the caller gets his second back each time */
    const int64_t begin_ns = fake.clock_ns;
    next_is(device, &frame, PLACIDO_TIMEOUT, "waiting for the v4l2 device");
    assert_true(placido_device_is_waiting(device));
    assert_true(fake.clock_ns - begin_ns <= 1002000000);
    double value;
    assert_int_equal(placido_device_get(device, "gain", &value, NULL), PLACIDO_GONE);
  }
  have_controls(); /* as after power on */
  next_is(device, &frame, PLACIDO_OK, NULL);
  assert_false(placido_device_is_waiting(device));
  assert_int_equal(frame.seq, 2);
  assert_true(frame.t_ns > before_ns);
  assert_memory_equal(frame.data, grey, sizeof grey);
  double gain;
  assert_int_equal(placido_device_get(device, "gain", &gain, NULL), PLACIDO_OK);
  assert_true(gain == 55);
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.replugs, 1);
  assert_int_equal(counts.frames, 3);
  assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  placido_device_close(device);
}

static void patience_ends(void **state) {
  (void)state;
  placido_driver row;
  placido_device *device = open_device(&row, "/dev/video0");
  placido_error err = {0};
  assert_int_equal(placido_device_patience_set(device, -1, &err), PLACIDO_INPUT);
  assert_int_equal(placido_device_patience_set(device, 1e9, &err), PLACIDO_INPUT);
  assert_int_equal(placido_device_patience_set(device, 3, &err), PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  fake_unplug();
  placido_frame frame = {0};
  const int64_t begin_ns = fake.clock_ns;
  int status;
  int calls_made = 0;
  do {
    status = placido_device_next(device, &frame, 100, &err);
    calls_made++;
  } while (status == PLACIDO_TIMEOUT);
  assert_int_equal(status, PLACIDO_GONE);
  assert_says(&err, "Fake camera");
  assert_says(&err, "waited 3 s for it to come back");
  assert_true(calls_made >= 28);
  assert_true(fake.clock_ns - begin_ns >= 3000000000 && fake.clock_ns - begin_ns < 3100000000);
  fake_replug(); /* too late */
  next_is(device, &frame, PLACIDO_GONE, "did not come back within 3 s");
  assert_false(placido_device_is_waiting(device));
  assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK); /* but for whoever asks anew */
  next_is(device, &frame, PLACIDO_OK, NULL);
  placido_frame_free(&frame);
  placido_device_close(device);
}

/* The library's default; and the address goes before what a program sets. */
static void without_patience_it_is_told_at_once(void **state) {
  (void)state;
  for (int i = 0; i < 2; i++) {
    set_up(state);
    placido_driver row;
    placido_device *device = open_device(&row, i ? "/dev/video0?replug_s=0" : "/dev/video0");
    if (i) {
      assert_int_equal(placido_device_patience_set(device, 10, NULL), PLACIDO_OK);
    }
    assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
    fake_unplug();
    placido_frame frame = {0};
    const int64_t begin_ns = fake.clock_ns;
    next_is(device, &frame, PLACIDO_GONE, "unplugged");
    assert_true(fake.clock_ns - begin_ns < 10000000);
    placido_device_close(device); /* while it is away */
    placido_frame_free(&frame);
  }
}

static void a_wrong_patience_is_refused(void **state) {
  (void)state;
  static const char *const addresses[] = {"/dev/video0?replug_s=-1", "/dev/video0?replug_s=4000",
                                          "/dev/video0?replug_s=nan"};
  placido_driver row = placido_v4l2_driver;
  row.open = open_fake;
  for (size_t i = 0; i < 3; i++) {
    placido_device *device;
    placido_error err = {0};
    assert_int_equal(placido_device_open_with(&device, &row, &played, addresses[i], NULL, &err),
                     PLACIDO_INPUT);
    assert_null(device);
    assert_says(&err, "from 0 to 3600 seconds");
  }
}

/* A contact that is never still keeps nobody longer than asked, and each time begins anew. */
static void a_loose_contact_is_survived(void **state) {
  (void)state;
  placido_driver row;
  placido_device *device = open_device(&row, "/dev/video0?replug_s=1");
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  placido_frame frame = {0};
  next_is(device, &frame, PLACIDO_OK, NULL);
  for (int i = 1; i <= 1000; i++) {
    fake.event_count = fake.event_next = 0;
    fake_next((struct fake_event){.is_unplug = true});
    replug.at_ns = fake.clock_ns + 500000000;
    next_is(device, &frame, PLACIDO_OK, NULL);
    assert_int_equal(frame.seq, i);
    assert_int_equal(fake.open_count, 1);
  }
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.replugs, 1000);
  placido_frame_free(&frame);
  placido_device_close(device);
}

/* Nodes of /sys with their devices' serial numbers: "" for none. */
static char *make_tree(void **state, const char *const serials[], size_t count) {
  static const char *const directories[] = {"sys", "sys/class", "sys/class/video4linux"};
  for (size_t i = 0; i < 3; i++) {
    char *path = scratch_path(state, directories[i]);
    mkdir(path, 0700);
    free(path);
  }
  for (size_t i = 0; i < count; i++) {
    char name[100];
    static const char *const parts[] = {"", "/device"};
    for (size_t k = 0; k < 2; k++) {
      snprintf(name, sizeof name, "sys/class/video4linux/video%zu%s", i, parts[k]);
      char *path = scratch_path(state, name);
      mkdir(path, 0700);
      free(path);
    }
    snprintf(name, sizeof name, "sys/class/video4linux/video%zu/serial", i);
    if (serials[i][0]) {
      free(scratch_write_text(state, name, serials[i]));
    }
    snprintf(name, sizeof name, "sys/class/video4linux/video%zu/index", i);
    free(scratch_write_text(state, name, "0\n"));
  }
  char *root = scratch_path(state, "");
  root[strlen(root) - 1] = '\0';
  return root;
}

/* Unplugged as /dev/video0, it comes back as another node and perhaps elsewhere on the bus. */
static void the_node_may_have_another_number(void **state) {
  static const struct {
    const char *serials[3];
    int node;
    const char *bus;
    int status;
    const char *said;
  } cases[] = {
      {{"SN1", "", "SN1"}, 2, "usb-fake-1", PLACIDO_OK, NULL},
      {{"", "SN7", ""}, 2, "usb-fake-1", PLACIDO_OK, NULL}, /* known by its place on the bus */
      {{"", "SN7", ""}, 2, "usb-fake-2", PLACIDO_GONE, "waited 2 s"},
      {{"SN1", "", "SN2"}, 2, "usb-fake-1", PLACIDO_GONE, "waited 2 s"},
      {{"SN1", "SN1", "SN1"}, 2, "usb-fake-2", PLACIDO_GONE, "waited 2 s"}, /* twins */
      {{"SN1", "SN1", "SN1"}, 2, "usb-fake-1", PLACIDO_OK, NULL},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    set_up(state);
    scratch_teardown(state);
    scratch_setup(state);
    /* before: video0, and video1 where it is a twin of it */
    char *root = make_tree(state, cases[i].serials, 2);
    placido_v4l2_calls rooted = fake_calls;
    rooted.root = root;
    calls = &rooted;
    placido_driver row;
    placido_device *device = open_device(&row, "/dev/video0?replug_s=2");
    assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
    fake_unplug();
    free(make_tree(state, cases[i].serials, 3));
    fake.bus = cases[i].bus;
    replug.at_ns = fake.clock_ns + 300000000;
    replug.node = cases[i].node;
    placido_frame frame = {0};
    for (int k = 0; k < 1 + (cases[i].status != PLACIDO_OK); k++) {
      next_is(device, &frame, k < 1 && cases[i].status ? PLACIDO_TIMEOUT : cases[i].status,
              k < 1 && cases[i].status ? "waiting" : cases[i].said);
    }
    placido_frame_free(&frame);
    placido_device_close(device);
    assert_int_equal(fake.open_count, 0);
    free(root);
  }
}

/* On a slower bus the size may not be there any longer: whoever records counts on it. */
static void another_size_is_not_taken(void **state) {
  (void)state;
  placido_driver row;
  placido_device *device = open_device(&row, "/dev/video0?replug_s=1.5");
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  fake_unplug();
  fake.offers[0].width = 4;
  replug.at_ns = fake.clock_ns + 1;
  placido_frame frame = {0};
  next_is(device, &frame, PLACIDO_TIMEOUT, "waiting");
  next_is(device, &frame, PLACIDO_GONE, "came back with 4 x 4 pixels of GREY, not 8 x 4");
  placido_frame_free(&frame);
  placido_device_close(device);
}

/* A device whose numbers and clock begin anew with each start, and that has events as well. */
static struct {
  uint64_t seq;
  int64_t t_ns;
  int left; /* until it is gone */
  bool is_away;
  int started, stopped;
} plain;

static const placido_device_info plain_info = {.uri = "plain:"};

static int plain_open(void **state, const char *address, placido_notes *notes,
                      placido_error *err) {
  (void)address;
  (void)notes;
  (void)err;
  *state = &plain;
  return PLACIDO_OK;
}

static void plain_close(void *state) {
  (void)state;
}

static const placido_device_info *plain_get_info(const void *state) {
  (void)state;
  return &plain_info;
}

static int plain_start(void *state, placido_error *err) {
  (void)state;
  if (plain.is_away) {
    plain.is_away = false; /* until the next try */
    return placido_error_set(err, PLACIDO_SYSTEM, "permission denied"); /* udev is not ready */
  }
  plain.seq = 0;
  plain.t_ns = 1000;
  plain.left = 3;
  plain.started++;
  return PLACIDO_OK;
}

static int plain_stop(void *state, placido_error *err) {
  (void)state;
  (void)err;
  plain.stopped++;
  return PLACIDO_OK;
}

static int plain_take(uint64_t *seq, int64_t *t_ns, placido_error *err) {
  if (plain.left-- <= 0) {
    plain.is_away = true;
    return placido_error_set(err, PLACIDO_GONE, "gone");
  }
  *seq = plain.seq++;
  *t_ns = plain.t_ns++;
  return PLACIDO_OK;
}

static int plain_next(void *state, placido_frame *frame, int timeout_ms, placido_error *err) {
  (void)state;
  (void)timeout_ms;
  return plain_take(&frame->seq, &frame->t_ns, err);
}

static int plain_event(void *state, placido_event *event, int timeout_ms, placido_error *err) {
  (void)state;
  (void)timeout_ms;
  return plain_take(&event->seq, &event->t_ns, err);
}

static const placido_driver plain_driver = {.scheme = "plain",
                                            .summary = "of this test",
                                            .open = plain_open,
                                            .close = plain_close,
                                            .info = plain_get_info,
                                            .start = plain_start,
                                            .next = plain_next,
                                            .event = plain_event,
                                            .stop = plain_stop};

static void numbers_grow_whatever_the_driver_counts(void **state) {
  (void)state;
  memset(&plain, 0, sizeof plain);
  placido_device *device;
  assert_int_equal(
      placido_device_open_with(&device, &plain_driver, &played, "?replug_s=5", NULL, NULL),
      PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  placido_frame frame = {0};
  placido_event event;
  uint64_t last_event = 0;
  int64_t last_ns = 0;
  for (uint64_t i = 0; i < 20; i++) {
    next_is(device, &frame, PLACIDO_OK, NULL);
    assert_int_equal(placido_device_event(device, &event, 1000, NULL), PLACIDO_OK);
    assert_true(i == 0 || event.seq > last_event);
    assert_true(frame.t_ns >= last_ns);
    last_event = event.seq;
    last_ns = frame.t_ns;
  }
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.replugs, plain.started - 1);
  assert_true(counts.replugs >= 10);
  assert_int_equal(plain.stopped, plain.started - 1); /* every start has its one stop */
  assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
  assert_int_equal(plain.stopped, plain.started);
  placido_device_close(device);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, nothing_is_left)
  const struct CMUnitTest tests[] = {
      TEST(frames_flow_on_behind_a_replug),
      TEST(patience_ends),
      TEST(without_patience_it_is_told_at_once),
      TEST(a_wrong_patience_is_refused),
      TEST(a_loose_contact_is_survived),
      cmocka_unit_test_setup_teardown(the_node_may_have_another_number, scratch_setup,
                                      scratch_teardown),
      TEST(another_size_is_not_taken),
      TEST(numbers_grow_whatever_the_driver_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

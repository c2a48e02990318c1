/* A USB3 Vision camera that stalls, falls silent or out of step goes on, and what it cost is
 * counted. */
#include "base/memory.h"
#include "tests/drivers/u3v_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

/* Out of step: the picture is lost, and counted; the stream begins anew. Where an end is missing,
 * the next beginning has been taken for it. */
static void a_lost_beginning_or_end_costs_what_is_counted(void **state) {
  static const struct {
    struct fake_picture picture;
    uint64_t lost;
  } cases[] = {{{.no_leader = true}, 1}, {{.bad_leader = true}, 1}, {{.bad_trailer = true}, 1},
               {{.surplus = 100}, 1},    {{.surplus = 5000}, 1},    {{.no_trailer = true}, 2}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    fake_next((struct fake_picture){0});
    fake_next(cases[i].picture);
    void *camera = start_camera("");
    placido_frame frame = {0};
    take_picture_of(camera, &frame, 0, 0);
    take_picture_of(camera, &frame, 0, 0); /* the camera counts anew */
    assert_int_equal(frame.seq, 1 + cases[i].lost);
    take_picture_of(camera, &frame, 1, 0);
    assert_counts(camera, 3, cases[i].lost, 0, 0, 1);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

static void a_fault_in_mid_stream_is_mended(void **state) {
  static const enum placido_u3v_end ends[] = {PLACIDO_U3V_STALLED, PLACIDO_U3V_OVERFLOW,
                                              PLACIDO_U3V_TIMED_OUT, PLACIDO_U3V_CANCELLED,
                                              PLACIDO_U3V_FAILED};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    for (int n = 4; n <= 6; n++) { /* leader, samples or trailer of the second picture */
      reset(state);
      fake.transfer_fail_at = n;
      fake.transfer_fail_end = ends[i];
      void *camera = start_camera("");
      placido_frame frame = {0};
      take_picture_of(camera, &frame, 0, 0);
      take_picture_of(camera, &frame, 0, 0);
      assert_int_equal(frame.seq, 2);
      assert_counts(camera, 2, 1, 0, 0, 1);
      assert_int_equal(fake.starts, 2);
      stop_camera(camera);
      placido_frame_free(&frame);
    }
  }
}

/* Pictures that came before the fault are not lost with it. */
static void what_came_before_a_fault_is_given_out(void **state) {
  (void)state;
  fake.transfer_fail_at = 8;
  fake.transfer_fail_end = PLACIDO_U3V_STALLED;
  void *camera = start_camera("");
  placido_frame frame = {0};
  fake_sleep_ms(100);
  take_picture_of(camera, &frame, 0, 0);
  take_picture_of(camera, &frame, 1, 0);
  assert_counts(camera, 2, 0, 0, 0, 0);
  take_picture_of(camera, &frame, 0, 0);
  assert_counts(camera, 3, 1, 0, 0, 1);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void a_camera_that_never_recovers_is_given_up(void **state) {
  (void)state;
  for (int i = 0; i < 40; i++) {
    fake_next((struct fake_picture){.bad_leader = true});
  }
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  assert_int_equal(driver->next(camera, &frame, 5000, &err), PLACIDO_SYSTEM);
  assert_says(&err, "does not recover: a picture came without its beginning");
  assert_int_equal(counts_of(camera).restarts, 3);
  fake.script_next = fake.script_count; /* somebody mends it */
  take_picture_of(camera, &frame, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void silence_is_a_time_out(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  set(camera, "trigger", 1);
  for (int i = 0; i < 30; i++) {
    const int64_t before_ns = fake.clock_ns;
    assert_int_equal(driver->next(camera, &frame, 300, &err), PLACIDO_TIMEOUT);
    assert_says(&err, "within 300 ms");
    assert_true(fake.clock_ns - before_ns < 310000000);
  }
  assert_int_equal(driver->next(camera, &frame, 0, &err), PLACIDO_TIMEOUT);
  set(camera, "trigger_software", 1);
  take_picture_of(camera, &frame, 0, 0);
  assert_int_equal(driver->next(camera, &frame, 300, &err), PLACIDO_TIMEOUT);
  assert_counts(camera, 1, 0, 0, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

/* A camera that lost its settings, as by a dip of its power, is silent for ever. */
static void a_camera_that_switched_itself_off_is_started_anew(void **state) {
  (void)state;
  fake_next((struct fake_picture){0});
  fake_next((struct fake_picture){.is_switched_off = true});
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  take_picture_of(camera, &frame, 0, 0);
  int status = PLACIDO_TIMEOUT;
  for (int i = 0; status == PLACIDO_TIMEOUT && i < 10; i++) {
    status = driver->next(camera, &frame, 300, &err);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_counts(camera, 2, 0, 0, 0, 1);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void a_camera_that_does_not_answer_is_no_hang(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  take(camera, &frame);
  fake.answers_not = true;
  fake.is_acquiring = false;
  const int64_t before_ns = fake.clock_ns;
  int status = PLACIDO_TIMEOUT;
  for (int i = 0; status == PLACIDO_TIMEOUT && i < 40; i++) {
    status = driver->next(camera, &frame, 100, &err);
  }
  assert_int_equal(status, PLACIDO_SYSTEM);
  assert_says(&err, "does not recover: the camera does not answer");
  assert_true(fake.clock_ns - before_ns < 60000000000); /* each question waits a second at most */
  stop_camera(camera);
  placido_frame_free(&frame);
}

/* While nobody looks, the queue keeps the oldest pictures, and the camera's counter tells of those
 * that found no room. */
static void a_slow_consumer_loses_what_is_counted(void **state) {
  (void)state;
  void *camera = start_camera("?buffers=4");
  placido_frame frame = {0};
  take_picture_of(camera, &frame, 0, 0);
  fake_sleep_ms(1000);
  for (uint64_t i = 1; i <= 4; i++) {
    take_picture_of(camera, &frame, i, 0);
  }
  take(camera, &frame);
  const placido_device_statistics counts = counts_of(camera);
  assert_int_equal(counts.frames, 6);
  assert_in_range(counts.dropped, 94, 97); /* of about a hundred */
  assert_int_equal(frame.seq, counts.frames + counts.dropped - 1);
  assert_int_equal(counts.restarts, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void unplugging_is_told(void **state) {
  (void)state;
  for (int n = 0; n < 4; n++) {
    reset(state);
    for (int i = 0; i < n; i++) {
      fake_next((struct fake_picture){0});
    }
    fake_next((struct fake_picture){.is_unplug = true});
    void *camera = start_camera("");
    placido_frame frame = {0};
    placido_error err = {0};
    for (int i = 0; i < n; i++) {
      take_picture_of(camera, &frame, (uint64_t)i, 0);
    }
    assert_int_equal(driver->next(camera, &frame, 1000, &err), PLACIDO_GONE);
    assert_int_equal(fake.open_count, 0);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

static void allocations_that_fail_cost_no_picture(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  placido_memory_fail_at(1);
  assert_int_equal(driver->next(camera, &frame, 500, &err), PLACIDO_MEMORY);
  placido_memory_fail_at(0);
  take_picture_of(camera, &frame, 0, 0);
  assert_counts(camera, 1, 0, 0, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)
  const struct CMUnitTest tests[] = {
      TEST(a_lost_beginning_or_end_costs_what_is_counted),
      TEST(a_fault_in_mid_stream_is_mended),
      TEST(what_came_before_a_fault_is_given_out),
      TEST(a_camera_that_never_recovers_is_given_up),
      TEST(silence_is_a_time_out),
      TEST(a_camera_that_switched_itself_off_is_started_anew),
      TEST(a_camera_that_does_not_answer_is_no_hang),
      TEST(a_slow_consumer_loses_what_is_counted),
      TEST(unplugging_is_told),
      TEST(allocations_that_fail_cost_no_picture),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

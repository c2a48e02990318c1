/* Whatever call or transfer fails, and whatever the camera claims: no crash, no hang, nothing
 * held. */
#include "base/memory.h"
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/registers.h"
#include "tests/drivers/u3v_use.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* How long a day with a camera may take, at most, on the camera's clock: each of its calls that is
 * not answered is asked five times. A loop would pass it. */
#define DAY_MAX_NS 2000000000000
#define CALLS_MAX 20000

static const enum placido_u3v_end ends[] = {PLACIDO_U3V_STALLED,   PLACIDO_U3V_OVERFLOW,
                                            PLACIDO_U3V_TIMED_OUT, PLACIDO_U3V_CANCELLED,
                                            PLACIDO_U3V_FAILED,    PLACIDO_U3V_GONE};

#define END_COUNT (sizeof ends / sizeof *ends)

static void assert_told(int status, const placido_error *err) {
  if (status != PLACIDO_OK && !err->text[0]) {
    fail_msg("status %d without a sentence", status);
  }
  if (status != PLACIDO_OK) {
    assert_int_equal(err->status, status);
  }
}

/* Takes six pictures from a started camera. Returns the first status that is not PLACIDO_OK. */
static int take_some(void *camera) {
  placido_frame frame = {0};
  int first = PLACIDO_OK;
  uint64_t last_seq = 0;
  for (int i = 0; i < 6; i++) {
    placido_error err = {0};
    const int status = driver->next(camera, &frame, 200, &err);
    assert_told(status, &err);
    if (status == PLACIDO_OK) {
      assert_non_null(frame.data);
      assert_true(i == 0 || last_seq == 0 || frame.seq > last_seq);
      last_seq = frame.seq;
    }
    first = first ? first : status;
  }
  placido_frame_free(&frame);
  return first;
}

/* Every control is read, and set to what it was. */
static int regulate(void *camera) {
  size_t count;
  int first = PLACIDO_OK;
  driver->controls(camera, &count);
  for (size_t i = 0; i < count; i++) {
    placido_error err = {0};
    double value;
    int status = driver->get(camera, i, &value, &err);
    assert_told(status, &err);
    if (!status) {
      status = driver->set(camera, i, value, &err);
      assert_told(status, &err);
    }
    /* What can only be read, and a trigger that the camera does not listen to. */
    first = first || status == PLACIDO_UNSUPPORTED ? first : status;
  }
  return first;
}

/* Opens, regulates, takes pictures, stops, starts again, closes. Returns the first status that is
 * not PLACIDO_OK. */
static int run_a_day(void) {
  void *camera = NULL;
  placido_error err = {0};
  const int64_t begin_ns = fake.clock_ns;
  int first = placido_u3v_open(&camera, "S1?fps=50&buffers=3", &fake_calls, NULL, &err);
  assert_told(first, &err);
  assert_true((first == PLACIDO_OK) == (camera != NULL));
  for (int round = 0; camera && round < 2; round++) {
    int status = regulate(camera);
    first = first ? first : status;
    status = driver->start(camera, &err);
    assert_told(status, &err);
    first = first ? first : status;
    if (!status) {
      status = take_some(camera);
      first = first ? first : status;
      assert_int_equal(driver->stop(camera, &err), PLACIDO_OK);
    }
  }
  if (camera) {
    driver->close(camera);
  }
  assert_int_equal(fake.open_count, 0);
  assert_int_equal(fake.own_count, 0);
  assert_int_equal(fake.pending_count, 0);
  assert_true(fake.call_count < CALLS_MAX);
  assert_true(fake.clock_ns - begin_ns < DAY_MAX_NS);
  return first;
}

static void every_call_may_fail_in_every_way(void **state) {
  (void)state;
  fake_reset();
  assert_int_equal(run_a_day(), PLACIDO_OK);
  const int calls = fake.call_count;
  int failed_runs = 0;
  assert_true(calls > 200);
  for (size_t i = 0; i < END_COUNT; i++) {
    for (int n = 1; n <= calls; n++) {
      for (int for_ever = 0; for_ever < 2; for_ever++) {
        fake_reset();
        fake.fail_at = n;
        fake.fail_end = ends[i];
        fake.fails_for_ever = for_ever;
        failed_runs += run_a_day() != PLACIDO_OK;
      }
    }
  }
  assert_true(failed_runs > calls); /* the faults did arrive */
}

/* A fault of the stream that is not the unplugging costs pictures, not the day. */
static void every_transfer_may_fail_in_every_way(void **state) {
  (void)state;
  fake_reset();
  assert_int_equal(run_a_day(), PLACIDO_OK);
  const int transfers = fake.transfer_count;
  assert_true(transfers >= 36); /* three for each of twelve pictures */
  for (size_t i = 0; i < END_COUNT; i++) {
    for (int n = 1; n <= 36; n++) {
      fake_reset();
      fake.transfer_fail_at = n;
      fake.transfer_fail_end = ends[i];
      assert_int_equal(run_a_day(),
                       ends[i] == PLACIDO_U3V_GONE ? PLACIDO_GONE : PLACIDO_OK);
    }
  }
}

/* Leaders and trailers of garbage, and samples, which nobody can tell from others. */
static void every_transfer_may_be_garbage(void **state) {
  (void)state;
  for (int n = 1; n <= 36; n++) {
    fake_reset();
    fake.transfer_fail_at = n;
    fake.transfer_fail_end = PLACIDO_U3V_DONE;
    assert_int_equal(run_a_day(), PLACIDO_OK);
  }
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  int status = PLACIDO_MEMORY;
  unsigned long n = 1;
  for (; status != PLACIDO_OK; n++) {
    fake_reset();
    placido_memory_fail_at(n);
    status = run_a_day();
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_MEMORY || status == PLACIDO_OK);
  }
  assert_true(n > 20);
}

static void every_picture_may_be_the_unplugging(void **state) {
  (void)state;
  for (int n = 0; n < 6; n++) {
    fake_reset();
    for (int i = 0; i < n; i++) {
      fake_next((struct fake_picture){0});
    }
    fake_next((struct fake_picture){.is_unplug = true});
    assert_int_equal(run_a_day(), PLACIDO_GONE);
  }
}

/* What a camera may claim in its registers, to our cost. */
static void absurd_claims_are_refused(void **state) {
  (void)state;
  static const uint32_t absurd[] = {0, 1, 0x7fffffff, 0x80000000u, 0xffffffffu};
  static const uint32_t registers[] = {
      FAKE_SIRM + PLACIDO_SIRM_INFO,
      FAKE_SIRM + PLACIDO_SIRM_REQUIRED_LEADER,
      FAKE_SIRM + PLACIDO_SIRM_REQUIRED_TRAILER,
      FAKE_WIDTH,
      FAKE_HEIGHT,
      FAKE_OFFSET_X,
      FAKE_PIXEL_FORMAT,
      PLACIDO_ABRM_SBRM_ADDRESS,
      PLACIDO_ABRM_SBRM_ADDRESS + 4,
      PLACIDO_ABRM_MANIFEST_ADDRESS,
      PLACIDO_ABRM_MANIFEST_ADDRESS + 4,
      PLACIDO_ABRM_MAX_RESPONSE_MS,
      FAKE_EXPOSURE,
      FAKE_RATE,
  };
  int refused = 0;
  for (size_t i = 0; i < sizeof registers / sizeof *registers; i++) {
    for (size_t k = 0; k < sizeof absurd / sizeof *absurd; k++) {
      fake_reset();
      fake_put(registers[i], absurd[k]);
      refused += run_a_day() != PLACIDO_OK;
    }
  }
  assert_true(refused >= 40);
}

static void absurd_sizes_of_the_stream_are_refused(void **state) {
  (void)state;
  static const size_t spare[] = {(size_t)5 << 20, (size_t)1 << 40, (size_t)0 - 3072,
                                 (size_t)0 - 3073};
  for (size_t i = 0; i < sizeof spare / sizeof *spare; i++) {
    fake_reset();
    fake.spare_bytes = spare[i];
    void *camera = open_camera("", NULL);
    placido_error err = {0};
    assert_int_equal(driver->start(camera, &err), PLACIDO_INPUT);
    assert_says(&err, "for a picture of 3072");
    driver->close(camera);
    assert_int_equal(fake.open_count + fake.own_count, 0);
  }
}

/* The kernel keeps what was cancelled: neither waited for without end nor freed under it. */
static void a_transfer_that_does_not_come_back_is_left_alone(void **state) {
  (void)state;
  for (int by_restart = 0; by_restart < 2; by_restart++) {
    fake_reset();
    void *camera = start_camera("");
    placido_frame frame = {0};
    placido_error err = {0};
    take_picture_of(camera, &frame, 0, 0);
    fake.never_gives_back = true;
    const int64_t before_ns = fake.clock_ns;
    if (by_restart) {
      fake_next((struct fake_picture){.bad_leader = true});
      assert_int_equal(driver->next(camera, &frame, 500, &err), PLACIDO_SYSTEM);
      assert_says(&err, "does not give back");
      assert_int_equal(driver->next(camera, &frame, 500, &err), PLACIDO_GONE);
    }
    assert_int_equal(driver->stop(camera, &err), PLACIDO_OK);
    assert_true(fake.clock_ns - before_ns < 3000000000);
    assert_int_equal(fake.open_count, 1); /* abandoned */
    assert_true(fake.pending_count > 0);
    driver->close(camera);
    placido_frame_free(&frame);
  }
}

static void slow_answers_are_waited_for(void **state) {
  (void)state;
  fake_reset();
  fake.slow_ns = 100000000;
  void *camera = start_camera("");
  placido_frame frame = {0};
  take_picture_of(camera, &frame, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_call_may_fail_in_every_way),
      cmocka_unit_test(every_transfer_may_fail_in_every_way),
      cmocka_unit_test(every_transfer_may_be_garbage),
      cmocka_unit_test(every_allocation_may_fail),
      cmocka_unit_test(every_picture_may_be_the_unplugging),
      cmocka_unit_test(absurd_claims_are_refused),
      cmocka_unit_test(absurd_sizes_of_the_stream_are_refused),
      cmocka_unit_test(a_transfer_that_does_not_come_back_is_left_alone),
      cmocka_unit_test(slow_answers_are_waited_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Pictures of a USB3 Vision camera come bit for bit, and what is doubtful is flagged. */
#include "base/memory.h"
#include "tests/drivers/u3v_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static void pictures_come_bit_for_bit(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  for (uint64_t i = 0; i < 30; i++) {
    take_picture_of(camera, &frame, i, 0);
    assert_int_equal(frame.seq, i);
    assert_int_equal(frame.width_px, 64);
    assert_int_equal(frame.height_px, 48);
    assert_int_equal(frame.format, PLACIDO_MONO8);
    assert_int_equal(frame.bits, 8);
    assert_int_equal(frame.flags, 0);
  }
  assert_counts(camera, 30, 0, 0, 0, 0);
  assert_int_equal(fake_get(FAKE_LOCKED), 1);
  stop_camera(camera);
  assert_int_equal(fake_get(FAKE_LOCKED), 0);
  assert_false(fake.is_acquiring);
  placido_frame_free(&frame);
}

static void large_pictures_come_in_several_transfers(void **state) {
  (void)state;
  void *camera = start_camera("?size=2040x1536&buffers=8");
  placido_frame frame = {0};
  for (uint64_t i = 0; i < 12; i++) {
    take_picture_of(camera, &frame, i, 0);
  }
  assert_counts(camera, 12, 0, 0, 0, 0);
  assert_true(fake.flying_most > (size_t)6 << 20);
  assert_true(fake.flying_most <= (size_t)8 << 20); /* half of what the kernel has for all */
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void less_memory_for_usb_makes_do(void **state) {
  (void)state;
  fake.usb_memory = 2500000; /* less than one picture of 3 transfers */
  void *camera = start_camera("?size=2040x1536");
  placido_frame frame = {0};
  for (uint64_t i = 0; i < 5; i++) {
    take_picture_of(camera, &frame, i, 0);
  }
  assert_counts(camera, 5, 0, 0, 0, 0);
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  placido_error err = {0};
  fake.usb_memory = 100;
  assert_int_equal(driver->start(camera, &err), PLACIDO_SYSTEM);
  assert_says(&err, "usbfs_memory_mb");
  driver->close(camera);
  placido_frame_free(&frame);
}

/* The frame's block and the one that the picture came in change places. */
static void plain_pictures_are_not_copied(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  take(camera, &frame);
  placido_memory_fail_at(0);
  for (int i = 0; i < 50; i++) {
    const uint8_t *before = frame.data;
    take(camera, &frame);
    assert_ptr_not_equal(frame.data, before);
  }
  assert_int_equal(placido_memory_fail_at(0), 0); /* allocations */
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void borrowed_and_small_frames_get_a_block_of_their_own(void **state) {
  (void)state;
  void *camera = start_camera("");
  uint8_t samples[4] = {1, 2, 3, 4};
  placido_frame borrowed = {.data = samples}, small = {0};
  assert_int_equal(placido_frame_resize(&small, 2, 2, PLACIDO_MONO8, NULL), PLACIDO_OK);
  take_picture_of(camera, &borrowed, 0, 0);
  take_picture_of(camera, &small, 1, 0);
  assert_ptr_not_equal(borrowed.data, samples);
  assert_int_equal(samples[3], 4);
  placido_frame_free(&borrowed);
  placido_frame_free(&small);
  stop_camera(camera);
}

static void packed_pictures_are_unpacked(void **state) {
  (void)state;
  void *camera = start_camera("?format=Mono12p");
  placido_frame frame = {0};
  take(camera, &frame);
  assert_int_equal(frame.format, PLACIDO_MONO16);
  assert_int_equal(frame.bits, 12);
  uint16_t second;
  memcpy(&second, frame.data + 2, sizeof second);
  assert_int_equal(second, fake_sample(0, 1) >> 4 | fake_sample(0, 2) << 4);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void wide_samples_are_taken_as_they_are(void **state) {
  (void)state;
  void *camera = start_camera("?format=Mono12");
  placido_frame frame = {0};
  take(camera, &frame);
  assert_int_equal(frame.format, PLACIDO_MONO16);
  assert_int_equal(frame.bits, 12);
  assert_int_equal(frame.stride_bytes, 128);
  assert_int_equal(frame.data[1], fake_sample(0, 1));
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void padded_rows_have_a_stride(void **state) {
  (void)state;
  fake.spare_bytes = 48 * 8;
  fake_next((struct fake_picture){.padding = 8, .surplus = 48 * 8});
  void *camera = start_camera("");
  placido_frame frame = {0};
  take_picture_of(camera, &frame, 0, 0);
  assert_int_equal(frame.stride_bytes, 72);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void skipped_numbers_are_counted(void **state) {
  (void)state;
  fake_next((struct fake_picture){0});
  fake_next((struct fake_picture){.skip = 3});
  fake_next((struct fake_picture){.resets_id = true}); /* no gap can be told */
  void *camera = start_camera("");
  placido_frame frame = {0};
  take_picture_of(camera, &frame, 0, 0);
  take_picture_of(camera, &frame, 4, 0);
  assert_int_equal(frame.seq, 4);
  take_picture_of(camera, &frame, 0, 0);
  take_picture_of(camera, &frame, 1, 0);
  assert_int_equal(frame.seq, 6);
  assert_counts(camera, 4, 3, 0, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

/* A picture that is all there and yet not to be trusted is given out with a flag, in step. */
static void doubtful_pictures_are_flagged(void **state) {
  static const struct {
    struct fake_picture picture;
    uint32_t flags;
    int black_rows;
  } cases[] = {
      {{.trailer_id_off = 1}, PLACIDO_FRAME_CORRUPT, 0},
      {{.trailer_id_off = UINT64_MAX}, PLACIDO_FRAME_CORRUPT, 0},
      {{.status = 0xA100}, PLACIDO_FRAME_CORRUPT, 0},
      {{.status = 0xA101, .valid_rows = 40}, PLACIDO_FRAME_CORRUPT | PLACIDO_FRAME_TRUNCATED, 8},
      {{.valid_rows = 1}, PLACIDO_FRAME_TRUNCATED, 47},
      {{.mimics_trailer = true}, 0, -1},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    fake_next((struct fake_picture){0});
    fake_next(cases[i].picture);
    void *camera = start_camera("");
    placido_frame frame = {0};
    take_picture_of(camera, &frame, 0, 0);
    if (cases[i].black_rows >= 0) {
      take_picture_of(camera, &frame, 1, cases[i].black_rows);
    } else {
      take(camera, &frame);
    }
    assert_int_equal(frame.flags, cases[i].flags);
    take_picture_of(camera, &frame, 2, 0);
    assert_int_equal(frame.seq, 2);
    assert_counts(camera, 3, 0, (cases[i].flags & PLACIDO_FRAME_CORRUPT) != 0,
                  (cases[i].flags & PLACIDO_FRAME_TRUNCATED) != 0, 0);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

/* A camera that ends a picture early leaves the rest of its transfers out, or sends them empty. */
static void a_picture_that_ends_early_is_black_below(void **state) {
  static const struct {
    uint32_t bytes;
    int black_rows;
    bool is_padded;
  } cases[] = {{1600, 23, false}, {1600, 23, true}, {64, 47, false},
               {0, 48, false},    {0, 48, true},    {3071, 1, true}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    fake_next((struct fake_picture){0});
    fake_next((struct fake_picture){
        .is_short = true, .bytes = cases[i].bytes, .is_padded = cases[i].is_padded});
    void *camera = start_camera("");
    placido_frame frame = {0};
    take_picture_of(camera, &frame, 0, 0);
    take_picture_of(camera, &frame, 1, cases[i].black_rows);
    /* Out of step where a transfer is left out: the stream begins anew, and loses no picture that
     * was on its way. */
    const bool is_out = cases[i].bytes == 0 && !cases[i].is_padded;
    take_picture_of(camera, &frame, is_out ? 0 : 2, 0);
    assert_int_equal(frame.seq, 2);
    assert_counts(camera, 3, 0, 0, 1, is_out);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

static void a_large_picture_that_ends_early_is_black_below(void **state) {
  (void)state;
  const uint32_t mebibyte = 1 << 20;
  /* In the second transfer; and exactly at its beginning, where no transfer is short. */
  const uint32_t bytes[] = {mebibyte + 2048, mebibyte};
  for (int i = 0; i < 2; i++) {
    reset(state);
    fake_next((struct fake_picture){.is_short = true, .bytes = bytes[i]});
    void *camera = start_camera("?size=2048x1536");
    placido_frame frame = {0};
    take_picture_of(camera, &frame, 0, 1536 - (int)(bytes[i] / 2048));
    take_picture_of(camera, &frame, 0, 0);
    assert_counts(camera, 2, 0, 0, 1, 1);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

/* What comes is no picture as agreed: told, counted, and in step for the next. */
static void other_data_are_refused(void **state) {
  static const struct {
    struct fake_picture picture;
    const char *text;
  } cases[] = {
      {{.payload_type = 0x4000}, "no picture"},
      {{.payload_type = 0x1001}, "no picture"},
      {{.width = 65}, "agreed was 64 x 48"},
      {{.height = 0x80000000u}, "agreed was 64 x 48"},
      {{.format = 0x01100005}, "agreed was 64 x 48, Mono8"},
      {{.padding = 60000}, "more than was agreed"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    fake_next(cases[i].picture);
    void *camera = start_camera("");
    placido_frame frame = {0};
    placido_error err = {0};
    assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_INPUT);
    assert_says(&err, cases[i].text);
    take_picture_of(camera, &frame, 1, 0);
    assert_int_equal(frame.seq, 1);
    assert_counts(camera, 1, 0, 1, 0, 0);
    stop_camera(camera);
    placido_frame_free(&frame);
  }
}

static void pictures_with_chunks_are_pictures(void **state) {
  (void)state;
  fake.spare_bytes = 100;
  fake_next((struct fake_picture){.payload_type = 0x4001, .surplus = 100});
  fake_next((struct fake_picture){.width = 32, .height = 24}); /* smaller than agreed */
  void *camera = start_camera("");
  placido_frame frame = {0};
  take_picture_of(camera, &frame, 0, 0);
  take_picture_of(camera, &frame, 1, 0);
  assert_int_equal(frame.width_px, 32);
  assert_int_equal(frame.height_px, 24);
  assert_counts(camera, 2, 0, 0, 0, 0);
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void pictures_have_the_time_of_their_exposure(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  for (int i = 0; i < 1000; i++) {
    const int64_t due_ns = fake.next_ns;
    fake.camera_ahead_ns += 500; /* its crystal is 50 ppm fast */
    take(camera, &frame);
    /* Twice 50 ppm over the five seconds between two looks. */
    assert_in_range(frame.t_ns - (due_ns - FAKE_EXPOSED_NS) + 500000, 0, 1000000);
  }
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void without_a_clock_it_is_the_time_of_arrival(void **state) {
  (void)state;
  fake.has_no_clock = true;
  void *camera = start_camera("");
  placido_frame frame = {0};
  for (int i = 0; i < 5; i++) {
    const int64_t due_ns = fake.next_ns;
    take(camera, &frame);
    assert_in_range(frame.t_ns - due_ns, 0, 1000000);
  }
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void time_does_not_go_back(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  int64_t last_ns = 0;
  for (int i = 0; i < 400; i++) {
    if (i % 50 == 20) {
      fake_next((struct fake_picture){.is_late = true});
    }
    if (i == 150) {
      fake.camera_ahead_ns = -900000000; /* its clock is set anew */
    }
    if (i == 300) {
      driver->stop(camera, NULL);
      assert_int_equal(driver->start(camera, NULL), PLACIDO_OK);
    }
    take(camera, &frame);
    assert_true(frame.t_ns > last_ns);
    assert_true(frame.t_ns <= fake.clock_ns);
    last_ns = frame.t_ns;
  }
  stop_camera(camera);
  placido_frame_free(&frame);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)
  const struct CMUnitTest tests[] = {
      TEST(pictures_come_bit_for_bit),
      TEST(large_pictures_come_in_several_transfers),
      TEST(less_memory_for_usb_makes_do),
      TEST(plain_pictures_are_not_copied),
      TEST(borrowed_and_small_frames_get_a_block_of_their_own),
      TEST(packed_pictures_are_unpacked),
      TEST(wide_samples_are_taken_as_they_are),
      TEST(padded_rows_have_a_stride),
      TEST(skipped_numbers_are_counted),
      TEST(doubtful_pictures_are_flagged),
      TEST(a_picture_that_ends_early_is_black_below),
      TEST(a_large_picture_that_ends_early_is_black_below),
      TEST(other_data_are_refused),
      TEST(pictures_with_chunks_are_pictures),
      TEST(pictures_have_the_time_of_their_exposure),
      TEST(without_a_clock_it_is_the_time_of_arrival),
      TEST(time_does_not_go_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

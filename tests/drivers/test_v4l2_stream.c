/* Pictures, losses, damage, silence and unplugging come out as the camera's script says. */
#include "base/file.h"
#include "base/memory.h"
#include "drivers/v4l2/mjpeg.h"
#include "tests/drivers/v4l2_use.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* Through every way to the pictures: a queue, a multiplanar queue, read(). */
static void pictures_arrive_bit_by_bit(void **state) {
  for (int way = 0; way < 3; way++) {
    reset(state);
    fake.is_multiplanar = way == 1;
    fake.can_read = way == 2;
    fake.can_stream = way != 2;
    void *camera = start_camera("/dev/video0");
    assert_true(fake.last_open_flags & O_NONBLOCK && fake.last_open_flags & O_CLOEXEC);
    placido_frame frame = {0};
    for (uint64_t i = 0; i < 20; i++) {
      take(camera, &frame);
      assert_int_equal(frame.width_px, 8);
      assert_int_equal(frame.height_px, 4);
      assert_int_equal(frame.seq, i);
      assert_int_equal(frame.flags, 0);
      assert_int_equal(frame.t_ns, fake.clock_ns);
      assert_memory_equal(frame.data, grey, sizeof grey);
    }
    assert_int_equal(counts_of(camera).frames, 20);
    assert_int_equal(counts_of(camera).dropped + counts_of(camera).restarts, 0);
    placido_frame_free(&frame);
    stop_camera(camera);
    assert_int_equal(nothing_is_left(state), 0);
  }
}

static void a_camera_whose_queue_is_refused_is_read_from(void **state) {
  (void)state;
  fake.can_read = true;
  void *camera = open_camera("/dev/video0", NULL);
  fake.can_stream = false; /* it said otherwise */
  placido_frame frame = {0};
  assert_int_equal(driver->start(camera, NULL), PLACIDO_OK);
  take(camera, &frame);
  assert_memory_equal(frame.data, grey, sizeof grey);
  placido_frame_free(&frame);
  stop_camera(camera);
}

/* The JPEG is black but for its upper left quarter. Damaged ones are told and counted, and the next
 * one is whole. */
static void jpeg_pictures_are_decoded(void **state) {
  (void)state;
  char *jpeg;
  size_t size;
  assert_int_equal(placido_file_read(&jpeg, &size, PLACIDO_TEST_DATA "/corner.jpg", 0, NULL),
                   PLACIDO_OK);
  fake.offers[0] = (struct fake_offer){V4L2_PIX_FMT_MJPEG, 16, 8, {30}};
  fake.picture = (const uint8_t *)jpeg;
  fake.picture_size = size;
  void *camera;
  if (placido_v4l2_open(&camera, "/dev/video0", &fake_calls, NULL, NULL) == PLACIDO_OK) {
    fake_next((struct fake_event){0});
    fake_next((struct fake_event){.is_short = true, .used = 0});
    fake_next((struct fake_event){.is_short = true, .used = 30});
    fake_next((struct fake_event){0});
    assert_int_equal(driver->start(camera, NULL), PLACIDO_OK);
    placido_frame frame = {0};
    placido_error err = {0};
    for (int i = 0; i < 4; i++) {
      const int status = driver->next(camera, &frame, 100, &err);
      assert_int_equal(status, i == 1 || i == 2 ? PLACIDO_INPUT : PLACIDO_OK);
      assert_true(status == PLACIDO_OK || strstr(err.text, "damaged"));
    }
    assert_int_equal(frame.seq, 3);
    assert_int_equal(frame.width_px, 16);
    assert_true(frame.data[0] > 200 && frame.data[15] < 55 && frame.data[7 * 16] < 55);
    assert_int_equal(counts_of(camera).corrupt, 2);
    placido_frame_free(&frame);
    stop_camera(camera);
  } else {
    const placido_v4l2_format *format = placido_v4l2_format_named("MJPEG");
    assert_false(placido_v4l2_is_readable(format));
  }
  placido_memory_free(jpeg);
}

static void lost_and_damaged_pictures_are_counted(void **state) {
  (void)state;
  fake_next((struct fake_event){.skip = 2});
  fake_next((struct fake_event){.skip = 3, .flags = V4L2_BUF_FLAG_ERROR});
  fake_next((struct fake_event){.is_short = true, .used = 17});
  fake_next((struct fake_event){.is_short = true, .used = 0, .flags = V4L2_BUF_FLAG_ERROR});
  fake_next((struct fake_event){.is_short = true, .used = 0xffffffff}); /* more than there is */
  static const struct {
    uint64_t seq;
    uint32_t flags;
  } expected[] = {{0, 0}, {4, PLACIDO_FRAME_CORRUPT}, {5, PLACIDO_FRAME_TRUNCATED},
                  {6, PLACIDO_FRAME_CORRUPT | PLACIDO_FRAME_TRUNCATED}, {7, 0}, {8, 0}};
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
    take(camera, &frame);
    assert_int_equal(frame.seq, expected[i].seq);
    assert_int_equal(frame.flags, expected[i].flags);
    if (i == 2) {
      assert_memory_equal(frame.data, grey, 16);
      assert_int_equal(frame.data[16], 0);
    }
  }
  const placido_device_statistics counts = counts_of(camera);
  assert_int_equal(counts.frames, 6);
  assert_int_equal(counts.dropped, 3); /* of those before the first nothing is known */
  assert_int_equal(counts.corrupt, 2);
  assert_int_equal(counts.truncated, 2);
  assert_int_equal(counts.restarts, 0);
  placido_frame_free(&frame);
  stop_camera(camera);
}

/* A plane may begin with bytes that are no picture; what they push out at the end is missing. */
static void a_plane_begins_at_its_offset(void **state) {
  (void)state;
  fake.is_multiplanar = true;
  fake.lie_data_offset = 8;
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  take(camera, &frame);
  assert_int_equal(frame.flags, PLACIDO_FRAME_TRUNCATED);
  assert_memory_equal(frame.data, grey + 8, 24);
  assert_int_equal(frame.data[24], 0);
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void the_counter_of_32_bits_goes_on(void **state) {
  (void)state;
  fake_next((struct fake_event){.skip = 0xfffffffe});
  fake_next((struct fake_event){0});
  fake_next((struct fake_event){.skip = 1}); /* 0 is lost */
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  static const uint64_t expected[] = {0, 1, 3};
  for (int i = 0; i < 3; i++) {
    take(camera, &frame);
    assert_int_equal(frame.seq, expected[i]);
  }
  assert_int_equal(counts_of(camera).dropped, 1);
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void waiting_ends_at_the_deadline(void **state) {
  (void)state;
  fake_next((struct fake_event){.is_silent = true});
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  placido_error err = {0};
  const int64_t before_ns = fake.clock_ns;
  assert_int_equal(driver->next(camera, &frame, 250, &err), PLACIDO_TIMEOUT);
  assert_int_equal(fake.clock_ns - before_ns, 250000000);
  assert_says(&err, "no frame within 250 ms");
  take(camera, &frame); /* and goes on */
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void a_queue_that_was_asleep_is_started_anew(void **state) {
  (void)state;
  fake_next((struct fake_event){.is_silent = true});
  fake_next((struct fake_event){.is_silent = true});
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  assert_int_equal(driver->next(camera, &frame, 10, NULL), PLACIDO_TIMEOUT);
  assert_int_equal(fake.streamon_count, 1); /* mere silence: perhaps it waits for a trigger */
  fake.asleep_ns += 3600000000000;
  assert_int_equal(driver->next(camera, &frame, 10, NULL), PLACIDO_TIMEOUT);
  take(camera, &frame);
  assert_int_equal(fake.streamon_count, 2);
  assert_int_equal(counts_of(camera).restarts, 1);
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void a_passing_error_is_mended(void **state) {
  static const int codes[] = {EINTR, EAGAIN, EIO, EINVAL, EPIPE};
  for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
    reset(state);
    fake_next((struct fake_event){0});
    fake_next((struct fake_event){.code = codes[i]});
    void *camera = start_camera("/dev/video0");
    placido_frame frame = {0};
    take(camera, &frame);
    take(camera, &frame);
    assert_int_equal(frame.seq, 1);
    const bool restarts = codes[i] != EINTR && codes[i] != EAGAIN;
    assert_int_equal(counts_of(camera).restarts, restarts);
    placido_frame_free(&frame);
    stop_camera(camera);
  }
}

static void an_error_that_stays_is_told(void **state) {
  (void)state;
  for (int i = 0; i < 20; i++) {
    fake_next((struct fake_event){.code = EIO});
  }
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  placido_error err = {0};
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_SYSTEM);
  assert_says(&err, "taking a picture from the camera Fake camera");
  assert_says(&err, strerror(EIO));
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_SYSTEM);
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void an_unplugged_camera_is_found_again(void **state) {
  (void)state;
  have_controls();
  fake_next((struct fake_event){0});
  fake_next((struct fake_event){.is_unplug = true}); /* DQBUF says EINVAL, as uvcvideo does */
  void *camera = start_camera("/dev/video0");
  assert_int_equal(driver->set(camera, control_index(camera, "gain"), 55, NULL), PLACIDO_OK);
  placido_frame frame = {0};
  placido_error err = {0};
  take(camera, &frame);
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  assert_says(&err, "Fake camera");
  assert_says(&err, "unplugged");
  assert_int_equal(fake.open_count + fake.mapped_count, 0); /* the kernel can forget the node */
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  double value;
  assert_int_equal(driver->get(camera, control_index(camera, "gain"), &value, NULL),
                   PLACIDO_GONE);
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  assert_int_equal(driver->start(camera, &err), PLACIDO_GONE); /* not yet */

  fake_replug();
  have_controls(); /* as after power on */
  assert_int_equal(driver->start(camera, &err), PLACIDO_OK);
  take(camera, &frame);
  assert_int_equal(frame.seq, 1); /* the counter goes on */
  assert_int_equal(driver->get(camera, control_index(camera, "gain"), &value, NULL), PLACIDO_OK);
  assert_true(value == 55);
  placido_frame_free(&frame);
  stop_camera(camera);
}

static void another_camera_in_its_place_is_not_taken(void **state) {
  (void)state;
  fake_next((struct fake_event){.is_unplug = true});
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  placido_error err = {0};
  assert_int_equal(driver->next(camera, &frame, 100, NULL), PLACIDO_GONE);
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  fake_replug();
  fake.card = "Other camera";
  assert_int_equal(driver->start(camera, &err), PLACIDO_GONE);
  assert_says(&err, "is the camera Other camera now");
  placido_frame_free(&frame);
  driver->close(camera);
}

static void buffers_are_shared_where_offered(void **state) {
  (void)state;
  void *camera = start_camera("/dev/video0?buffers=3");
  int descriptor;
  assert_int_equal(fake.buffer_count, 3);
  assert_int_equal(placido_v4l2_export(camera, 2, &descriptor, NULL), PLACIDO_OK);
  assert_true(descriptor >= 0);
  assert_int_equal(placido_v4l2_export(camera, 3, &descriptor, NULL), PLACIDO_INPUT);
  assert_int_equal(descriptor, -1);
  fake.cannot_export = true;
  assert_int_equal(placido_v4l2_export(camera, 0, &descriptor, NULL), PLACIDO_UNSUPPORTED);
  stop_camera(camera);
}

/* As uvcvideo does after a stalled endpoint: a damaged picture or two, then nothing for ever. */
static void silence_behind_a_damaged_picture_starts_the_queue_anew(void **state) {
  (void)state;
  void *camera = start_camera("/dev/video0");
  placido_frame frame = {0};
  take(camera, &frame);
  fake_next((struct fake_event){.flags = V4L2_BUF_FLAG_ERROR});
  fake_next((struct fake_event){.is_silent = true});
  take(camera, &frame);
  assert_int_equal(frame.flags, PLACIDO_FRAME_CORRUPT);
  assert_int_equal(driver->next(camera, &frame, 5000, NULL), PLACIDO_OK);
  assert_int_equal(frame.flags, 0);
  assert_int_equal(counts_of(camera).restarts, 1);
  /* Without damage before it, silence is a camera that waits for its trigger. */
  fake_next((struct fake_event){.is_silent = true});
  assert_int_equal(driver->next(camera, &frame, 5000, NULL), PLACIDO_TIMEOUT);
  assert_int_equal(counts_of(camera).restarts, 1);
  placido_frame_free(&frame);
  stop_camera(camera);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)
  const struct CMUnitTest tests[] = {
      TEST(pictures_arrive_bit_by_bit),
      TEST(a_camera_whose_queue_is_refused_is_read_from),
      TEST(jpeg_pictures_are_decoded),
      TEST(lost_and_damaged_pictures_are_counted),
      TEST(a_plane_begins_at_its_offset),
      TEST(the_counter_of_32_bits_goes_on),
      TEST(waiting_ends_at_the_deadline),
      TEST(a_queue_that_was_asleep_is_started_anew),
      TEST(a_passing_error_is_mended),
      TEST(an_error_that_stays_is_told),
      TEST(an_unplugged_camera_is_found_again),
      TEST(another_camera_in_its_place_is_not_taken),
      TEST(buffers_are_shared_where_offered),
      TEST(silence_behind_a_damaged_picture_starts_the_queue_anew),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

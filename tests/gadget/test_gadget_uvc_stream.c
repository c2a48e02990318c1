/* The simulated UVC camera sends the view bit by bit, when it is due, or with the fault that was
 * ordered. */
#include "tests/gadget/uvc_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <linux/usb/video.h>
#include <string.h>

static void the_view_arrives_bit_by_bit(void **state) {
  (void)state;
  agree(1, 1);
  uint8_t id = 2;
  for (int i = 0; i < 10; i++) {
    scene.data[0] = (uint8_t)i;
    receive();
    assert_int_equal(picture.size, WIDTH * HEIGHT);
    assert_int_equal(picture.payloads, 2);
    assert_memory_equal(picture.bytes, scene.data, picture.size);
    assert_int_not_equal(picture.first_flags & UVC_STREAM_FID, id);
    assert_int_equal(picture.last_flags, picture.first_flags | UVC_STREAM_EOF);
    id = picture.first_flags & UVC_STREAM_FID;
    size_t size = sizeof picture.bytes;
    assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_LATER);
    pass(50 * MS);
  }
  placido_gadget_statistics statistics;
  placido_uvc_face.statistics(gadget.state, &statistics);
  assert_int_equal(statistics.pictures, 10);
  assert_int_equal(statistics.dropped, 0);
  assert_true(statistics.commands > 0);
}

static void colour_has_the_samples_as_luma(void **state) {
  (void)state;
  agree(2, 1);
  receive();
  assert_int_equal(picture.size, 2 * WIDTH * HEIGHT);
  for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
    assert_int_equal(picture.bytes[2 * i], scene.data[i]);
    assert_int_equal(picture.bytes[2 * i + 1], 128);
  }
}

static void half_the_size_is_the_mean_of_four(void **state) {
  (void)state;
  agree(1, 2);
  receive();
  assert_int_equal(picture.size, WIDTH * HEIGHT / 4);
  for (int y = 0; y < HEIGHT / 2; y++) {
    for (int x = 0; x < WIDTH / 2; x++) {
      const uint8_t *at = scene.data + 2 * y * WIDTH + 2 * x;
      const int sum = at[0] + at[1] + at[WIDTH] + at[WIDTH + 1];
      assert_int_equal(picture.bytes[y * WIDTH / 2 + x], (sum + 2) / 4);
    }
  }
}

/* 12 bits of an odd width: the size's last column is cut off, the small one is from the middle. */
static void words_are_shown_by_their_upper_bits(void **state) {
  plug_in(701, 500, PLACIDO_MONO16, 20, PLACIDO_GADGET_HIGH);
  uint16_t *samples = (uint16_t *)(void *)scene.data;
  const size_t row = scene.stride_bytes / 2;
  scene.bits = 12;
  for (size_t i = 0; i < 500 * row; i++) {
    samples[i] &= 0xfff;
  }
  agree(1, 1);
  receive();
  assert_int_equal(picture.size, 700 * 500);
  assert_int_equal(picture.bytes[700 * 499 + 699], samples[499 * row + 699] >> 4);
  agree(1, 3);
  receive();
  assert_int_equal(picture.size, 640 * 480);
  assert_int_equal(picture.bytes[0], samples[10 * row + 30] >> 4);
  agree(1, 2);
  receive();
  const uint16_t *at = samples + 2 * row;
  assert_int_equal(picture.bytes[350], (at[0] + at[1] + at[row] + at[row + 1]) / 4 >> 4);
  unplug(state);
}

static void controls_change_the_picture(void **state) {
  (void)state;
  static const struct {
    uint32_t exposure, gain, brightness;
    int levels[3]; /* of 0, 100, 200 */
  } settings[] = {{100, 16, 0, {0, 100, 200}},      {50, 16, 0, {0, 50, 100}},
                  {100, 32, 0, {0, 200, 255}},      {100, 16, 100, {100, 200, 255}},
                  {100, 16, 0xff9c, {0, 0, 100}}, {10000, 255, 0, {0, 255, 255}},
                  {100, 0, 7, {7, 7, 7}}};
  agree(1, 1);
  for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
    assert_int_equal(set(UVC_CT_EXPOSURE_TIME_ABSOLUTE_CONTROL, CAMERA, settings[i].exposure, 4),
                     PLACIDO_GADGET_DONE);
    assert_int_equal(set(UVC_PU_GAIN_CONTROL, PROCESSING, settings[i].gain, 2),
                     PLACIDO_GADGET_DONE);
    assert_int_equal(set(UVC_PU_BRIGHTNESS_CONTROL, PROCESSING, settings[i].brightness, 2),
                     PLACIDO_GADGET_DONE);
    for (int j = 0; j < 3; j++) {
      scene.data[j] = (uint8_t)(100 * j);
    }
    receive();
    for (int j = 0; j < 3; j++) {
      assert_int_equal(picture.bytes[j], settings[i].levels[j]);
    }
    pass(50 * MS);
  }
}

/* The clock of the device, its count of milliseconds and the time of exposure are one clock: as
 * much passes in each between two pictures. */
static void clocks_run_in_step(void **state) {
  (void)state;
  agree(1, 1);
  uint32_t taken = 0, clock = 0, frame = 0;
  for (int i = 0; i < 100; i++) {
    pass(3 * MS); /* the host is late */
    receive();
    for (int j = 1; j < picture.payloads; j++) {
      assert_memory_equal(picture.headers[j] + 2, picture.headers[0] + 2, 4);
    }
    const uint8_t *header = picture.headers[0];
    if (i > 0) {
      assert_int_equal(number(header + 2, 4) - taken, 50000);
      assert_int_equal(number(header + 6, 4) - clock, 50000);
      assert_int_equal((number(header + 10, 2) - frame) & 0x7ff, 50);
    }
    taken = number(header + 2, 4);
    clock = number(header + 6, 4);
    frame = number(header + 10, 2);
    assert_int_equal(clock - taken, 3000);
    assert_true(frame < 2048);
    pass(47 * MS);
  }
}

static void pictures_come_when_they_are_due(void **state) {
  (void)state;
  agree(1, 1);
  receive();
  assert_int_equal(placido_gadget_tick(&gadget, now_ns), now_ns + 50 * MS);
  pass(50 * MS - 1);
  assert_int_equal(receive()->payloads, 0);
  pass(1);
  assert_int_equal(receive()->payloads, 2);
  /* left lying for a while, they are lost, and the newest comes; then the rhythm is the old one */
  pass(475 * MS);
  assert_int_equal(receive()->payloads, 2);
  assert_int_equal(receive()->payloads, 0);
  pass(25 * MS);
  assert_int_equal(receive()->payloads, 2);
  placido_gadget_statistics statistics;
  placido_uvc_face.statistics(gadget.state, &statistics);
  assert_int_equal(statistics.pictures, 4);
  assert_int_equal(statistics.dropped, 8);
  /* nobody fetches: no more than one call a picture */
  pass(500 * MS);
  assert_true(placido_gadget_tick(&gadget, now_ns) >= now_ns + 50 * MS);
}

/* A payload may come in several transfers. One that is short and ends with a full transfer is
 * ended by an empty one; one that is as long as it may be is not. */
static void payloads_end_whatever_the_transfers(void **state) {
  (void)state;
  static const size_t transfers[] = {1024, 5120, 16408 / 2, 16384, 65536};
  for (size_t i = 0; i < sizeof transfers / sizeof transfers[0]; i++) {
    agree(1, 1); /* 49,152 pixels: 32,768 bytes in the first payload, 16,408 in the last */
    size_t payload = 0, total = 0;
    int payloads = 0;
    while (payloads < 2) {
      size_t size = transfers[i];
      assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_DONE);
      payload += size;
      total += size;
      if (size < transfers[i] || payload == TRANSFER) {
        assert_int_equal(payload, payloads ? 16408 : TRANSFER);
        payload = 0;
        payloads++;
      }
    }
    assert_int_equal(total, WIDTH * HEIGHT + 2 * 12);
    size_t size = transfers[i];
    assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_LATER);
  }
}

static void a_stop_stops_and_a_commit_starts_anew(void **state) {
  (void)state;
  assert_int_equal(receive()->payloads, 0); /* nobody has asked for pictures */
  agree(1, 1);
  size_t size = TRANSFER;
  assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_DONE);
  agree(2, 2); /* in mid-picture */
  assert_int_equal(receive()->size, WIDTH * HEIGHT / 2);
  const placido_gadget_setup set_interface = {0x01, 11, 0, 1, 0};
  pass(50 * MS);
  size = TRANSFER;
  assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_DONE);
  size = 0;
  assert_int_equal(placido_gadget_transfer(&gadget, 0, &set_interface, NULL, &size),
                   PLACIDO_GADGET_DONE);
  pass(50 * MS);
  assert_int_equal(receive()->payloads, 0);
  assert_int_equal(placido_gadget_tick(&gadget, now_ns), INT64_MAX);
  agree(2, 2);
  assert_int_equal(receive()->size, WIDTH * HEIGHT / 2);
}

static void clear_halt(void) {
  const placido_gadget_setup clear = {0x02, 1, 0, PLACIDO_UVC_STREAM_ENDPOINT, 0};
  size_t size = 0;
  assert_int_equal(placido_gadget_transfer(&gadget, 0, &clear, NULL, &size), PLACIDO_GADGET_DONE);
}

static void check_whole(uint8_t *id) {
  pass(50 * MS);
  receive();
  assert_int_equal(picture.size, WIDTH * HEIGHT);
  assert_memory_equal(picture.bytes, scene.data, WIDTH * HEIGHT);
  assert_int_equal(picture.all_flags & UVC_STREAM_ERR, 0);
  assert_int_not_equal(picture.first_flags & UVC_STREAM_FID, *id);
  *id = picture.last_flags & UVC_STREAM_FID;
}

/* Behind every fault a whole picture follows, with another id than the bytes before. */
static void faults_are_as_ordered(void **state) {
  (void)state;
  static const struct {
    enum placido_gadget_fault fault;
    size_t size;
    int payloads;
    uint8_t flags; /* in some payload, beside id and those that are always there */
    bool changes_id, toggles, stalls;
  } cases[] = {
      {PLACIDO_GADGET_FAULT_STALL, 32756, 1, 0, false, true, true},
      {PLACIDO_GADGET_FAULT_DROP, 0, 1, UVC_STREAM_EOF, false, true, false},
      {PLACIDO_GADGET_FAULT_CORRUPT, 49152, 2, UVC_STREAM_EOF | UVC_STREAM_ERR, false, true, false},
      {PLACIDO_GADGET_FAULT_TRUNCATE, 24576, 1, UVC_STREAM_EOF, false, true, false},
      {PLACIDO_GADGET_FAULT_MISNUMBER, 49152, 2, UVC_STREAM_EOF, true, true, false},
      {PLACIDO_GADGET_FAULT_LOST_START, 49152 - 32756, 1, UVC_STREAM_EOF, false, true, false},
      {PLACIDO_GADGET_FAULT_LOST_END, 32756, 1, 0, false, true, false},
  };
  agree(1, 1);
  uint8_t id = 2;
  receive();
  id = picture.last_flags & UVC_STREAM_FID;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    check_whole(&id);
    faults.left[cases[i].fault] = 1;
    pass(50 * MS);
    receive();
    assert_int_equal(faults.left[cases[i].fault], 0);
    assert_int_equal(picture.size, cases[i].size);
    assert_int_equal(picture.payloads, cases[i].payloads);
    assert_int_equal(picture.all_flags & (UVC_STREAM_EOF | UVC_STREAM_ERR), cases[i].flags);
    assert_int_equal(picture.is_stalled, cases[i].stalls);
    assert_int_not_equal(picture.first_flags & UVC_STREAM_FID, id);
    const uint8_t changes = (picture.first_flags ^ picture.last_flags) & UVC_STREAM_FID;
    assert_int_equal(changes, cases[i].changes_id);
    id = picture.last_flags & UVC_STREAM_FID;
    if (cases[i].stalls) {
      pass(50 * MS);
      assert_true(receive()->is_stalled); /* until the host clears it */
      clear_halt();
    }
    check_whole(&id);
  }
  assert_int_equal(get(UVC_GET_CUR, UVC_VS_STREAM_ERROR_CODE_CONTROL, VS, 1), 3);
}

/* Faults of a picture that one payload holds. */
static void small_pictures_have_faults_too(void **state) {
  plug_in(64, 48, PLACIDO_MONO8, 20, PLACIDO_GADGET_SUPER);
  agree(1, 1);
  static const int payloads[] = {[PLACIDO_GADGET_FAULT_STALL] = 0, 1, 1, 1, 1, 0, 0};
  for (int fault = 0; fault <= PLACIDO_GADGET_FAULT_LOST_END; fault++) {
    faults.left[fault] = 1;
    receive();
    assert_int_equal(faults.left[fault], 0);
    assert_int_equal(picture.payloads, payloads[fault]);
    assert_int_equal(picture.is_stalled, fault == PLACIDO_GADGET_FAULT_STALL);
    if (fault == PLACIDO_GADGET_FAULT_STALL) {
      clear_halt();
    }
    pass(50 * MS);
    assert_int_equal(receive()->size, 64 * 48);
    pass(50 * MS);
  }
  unplug(state);
}

static void a_cleared_halt_begins_with_a_picture(void **state) {
  (void)state;
  agree(1, 1);
  size_t size = 1000;
  assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_DONE); /* part of a payload */
  clear_halt();
  pass(50 * MS);
  assert_memory_equal(receive()->bytes, scene.data, WIDTH * HEIGHT);
}

static void everything_comes_later_where_it_is_slow(void **state) {
  (void)state;
  agree(1, 1);
  receive();
  faults.slow_ms = 30;
  uint8_t data[2];
  size_t size = sizeof data;
  assert_int_equal(ask(UVC_GET_CUR, UVC_PU_GAIN_CONTROL, PROCESSING, data, &size),
                   PLACIDO_GADGET_LATER);
  assert_int_equal(placido_gadget_tick(&gadget, now_ns), now_ns + 30 * MS);
  pass(30 * MS);
  size = sizeof data;
  assert_int_equal(ask(UVC_GET_CUR, UVC_PU_GAIN_CONTROL, PROCESSING, data, &size),
                   PLACIDO_GADGET_DONE);
  assert_int_equal(data[0], 16);
  pass(49 * MS);
  assert_int_equal(receive()->payloads, 0);
  pass(1 * MS);
  assert_int_equal(receive()->payloads, 2);
  const uint8_t *header = picture.headers[0];
  assert_int_equal(number(header + 6, 4) - number(header + 2, 4), 30000);
}

static void a_view_without_a_picture_is_waited_for(void **state) {
  (void)state;
  agree(1, 1);
  is_dark = true;
  assert_int_equal(receive()->payloads, 0);
  assert_int_equal(receive()->payloads, 0);
  assert_int_equal(looks, 1); /* once a picture */
  is_dark = false;
  assert_int_equal(receive()->payloads, 0);
  pass(50 * MS);
  assert_int_equal(receive()->payloads, 2);
  scene.width_px = WIDTH + 1; /* not what was promised: never read past its end */
  pass(50 * MS);
  assert_int_equal(receive()->payloads, 0);
  scene.width_px = WIDTH;
}

int main(void) {
#define CASE(name) cmocka_unit_test_setup_teardown(name, plug_in_usual, unplug)
  const struct CMUnitTest tests[] = {
      CASE(the_view_arrives_bit_by_bit),
      CASE(colour_has_the_samples_as_luma),
      CASE(half_the_size_is_the_mean_of_four),
      cmocka_unit_test(words_are_shown_by_their_upper_bits),
      CASE(controls_change_the_picture),
      CASE(clocks_run_in_step),
      CASE(pictures_come_when_they_are_due),
      CASE(payloads_end_whatever_the_transfers),
      CASE(a_stop_stops_and_a_commit_starts_anew),
      CASE(faults_are_as_ordered),
      cmocka_unit_test(small_pictures_have_faults_too),
      CASE(a_cleared_halt_begins_with_a_picture),
      CASE(everything_comes_later_where_it_is_slow),
      CASE(a_view_without_a_picture_is_waited_for),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What tests do with a simulated UVC camera. */
#include "tests/gadget/uvc_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <linux/usb/video.h>
#include <string.h>

placido_frame scene;
int looks;
placido_gadget_faults faults;
placido_gadget gadget;
int64_t now_ns;
bool is_dark;

const placido_frame *look(void *user, int64_t t_ns) {
  (void)user;
  (void)t_ns;
  looks++;
  return is_dark ? NULL : &scene;
}

static void paint(int width_px, int height_px, enum placido_format format) {
  assert_int_equal(placido_frame_resize(&scene, width_px, height_px, format, NULL), PLACIDO_OK);
  uint32_t random = 1;
  for (size_t i = 0; i < (size_t)scene.height_px * scene.stride_bytes; i++) {
    random = random * 1664525u + 1013904223u;
    scene.data[i] = (uint8_t)(random >> 24);
  }
}

void plug_in(int width_px, int height_px, enum placido_format format, double rate_hz,
             enum placido_gadget_speed speed) {
  memset(&faults, 0, sizeof faults);
  is_dark = false;
  looks = 0;
  now_ns = 1000 * MS;
  paint(width_px, height_px, format);
  const placido_gadget_options options = {
      .view = {look, NULL, width_px, height_px, rate_hz},
      .faults = &faults,
      .speed = speed,
      .serial = "SIM1"};
  void *state;
  placido_error err = {0};
  if (placido_uvc_face.open(&state, &options, &err)) {
    fail_msg("%s", err.text);
  }
  gadget = (placido_gadget){.function = placido_uvc_face.function, .state = state, .speed = speed};
  placido_gadget_tick(&gadget, now_ns);
}

int unplug(void **state) {
  (void)state;
  placido_uvc_face.close(gadget.state);
  gadget.state = NULL;
  placido_frame_free(&scene);
  return 0;
}

int plug_in_usual(void **state) {
  (void)state;
  plug_in(WIDTH, HEIGHT, PLACIDO_MONO8, 20, PLACIDO_GADGET_SUPER);
  return 0;
}

void pass(int64_t time_ns) {
  now_ns += time_ns;
  placido_gadget_tick(&gadget, now_ns);
}

enum placido_gadget_answer ask(uint8_t request, uint8_t selector, uint16_t entity, uint8_t *data,
                               size_t *size) {
  const placido_gadget_setup setup = {request & 0x80 ? 0xa1 : 0x21, request,
                                      (uint16_t)(selector << 8), entity, (uint16_t)*size};
  return placido_gadget_transfer(&gadget, 0, &setup, data, size);
}

uint32_t number(const uint8_t *at, int size) {
  uint32_t value = 0;
  for (int i = 0; i < size; i++) {
    value |= (uint32_t)at[i] << 8 * i;
  }
  return value;
}

uint32_t get(uint8_t request, uint8_t selector, uint16_t entity, size_t length) {
  uint8_t data[64] = {0};
  size_t size = sizeof data;
  assert_int_equal(ask(request, selector, entity, data, &size), PLACIDO_GADGET_DONE);
  assert_int_equal(size, length);
  return number(data, (int)size);
}

enum placido_gadget_answer set(uint8_t selector, uint16_t entity, uint32_t value, size_t size) {
  uint8_t data[8] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                     (uint8_t)(value >> 24)};
  return ask(UVC_SET_CUR, selector, entity, data, &size);
}

uint32_t reason(void) {
  return get(UVC_GET_CUR, UVC_VC_REQUEST_ERROR_CODE_CONTROL, 0, 1);
}

void get_block(uint8_t request, uint8_t selector, uint8_t block[PROBE]) {
  size_t size = PROBE;
  assert_int_equal(ask(request, selector, VS, block, &size), PLACIDO_GADGET_DONE);
  assert_int_equal(size, PROBE);
}

enum placido_gadget_answer set_block(uint8_t selector, uint8_t block[PROBE]) {
  size_t size = PROBE;
  return ask(UVC_SET_CUR, selector, VS, block, &size);
}

void agree(uint8_t format, uint8_t size) {
  uint8_t block[PROBE] = {0, 0, format, size};
  assert_int_equal(set_block(UVC_VS_PROBE_CONTROL, block), PLACIDO_GADGET_DONE);
  get_block(UVC_GET_CUR, UVC_VS_PROBE_CONTROL, block);
  assert_int_equal(block[2], format);
  assert_int_equal(block[3], size);
  assert_int_equal(set_block(UVC_VS_COMMIT_CONTROL, block), PLACIDO_GADGET_DONE);
}

enum placido_gadget_answer fetch(uint8_t *bytes, size_t *size) {
  return placido_gadget_transfer(&gadget, PLACIDO_UVC_STREAM_ENDPOINT, NULL, bytes, size);
}

struct picture picture;

const struct picture *receive(void) {
  static uint8_t transfer[TRANSFER];
  picture = (struct picture){0};
  while (!(picture.last_flags & UVC_STREAM_EOF)) {
    size_t size = sizeof transfer;
    const enum placido_gadget_answer answer = fetch(transfer, &size);
    picture.is_stalled = answer == PLACIDO_GADGET_STALL;
    if (answer != PLACIDO_GADGET_DONE) {
      return &picture;
    }
    assert_in_range(size, 12, sizeof transfer);
    assert_int_equal(transfer[0], 12);
    assert_true((transfer[1] & 0x8c) == 0x8c); /* PTS, SCR, end of header */
    memcpy(picture.headers[picture.payloads % 64], transfer, 12);
    memcpy(picture.bytes + picture.size, transfer + 12, size - 12);
    picture.size += size - 12;
    picture.last_flags = transfer[1];
    picture.all_flags |= transfer[1];
    picture.first_flags = picture.payloads++ ? picture.first_flags : transfer[1];
  }
  return &picture;
}

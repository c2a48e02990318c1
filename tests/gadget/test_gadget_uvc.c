/* The simulated UVC camera says of itself what is consistent, and agrees on a mode and on settings
 * as the class wants it. */
#include "base/memory.h"
#include "tests/gadget/uvc_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <linux/usb/ch9.h>
#include <linux/usb/video.h>
#include <string.h>

/* Walks over the descriptors of a configuration: the next one of this type and subtype. */
static const uint8_t *next(const uint8_t *at, const uint8_t *end, uint8_t type, uint8_t subtype) {
  for (at += at[0]; at < end; at += at[0]) {
    assert_true(at[0] >= 2 && at[0] <= end - at);
    if (at[1] == type && (type != USB_DT_CS_INTERFACE || at[2] == subtype)) {
      return at;
    }
  }
  return end;
}

static void check_frames(const uint8_t *format, const uint8_t *end, int bits) {
  assert_int_equal(format[21], bits);
  const uint8_t *frame = format;
  for (int i = 1; i <= format[4]; i++) {
    frame = next(frame, end, USB_DT_CS_INTERFACE, UVC_VS_FRAME_UNCOMPRESSED);
    assert_int_equal(frame[3], i);
    const uint32_t bytes = number(frame + 5, 2) * number(frame + 7, 2) * (uint32_t)bits / 8;
    assert_int_equal(number(frame + 17, 4), bytes);
    assert_int_equal(frame[0], 26 + 4 * frame[25]);
    assert_true(frame[25] >= 1 && number(frame + 5, 2) % 2 == 0);
    bool has_usual = false;
    for (int j = 0; j < frame[25]; j++) {
      const uint32_t interval = number(frame + 26 + 4 * j, 4);
      assert_true(j == 0 || interval > number(frame + 22 + 4 * j, 4));
      has_usual = has_usual || interval == number(frame + 21, 4);
    }
    assert_true(has_usual);
    assert_true(number(frame + 9, 4) <= number(frame + 13, 4));
  }
  /* behind the last one: the colours, and nothing else of this format */
  frame += frame[0];
  assert_int_equal(frame[2], UVC_VS_COLORFORMAT);
}

static void check_configuration(const uint8_t *all, size_t size,
                                enum placido_gadget_speed speed) {
  const uint8_t *end = all + size;
  assert_int_equal(number(all + 2, 2), size);
  assert_int_equal(all[4], 2);
  const uint8_t *control = next(all, end, USB_DT_INTERFACE, 0);
  const uint8_t *stream = next(control, end, USB_DT_INTERFACE, 0);
  assert_true(next(stream, end, USB_DT_INTERFACE, 0) == end);
  assert_int_equal(control[2], 0);
  assert_int_equal(stream[2], 1);
  const uint8_t *association = next(all, end, USB_DT_INTERFACE_ASSOCIATION, 0);
  assert_int_equal(association[7], control[8]); /* the same name (UVC, section 3.7) */
  const uint8_t *header = next(control, stream, USB_DT_CS_INTERFACE, UVC_VC_HEADER);
  assert_true(header == control + control[0]);
  assert_int_equal(number(header + 5, 2), stream - header);
  const uint8_t *endpoint = next(stream, end, USB_DT_ENDPOINT, 0);
  const uint8_t *input = next(stream, end, USB_DT_CS_INTERFACE, UVC_VS_INPUT_HEADER);
  assert_int_equal(input[0], 13 + input[3] * input[12]);
  assert_int_equal(number(input + 4, 2), endpoint - input);
  assert_int_equal(input[6], endpoint[2]);
  assert_int_equal(input[3], 2);
  const uint8_t *grey = next(input, endpoint, USB_DT_CS_INTERFACE, UVC_VS_FORMAT_UNCOMPRESSED);
  const uint8_t *yuy2 = next(grey, endpoint, USB_DT_CS_INTERFACE, UVC_VS_FORMAT_UNCOMPRESSED);
  assert_memory_equal(grey + 5, "Y800", 4);
  assert_memory_equal(yuy2 + 5, "YUY2", 4);
  check_frames(grey, endpoint, 8);
  check_frames(yuy2, endpoint, 16);
  const bool is_super = speed == PLACIDO_GADGET_SUPER;
  assert_int_equal(number(endpoint + 4, 2), is_super ? 1024 : 512);
  const uint8_t *companion = next(endpoint, end, USB_DT_SS_ENDPOINT_COMP, 0);
  assert_true(is_super ? companion == endpoint + 7 && companion + 6 == end : companion == end);
}

static const uint8_t *descriptor(uint8_t type, uint8_t index, size_t *size) {
  return gadget.function->descriptor(gadget.state, type, index, size);
}

static void descriptors_add_up(void **state) {
  static const struct {
    int width_px, height_px;
    double rate_hz;
  } views[] = {{WIDTH, HEIGHT, 20}, {1280, 1024, 29.97}, {640, 480, 30},
               {1280, 960, 1000},   {16, 17, 0.1},       {8192, 8191, 60}};
  for (size_t i = 0; i < 2 * sizeof views / sizeof views[0]; i++) {
    const enum placido_gadget_speed speed = i % 2 ? PLACIDO_GADGET_HIGH : PLACIDO_GADGET_SUPER;
    plug_in(views[i / 2].width_px, views[i / 2].height_px, PLACIDO_MONO8, views[i / 2].rate_hz,
            speed);
    size_t size;
    const uint8_t *bytes = descriptor(USB_DT_CONFIG, 0, &size);
    assert_true(size <= PLACIDO_UVC_CONFIGURATION_MAX);
    check_configuration(bytes, size, speed);
    bytes = descriptor(USB_DT_DEVICE, 0, &size);
    assert_int_equal(size, 18);
    assert_int_equal(bytes[0], 18);
    for (uint8_t j = 1; j <= bytes[16]; j++) {
      size_t length;
      const uint8_t *string = descriptor(USB_DT_STRING, j, &length);
      assert_int_equal(string[0], length);
    }
    bytes = descriptor(USB_DT_BOS, 0, &size);
    assert_true(speed == PLACIDO_GADGET_SUPER ? number(bytes + 2, 2) == size : !bytes);
    assert_null(descriptor(USB_DT_STRING, 4, &size));
    unplug(state);
  }
}

/* The longest list that there can be: three sizes, seven rates each. */
static void the_longest_configuration_fits(void **state) {
  (void)state;
  placido_uvc_modes modes;
  placido_uvc_modes_make(&modes, 1280, 1024, 24, PLACIDO_GADGET_SUPER);
  placido_uvc_descriptors descriptors;
  placido_uvc_descriptors_make(&descriptors, &modes, PLACIDO_GADGET_SUPER, "1");
  for (int format = 0; format < PLACIDO_UVC_FORMATS; format++) {
    for (int size = 0; size < PLACIDO_UVC_SIZES_MAX; size++) {
      assert_int_equal(modes.intervals[format][size].count, PLACIDO_UVC_INTERVALS_MAX);
    }
  }
  assert_true(descriptors.configuration_size <= PLACIDO_UVC_CONFIGURATION_MAX);
}

static void sizes_and_rates_are_the_views(void **state) {
  (void)state;
  placido_uvc_modes modes;
  placido_uvc_modes_make(&modes, 1281, 1024, 25, PLACIDO_GADGET_HIGH);
  assert_int_equal(modes.size_count, 3);
  assert_int_equal(modes.sizes[0].width_px, 1280);
  assert_int_equal(modes.sizes[1].width_px, 640);
  assert_int_equal(modes.sizes[1].height_px, 512);
  assert_true(modes.sizes[1].is_binned);
  assert_int_equal(modes.sizes[2].height_px, 480);
  assert_false(modes.sizes[2].is_binned);
  const placido_uvc_intervals *grey = &modes.intervals[PLACIDO_UVC_GREY][0];
  assert_int_equal(grey->at[grey->usual], 400000);
  assert_int_equal(grey->at[0], 333333); /* 60 Hz is more than 40 MB/s */
  const placido_uvc_intervals *yuy2 = &modes.intervals[PLACIDO_UVC_YUY2][0];
  assert_int_equal(yuy2->at[yuy2->usual], 666667); /* as fast as the bus allows */
  placido_uvc_modes_make(&modes, 1280, 960, 25, PLACIDO_GADGET_SUPER);
  assert_int_equal(modes.size_count, 2); /* half of it is 640×480 already */
}

static void the_probe_begins_with_the_usual(void **state) {
  (void)state;
  static const uint8_t usual[PROBE] = {0, 0, 1, 1, 0x20, 0xa1, 0x07, 0, /* 500000: 20 Hz */
                                       [19] = 0xc0, /* 256 · 192 bytes */
                                       [23] = 0x80, /* 32768 */
                                       [26] = 0x40, 0x42, 0x0f, 0, /* 1 MHz */
                                       3};
  uint8_t block[PROBE];
  get_block(UVC_GET_DEF, UVC_VS_PROBE_CONTROL, block);
  assert_memory_equal(block, usual, PROBE);
  get_block(UVC_GET_CUR, UVC_VS_PROBE_CONTROL, block);
  assert_memory_equal(block, usual, PROBE);
  assert_int_equal(get(UVC_GET_LEN, UVC_VS_PROBE_CONTROL, VS, 2), PROBE);
  assert_int_equal(get(UVC_GET_INFO, UVC_VS_PROBE_CONTROL, VS, 1), 3);
  get_block(UVC_GET_MIN, UVC_VS_PROBE_CONTROL, block);
  assert_true(block[2] == 1 && block[3] == 1 && number(block + 4, 4) == 166667);
  get_block(UVC_GET_MAX, UVC_VS_PROBE_CONTROL, block);
  assert_true(block[2] == 2 && block[3] == 2 && number(block + 4, 4) == 2000000);
  get_block(UVC_GET_RES, UVC_VS_PROBE_CONTROL, block);
  assert_true(block[2] == 1 && block[3] == 1);
  size_t size = 4; /* a host of an older class reads less */
  assert_int_equal(ask(UVC_GET_CUR, UVC_VS_PROBE_CONTROL, VS, block, &size), PLACIDO_GADGET_DONE);
  assert_int_equal(size, 4);
}

static void the_probe_corrects(void **state) {
  (void)state;
  static const struct {
    uint8_t format, size;
    uint32_t interval;
    uint8_t able_format, able_size;
    uint32_t able_interval;
  } wishes[] = {{2, 2, 333333, 2, 2, 333333}, {2, 2, 300000, 2, 2, 333333},
                {1, 1, 0, 1, 1, 500000},      {1, 1, 1, 1, 1, 166667},
                {1, 1, 0xffffffff, 1, 1, 2000000}, {0, 0, 666667, 1, 1, 666667},
                {255, 255, 500000, 1, 1, 500000},  {2, 3, 500000, 2, 1, 500000}};
  for (size_t i = 0; i < sizeof wishes / sizeof wishes[0]; i++) {
    uint8_t block[PROBE], committed[PROBE];
    memset(block, 0xff, sizeof block);
    block[0] = 1;
    block[1] = 0;
    block[2] = wishes[i].format;
    block[3] = wishes[i].size;
    for (int j = 0; j < 4; j++) {
      block[4 + j] = (uint8_t)(wishes[i].interval >> 8 * j);
    }
    assert_int_equal(set_block(UVC_VS_PROBE_CONTROL, block), PLACIDO_GADGET_DONE);
    get_block(UVC_GET_CUR, UVC_VS_PROBE_CONTROL, block);
    assert_int_equal(block[0], 1); /* the host's hint */
    assert_int_equal(block[2], wishes[i].able_format);
    assert_int_equal(block[3], wishes[i].able_size);
    assert_int_equal(number(block + 4, 4), wishes[i].able_interval);
    const uint32_t scale = wishes[i].able_size == 2 ? 4 : 1;
    assert_int_equal(number(block + 18, 4), WIDTH * HEIGHT / scale * wishes[i].able_format);
    assert_int_equal(number(block + 22, 4), TRANSFER);
    assert_int_equal(set_block(UVC_VS_COMMIT_CONTROL, block), PLACIDO_GADGET_DONE);
    get_block(UVC_GET_CUR, UVC_VS_COMMIT_CONTROL, committed);
    assert_memory_equal(block, committed, PROBE);
  }
}

static void a_commit_to_what_cannot_be_is_refused(void **state) {
  (void)state;
  static const struct {
    int place;
    uint8_t value;
  } wrong[] = {{2, 3}, {2, 0}, {3, 9}, {4, 0x21}, {18, 1}, {24, 1}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    uint8_t block[PROBE];
    get_block(UVC_GET_DEF, UVC_VS_PROBE_CONTROL, block);
    block[wrong[i].place] = wrong[i].value;
    assert_int_equal(set_block(UVC_VS_COMMIT_CONTROL, block), PLACIDO_GADGET_STALL);
    assert_int_equal(reason(), 4); /* out of range */
    size_t size = sizeof picture.bytes;
    assert_int_equal(fetch(picture.bytes, &size), PLACIDO_GADGET_LATER);
  }
}

static void refusals_have_their_reason(void **state) {
  (void)state;
  static const struct {
    uint8_t request, selector;
    uint16_t entity;
    size_t size;
    uint32_t why;
  } wrong[] = {
      {UVC_SET_CUR, UVC_VS_PROBE_CONTROL, VS, 26, 7},           /* too short */
      {UVC_SET_CUR, UVC_VS_PROBE_CONTROL, VS, 48, 7},           /* UVC 1.5's */
      {UVC_GET_MIN, UVC_VS_COMMIT_CONTROL, VS, PROBE, 7},       /* no such request */
      {0x99, UVC_VS_PROBE_CONTROL, VS, PROBE, 7},               /* no such request at all */
      {UVC_GET_CUR, UVC_VS_STILL_PROBE_CONTROL, VS, 11, 6},     /* no such control */
      {UVC_GET_CUR, 9, CAMERA, 4, 6},                           /* nor here */
      {UVC_GET_CUR, 1, PLACIDO_UVC_OUTPUT << 8, 1, 6},          /* an output has none at all */
      {UVC_GET_CUR, 1, 0, 1, 6},                                /* power mode: none */
      {UVC_GET_CUR, 2, 9 << 8, 2, 5},                           /* no such unit */
      {UVC_GET_CUR, UVC_VS_PROBE_CONTROL, CAMERA | VS, PROBE, 5},
      {UVC_GET_CUR, UVC_VS_PROBE_CONTROL, 2, PROBE, 5},         /* no such interface */
      {UVC_SET_CUR, UVC_PU_BRIGHTNESS_CONTROL, PROCESSING, 1, 7},
      {UVC_SET_CUR, UVC_VC_REQUEST_ERROR_CODE_CONTROL, 0, 1, 7}, /* is read only */
      {UVC_GET_MIN, UVC_CT_AE_MODE_CONTROL, CAMERA, 1, 7},       /* a bit map has no ends */
  };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    uint8_t data[64] = {0};
    size_t size = wrong[i].size;
    assert_int_equal(ask(wrong[i].request, wrong[i].selector, wrong[i].entity, data, &size),
                     PLACIDO_GADGET_STALL);
    assert_int_equal(size, 0);
    assert_int_equal(reason(), wrong[i].why);
    assert_int_equal(reason(), wrong[i].why); /* reading does not change it */
    get(UVC_GET_CUR, UVC_PU_GAIN_CONTROL, PROCESSING, 2);
    assert_int_equal(reason(), 0);
  }
  const placido_gadget_setup to_endpoint = {0x22, UVC_SET_CUR, 0x0100, 0x81, 3};
  uint8_t data[3] = {0};
  size_t size = sizeof data;
  assert_int_equal(placido_gadget_transfer(&gadget, 0, &to_endpoint, data, &size),
                   PLACIDO_GADGET_STALL);
}

static void controls_have_ranges(void **state) {
  (void)state;
  static const struct {
    uint8_t selector;
    uint16_t entity;
    size_t size;
    int32_t min, max, usual;
  } controls[] = {{UVC_CT_EXPOSURE_TIME_ABSOLUTE_CONTROL, CAMERA, 4, 1, 10000, 100},
                  {UVC_PU_BRIGHTNESS_CONTROL, PROCESSING, 2, -128, 127, 0},
                  {UVC_PU_GAIN_CONTROL, PROCESSING, 2, 0, 255, 16}};
  for (size_t i = 0; i < sizeof controls / sizeof controls[0]; i++) {
    const uint8_t selector = controls[i].selector;
    const uint16_t entity = controls[i].entity;
    const size_t size = controls[i].size;
    const uint32_t mask = size == 2 ? 0xffff : 0xffffffff;
    const int32_t ends[2] = {controls[i].min, controls[i].max};
    assert_int_equal(get(UVC_GET_LEN, selector, entity, 2), size);
    assert_int_equal(get(UVC_GET_INFO, selector, entity, 1), 3);
    assert_int_equal(get(UVC_GET_RES, selector, entity, size), 1);
    assert_int_equal(get(UVC_GET_DEF, selector, entity, size), controls[i].usual);
    assert_int_equal(get(UVC_GET_CUR, selector, entity, size), controls[i].usual);
    for (int j = 0; j < 2; j++) {
      const uint32_t end = (uint32_t)ends[j] & mask, beyond = (uint32_t)(ends[j] + 2 * j - 1);
      assert_int_equal(get(j ? UVC_GET_MAX : UVC_GET_MIN, selector, entity, size), end);
      assert_int_equal(set(selector, entity, end, size), PLACIDO_GADGET_DONE);
      if (ends[j] > 0 || size == 2) {
        assert_int_equal(set(selector, entity, beyond, size), PLACIDO_GADGET_STALL);
        assert_int_equal(reason(), 4);
      }
      assert_int_equal(get(UVC_GET_CUR, selector, entity, size), end);
    }
  }
  assert_int_equal(set(UVC_CT_EXPOSURE_TIME_ABSOLUTE_CONTROL, CAMERA, 0x80000000, 4),
                   PLACIDO_GADGET_STALL);
}

static void exposure_is_manual(void **state) {
  (void)state;
  const uint8_t mode = UVC_CT_AE_MODE_CONTROL;
  assert_int_equal(get(UVC_GET_RES, mode, CAMERA, 1), 1); /* no other mode */
  assert_int_equal(get(UVC_GET_CUR, mode, CAMERA, 1), 1);
  for (uint32_t wish = 0; wish < 16; wish++) {
    assert_int_equal(set(mode, CAMERA, wish, 1),
                     wish == 1 ? PLACIDO_GADGET_DONE : PLACIDO_GADGET_STALL);
    assert_int_equal(reason(), wish == 1 ? 0 : 8);
  }
}

static void settings_last_until_the_power_goes(void **state) {
  (void)state;
  assert_int_equal(set(UVC_PU_GAIN_CONTROL, PROCESSING, 99, 2), PLACIDO_GADGET_DONE);
  for (uint16_t configuration = 1; configuration < 2; configuration--) { /* 1, then 0 */
    const placido_gadget_setup choose = {0x00, USB_REQ_SET_CONFIGURATION, configuration, 0, 0};
    size_t size = 0;
    assert_int_equal(placido_gadget_transfer(&gadget, 0, &choose, NULL, &size),
                     PLACIDO_GADGET_DONE);
    assert_int_equal(get(UVC_GET_CUR, UVC_PU_GAIN_CONTROL, PROCESSING, 2),
                     configuration ? 99 : 16);
  }
}

static int open_status(int width_px, double rate_hz, const char *serial) {
  const placido_gadget_options options = {.view = {look, NULL, width_px, HEIGHT, rate_hz},
                                          .faults = &faults,
                                          .speed = PLACIDO_GADGET_SUPER,
                                          .serial = serial};
  void *camera;
  const int status = placido_uvc_face.open(&camera, &options, NULL);
  assert_int_equal(camera != NULL, status == PLACIDO_OK);
  placido_uvc_face.close(camera);
  return status;
}

static void cameras_that_cannot_be_are_refused(void **state) {
  (void)state;
  char longest[65];
  memset(longest, 'x', sizeof longest);
  longest[64] = '\0';
  assert_int_equal(open_status(WIDTH, 20, longest), PLACIDO_INPUT);
  assert_int_equal(open_status(WIDTH, 20, longest + 1), PLACIDO_OK);
  assert_int_equal(open_status(WIDTH, 20, ""), PLACIDO_INPUT);
  assert_int_equal(open_status(15, 20, "1"), PLACIDO_INPUT);
  assert_int_equal(open_status(8193, 20, "1"), PLACIDO_INPUT);
  assert_int_equal(open_status(WIDTH, 0, "1"), PLACIDO_INPUT);
  assert_int_equal(open_status(WIDTH, 1e9, "1"), PLACIDO_INPUT);
  for (unsigned long n = 1; n <= 2; n++) {
    placido_memory_fail_at(n);
    assert_int_equal(open_status(WIDTH, 20, "1"), PLACIDO_MEMORY);
  }
  placido_memory_fail_at(0);
}

int main(void) {
#define CASE(name) cmocka_unit_test_setup_teardown(name, plug_in_usual, unplug)
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(descriptors_add_up),
      cmocka_unit_test(the_longest_configuration_fits),
      cmocka_unit_test(sizes_and_rates_are_the_views),
      CASE(the_probe_begins_with_the_usual),
      CASE(the_probe_corrects),
      CASE(a_commit_to_what_cannot_be_is_refused),
      CASE(refusals_have_their_reason),
      CASE(controls_have_ranges),
      CASE(exposure_is_manual),
      CASE(settings_last_until_the_power_goes),
      cmocka_unit_test(cameras_that_cannot_be_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

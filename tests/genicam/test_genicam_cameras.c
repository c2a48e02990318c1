/* Descriptions as different vendors write them, used as a driver uses them. */
#include "tests/genicam/memory_port.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

/* Room for what a callback collects. */
struct list {
  char text[512];
  int stop_at; /* the call that returns 7; 0: none */
  int calls;
};

static int collect(struct list *list, const char *first, const char *second) {
  const size_t length = strlen(list->text);
  snprintf(list->text + length, sizeof list->text - length, "%s/%s ", first, second);
  return ++list->calls == list->stop_at ? 7 : 0;
}

static int collect_feature(void *user, const char *name, const char *category) {
  return collect(user, category, name);
}

static int collect_entry(void *user, const char *entry, int64_t value) {
  char number[32];
  snprintf(number, sizeof number, "%lld", (long long)value);
  return collect(user, entry, number);
}

static void assert_text(struct memory *memory, const char *name, const char *wanted) {
  char text[64];
  assert_int_equal(
      placido_genicam_get_text(memory->features, name, text, sizeof text, &memory->err),
      PLACIDO_OK);
  assert_string_equal(text, wanted);
}

static void put_real(struct memory *memory, uint64_t address, double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  memory_put(memory, address, sizeof bits, false, bits);
}

static void features_are_listed_with_their_category(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  struct list list = {0};
  assert_int_equal(
      placido_genicam_each(memory.features, collect_feature, &list, &memory.err), PLACIDO_OK);
  assert_string_equal(list.text,
                      "DeviceControl/DeviceVendorName DeviceControl/DeviceUserID "
                      "DeviceControl/DeviceTemperature ImageFormatControl/Width "
                      "ImageFormatControl/Height ImageFormatControl/OffsetX "
                      "ImageFormatControl/PixelFormat ImageFormatControl/ReverseX "
                      "AcquisitionControl/AcquisitionStart AcquisitionControl/AcquisitionStop "
                      "AcquisitionControl/ExposureTime AcquisitionControl/TriggerMode ");
  list = (struct list){.stop_at = 2};
  assert_int_equal(placido_genicam_each(memory.features, collect_feature, &list, NULL), 7);
  assert_int_equal(list.calls, 2);
  memory_close(&memory);
}

static void sizes_have_limits_that_move(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  memory_put(&memory, 0, 4, false, 640);
  memory_put(&memory, 8, 4, false, 100);
  const placido_feature width = description_of(&memory, "Width");
  assert_int_equal(width.kind, PLACIDO_FEATURE_INTEGER);
  assert_true(width.min == 16 && width.max == 1180 && width.step == 4);
  assert_true(width.can_read && width.can_write);
  assert_true(description_of(&memory, "OffsetX").max == 640);
  assert_int_equal(placido_genicam_set_integer(memory.features, "Width", 1180, NULL),
                   PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0, 4, false), 1180);
  assert_true(description_of(&memory, "OffsetX").max == 100);
  static const int64_t wrong[] = {1184, 12, 1178, -16, INT64_MAX};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    assert_int_equal(
        placido_genicam_set_integer(memory.features, "Width", wrong[i], &memory.err),
        PLACIDO_INPUT);
    assert_says(&memory, "Width: ");
  }
  /* A float is rounded to the nearest. */
  assert_int_equal(placido_genicam_set_float(memory.features, "Width", 639.7, NULL), PLACIDO_OK);
  assert_true(float_of(&memory, "Width") == 640);
  memory_close(&memory);
}

static void what_is_locked_while_streaming_can_only_be_read(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  memory_put(&memory, 0, 4, false, 640);
  memory_put(&memory, 12, 4, false, 0x01080001);
  placido_genicam *features = memory.features;
  assert_int_equal(placido_genicam_set_integer(features, "TLParamsLocked", 1, NULL), PLACIDO_OK);
  assert_true(description_of(&memory, "Width").can_read);
  assert_false(description_of(&memory, "Width").can_write);
  assert_int_equal(placido_genicam_set_integer(features, "Width", 320, &memory.err),
                   PLACIDO_UNSUPPORTED);
  assert_says(&memory, "Width cannot be written now");
  assert_int_equal(placido_genicam_set_text(features, "PixelFormat", "Mono12", &memory.err),
                   PLACIDO_UNSUPPORTED);
  assert_int_equal(memory.writes, 0);
  assert_int_equal(placido_genicam_set_integer(features, "TLParamsLocked", 2, NULL),
                   PLACIDO_INPUT);
  assert_int_equal(placido_genicam_set_integer(features, "TLParamsLocked", 0, NULL), PLACIDO_OK);
  assert_int_equal(placido_genicam_set_integer(features, "Width", 320, NULL), PLACIDO_OK);
  memory_close(&memory);
}

static void pixel_formats_are_those_that_the_camera_has(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  placido_genicam *features = memory.features;
  struct list list = {0};
  assert_int_equal(
      placido_genicam_entries(features, "PixelFormat", collect_entry, &list, NULL), PLACIDO_OK);
  assert_string_equal(list.text, "Mono8/17301505 Mono12/17825797 ");
  assert_int_equal(placido_genicam_set_text(features, "PixelFormat", "Mono12", NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 12, 4, false), 0x01100005);
  assert_text(&memory, "PixelFormat", "Mono12");
  assert_int_equal(integer_of(&memory, "PixelFormat"), 0x01100005);
  assert_int_equal(placido_genicam_set_integer(features, "PixelFormat", 0x01080001, NULL),
                   PLACIDO_OK);
  assert_text(&memory, "PixelFormat", "Mono8");
  assert_int_equal(placido_genicam_set_text(features, "PixelFormat", "BayerRG8", &memory.err),
                   PLACIDO_UNSUPPORTED);
  assert_says(&memory, "BayerRG8 of the camera's feature PixelFormat is not available");
  assert_int_equal(placido_genicam_set_text(features, "PixelFormat", "RGB8", &memory.err),
                   PLACIDO_INPUT);
  assert_int_equal(placido_genicam_set_integer(features, "PixelFormat", 5, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "no entry of the value 5");
  memory_put(&memory, 12, 4, false, 99);
  placido_genicam_forget(features);
  char text[16] = "left";
  assert_int_equal(
      placido_genicam_get_text(features, "PixelFormat", text, sizeof text, &memory.err),
      PLACIDO_INPUT);
  assert_says(&memory, "PixelFormat is 99");
  assert_string_equal(text, "");
  /* With the bit of colour the entry is there. */
  memory.bytes[16] = 1;
  placido_genicam_forget(features);
  assert_int_equal(placido_genicam_set_text(features, "PixelFormat", "BayerRG8", NULL),
                   PLACIDO_OK);
  memory_close(&memory);
}

static void structures_share_a_register(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  memory_put(&memory, 16, 4, false, 0xABCDEEC1);
  assert_int_equal(integer_of(&memory, "HasColour"), 1);
  assert_int_equal(integer_of(&memory, "BitDepth"), 12);
  assert_int_equal(integer_of(&memory, "Trim"), -2);
  assert_int_equal(placido_genicam_set_integer(memory.features, "BitDepth", 8, NULL),
                   PLACIDO_UNSUPPORTED);
  assert_int_equal(placido_genicam_set_integer(memory.features, "Trim", 7, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 16, 4, false), 0xABCDE7C1);
  assert_int_equal(integer_of(&memory, "BitDepth"), 12);
  memory_close(&memory);
}

static void texts_floats_and_switches(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  placido_genicam *features = memory.features;
  memcpy(memory.bytes + 0x100, "Placido", 8);
  assert_text(&memory, "DeviceVendorName", "Placido");
  assert_int_equal(placido_genicam_set_text(features, "DeviceVendorName", "x", NULL),
                   PLACIDO_UNSUPPORTED);
  assert_int_equal(placido_genicam_set_text(features, "DeviceUserID", "left eye", NULL),
                   PLACIDO_OK);
  assert_text(&memory, "DeviceUserID", "left eye");

  const placido_feature exposure = description_of(&memory, "ExposureTime");
  assert_int_equal(exposure.kind, PLACIDO_FEATURE_FLOAT);
  assert_true(exposure.min == 10 && exposure.max == 1e6 && exposure.step == 0);
  assert_string_equal(exposure.unit, "us");
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 2500.5, NULL), PLACIDO_OK);
  assert_true(float_of(&memory, "ExposureTime") == 2500.5);
  assert_int_equal(integer_of(&memory, "ExposureTime"), 2501); /* half away from zero */
  static const double wrong[] = {9.9, 1000001, NAN, INFINITY};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    assert_int_equal(
        placido_genicam_set_float(features, "ExposureTime", wrong[i], NULL), PLACIDO_INPUT);
  }
  put_real(&memory, 0x20, 1e30);
  placido_genicam_forget(features);
  int64_t whole;
  assert_int_equal(
      placido_genicam_get_integer(features, "ExposureTime", &whole, &memory.err), PLACIDO_INPUT);

  /* What changes by itself is asked for each time. */
  memory_put(&memory, 0x120, 4, false, 0x42140000);
  assert_true(float_of(&memory, "DeviceTemperature") == 37);
  memory_put(&memory, 0x120, 4, false, 0x42180000);
  assert_true(float_of(&memory, "DeviceTemperature") == 38);
  assert_false(description_of(&memory, "DeviceTemperature").can_write);

  assert_int_equal(placido_genicam_set_integer(features, "ReverseX", 1, NULL), PLACIDO_OK);
  assert_int_equal(memory.bytes[0x14], 0x80);
  assert_int_equal(integer_of(&memory, "ReverseX"), 1);
  assert_int_equal(placido_genicam_set_integer(features, "ReverseX", 0, NULL), PLACIDO_OK);
  assert_int_equal(memory.bytes[0x14], 0x01);
  assert_int_equal(integer_of(&memory, "ReverseX"), 0);
  assert_int_equal(placido_genicam_set_integer(features, "ReverseX", 2, NULL), PLACIDO_INPUT);
  memory_close(&memory);
}

static void commands_are_executed(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "direct.xml");
  placido_genicam *features = memory.features;
  assert_int_equal(placido_genicam_execute(features, "AcquisitionStart", NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x18, 4, false), 1);
  assert_int_equal(placido_genicam_execute(features, "AcquisitionStop", NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x18, 4, false), 0);
  const placido_feature start = description_of(&memory, "AcquisitionStart");
  assert_int_equal(start.kind, PLACIDO_FEATURE_COMMAND);
  assert_true(start.can_write && !start.can_read);
  assert_true(isnan(start.min) && isnan(start.max));
  int64_t value;
  assert_int_equal(placido_genicam_get_integer(features, "AcquisitionStart", &value, NULL),
                   PLACIDO_INPUT);
  assert_int_equal(placido_genicam_execute(features, "Width", &memory.err), PLACIDO_INPUT);
  assert_says(&memory, "Width is no command");
  memory_close(&memory);
}

static void a_selector_chooses_the_register(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "converted.xml");
  placido_genicam *features = memory.features;
  memory_put(&memory, 0x48, 4, true, 0x80000000); /* there is a gain */
  memory_put(&memory, 0x40, 4, true, 0xABC00000 | 100);
  memory_put(&memory, 0x44, 4, true, 20);
  assert_int_equal(integer_of(&memory, "GainRaw"), 100);
  assert_true(description_of(&memory, "GainRaw").max == 500);
  assert_true(fabs(float_of(&memory, "Gain") - 3.59) < 1e-12);
  assert_true(fabs(description_of(&memory, "Gain").max - 17.95) < 1e-12);
  assert_string_equal(description_of(&memory, "Gain").unit, "dB");
  assert_int_equal(placido_genicam_set_float(features, "Gain", 7.2, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x40, 4, true), 0xABC00000 | 201); /* 200.56 */

  assert_int_equal(placido_genicam_set_text(features, "GainSelector", "Digital", NULL),
                   PLACIDO_OK);
  assert_int_equal(integer_of(&memory, "GainRaw"), 20);
  assert_true(description_of(&memory, "GainRaw").max == 100);
  assert_true(fabs(float_of(&memory, "Gain") - 20 * 2 * 0.0359) < 1e-12);
  assert_int_equal(placido_genicam_set_integer(features, "GainRaw", 101, NULL), PLACIDO_INPUT);
  assert_int_equal(placido_genicam_set_integer(features, "GainRaw", 50, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x44, 4, true), 50);
  assert_int_equal(memory_take(&memory, 0x40, 4, true), 0xABC00000 | 201);

  for (int i = 0; i < 16; i++) {
    assert_int_equal(placido_genicam_set_integer(features, "LUTIndex", i, NULL), PLACIDO_OK);
    assert_int_equal(placido_genicam_set_integer(features, "LUTValue", 1000 + i, NULL),
                     PLACIDO_OK);
  }
  for (int i = 0; i < 16; i++) {
    assert_int_equal(memory_take(&memory, 0x200 + 4 * (uint64_t)i, 2, true), 1000 + i);
  }
  /* Without its bit the gain is not available, and neither read nor limited. */
  memory_put(&memory, 0x48, 4, true, 0);
  placido_genicam_forget(features);
  const placido_feature gain = description_of(&memory, "Gain");
  assert_true(!gain.can_read && !gain.can_write && isnan(gain.max));
  double value;
  assert_int_equal(placido_genicam_get_float(features, "Gain", &value, &memory.err),
                   PLACIDO_UNSUPPORTED);
  assert_says(&memory, "not available");
  memory_close(&memory);
}

static void exposure_is_raw_times_a_base(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "converted.xml");
  placido_genicam *features = memory.features;
  memory_put(&memory, 0x54, 4, true, 12500); /* ns */
  memory_put(&memory, 0x50, 4, true, 80);
  assert_true(float_of(&memory, "ExposureTime") == 1000);
  const placido_feature exposure = description_of(&memory, "ExposureTime");
  assert_true(exposure.min == 12.5 && exposure.max == 51187.5);
  assert_string_equal(exposure.unit, "us");
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 2504, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x50, 4, true), 200); /* 200.32 */
  assert_true(float_of(&memory, "ExposureTime") == 2500);
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 51187.5, NULL),
                   PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x50, 4, true), 4095);
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 51200, NULL),
                   PLACIDO_INPUT);
  /* With another time base another limit; while the camera regulates itself, none is written. */
  memory_put(&memory, 0x54, 4, true, 1000);
  placido_genicam_forget(features);
  assert_true(description_of(&memory, "ExposureTime").max == 4095);
  memory_put(&memory, 0x4C, 4, true, 0x02000000);
  placido_genicam_forget(features);
  assert_text(&memory, "ExposureAuto", "Continuous");
  assert_false(description_of(&memory, "ExposureTime").can_write);
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 100, NULL),
                   PLACIDO_UNSUPPORTED);
  assert_int_equal(placido_genicam_set_text(features, "ExposureAuto", "Off", NULL), PLACIDO_OK);
  assert_int_equal(placido_genicam_set_float(features, "ExposureTime", 100, NULL), PLACIDO_OK);
  /* A setting that this model lacks. */
  assert_int_equal(placido_genicam_set_text(features, "ExposureAuto", "Once", NULL),
                   PLACIDO_UNSUPPORTED);
  memory_close(&memory);
}

static void a_falling_converter_swaps_its_limits(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "converted.xml");
  memory_put(&memory, 0x58, 4, true, 40000);
  assert_true(float_of(&memory, "AcquisitionFrameRate") == 25);
  const placido_feature rate = description_of(&memory, "AcquisitionFrameRate");
  assert_true(rate.min == 1 && rate.max == 100);
  assert_int_equal(
      placido_genicam_set_float(memory.features, "AcquisitionFrameRate", 60, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x58, 4, true), 16667);
  memory_close(&memory);
}

static void a_varying_converter_maps_entries(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "converted.xml");
  placido_genicam *features = memory.features;
  memory_put(&memory, 0x5C, 4, true, 1);
  assert_text(&memory, "TriggerSource", "Line1");
  assert_false(description_of(&memory, "TriggerSoftware").can_write);
  assert_int_equal(placido_genicam_execute(features, "TriggerSoftware", NULL),
                   PLACIDO_UNSUPPORTED);
  assert_int_equal(placido_genicam_set_text(features, "TriggerSource", "Software", NULL),
                   PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x5C, 4, true), 0x80);
  assert_text(&memory, "TriggerSource", "Software");
  assert_int_equal(placido_genicam_execute(features, "TriggerSoftware", NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0x60, 4, true), 0xC0DE);
  /* What comes with a picture is not in the camera. */
  assert_false(description_of(&memory, "ChunkTimestamp").can_read);
  memory_close(&memory);
}

static void computed_addresses_follow_a_selection(void **state) {
  (void)state;
  struct memory memory;
  memory_open_file(&memory, "prefixed.xml");
  placido_genicam *features = memory.features;
  assert_string_equal(description_of(&memory, "Gamma").unit, "\xC2\xB5m"); /* from Latin-1 */
  assert_true(float_of(&memory, "Gamma") == 2);
  assert_int_equal(placido_genicam_set_integer(features, "Line", 5, NULL), PLACIDO_OK);
  assert_true(float_of(&memory, "Gamma") == -1);
  const uint64_t address = 0x80 + 4 + (2 << 8) + 16 * 5;
  memory_put(&memory, address, 3, true, 0xFFFF00);
  assert_int_equal(integer_of(&memory, "Counter"), -256);
  assert_int_equal(memory.address, address);
  assert_int_equal(memory.size, 3);
  struct list list = {0};
  assert_int_equal(placido_genicam_each(features, collect_feature, &list, NULL), PLACIDO_OK);
  assert_string_equal(list.text, "Root/Gamma Root/Line Root/Counter ");
  memory_close(&memory);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(features_are_listed_with_their_category),
      cmocka_unit_test(sizes_have_limits_that_move),
      cmocka_unit_test(what_is_locked_while_streaming_can_only_be_read),
      cmocka_unit_test(pixel_formats_are_those_that_the_camera_has),
      cmocka_unit_test(structures_share_a_register),
      cmocka_unit_test(texts_floats_and_switches),
      cmocka_unit_test(commands_are_executed),
      cmocka_unit_test(a_selector_chooses_the_register),
      cmocka_unit_test(exposure_is_raw_times_a_base),
      cmocka_unit_test(a_falling_converter_swaps_its_limits),
      cmocka_unit_test(a_varying_converter_maps_entries),
      cmocka_unit_test(computed_addresses_follow_a_selection),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

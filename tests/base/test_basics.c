/* Messages are one line, notes never repeat, allocations fail where told, frames keep room. */
#include "base/memory.h"
#include "base/text.h"

#include <placido/frame.h>
#include <placido/image.h>
#include <placido/notes.h>
#include <placido/status.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <limits.h>
#include <string.h>

static void a_message_is_one_line(void **state) {
  (void)state;
  placido_error err;
  assert_int_equal(placido_error_set(&err, PLACIDO_INPUT, "a\nb\tc\x7f%d", 7), PLACIDO_INPUT);
  assert_int_equal(err.status, PLACIDO_INPUT);
  assert_string_equal(err.text, "a b c 7");
  placido_error_set(&err, PLACIDO_INPUT, "a\xc2\x9b" "31m");
  assert_string_equal(err.text, "a  31m"); /* U+009B opens a terminal's control sequence */
  assert_int_equal(placido_error_set(NULL, PLACIDO_END, "x"), PLACIDO_END);
}

static void a_cut_message_ends_with_a_whole_character(void **state) {
  (void)state;
  placido_error err;
  char wide[700];
  for (size_t i = 0; i + 2 < sizeof wide; i += 2) {
    memcpy(wide + i, "\xc3\xa9", 3);
  }
  placido_error_set(&err, PLACIDO_INPUT, "%s", wide);
  assert_int_equal(strlen(err.text), 510); /* 255 whole characters; 511 bytes would cut one */
}

static void a_long_path_is_shown_by_its_end(void **state) {
  (void)state;
  char path[1000];
  memset(path, 'a', sizeof path);
  memcpy(path + sizeof path - 9, "/end.png", 9);
  const char *tail = placido_text_tail(path);
  assert_true(strlen(tail) <= 200);
  assert_string_equal(tail + strlen(tail) - 8, "/end.png");
  assert_ptr_equal(placido_text_tail("short"), "short");
}

static void notes_do_not_repeat(void **state) {
  (void)state;
  placido_notes notes = {0};
  placido_notes_add(NULL, "dropped");
  placido_notes_add(&notes, "mire %d is missing", 3);
  placido_notes_add(&notes, "mire %d is missing", 4);
  placido_notes_add(&notes, "mire %d is missing", 3);
  assert_int_equal(notes.count, 2);
  assert_string_equal(notes.lines[1], "mire 4 is missing");
  placido_memory_fail_at(1);
  placido_notes_add(&notes, "lost");
  placido_memory_fail_at(2);
  placido_notes_add(&notes, "lost");
  placido_memory_fail_at(0);
  assert_int_equal(notes.count, 2);
  placido_notes_clear(&notes);
  assert_int_equal(notes.count, 0);
  placido_notes_clear(NULL);
}

static void the_nth_allocation_fails_once(void **state) {
  (void)state;
  placido_error err;
  placido_memory_fail_at(2);
  void *first = placido_memory_new(1, 8, &err);
  void *second = placido_memory_new(1, 8, &err);
  void *third = placido_memory_new(1, 8, &err);
  assert_non_null(first);
  assert_null(second);
  assert_non_null(third);
  assert_int_equal(err.status, PLACIDO_MEMORY);
  assert_int_equal(placido_memory_fail_at(0), 3);
  placido_memory_free(first);
  placido_memory_free(third);
  placido_memory_free(NULL);
}

static void a_product_that_overflows_is_refused(void **state) {
  (void)state;
  placido_error err;
  assert_null(placido_memory_new(SIZE_MAX / 2, 4, &err));
  assert_int_equal(err.status, PLACIDO_MEMORY);
  char *block = placido_memory_new(0, 8, &err);
  assert_non_null(block);
  assert_null(placido_memory_grow(block, SIZE_MAX / 2, 4, &err));
  block[0] = 1; /* still valid */
  placido_memory_free(block);
}

static void a_frame_keeps_memory_that_is_large_enough(void **state) {
  (void)state;
  placido_frame frame = {0};
  placido_error err;
  assert_int_equal(placido_frame_resize(&frame, 100, 50, PLACIDO_MONO16, &err), PLACIDO_OK);
  assert_int_equal((uintptr_t)frame.data % 64, 0);
  assert_true(frame.stride_bytes >= 200);
  assert_int_equal(frame.bits, 16);
  const uint8_t *data = frame.data;
  assert_int_equal(placido_frame_resize(&frame, 60, 50, PLACIDO_RGB8, &err), PLACIDO_OK);
  assert_ptr_equal(frame.data, data);
  assert_int_equal(frame.bits, 8);
  assert_int_equal(placido_frame_resize(&frame, 0, 50, PLACIDO_MONO8, &err), PLACIDO_INPUT);
  assert_int_equal(placido_frame_resize(&frame, 5, 65537, PLACIDO_MONO8, &err), PLACIDO_INPUT);
  assert_int_equal(placido_frame_resize(&frame, INT_MAX, INT_MIN, PLACIDO_MONO8, &err),
                   PLACIDO_INPUT);
  assert_int_equal(frame.width_px, 60); /* a refused size changes nothing */
  placido_memory_fail_at(1);
  assert_int_equal(placido_frame_resize(&frame, 1000, 50, PLACIDO_MONO8, &err), PLACIDO_MEMORY);
  placido_memory_fail_at(0);
  assert_int_equal(frame.width_px, 60);
  placido_frame_free(&frame);
  assert_null(frame.data);
  placido_frame_free(NULL);
}

static void borrowed_samples_are_never_freed(void **state) {
  (void)state;
  uint8_t samples[16] = {0};
  placido_frame frame = {
      .width_px = 4, .height_px = 4, .stride_bytes = 4, .bits = 8, .data = samples};
  placido_frame_free(&frame);
  frame.data = samples;
  assert_int_equal(placido_frame_resize(&frame, 4, 4, PLACIDO_MONO8, NULL), PLACIDO_OK);
  assert_ptr_not_equal(frame.data, samples);
  placido_frame_free(&frame);
}

static void an_image_has_zeroed_planes_in_order(void **state) {
  (void)state;
  placido_image image;
  placido_error err;
  assert_int_equal(placido_image_new(&image, 3, 2, 4, &err), PLACIDO_OK);
  assert_ptr_equal(placido_image_plane(&image, 2), image.data + 12);
  for (int i = 0; i < 24; i++) {
    assert_true(image.data[i] == 0);
  }
  placido_image_free(&image);
  assert_int_equal(placido_image_new(&image, 3, 65537, 1, &err), PLACIDO_INPUT);
  assert_int_equal(placido_image_new(&image, 3, 3, 5, &err), PLACIDO_INPUT);
  assert_null(image.data);
  placido_image_free(&image);
}

static void srgb_and_linear_light_are_each_others_inverse(void **state) {
  (void)state;
  placido_image image;
  assert_int_equal(placido_image_new(&image, 256, 1, 4, NULL), PLACIDO_OK);
  for (int i = 0; i < 256 * 4; i++) {
    image.data[i] = (float)(i % 256) / 255;
  }
  placido_image_to_linear(&image);
  /* IEC 61966-2-1: code 188 is half of white's light, within the step of one code (0.005). */
  assert_float_equal(placido_image_plane(&image, 1)[188], 0.5, 0.005);
  assert_float_equal(placido_image_plane(&image, 0)[10], 10.0 / 255 / 12.92, 1e-7);
  assert_true(placido_image_plane(&image, 3)[188] == 188.0f / 255); /* alpha is no light */
  placido_image_to_srgb(&image);
  for (int i = 0; i < 256 * 4; i++) {
    /* Far less than the 1/65535 that a 16-bit file can show. */
    assert_float_equal(image.data[i], (float)(i % 256) / 255, 2e-6);
  }
  placido_image_free(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_message_is_one_line),
      cmocka_unit_test(a_cut_message_ends_with_a_whole_character),
      cmocka_unit_test(a_long_path_is_shown_by_its_end),
      cmocka_unit_test(notes_do_not_repeat),
      cmocka_unit_test(the_nth_allocation_fails_once),
      cmocka_unit_test(a_product_that_overflows_is_refused),
      cmocka_unit_test(a_frame_keeps_memory_that_is_large_enough),
      cmocka_unit_test(borrowed_samples_are_never_freed),
      cmocka_unit_test(an_image_has_zeroed_planes_in_order),
      cmocka_unit_test(srgb_and_linear_light_are_each_others_inverse),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

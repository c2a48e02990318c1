/* JSON errors name file, line and field; nothing in a file makes the reader fall over. */
#include "base/json.h"
#include "base/memory.h"
#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char document[] = "{\n"
                               " \"format\": \"placido-test/1\",\n"
                               " \"text\": \"a } [ \\\" , : \\\\\",\n"
                               " \"camera\": {\n"
                               "  \"focal_px\": [1.5,\n"
                               "   \"two\"],\n"
                               "  \"model\": \"pinhole\"\n"
                               " },\n"
                               " \"edges\": [{\"radius_mm\": 1}, {}, \n"
                               "  {\"radius_mm\": null}],\n"
                               " \"count\": 3.5, \"whole\": 4.0, \"yes\": true\n"
                               "}\n";

static placido_json *load(void **state, const char *text) {
  char *path = scratch_write_text(state, "d.json", text);
  placido_json *json;
  placido_error err = {0};
  if (placido_json_load(&json, path, "placido-test/1", &err)) {
    fail_msg("%s", err.text);
  }
  free(path);
  return json;
}

/* What the message says behind the folder. */
static const char *said(const placido_error *err) {
  const char *file = strstr(err->text, "d.json");
  return file ? file : err->text;
}

static void values_are_found_by_path(void **state) {
  placido_json *json = load(state, document);
  double number;
  int whole;
  bool yes;
  char text[32];
  size_t count;
  assert_int_equal(placido_json_number(json, "camera.focal_px[0]", &number, NULL), PLACIDO_OK);
  assert_true(number == 1.5);
  assert_int_equal(placido_json_integer(json, "whole", 0, 9, &whole, NULL), PLACIDO_OK);
  assert_int_equal(whole, 4);
  assert_int_equal(placido_json_boolean(json, "yes", &yes, NULL), PLACIDO_OK);
  assert_true(yes);
  assert_int_equal(placido_json_string(json, "text", text, sizeof text, NULL), PLACIDO_OK);
  assert_string_equal(text, "a } [ \" , : \\");
  assert_int_equal(placido_json_count(json, "edges", &count, NULL), PLACIDO_OK);
  assert_int_equal(count, 3);
  assert_null(placido_json_find(json, "edges[7].radius_mm"));
  assert_null(placido_json_find(json, "edges[x]"));
  assert_null(placido_json_find(json, "camera..model"));
  assert_true(json_is_object(placido_json_find(json, "")));
  placido_json_free(json);
  placido_json_free(NULL);
}

static void errors_name_file_line_and_field(void **state) {
  placido_json *json = load(state, document);
  placido_error err;
  double number, numbers[2];
  int whole;
  char text[4];
  assert_int_equal(placido_json_number(json, "camera.focal_px[1]", &number, &err), PLACIDO_INPUT);
  assert_string_equal(said(&err),
                      "d.json:6: field camera.focal_px[1]: is a string, a number is expected");
  placido_json_number(json, "camera.position", &number, &err);
  assert_string_equal(said(&err),
                      "d.json:4: field camera.position: missing (a number is expected)");
  placido_json_number(json, "edges[1].radius_mm", &number, &err);
  assert_string_equal(said(&err),
                      "d.json:9: field edges[1].radius_mm: missing (a number is expected)");
  placido_json_number(json, "edges[2].radius_mm", &number, &err);
  assert_string_equal(said(&err),
                      "d.json:10: field edges[2].radius_mm: is null, a number is expected");
  placido_json_integer(json, "count", 0, 9, &whole, &err);
  assert_string_equal(said(&err),
                      "d.json:11: field count: is 3.5, an integer from 0 to 9 is expected");
  placido_json_integer(json, "whole", 5, 9, &whole, &err);
  assert_string_equal(said(&err),
                      "d.json:11: field whole: is 4, an integer from 5 to 9 is expected");
  placido_json_string(json, "camera.model", text, sizeof text, &err);
  assert_string_equal(said(&err),
                      "d.json:7: field camera.model: has 7 bytes, at most 3 are expected");
  placido_json_numbers(json, "camera.focal_px", numbers, 2, &err);
  assert_string_equal(said(&err),
                      "d.json:5: field camera.focal_px: element 1 is not a finite number");
  placido_json_numbers(json, "edges", numbers, 2, &err);
  assert_string_equal(said(&err),
                      "d.json:9: field edges: has 3 elements, 2 numbers are expected");
  placido_json_free(json);
}

static void a_value_without_sense_is_refused_at_its_line(void **state) {
  placido_json *json = load(state, document);
  placido_error err;
  assert_int_equal(placido_json_refuse(json, "camera.focal_px[0]", &err, "%d px is small", 1),
                   PLACIDO_INPUT);
  assert_string_equal(said(&err), "d.json:5: field camera.focal_px[0]: 1 px is small");
  placido_json_free(json);
}

static void unknown_keys_give_one_line(void **state) {
  placido_json *json = load(state, document);
  const char *const known[] = {"format", "text", "camera", "edges", NULL};
  placido_notes notes = {0};
  placido_json_warn_unknown(json, "", known, &notes);
  placido_json_warn_unknown(json, "nowhere", known, &notes);
  placido_json_warn_unknown(json, "", known, NULL);
  assert_int_equal(notes.count, 1);
  assert_non_null(
      strstr(notes.lines[0], "d.json:1: unknown fields are ignored: count, whole, yes"));
  placido_notes_clear(&notes);
  placido_json_free(json);
}

/* Loads a text that must be refused and returns what was said. */
static const char *refusal(void **state, const char *text, size_t size, placido_error *err) {
  char *path = scratch_write(state, "d.json", text, size);
  placido_json *json;
  assert_int_equal(placido_json_load(&json, path, "placido-test/1", err), PLACIDO_INPUT);
  assert_null(json);
  free(path);
  return said(err);
}

static void broken_files_are_refused_at_their_place(void **state) {
  static const struct {
    const char *text, *begins;
  } cases[] = {
      {"", "d.json:1:1: the file is empty"},
      {"{\n \"format\": placido}", "d.json:2:"},
      {"{\"format\": \"placido-test/1\",\n\"a\": NaN}", "d.json:2:"},
      {"{\"format\": \"placido-test/1\",\n\"a\": 1e999}", "d.json:2:"},
      {"{\"format\": \"placido-test/1\",\n\"a\": 1, \"a\": 2}", "d.json:2:"},
      {"[]", "d.json:1: not a JSON object"},
      {"{}", "d.json:1: field format: missing"},
      {"{\n\"format\": 3}", "d.json:2: field format: missing or not a string"},
      {"{\n\"format\": \"placido-test/2\"}",
       "d.json:2: field format: unknown version \"placido-test/2\" (expected \"placido-test/1\")"},
      {"{\n\"format\": \"placido-tes/1\"}",
       "d.json:2: field format: unknown format \"placido-tes/1\" (expected \"placido-test/1\")"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_error err = {0};
    const char *text = refusal(state, cases[i].text, strlen(cases[i].text), &err);
    if (strncmp(text, cases[i].begins, strlen(cases[i].begins)) != 0) {
      fail_msg("\"%s\" does not begin with \"%s\"", text, cases[i].begins);
    }
  }
}

static void binary_and_deeply_nested_files_do_no_harm(void **state) {
  placido_error err;
  char binary[256];
  for (size_t i = 0; i < sizeof binary; i++) {
    binary[i] = (char)(i * 37 + 200);
  }
  refusal(state, binary, sizeof binary, &err);
  refusal(state, "{\"a\": \0 1}", 10, &err);
  size_t depth = 1000000;
  char *nested = malloc(depth);
  assert_non_null(nested);
  memset(nested, '[', depth);
  refusal(state, nested, depth, &err);
  free(nested);
}

static void a_byte_order_mark_is_no_part_of_the_text(void **state) {
  placido_json *json = load(state, "\xef\xbb\xbf{\"format\": \"placido-test/1\",\n\"a\": 3}");
  placido_error err;
  double number;
  assert_int_equal(placido_json_number(json, "a", &number, NULL), PLACIDO_OK);
  placido_json_number(json, "b", &number, &err);
  assert_string_equal(said(&err), "d.json:1: field b: missing (a number is expected)");
  placido_json_free(json);
}

static void a_missing_file_is_a_system_error(void **state) {
  char *path = scratch_path(state, "none.json");
  placido_json *json;
  placido_error err;
  assert_int_equal(placido_json_load(&json, path, "placido-test/1", &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "none.json"));
  free(path);
}

static void numbers_read_back_bit_for_bit(void **state) {
  static const double values[] = {0.1, 1.0 / 3, DBL_MIN, DBL_MAX, 5e-324, -0.0, 83.990863401178764};
  char *path = scratch_path(state, "d.json");
  json_t *array = json_array();
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    json_array_append_new(array, placido_json_real(values[i]));
  }
  json_array_append_new(array, placido_json_real(NAN));
  json_t *root = json_pack("{s:s, s:o}", "format", "placido-test/1", "values", array);
  placido_error err;
  assert_int_equal(placido_json_save(root, path, &err), PLACIDO_OK);
  json_decref(root);
  placido_json *json;
  assert_int_equal(placido_json_load(&json, path, "placido-test/1", &err), PLACIDO_OK);
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    double value = json_number_value(json_array_get(placido_json_find(json, "values"), i));
    assert_memory_equal(&value, &values[i], sizeof value);
  }
  assert_true(json_is_null(placido_json_find(json, "values[7]")));
  placido_json_free(json);
  free(path);
}

static void every_allocation_may_fail(void **state) {
  char *path = scratch_write_text(state, "d.json", document);
  int status = PLACIDO_MEMORY;
  unsigned long n = 0;
  while (status == PLACIDO_MEMORY) {
    placido_json *json;
    placido_error err = {0};
    placido_memory_fail_at(++n);
    status = placido_json_load(&json, path, "placido-test/1", &err);
    placido_memory_fail_at(0);
    assert_int_equal(err.status, status);
    assert_true((json != NULL) == (status == PLACIDO_OK));
    placido_json_free(json);
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 2); /* at least the document and its text */
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(values_are_found_by_path),
      TEST(errors_name_file_line_and_field),
      TEST(a_value_without_sense_is_refused_at_its_line),
      TEST(unknown_keys_give_one_line),
      TEST(broken_files_are_refused_at_their_place),
      TEST(binary_and_deeply_nested_files_do_no_harm),
      TEST(a_byte_order_mark_is_no_part_of_the_text),
      TEST(a_missing_file_is_a_system_error),
      TEST(numbers_read_back_bit_for_bit),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

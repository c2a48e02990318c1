/* Descriptions are read whatever their shape; what is none, or hostile, is told. */
#include "tests/genicam/memory_port.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DESCRIPTION(nodes) "<RegisterDescription>" nodes "</RegisterDescription>"

static int read_text(struct memory *memory, const char *xml, size_t size) {
  memory_reset(memory);
  memory->features = (placido_genicam *)memory; /* must become NULL */
  return placido_genicam_read(&memory->features, xml, size, &memory->port, &memory->err);
}

static void what_is_no_description_is_told(void **state) {
  (void)state;
  static const struct {
    const char *xml, *said;
  } cases[] = {
      {"", "line 1: it is no XML"},
      {"no XML at all", "line 1: it is no XML"},
      {"<html></html>", "<RegisterDescription>"},
      {"<Integer/>", "<RegisterDescription>"},
      {"<RegisterDescription>", "no XML"},
      {"<RegisterDescription>\n\n<Integer></Float></RegisterDescription>", "line 3"},
      {DESCRIPTION("&unknown;"), "no XML"},
      {DESCRIPTION("\x01"), "no XML"},
      {"<?xml version=\"1.0\" encoding=\"none-such\"?>" DESCRIPTION(""), "no XML"},
      {"<!DOCTYPE RegisterDescription [<!ENTITY a \"b\">]>" DESCRIPTION(""), "refused"},
      {"<!DOCTYPE RegisterDescription [<!ATTLIST Integer Name CDATA \"b\">]>" DESCRIPTION(""),
       "refused"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    assert_int_equal(read_text(&memory, cases[i].xml, strlen(cases[i].xml)), PLACIDO_INPUT);
    assert_null(memory.features);
    assert_says(&memory, cases[i].said);
  }
}

/* A billion laughs: refused before the first. */
static void bombs_do_not_go_off(void **state) {
  (void)state;
  char xml[4096];
  int length = snprintf(xml, sizeof xml, "<!DOCTYPE RegisterDescription [<!ENTITY l0 \"lol\">");
  for (int i = 1; i < 10; i++) {
    length += snprintf(xml + length, sizeof xml - (size_t)length, "<!ENTITY l%d \"", i);
    for (int k = 0; k < 10; k++) {
      length += snprintf(xml + length, sizeof xml - (size_t)length, "&l%d;", i - 1);
    }
    length += snprintf(xml + length, sizeof xml - (size_t)length, "\">");
  }
  length += snprintf(xml + length, sizeof xml - (size_t)length, "]>" DESCRIPTION("&l9;"));
  struct memory memory;
  assert_int_equal(read_text(&memory, xml, (size_t)length), PLACIDO_INPUT);
  assert_says(&memory, "refused");
}

static void elements_may_not_lie_without_end(void **state) {
  (void)state;
  static const char *const elements[] = {"<a>", "<Group>", "<Category>"};
  for (size_t i = 0; i < sizeof elements / sizeof *elements; i++) {
    char xml[64 + 20 * 1000] = "<RegisterDescription>";
    for (int k = 0; k < 1000; k++) {
      strcat(xml, elements[i]);
    }
    struct memory memory;
    assert_int_equal(read_text(&memory, xml, strlen(xml)), PLACIDO_INPUT);
    assert_says(&memory, "too deep");
  }
}

static void a_text_may_not_be_too_long(void **state) {
  (void)state;
  const size_t size = 1 << 17;
  char *xml = malloc(size);
  assert_non_null(xml);
  memset(xml, '1', size);
  static const char begin[] = "<RegisterDescription><Integer Name=\"A\"><Value>";
  memcpy(xml, begin, sizeof begin - 1);
  struct memory memory;
  assert_int_equal(read_text(&memory, xml, size), PLACIDO_INPUT);
  assert_says(&memory, "too long");
  free(xml);
}

/* Cut anywhere, a description is refused or read, and in no case anything else happens. */
static void truncated_files_are_told(void **state) {
  (void)state;
  char path[1024];
  snprintf(path, sizeof path, "%s/genicam/converted.xml", PLACIDO_TEST_DATA);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  char xml[1 << 15];
  const size_t size = fread(xml, 1, sizeof xml, file);
  fclose(file);
  assert_true(size > 1000 && size < sizeof xml);
  for (size_t cut = 0; cut + 2 < size; cut += 7) {
    char *copy = malloc(cut + 1); /* a sanitizer sees what is read behind it */
    assert_non_null(copy);
    memcpy(copy, xml, cut);
    struct memory memory;
    assert_int_equal(read_text(&memory, copy, cut), PLACIDO_INPUT);
    assert_null(memory.features);
    assert_says(&memory, "no XML");
    free(copy);
  }
}

/* Cameras pad their file to the next block. */
static void what_stands_behind_the_end_is_not_read(void **state) {
  (void)state;
  static const char xml[64] = DESCRIPTION("");
  struct memory memory;
  assert_int_equal(read_text(&memory, xml, sizeof xml), PLACIDO_OK);
  memory_close(&memory);
}

static void encodings_are_those_of_expat(void **state) {
  (void)state;
  static const char xml[] = DESCRIPTION("<Integer Name=\"A\"><Value>5</Value></Integer>");
  char wide[2 * sizeof xml + 2] = {'\xFF', '\xFE'};
  for (size_t i = 0; i + 1 < sizeof xml; i++) {
    wide[2 * i + 2] = xml[i];
  }
  struct memory memory;
  assert_int_equal(read_text(&memory, wide, 2 * sizeof xml), PLACIDO_OK);
  assert_int_equal(integer_of(&memory, "A"), 5);
  memory_close(&memory);
  memory_open_nodes(&memory, "<Float Name=\"A\"><Value>5</Value><Unit>\xC2\xB5s</Unit></Float>");
  assert_string_equal(description_of(&memory, "A").unit, "\xC2\xB5s");
  memory_close(&memory);
}

static void unknown_elements_are_passed_over(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(
      &memory,
      "<Unknown Name=\"U\"><pValue>X</pValue><Integer Name=\"V\"><Value>1</Value></Integer>"
      "</Unknown><Integer Name=\"A\"><Extension><Value>8</Value></Extension>"
      "<Value> <!-- no -->\n 4<Deep><Value>9</Value></Deep>2 </Value>"
      "<Float Name=\"Within\"><Value>1</Value></Float></Integer>"
      "<EnumEntry Name=\"Stray\"><Value>1</Value></EnumEntry><Value>7</Value>");
  assert_int_equal(integer_of(&memory, "A"), 42);
  static const char *const absent[] = {"U", "V", "Within", "Stray", "Unknown", ""};
  for (size_t i = 0; i < sizeof absent / sizeof *absent; i++) {
    int64_t value = 1;
    assert_int_equal(description_of(&memory, absent[i]).kind, PLACIDO_FEATURE_NONE);
    assert_int_equal(
        placido_genicam_get_integer(memory.features, absent[i], &value, &memory.err),
        PLACIDO_INPUT);
    assert_says(&memory, "has no feature");
    assert_int_equal(value, 0);
  }
  memory_close(&memory);
}

static void of_one_name_the_first_counts(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(&memory,
                    "<Integer Name=\"B\"><pValue>A</pValue></Integer>"
                    "<Integer Name=\"A\"><Value>1</Value><Value>3</Value></Integer>"
                    "<Float Name=\"A\"><Value>2</Value></Float>");
  assert_int_equal(integer_of(&memory, "A"), 1);
  assert_int_equal(integer_of(&memory, "B"), 1);
  assert_int_equal(description_of(&memory, "A").kind, PLACIDO_FEATURE_INTEGER);
  memory_close(&memory);
}

/* `count` nodes, of which each refers to the next. */
static char *chain(size_t count) {
  char *nodes = malloc(count * 64 + 64);
  assert_non_null(nodes);
  size_t length = 0;
  for (size_t i = 0; i < count; i++) {
    length += (size_t)sprintf(
        nodes + length, "<Integer Name=\"N%zu\"><pValue>N%zu</pValue></Integer>", i, i + 1);
  }
  sprintf(nodes + length, "<Integer Name=\"N%zu\"><Value>3</Value></Integer>", count);
  return nodes;
}

static void a_hundred_thousand_nodes_are_read(void **state) {
  (void)state;
  char *nodes = chain(100000);
  struct memory memory;
  memory_open_nodes(&memory, nodes);
  free(nodes);
  assert_int_equal(integer_of(&memory, "N99950"), 3);
  int64_t value;
  assert_int_equal(placido_genicam_get_integer(memory.features, "N0", &value, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "deeper than");
  memory_close(&memory);
}

static void more_nodes_than_any_camera_has_are_refused(void **state) {
  (void)state;
  char *nodes = chain(260000);
  struct memory memory;
  assert_int_equal(memory_try(&memory, nodes), PLACIDO_INPUT);
  assert_says(&memory, "over 250000 nodes");
  free(nodes);
  /* As many elements in one node. */
  const size_t count = 70000;
  nodes = malloc(count * 16 + 64);
  assert_non_null(nodes);
  size_t length = (size_t)sprintf(nodes, "<Integer Name=\"A\">");
  for (size_t i = 0; i < count; i++) {
    length += (size_t)sprintf(nodes + length, "<Min>0</Min>");
  }
  sprintf(nodes + length, "</Integer>");
  assert_int_equal(memory_try(&memory, nodes), PLACIDO_INPUT);
  assert_says(&memory, "A of the camera's description says too much");
  free(nodes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_no_description_is_told),
      cmocka_unit_test(bombs_do_not_go_off),
      cmocka_unit_test(elements_may_not_lie_without_end),
      cmocka_unit_test(a_text_may_not_be_too_long),
      cmocka_unit_test(truncated_files_are_told),
      cmocka_unit_test(what_stands_behind_the_end_is_not_read),
      cmocka_unit_test(encodings_are_those_of_expat),
      cmocka_unit_test(unknown_elements_are_passed_over),
      cmocka_unit_test(of_one_name_the_first_counts),
      cmocka_unit_test(a_hundred_thousand_nodes_are_read),
      cmocka_unit_test(more_nodes_than_any_camera_has_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Error against time: which settings are efficient, and what is written. */
#include "tests/base/scratch.h"

#include "report/pareto.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const placido_pareto_point points[] = {
    {40, 0.01, "fine"},      {10, 1, "coarse"}, {20, 0.1, "middle"},
    {30, 0.1, "as good as the middle, slower"}, {15, 2, "slower and worse"},
    {20, 0.3, "as slow as the middle, worse"},  {80, 0, "exact"}};

static placido_pareto all(void) {
  return (placido_pareto){.title = "A stage",
                          .error_name = "error, µm",
                          .floor = 0.05,
                          .count = sizeof points / sizeof *points,
                          .points = points};
}

static void test_front(void **state) {
  (void)state;
  size_t front[PLACIDO_PARETO_POINTS_MAX];
  const placido_pareto pareto = all();
  assert_int_equal(placido_pareto_front(front, &pareto), 4);
  assert_int_equal(front[0], 1);
  assert_int_equal(front[1], 2);
  assert_int_equal(front[2], 0);
  assert_int_equal(front[3], 6);
}

/* Whether the file's first kilobyte has that text. */
static bool begins_with(const char *path, const char *text) {
  char head[1024] = {0};
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  size_t size = fread(head, 1, sizeof head - 1, file);
  fclose(file);
  for (size_t i = 0; i + strlen(text) <= size; i++) {
    if (memcmp(head + i, text, strlen(text)) == 0) {
      return true;
    }
  }
  return false;
}

/* Draws the pareto into the file of that name; whether it then begins with `text`. */
static bool draws(void **state, const placido_pareto *pareto, const char *name, const char *text) {
  char *path = scratch_path(state, name);
  bool drawn = placido_figure_pareto(pareto, path, NULL) == PLACIDO_OK && begins_with(path, text);
  free(path);
  return drawn;
}

static void test_pictures(void **state) {
  const placido_pareto pareto = all();
  assert_true(draws(state, &pareto, "a.png", "PNG"));
  assert_true(draws(state, &pareto, "a.svg", "<svg"));
  assert_false(draws(state, &pareto, "nowhere/a.svg", "<svg"));
}

static void test_nothing_to_draw(void **state) {
  char *path = scratch_path(state, "b.png");
  placido_pareto pareto = all();
  placido_error err = {0};
  pareto.count = 0;
  assert_int_equal(placido_figure_pareto(&pareto, path, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "A stage"));
  free(path);
}

/* What a page says is escaped, and stands in it. */
static void test_page(void **state) {
  const placido_pareto_section section = {.pareto = all(),
                                          .picture = "a.png",
                                          .sentence_count = 1,
                                          .sentences = {"0.1 < 1 costs 20 ms"}};
  const placido_pareto_page page = {.machine = "one",
                                    .created = "now",
                                    .software = "this",
                                    .probe_ms = 3,
                                    .sections = &section,
                                    .count = 1};
  static char text[400000];
  char *folder = scratch_path(state, ""), *path = scratch_path(state, "accuracy.html");
  assert_true(draws(state, &section.pareto, "a.png", "PNG"));
  assert_int_equal(placido_report_pareto_write(&page, folder, NULL), PLACIDO_OK);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = '\0';
  fclose(file);
  assert_non_null(strstr(text, "0.1 &lt; 1 costs 20 ms"));
  assert_non_null(strstr(text, "exact"));
  assert_null(strstr(text, "slower and worse")); /* the table has only what is efficient */
  free(folder);
  free(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_front),
      cmocka_unit_test_setup_teardown(test_pictures, scratch_setup, scratch_teardown),
      cmocka_unit_test_setup_teardown(test_nothing_to_draw, scratch_setup, scratch_teardown),
      cmocka_unit_test_setup_teardown(test_page, scratch_setup, scratch_teardown)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Sentences of an accuracy table: numbers that were put in come out where they belong. */
#include "acquire/cli/accuracy/sentences.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

static void add(struct accuracy_table *table, enum accuracy_stage stage, const char *setting,
                const char *eye, enum accuracy_error error, double value, double ms) {
  struct accuracy_row row = {.stage = stage, .ms = ms};
  for (int i = 0; i < ACCURACY_ERRORS; i++) {
    row.error[i] = NAN;
  }
  if (error < ACCURACY_ERRORS) {
    row.error[error] = value;
  }
  snprintf(row.setting, sizeof row.setting, "%s", setting);
  snprintf(row.eye, sizeof row.eye, "%s", eye);
  assert_int_equal(accuracy_table_add(table, &row, NULL), 0);
}

/* Two eyes, of which the second is harder everywhere; times of which are the same. */
static void add_both(struct accuracy_table *table, enum accuracy_stage stage, const char *setting,
                     enum accuracy_error error, double value, double ms) {
  add(table, stage, setting, "easy", error, value / 7, ms);
  add(table, stage, setting, "hard", error, value, ms);
}

static struct accuracy_table make_table(void) {
  struct accuracy_table table = {0};
  add_both(&table, ACCURACY_MIRES, "meridians=45", ACCURACY_ELEVATION_UM, 0.7, 40);
  add_both(&table, ACCURACY_MIRES, "meridians=360 filter_px=2", ACCURACY_ELEVATION_UM, 0.06, 400);
  add(&table, ACCURACY_MIRES, "meridians=24", "easy", ACCURACY_ELEVATION_UM, 1e-5, 1);
  add_both(&table, ACCURACY_TRACE, "samples=50", ACCURACY_PSF_OTF, 0.03, 1);
  add_both(&table, ACCURACY_TRACE, "samples=100", ACCURACY_PSF_OTF, 0.002, 4);
  add_both(&table, ACCURACY_TRACE, "samples=400", ACCURACY_PSF_OTF, 0.0001, 64);
  add_both(&table, ACCURACY_REST, "part=maps", ACCURACY_ERRORS, 0, 50);
  add_both(&table, ACCURACY_REST, "part=indices", ACCURACY_ERRORS, 0, 30);
  return table;
}

static const char *text_of(const struct accuracy_sentences *sentences, enum accuracy_stage stage,
                           size_t number) {
  for (size_t i = 0; i < sentences->count; i++) {
    if (sentences->items[i].stage == stage && number-- == 0) {
      return sentences->items[i].text;
    }
  }
  return "";
}

static void assert_says(const char *text, const char *part) {
  if (!strstr(text, part)) {
    print_error("\"%s\" is expected in: %s\n", part, text);
    fail();
  }
}

static void test_ladder(void **state) {
  (void)state;
  struct accuracy_table table = make_table();
  struct accuracy_sentences sentences;
  accuracy_sentences_find(&sentences, &table);
  const char *mires = text_of(&sentences, ACCURACY_MIRES, 0);
  assert_says(mires, "the hardest of 2 eyes");
  assert_says(mires, "1 µm costs 40 ms (45 meridians)");
  assert_says(mires, "the least, 0.06 µm costs 400 ms (360 meridians, a filter of 2 px)");
  assert_null(strstr(mires, "24 meridians")); /* the hard eye has no such row */
  const char *trace = text_of(&sentences, ACCURACY_TRACE, 0);
  assert_says(trace, "error of the transfer function");
  assert_says(trace, ": 0.1 costs 1 ms (50 rays across), 0.01 costs 4 ms (100 rays across)");
  assert_says(trace, "the least, 0.0001 costs 64 ms (400 rays across).");
  assert_says(text_of(&sentences, ACCURACY_REST, 0), "take up to 80 ms");
  assert_string_equal(text_of(&sentences, ACCURACY_FLOOR, 0), "");
  accuracy_table_free(&table);
}

static void set_floor(struct accuracy_table *table, double value) {
  for (size_t i = 0; i < table->count; i++) {
    if (table->rows[i].stage == ACCURACY_FLOOR) {
      table->rows[i].error[ACCURACY_PSF_OTF] = value;
    }
  }
}

/* What leaves less than a tenth of the floor is enough: then more time buys nothing. What leaves
 * more than the floor at its finest is what limits. */
static void test_limit(void **state) {
  (void)state;
  struct accuracy_table table = make_table();
  struct accuracy_sentences sentences;
  add_both(&table, ACCURACY_FLOOR, "knobs=finest", ACCURACY_PSF_OTF, 0.02, 100);
  accuracy_sentences_find(&sentences, &table);
  const char *enough = text_of(&sentences, ACCURACY_TRACE, 1);
  assert_says(enough, "leaves 0.002 for 4 ms (100 rays across), while noise and camera leave 0.02 ");
  /* 0.02 + 0.002, and 0.02 + 0.0001, as a choice adds them up. */
  assert_says(enough, "16 times the time (400 rays across) buys next to nothing: 0.022 are left in "
                      "all, then 0.02.");
  set_floor(&table, 4);
  accuracy_sentences_find(&sentences, &table);
  enough = text_of(&sentences, ACCURACY_TRACE, 1);
  assert_says(enough, "leaves 0.03 for 1 ms (50 rays across)");
  assert_says(enough, "64 times the time (400 rays across) buys nothing: 4 is left in all.");
  set_floor(&table, 0.0005);
  accuracy_sentences_find(&sentences, &table);
  assert_says(text_of(&sentences, ACCURACY_TRACE, 1), "noise and camera, which leave 0.0005, limit");
  set_floor(&table, 1e-5);
  accuracy_sentences_find(&sentences, &table);
  assert_says(text_of(&sentences, ACCURACY_TRACE, 1), "so that it limits you");
  accuracy_table_free(&table);
}

static void test_points(void **state) {
  (void)state;
  struct accuracy_table table = make_table();
  struct accuracy_point points[4];
  assert_int_equal(accuracy_points_find(points, 4, &table, ACCURACY_TRACE, ACCURACY_PSF_OTF), 3);
  assert_string_equal(points[2].setting, "samples=400");
  assert_true(points[2].error == 0.0001 && points[2].ms == 64);
  assert_int_equal(accuracy_points_find(points, 4, &table, ACCURACY_TRACE, ACCURACY_IMAGE), 0);
  assert_int_equal(accuracy_points_find(points, 1, &table, ACCURACY_TRACE, ACCURACY_PSF_OTF), 1);
  accuracy_table_free(&table);
}

static void test_words(void **state) {
  (void)state;
  static const struct {
    const char *setting, *words;
  } cases[] = {
      {"knot_mm=0.5 degree=3 tolerance=0.1", "knots every 0.5 mm, degree 3, a tolerance of 0.1"},
      {"knot_mm=0 degree=5 tolerance=0", "knots as residuals ask, degree 5"},
      {"samples=100 light=counted", "100 rays across, counted"},
      {"doubles=0 memory_MB=2", "single precision, tiles of 2 MB"},
      {"wavelengths=1", "one wavelength"},
      {"other=7", "other 7"},
      {"", ""},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char text[96], small[8];
    accuracy_setting_say(text, sizeof text, cases[i].setting);
    assert_string_equal(text, cases[i].words);
    accuracy_setting_say(small, sizeof small, cases[i].setting);
    assert_true(strlen(small) < sizeof small);
  }
}

static void test_empty(void **state) {
  (void)state;
  struct accuracy_table table = {0};
  struct accuracy_sentences sentences;
  accuracy_sentences_find(&sentences, &table);
  assert_int_equal(sentences.count, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_ladder), cmocka_unit_test(test_limit), cmocka_unit_test(test_points),
      cmocka_unit_test(test_words),  cmocka_unit_test(test_empty),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

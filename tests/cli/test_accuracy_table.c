/* The accuracy table as a file, and what is chosen by one whose answers can be told by hand. */
#include "../base/scratch.h"
#include "../support/near.h"
#include "acquire/cli/accuracy/choose.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void add(struct accuracy_table *table, enum accuracy_stage stage, const char *setting,
                const char *eye, double elevation_um, double otf, double ms) {
  struct accuracy_row row = {.stage = stage,
                             .error = {elevation_um, NAN, otf, NAN, NAN},
                             .ms = ms};
  snprintf(row.setting, sizeof row.setting, "%s", setting);
  snprintf(row.eye, sizeof row.eye, "%s", eye);
  assert_int_equal(accuracy_table_add(table, &row, NULL), PLACIDO_OK);
}

/* Two eyes, of which b is the harder one; knots of 4 mm cannot examine it. */
static void fill(struct accuracy_table *table) {
  *table = (struct accuracy_table){
      .probe_ms = 3.5, .created = "2026-01-02T03:04:05Z", .machine = "by hand; 1 processor"};
  add(table, ACCURACY_MIRES, "meridians=90", "a", 0.03, 0.03, 10);
  add(table, ACCURACY_MIRES, "meridians=90", "b", 0.04, 0.04, 9);
  add(table, ACCURACY_MIRES, "meridians=360", "a", 0.01, 0.01, 30);
  add(table, ACCURACY_MIRES, "meridians=360", "b", 0.01, 0.01, 28);
  add(table, ACCURACY_FIT, "knot_mm=4", "a", 0.01, 0.01, 1);
  add(table, ACCURACY_FIT, "knot_mm=2", "a", 0.1, 0.1, 20);
  add(table, ACCURACY_FIT, "knot_mm=2", "b", 0.3, 0.3, 18);
  add(table, ACCURACY_FIT, "knot_mm=1", "a", 0.02, 0.02, 40);
  add(table, ACCURACY_FIT, "knot_mm=1", "b", 0.05, 0.05, 40);
  add(table, ACCURACY_FIT, "knot_mm=0.5", "a", 0.005, 0.005, 100);
  add(table, ACCURACY_FIT, "knot_mm=0.5", "b", 0.01, 0.01, 90);
  add(table, ACCURACY_FIT, "knot_mm=0.25", "a", 0.009, 0.009, 200);
  add(table, ACCURACY_FIT, "knot_mm=0.25", "b", 0.01, 0.01, 200);
  add(table, ACCURACY_TRACE, "samples=100", "a", NAN, 0.2, 1);
  add(table, ACCURACY_TRACE, "samples=100", "b", NAN, 0.1, 1);
  add(table, ACCURACY_TRACE, "samples=400", "a", NAN, 0.01, 8);
  add(table, ACCURACY_TRACE, "samples=400", "b", NAN, 0.02, 8);
  add(table, ACCURACY_REST, "part=maps", "a", NAN, NAN, 5);
  add(table, ACCURACY_REST, "part=focus", "b", NAN, NAN, 3);
  add(table, ACCURACY_FLOOR, "knobs=finest", "a", 0.01, 0.01, 200);
  add(table, ACCURACY_FLOOR, "knobs=finest", "b", 0.02, 0.02, 200);
}

/* Measuring only: neither rays nor parts of the rest. */
static struct accuracy_wish measuring(double elevation_um, double time_ms, const char *fixed) {
  struct accuracy_wish wish = {.time_ms = time_ms, .parts = "", .fixed = fixed, .speed = 1};
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    wish.error[k] = (double)INFINITY;
  }
  wish.error[ACCURACY_ELEVATION_UM] = elevation_um;
  wish.counts[ACCURACY_MIRES] = wish.counts[ACCURACY_FIT] = wish.counts[ACCURACY_FLOOR] = true;
  wish.needed[ACCURACY_MIRES] = wish.needed[ACCURACY_FIT] = true;
  wish.runs[ACCURACY_MIRES] = wish.runs[ACCURACY_FIT] = 1;
  return wish;
}

static void expect(const struct accuracy_wish *wish, const char *mires, const char *fit,
                   double elevation_um, double time_ms) {
  struct accuracy_table table;
  struct accuracy_choice choice;
  placido_error err = {0};
  fill(&table);
  if (accuracy_choose(&choice, &table, wish, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  assert_string_equal(choice.setting[ACCURACY_MIRES], mires);
  assert_string_equal(choice.setting[ACCURACY_FIT], fit);
  assert_near(choice.error[ACCURACY_ELEVATION_UM], elevation_um, 1e-12);
  assert_near(choice.time_ms, time_ms, 1e-9);
  accuracy_table_free(&table);
}

static void expect_refusal(const struct accuracy_wish *wish, const char *first,
                           const char *second) {
  struct accuracy_table table;
  struct accuracy_choice choice;
  placido_error err = {0};
  fill(&table);
  assert_int_equal(accuracy_choose(&choice, &table, wish, &err), PLACIDO_QUALITY);
  if (!strstr(err.text, first) || !strstr(err.text, second)) {
    fail_msg("neither \"%s\" nor \"%s\" in: %s", first, second, err.text);
  }
  accuracy_table_free(&table);
}

#define COARSE "meridians=90 filter_px=1"
#define FINE "meridians=360 filter_px=1"
#define KNOTS(mm) "knot_mm=" mm " degree=5 tolerance=0.001"

/* In eye b: 0.01 + 0.05 + 0.02 for 70 ms; 0.04 + 0.01 + 0.02 would take 110, and the other two
 * combinations below 70 ms leave 0.33 and 0.36. */
static void the_cheapest_that_reaches_an_error(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring(0.1, (double)INFINITY, "");
  expect(&wish, FINE, KNOTS("1"), 0.08, 70);
  wish = measuring(0.075, (double)INFINITY, "");
  expect(&wish, COARSE, KNOTS("0.5"), 0.07, 110);
  wish = measuring(0.05, (double)INFINITY, "");
  expect(&wish, FINE, KNOTS("0.5"), 0.04, 130);
}

/* 50 ms buy 0.04 + 0.05 + 0.02; what 90 and more buy needs 70. */
static void the_most_accurate_that_fits_a_time(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring((double)INFINITY, 60, "");
  expect(&wish, COARSE, KNOTS("1"), 0.11, 50);
  wish.time_ms = 30.5;
  expect(&wish, COARSE, KNOTS("2"), 0.36, 30);
  wish.time_ms = 1e6;
  expect(&wish, FINE, KNOTS("0.5"), 0.04, 130);
}

static void a_slower_machine_takes_longer(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring((double)INFINITY, 120, "");
  wish.speed = 2;
  expect(&wish, COARSE, KNOTS("1"), 0.11, 100);
}

static void what_cannot_be_reached_is_refused(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring(0.03, (double)INFINITY, "");
  expect_refusal(&wish, "reach 0.04 um (of the table's eye \"b\")", "what the picture shows");
  wish = measuring((double)INFINITY, 25, "");
  expect_refusal(&wish, "quickest settings take 30 ms", "20 are for the fit");
  wish = measuring(0.1, 60, "");
  expect_refusal(&wish, "accurate enough take 70 ms", "40 are for the fit");
}

/* Between knots of 1 and 2 mm the worse of both holds, of error and of time. */
static void a_given_knob_stays(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring(0.1, (double)INFINITY, "meridians=90 knot_mm=0.5");
  expect(&wish, COARSE, KNOTS("0.5"), 0.07, 110);
  wish = measuring(1, (double)INFINITY, "knot_mm=1.4");
  expect(&wish, COARSE, KNOTS("1.4"), 0.36, 50);
  wish = measuring(1, (double)INFINITY, "knot_mm=0.2");
  expect_refusal(&wish, "knot_mm=0.2", "does not reach");
}

/* More meridians are more points to fit to; finer knots, maps with more behind them. */
static void what_one_stage_hands_on_costs_the_next(void **state) {
  (void)state;
  struct accuracy_wish wish = measuring(1, (double)INFINITY, "meridians=360 knot_mm=0.25");
  wish.parts = "maps=1 focus=2";
  expect(&wish, FINE, KNOTS("0.25"), 0.04, 30 + 200 + 2 * (5 + 2 * 3));
}

/* Three pupils are traced thrice. The errors of the PSF add up likewise: in eye b with 400 rays
 * 0.01 + 0.05 + 0.02 + 0.02. */
static void rays_count_once_a_pupil(void **state) {
  (void)state;
  struct accuracy_table table;
  struct accuracy_choice choice;
  struct accuracy_wish wish = measuring((double)INFINITY, (double)INFINITY, "");
  wish.error[ACCURACY_PSF_OTF] = 0.11;
  wish.counts[ACCURACY_TRACE] = wish.needed[ACCURACY_TRACE] = true;
  wish.runs[ACCURACY_TRACE] = 3;
  fill(&table);
  assert_int_equal(accuracy_choose(&choice, &table, &wish, NULL), PLACIDO_OK);
  assert_non_null(strstr(choice.setting[ACCURACY_TRACE], "samples=400"));
  assert_near(choice.error[ACCURACY_PSF_OTF], 0.1, 1e-12);
  assert_near(choice.stage_ms[ACCURACY_TRACE], 24, 1e-9);
  assert_near(choice.time_ms, 70 + 24, 1e-9);
  accuracy_table_free(&table);
}

/* A stage that is run without being in the table leaves what it makes unknown, or refuses where
 * that was asked for. */
static void the_unknown_is_not_promised(void **state) {
  (void)state;
  struct accuracy_table table;
  struct accuracy_choice choice;
  struct accuracy_wish wish = measuring(0.1, (double)INFINITY, "samples=7");
  wish.counts[ACCURACY_TRACE] = true;
  wish.runs[ACCURACY_TRACE] = 1;
  fill(&table);
  assert_int_equal(accuracy_choose(&choice, &table, &wish, NULL), PLACIDO_OK);
  assert_near(choice.error[ACCURACY_ELEVATION_UM], 0.08, 1e-12);
  assert_true(isnan(choice.error[ACCURACY_PSF_OTF]) && isnan(choice.error[ACCURACY_LOGMAR]));
  assert_true(isnan(choice.time_ms));
  accuracy_table_free(&table);
  wish.needed[ACCURACY_TRACE] = true;
  expect_refusal(&wish, "samples=7", "does not reach");
  wish = measuring((double)INFINITY, (double)INFINITY, "");
  wish.error[ACCURACY_LOGMAR] = 0.1;
  expect_refusal(&wish, "does not tell", "acuity");
}

static void expect_same(const struct accuracy_table *one, const struct accuracy_table *other) {
  assert_int_equal(one->count, other->count);
  assert_string_equal(one->created, other->created);
  assert_string_equal(one->machine, other->machine);
  assert_true(one->probe_ms == other->probe_ms);
  for (size_t i = 0; i < one->count; i++) {
    const struct accuracy_row *a = &one->rows[i], *b = &other->rows[i];
    assert_int_equal(a->stage, b->stage);
    assert_string_equal(a->setting, b->setting);
    assert_string_equal(a->eye, b->eye);
    assert_true(a->ms == b->ms);
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      assert_true(a->error[k] == b->error[k] || (isnan(a->error[k]) && isnan(b->error[k])));
    }
  }
}

static void a_table_reads_back_bit_for_bit(void **state) {
  struct accuracy_table table, read;
  char *path = scratch_path(state, "accuracy.csv");
  fill(&table);
  table.rows[0].error[0] = 1.0 / 3;
  table.probe_ms = 10.0 / 3;
  assert_int_equal(accuracy_table_save(&table, path, NULL), PLACIDO_OK);
  assert_int_equal(accuracy_table_load(&read, path, NULL), PLACIDO_OK);
  expect_same(&table, &read);
  accuracy_table_free(&read);
  accuracy_table_free(&table);
  accuracy_table_free(&table);
  free(path);
}

#define HEAD "# placido-accuracy/1\n# created x\n# machine y\n# probe_ms 3\n"
#define COLUMNS "stage,setting,eye,elevation_um,axial_D,psf_otf,image,logmar,ms\n"
#define ROW "fit,knot_mm=1,a,0.1,,0.2,,,5\n"

static void a_damaged_table_is_refused(void **state) {
  static const struct {
    const char *text, *says;
  } cases[] = {
      {"", ".csv:1: \"# placido-accuracy/1\" was expected"},
      {"# placido-accuracy/2\n", ".csv:1: \"# placido-accuracy/1\" was expected"},
      {"# placido-accuracy/1\nstage\n", ".csv:2: \"# created ...\" was expected"},
      {"# placido-accuracy/1\n# created x\n# machine y\n# probe_ms 0\n", ".csv:4: a time over 0"},
      {HEAD "stage,setting\n", ".csv:5: stage,setting,eye,elevation_um"},
      {HEAD COLUMNS, "without a row"},
      {HEAD COLUMNS ROW "fit,knot_mm=1,a,0.1\n", ".csv:7: 9 columns were expected, not 4"},
      {HEAD COLUMNS ROW "fits,knot_mm=1,a,0.1,,0.2,,,5\n", ".csv:7: a stage"},
      {HEAD COLUMNS "fit,knot_mm=1,a,-0.1,,0.2,,,5\n", ".csv:6: an error of 0 or more"},
      {HEAD COLUMNS "fit,knot_mm=1,a,0.1um,,0.2,,,5\n", ".csv:6: an error of 0 or more"},
      {HEAD COLUMNS "fit,knot_mm=1,a,nan,,0.2,,,5\n", ".csv:6: an error of 0 or more"},
      {HEAD COLUMNS "fit,knot_mm=1,a,0.1,,0.2,,,\n", ".csv:6: a time of 0 or more"},
      {HEAD COLUMNS "fit,knot_mm=1,a name that is far longer than an eye may have,0.1,,0.2,,,5\n",
       ".csv:6: a shorter text"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct accuracy_table table;
    placido_error err = {0};
    char *path = scratch_write_text(state, "damaged.csv", cases[i].text);
    assert_int_equal(accuracy_table_load(&table, path, &err), PLACIDO_INPUT);
    assert_int_equal(table.count, 0);
    if (!strstr(err.text, cases[i].says)) {
      fail_msg("case %zu says: %s", i, err.text);
    }
    unlink(path);
    free(path);
  }
}

static void rows_that_a_file_could_not_hold_are_refused(void **state) {
  (void)state;
  struct accuracy_table table = {0};
  struct accuracy_row row = {.setting = "knot_mm=1,5", .eye = "a"};
  assert_int_equal(accuracy_table_add(&table, &row, NULL), PLACIDO_INPUT);
  memset(row.setting, 'x', sizeof row.setting);
  assert_int_equal(accuracy_table_add(&table, &row, NULL), PLACIDO_INPUT);
  assert_int_equal(table.count, 0);
}

/* What the program brings along has every stage that is chosen from, and the floor. */
static void the_built_in_table_is_whole(void **state) {
  (void)state;
  struct accuracy_table table;
  bool has[ACCURACY_STAGES] = {false};
  assert_int_equal(accuracy_table_built_in(&table, NULL), PLACIDO_OK);
  for (size_t i = 0; i < table.count; i++) {
    has[table.rows[i].stage] = true;
  }
  assert_true(has[ACCURACY_MIRES] && has[ACCURACY_FIT] && has[ACCURACY_TRACE]);
  assert_true(has[ACCURACY_ACUITY] && has[ACCURACY_REST] && has[ACCURACY_FLOOR]);
  accuracy_table_free(&table);
}

/* A fixed piece of work: least times of two moments differ by the clock's steps and by what others
 * take of the caches, not by much more. */
static void the_probe_measures_a_fixed_piece_of_work(void **state) {
  (void)state;
  const double one = accuracy_probe_ms(), other = accuracy_probe_ms();
  assert_true(one > 0 && other > 0 && one < 10 * other && other < 10 * one);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_cheapest_that_reaches_an_error),
      cmocka_unit_test(the_most_accurate_that_fits_a_time),
      cmocka_unit_test(a_slower_machine_takes_longer),
      cmocka_unit_test(what_cannot_be_reached_is_refused),
      cmocka_unit_test(a_given_knob_stays),
      cmocka_unit_test(what_one_stage_hands_on_costs_the_next),
      cmocka_unit_test(rays_count_once_a_pupil),
      cmocka_unit_test(the_unknown_is_not_promised),
      cmocka_unit_test_setup_teardown(a_table_reads_back_bit_for_bit, scratch_setup,
                                      scratch_teardown),
      cmocka_unit_test_setup_teardown(a_damaged_table_is_refused, scratch_setup, scratch_teardown),
      cmocka_unit_test(rows_that_a_file_could_not_hold_are_refused),
      cmocka_unit_test(the_built_in_table_is_whole),
      cmocka_unit_test(the_probe_measures_a_fixed_piece_of_work),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

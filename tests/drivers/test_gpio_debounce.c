/* A contact that bounces gives one change, which dates from its first edge. */
#include "drivers/gpio/debounce.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#define MS 1000000
#define HOLD_MS 20

static placido_gpio_debounce standing_at(int level) {
  placido_gpio_debounce debounce = {.hold_ns = HOLD_MS * MS};
  placido_gpio_debounce_start(&debounce, level);
  return debounce;
}

/* Edges in turn, at times in ms; none of them may complete a change. */
static void feed(placido_gpio_debounce *debounce, const double *times_ms, int count) {
  placido_gpio_change change;
  for (int i = 0; i < count; i++) {
    assert_false(placido_gpio_debounce_edge(debounce, (int64_t)(times_ms[i] * MS), !debounce->raw,
                                            &change));
  }
}

static void a_change_counts_when_the_line_has_stood_still(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  feed(&debounce, (const double[]){100}, 1);
  assert_int_equal(placido_gpio_debounce_due_ns(&debounce), 120 * MS);
  assert_false(placido_gpio_debounce_settle(&debounce, 120 * MS - 1, &change));
  assert_true(placido_gpio_debounce_settle(&debounce, 120 * MS, &change));
  assert_int_equal(change.t_ns, 100 * MS);
  assert_int_equal(change.level, 1);
  assert_int_equal(debounce.bounce_count, 0);
  assert_int_equal(placido_gpio_debounce_due_ns(&debounce), INT64_MAX);
  assert_false(placido_gpio_debounce_settle(&debounce, INT64_MAX - 1, &change));
}

static void bounces_are_one_change_that_dates_from_the_first(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  feed(&debounce, (const double[]){100, 100.3, 101, 104, 104.1}, 5);
  assert_false(placido_gpio_debounce_settle(&debounce, 124 * MS, &change));
  assert_true(placido_gpio_debounce_settle(&debounce, 125 * MS, &change));
  assert_int_equal(change.t_ns, 100 * MS);
  assert_int_equal(change.level, 1);
  assert_int_equal(debounce.bounce_count, 4);
}

static void a_glitch_is_no_change(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(1);
  placido_gpio_change change;
  feed(&debounce, (const double[]){50, 51}, 2);
  assert_false(placido_gpio_debounce_settle(&debounce, 500 * MS, &change));
  assert_int_equal(debounce.level, 1);
  assert_int_equal(debounce.bounce_count, 2);
  feed(&debounce, (const double[]){600}, 1);
  assert_true(placido_gpio_debounce_settle(&debounce, 700 * MS, &change));
  assert_int_equal(change.t_ns, 600 * MS); /* not the glitch's */
  assert_int_equal(change.level, 0);
}

/* Whoever reads late gets the same changes as whoever asked all the time. */
static void edges_read_late_give_the_same_changes(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  feed(&debounce, (const double[]){100, 102, 103}, 3);
  assert_true(placido_gpio_debounce_edge(&debounce, 300 * MS, 0, &change));
  assert_int_equal(change.t_ns, 100 * MS);
  assert_int_equal(change.level, 1);
  assert_true(placido_gpio_debounce_settle(&debounce, 320 * MS, &change));
  assert_int_equal(change.t_ns, 300 * MS);
  assert_int_equal(change.level, 0);
}

static void edges_just_closer_than_the_hold_belong_together(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  feed(&debounce, (const double[]){0, 19.9, 39.8, 59.7, 79.6}, 5);
  assert_true(placido_gpio_debounce_edge(&debounce, (int64_t)(99.6 * MS), 0, &change));
  assert_int_equal(change.t_ns, 0);
}

static void two_edges_seen_as_one_level_are_a_bounce(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  assert_false(placido_gpio_debounce_edge(&debounce, 10 * MS, 0, &change));
  assert_false(placido_gpio_debounce_settle(&debounce, 100 * MS, &change));
  assert_int_equal(debounce.bounce_count, 1);
  assert_int_equal(debounce.level, 0);
}

static void a_clock_that_goes_back_does_no_harm(void **state) {
  (void)state;
  placido_gpio_debounce debounce = standing_at(0);
  placido_gpio_change change;
  feed(&debounce, (const double[]){100, 90, 80}, 3);
  assert_int_equal(placido_gpio_debounce_due_ns(&debounce), 120 * MS);
  assert_true(placido_gpio_debounce_settle(&debounce, 120 * MS, &change));
  assert_int_equal(change.t_ns, 100 * MS);
}

static void without_a_hold_every_edge_counts(void **state) {
  (void)state;
  placido_gpio_debounce debounce = {0};
  placido_gpio_debounce_start(&debounce, 0);
  placido_gpio_change change;
  for (int i = 0; i < 10; i++) {
    assert_false(placido_gpio_debounce_edge(&debounce, i, !debounce.raw, &change));
    assert_true(placido_gpio_debounce_settle(&debounce, i, &change));
    assert_int_equal(change.t_ns, i);
    assert_int_equal(change.level, 1 - i % 2);
  }
  assert_int_equal(debounce.bounce_count, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_change_counts_when_the_line_has_stood_still),
      cmocka_unit_test(bounces_are_one_change_that_dates_from_the_first),
      cmocka_unit_test(a_glitch_is_no_change),
      cmocka_unit_test(edges_read_late_give_the_same_changes),
      cmocka_unit_test(edges_just_closer_than_the_hold_belong_together),
      cmocka_unit_test(two_edges_seen_as_one_level_are_a_bounce),
      cmocka_unit_test(a_clock_that_goes_back_does_no_harm),
      cmocka_unit_test(without_a_hold_every_edge_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

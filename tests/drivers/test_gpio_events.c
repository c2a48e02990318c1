/* A press of the pedal is one event at its time; triggers are numbered; an unplugged chip is gone
 * and found again. */
#include "tests/drivers/gpio_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

static void expect_event(void *chip, const char *name, int value, int64_t t_ns, uint64_t seq) {
  placido_event event;
  placido_error err = {0};
  if (driver->event(chip, &event, 2000, &err)) {
    fail_msg("%s", err.text);
  }
  assert_string_equal(event.name, name);
  assert_int_equal(event.value, value);
  assert_int_equal(event.t_ns, t_ns);
  assert_int_equal(event.seq, seq);
}

static void expect_silence(void *chip, int timeout_ms) {
  placido_event event;
  const int64_t before_ns = gpio_fake.clock_ns;
  assert_int_equal(driver->event(chip, &event, timeout_ms, NULL), PLACIDO_TIMEOUT);
  assert_int_equal(gpio_fake.clock_ns - before_ns, (int64_t)timeout_ms * FAKE_MS);
}

static void a_press_that_bounces_is_one_event_at_its_first_edge(void **state) {
  (void)state;
  static const double edges_ms[] = {100, 100.2, 101, 103, 103.1};
  for (int i = 0; i < 5; i++) {
    gpio_fake_pull(edges_ms[i], 7, 1 - i % 2);
  }
  gpio_fake_pull(400, 7, 0);
  void *chip = start_chip("/dev/gpiochip0?pedal=7&debounce_ms=20");
  expect_event(chip, "pedal", 1, at(100), 1);
  /* certain 20 ms after the last bounce; a wait is rounded up to whole milliseconds */
  assert_true(gpio_fake.clock_ns >= at(123.1) && gpio_fake.clock_ns < at(124.2));
  assert_int_equal(value_of(chip, "pedal"), 1);
  assert_int_equal(value_of(chip, "bounce_count"), 4);
  expect_event(chip, "pedal", 0, at(400), 2);
  expect_silence(chip, 300);
  driver->close(chip);
}

static void a_pedal_read_late_tells_the_same(void **state) {
  (void)state;
  gpio_fake_pull(100, 7, 1);
  gpio_fake_pull(102, 7, 0);
  gpio_fake_pull(104, 7, 1);
  gpio_fake_pull(400, 7, 0);
  gpio_fake_pull(700, 7, 1);
  void *chip = start_chip("/dev/gpiochip0?pedal=7");
  gpio_fake.clock_ns = at(2000); /* the program was busy */
  expect_event(chip, "pedal", 1, at(100), 1);
  expect_event(chip, "pedal", 0, at(400), 2);
  expect_event(chip, "pedal", 1, at(700), 3);
  expect_silence(chip, 0);
  driver->close(chip);
}

static void a_long_queue_of_bounces_is_read_to_its_end(void **state) {
  (void)state;
  for (int i = 0; i < FAKE_QUEUE - 1; i++) {
    gpio_fake_pull(100 + i * 0.5, 7, 1 - i % 2);
  }
  void *chip = start_chip("/dev/gpiochip0?pedal=7");
  gpio_fake.clock_ns = at(200);
  expect_event(chip, "pedal", 1, at(100), 1);
  assert_int_equal(value_of(chip, "bounce_count"), FAKE_QUEUE - 2);
  driver->close(chip);
}

static void a_glitch_and_a_pedal_held_at_the_start_are_no_events(void **state) {
  (void)state;
  gpio_fake.lines[7].voltage = 1;
  gpio_fake_pull(50, 7, 0);
  gpio_fake_pull(51, 7, 1);
  gpio_fake_pull(500, 7, 0);
  void *chip = start_chip("/dev/gpiochip0?pedal=7");
  assert_int_equal(value_of(chip, "pedal"), 1);
  expect_silence(chip, 400);
  expect_event(chip, "pedal", 0, at(500), 1);
  driver->close(chip);
}

static void triggers_are_numbered_however_short(void **state) {
  (void)state;
  for (int i = 0; i < 40; i++) { /* 30 Hz, 50 us long */
    gpio_fake_pull(33 * i + 1, 4, 1);
    gpio_fake_pull(33 * i + 1.05, 4, 0);
  }
  void *chip = start_chip("/dev/gpiochip0?trigger=4");
  for (int i = 0; i < 40; i++) {
    expect_event(chip, "trigger", 1, at(33 * i + 1), (uint64_t)i + 1);
  }
  expect_silence(chip, 100);
  assert_int_equal(value_of(chip, "trigger_count"), 40);
  driver->close(chip);
}

static void triggers_and_pedal_keep_their_times(void **state) {
  (void)state;
  gpio_fake_pull(100, 7, 1);
  gpio_fake_pull(110, 4, 1);
  gpio_fake_pull(200, 4, 0);
  void *chip = start_chip("/dev/gpiochip0?trigger=4&pedal=7");
  expect_event(chip, "trigger", 1, at(110), 1);
  expect_event(chip, "pedal", 1, at(100), 2); /* certain only 20 ms later */
  driver->close(chip);
  gpio_fake_pull(300, 7, 0);
  gpio_fake_pull(500, 7, 1);
  gpio_fake_pull(700, 4, 1);
  chip = start_chip("/dev/gpiochip0?trigger=4&pedal=7");
  gpio_fake.clock_ns = at(1000); /* read late, they come in the same order */
  expect_event(chip, "pedal", 0, at(300), 1);
  expect_event(chip, "trigger", 1, at(700), 2);
  expect_event(chip, "pedal", 1, at(500), 3);
  driver->close(chip);
}

static void a_gap_in_the_numbers_tells_of_lost_edges(void **state) {
  (void)state;
  for (int i = 0; i < FAKE_QUEUE + 6; i++) {
    gpio_fake_pull(i + 1, 4, 1);
    gpio_fake_pull(i + 1.5, 4, 0);
  }
  gpio_fake_pull(500, 4, 1);
  void *chip = start_chip("/dev/gpiochip0?trigger=4");
  gpio_fake.clock_ns = at(100);
  for (int i = 0; i < FAKE_QUEUE; i++) {
    expect_event(chip, "trigger", 1, at(i + 1), (uint64_t)i + 1);
  }
  expect_event(chip, "trigger", 1, at(500), FAKE_QUEUE + 6 + 1);
  placido_device_statistics counts = {0};
  driver->statistics(chip, &counts);
  assert_int_equal(counts.dropped, 6);
  driver->close(chip);
}

/* The queue is full with bounces, and the edge that releases the pedal is lost. */
static void a_lost_release_does_not_leave_the_pedal_pressed(void **state) {
  (void)state;
  gpio_fake.lines[7].voltage = 1;
  for (int i = 0; i < FAKE_QUEUE + 1; i++) {
    gpio_fake_pull(100 + i * 0.5, 7, i % 2);
  }
  void *chip = start_chip("/dev/gpiochip0?pedal=7");
  assert_int_equal(value_of(chip, "pedal"), 1);
  gpio_fake.clock_ns = at(200);
  expect_event(chip, "pedal", 0, at(200), 1); /* when it was seen */
  expect_silence(chip, 500);
  driver->close(chip);
}

static void what_came_before_the_start_is_not_told(void **state) {
  (void)state;
  gpio_fake_pull(10, 4, 1);
  gpio_fake_pull(11, 4, 0);
  gpio_fake_pull(12, 7, 1);
  void *chip = open_chip("/dev/gpiochip0?trigger=4&pedal=7");
  gpio_fake.clock_ns = at(50);
  assert_int_equal(driver->start(chip, NULL), PLACIDO_OK);
  assert_int_equal(value_of(chip, "pedal"), 1);
  expect_silence(chip, 200);
  driver->close(chip);
}

static void stamps_of_another_clock_are_refused(void **state) {
  (void)state;
  placido_event event;
  placido_error err = {0};
  gpio_fake.clock_offset_ns = 1700000000000000000;
  gpio_fake_pull(10, 4, 1);
  void *chip = start_chip("/dev/gpiochip0?trigger=4");
  assert_int_equal(driver->event(chip, &event, 100, &err), PLACIDO_UNSUPPORTED);
  assert_says(&err, "CLOCK_MONOTONIC");
  driver->close(chip);
}

static void an_unplugged_chip_is_gone_and_found_again_dark(void **state) {
  (void)state;
  placido_event event;
  placido_error err = {0};
  gpio_fake.unplug_ns = at(1000);
  void *chip = start_chip("fake?light=5&pedal=7");
  set(chip, "light", 1);
  assert_int_equal(driver->event(chip, &event, 60000, &err), PLACIDO_GONE);
  assert_says(&err, "the GPIO chip gpiochip0 (fake) is gone");
  assert_true(gpio_fake.clock_ns < at(1200)); /* not after the whole minute */
  assert_int_equal(gpio_fake.open_count, 0);  /* or the kernel could not forget the chip */
  assert_int_equal(driver->event(chip, &event, 100, NULL), PLACIDO_GONE);
  assert_int_equal(driver->set(chip, control_index(chip, "light"), 1, NULL), PLACIDO_GONE);
  assert_int_equal(driver->stop(chip, NULL), PLACIDO_OK);
  assert_int_equal(driver->start(chip, &err), PLACIDO_GONE);
  gpio_fake_replug();
  gpio_fake.path = "/dev/gpiochip3";
  gpio_fake_pull(9000, 7, 1);
  assert_int_equal(driver->start(chip, &err), PLACIDO_OK);
  assert_int_equal(gpio_fake.lines[5].voltage, 0);
  assert_int_equal(value_of(chip, "light"), 0);
  gpio_fake.clock_ns = at(8900);
  expect_event(chip, "pedal", 1, at(9000), 1);
  driver->close(chip);
}

static void a_chip_that_vanishes_while_a_light_is_switched_is_gone(void **state) {
  (void)state;
  void *chip = start_chip("fake?light=5");
  set(chip, "light", 1);
  gpio_fake_unplug();
  assert_int_equal(driver->stop(chip, NULL), PLACIDO_GONE);
  gpio_fake_replug();
  gpio_fake.label = "another";
  placido_error err = {0};
  assert_int_equal(driver->start(chip, &err), PLACIDO_GONE);
  driver->close(chip);
  gpio_fake.label = "fake";
  chip = start_chip("/dev/gpiochip0?light=5");
  gpio_fake_unplug();
  assert_int_equal(driver->set(chip, control_index(chip, "light"), 1, NULL), PLACIDO_GONE);
  gpio_fake_replug();
  gpio_fake.label = "another";
  assert_int_equal(driver->start(chip, &err), PLACIDO_SYSTEM);
  assert_says(&err, "is the GPIO chip another now, not fake");
  driver->close(chip);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(a_press_that_bounces_is_one_event_at_its_first_edge),
      TEST(a_pedal_read_late_tells_the_same),
      TEST(a_long_queue_of_bounces_is_read_to_its_end),
      TEST(a_glitch_and_a_pedal_held_at_the_start_are_no_events),
      TEST(triggers_are_numbered_however_short),
      TEST(triggers_and_pedal_keep_their_times),
      TEST(a_gap_in_the_numbers_tells_of_lost_edges),
      TEST(a_lost_release_does_not_leave_the_pedal_pressed),
      TEST(what_came_before_the_start_is_not_told),
      TEST(stamps_of_another_clock_are_refused),
      TEST(an_unplugged_chip_is_gone_and_found_again_dark),
      TEST(a_chip_that_vanishes_while_a_light_is_switched_is_gone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

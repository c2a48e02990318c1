/* What came and went is told once and in order, soon after an alarm, or every second without
 * one. */
#include "base/memory.h"
#include "drivers/hotplug/watch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#define MS 1000000ll

/* The world as the test has it: devices by letter, and alarms by time. */
static struct {
  int64_t now_ns;
  const char *there;       /* a letter a device */
  const char *later;       /* from later_ns on */
  int64_t later_ns;
  int64_t alarms_ns[8];    /* ascending; 0: no further one */
  int alarm_next;
  int looks, fails;        /* so many looks are refused */
  int64_t last_look_ns;
  int closed;
} world;

static int64_t now_ns(void) {
  return world.now_ns;
}

static void sleep_ms(int duration_ms) {
  assert_true(duration_ms > 0);
  world.now_ns += duration_ms * MS;
}

static const placido_clock played = {.now_ns = now_ns, .sleep_ms = sleep_ms};

static bool alarm_wait(void *state, int timeout_ms) {
  (void)state;
  const int64_t at_ns = world.alarms_ns[world.alarm_next];
  if (at_ns && at_ns <= world.now_ns + timeout_ms * MS) {
    world.now_ns = at_ns > world.now_ns ? at_ns : world.now_ns;
    world.alarm_next++;
    return true;
  }
  sleep_ms(timeout_ms);
  return false;
}

static void alarm_close(void *state) {
  ++*(int *)state;
}

static int look(const char *scheme,
                int (*found)(void *user, const char *uri, const char *description), void *user,
                placido_error *err) {
  assert_null(scheme);
  world.looks++;
  world.last_look_ns = world.now_ns;
  if (world.fails > 0) {
    world.fails--;
    return placido_error_set(err, PLACIDO_SYSTEM, "the bus cannot be read");
  }
  int status = PLACIDO_OK;
  const bool is_later = world.later && world.now_ns >= world.later_ns;
  for (const char *c = is_later ? world.later : world.there; !status && *c; c++) {
    char uri[8], description[16];
    snprintf(uri, sizeof uri, "v4l2:%c", *c & 0x5f);
    snprintf(description, sizeof description, "camera %c", *c); /* a and A: one node, two cameras */
    status = found(user, uri, description);
  }
  return status;
}

static placido_watch *open_watch(bool rings) {
  placido_watch *watch;
  const placido_alarm alarm = {
      .wait = rings ? alarm_wait : NULL, .close = alarm_close, .state = &world.closed};
  assert_int_equal(placido_watch_open_with(&watch, alarm, look, &played, NULL), PLACIDO_OK);
  return watch;
}

static int set_up(void **state) {
  (void)state;
  memset(&world, 0, sizeof world);
  world.now_ns = 5000 * MS;
  world.there = "";
  return 0;
}

/* The changes of the next `duration_ms`, as "+a -b". */
static const char *changes(placido_watch *watch, int duration_ms) {
  static char text[200];
  const int64_t until_ns = world.now_ns + duration_ms * MS;
  placido_change change;
  text[0] = '\0';
  for (;;) {
    const int left_ms = (int)((until_ns - world.now_ns) / MS);
    const int status = placido_watch_next(watch, &change, left_ms, NULL);
    if (status == PLACIDO_TIMEOUT) {
      assert_true(world.now_ns >= until_ns && world.now_ns <= until_ns + 2 * MS);
      return text;
    }
    assert_int_equal(status, PLACIDO_OK);
    const size_t length = strlen(text);
    snprintf(text + length, sizeof text - length, "%s%c%c", length ? " " : "",
             change.is_added ? '+' : '-', change.description[strlen("camera ")]);
  }
}

static void what_is_there_comes_first(void **state) {
  (void)state;
  world.there = "ab";
  placido_watch *watch = open_watch(true);
  assert_string_equal(changes(watch, 0), "+a +b");
  assert_string_equal(changes(watch, 60000), "");
  assert_int_equal(world.looks, 1); /* nobody looks without a reason */
  placido_watch_close(watch);
  assert_int_equal(world.closed, 1);
}

static void what_changed_is_told_soon_after_the_alarm(void **state) {
  (void)state;
  world.there = "ab";
  placido_watch *watch = open_watch(true);
  assert_string_equal(changes(watch, 0), "+a +b");
  world.alarms_ns[0] = world.now_ns + 3000 * MS;
  world.there = "bc";
  assert_string_equal(changes(watch, 3100), ""); /* the burst may not be over */
  assert_string_equal(changes(watch, 100), "-a +c");
  placido_watch_close(watch);
}

/* Permissions may come a moment after the last message. */
static void a_second_look_follows(void **state) {
  (void)state;
  placido_watch *watch = open_watch(true);
  assert_string_equal(changes(watch, 0), "");
  world.alarms_ns[0] = world.now_ns + 10 * MS;
  world.later = "a";
  world.later_ns = world.now_ns + 600 * MS;
  assert_string_equal(changes(watch, 5000), "+a");
  assert_int_equal(world.looks, 3);
  placido_watch_close(watch);
}

static void a_burst_is_one_look(void **state) {
  (void)state;
  placido_watch *watch = open_watch(true);
  changes(watch, 0);
  for (int i = 0; i < 7; i++) {
    world.alarms_ns[i] = world.now_ns + (10 + 20 * i) * MS;
  }
  const int64_t last_ns = world.alarms_ns[6];
  world.there = "a";
  assert_string_equal(changes(watch, 900), "+a");
  assert_int_equal(world.looks, 2);
  assert_true(world.last_look_ns >= last_ns + 200 * MS && world.last_look_ns <= last_ns + 210 * MS);
  placido_watch_close(watch);
}

/* A device that never is quiet does not hide the others. */
static bool ring_for_ever(void *state, int timeout_ms) {
  (void)state;
  world.now_ns += (timeout_ms < 50 ? timeout_ms : 50) * MS;
  return true;
}

static void an_endless_burst_is_looked_into(void **state) {
  (void)state;
  placido_watch *watch;
  assert_int_equal(placido_watch_open_with(&watch, (placido_alarm){.wait = ring_for_ever}, look,
                                           &played, NULL),
                   PLACIDO_OK);
  changes(watch, 0);
  world.there = "a";
  assert_string_equal(changes(watch, 1100), "+a");
  assert_string_equal(changes(watch, 10000), "");
  assert_true(world.looks <= 13);
  placido_watch_close(watch);
}

static void without_an_alarm_it_looks_every_second(void **state) {
  (void)state;
  world.there = "a";
  placido_watch *watch = open_watch(false);
  assert_string_equal(changes(watch, 0), "+a");
  world.there = "b";
  assert_string_equal(changes(watch, 900), "");
  assert_string_equal(changes(watch, 100), "-a +b");
  changes(watch, 10000);
  assert_int_equal(world.looks, 12);
  placido_watch_close(watch);
}

static void another_camera_under_the_same_name_is_told(void **state) {
  (void)state;
  world.there = "a";
  placido_watch *watch = open_watch(false);
  assert_string_equal(changes(watch, 0), "+a");
  world.there = "A";
  assert_string_equal(changes(watch, 1000), "-a +A");
  world.there = "AA"; /* one thing seen twice is one thing */
  assert_string_equal(changes(watch, 1000), "");
  placido_watch_close(watch);
}

static void a_look_that_fails_removes_nothing(void **state) {
  (void)state;
  world.there = "a";
  placido_watch *watch = open_watch(true);
  assert_string_equal(changes(watch, 0), "+a");
  world.alarms_ns[0] = world.now_ns + 1;
  world.fails = 1;
  world.there = "ab";
  placido_change change;
  placido_error err = {0};
  assert_int_equal(placido_watch_next(watch, &change, 5000, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "cannot be read"));
  assert_string_equal(changes(watch, 2000), "+b"); /* it looks again by itself */
  placido_watch_close(watch);
}

static void every_allocation_may_fail(void **state) {
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    set_up(state);
    world.there = "ab";
    placido_watch *watch;
    placido_change change;
    const placido_alarm alarm = {
        .wait = alarm_wait, .close = alarm_close, .state = &world.closed};
    placido_memory_fail_at(n);
    status = placido_watch_open_with(&watch, alarm, look, &played, NULL);
    for (int i = 0; !status && i < 2; i++) {
      status = placido_watch_next(watch, &change, 1000, NULL);
    }
    placido_memory_fail_at(0);
    placido_watch_close(watch);
    assert_int_equal(world.closed, 1);
  }
  assert_int_equal(status, PLACIDO_OK);
}

/* The system's own alarm, whatever it is here: nothing of it hangs or fails. */
static void the_real_watch_opens_and_closes(void **state) {
  (void)state;
  placido_watch *watch;
  placido_change change;
  int status;
  assert_int_equal(placido_watch_open(&watch, NULL), PLACIDO_OK);
  do {
    status = placido_watch_next(watch, &change, 10, NULL);
  } while (status == PLACIDO_OK);
  assert_int_equal(status, PLACIDO_TIMEOUT);
  placido_watch_close(watch);
  placido_watch_close(NULL);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup(name, set_up)
  const struct CMUnitTest tests[] = {
      TEST(what_is_there_comes_first),
      TEST(what_changed_is_told_soon_after_the_alarm),
      TEST(a_second_look_follows),
      TEST(a_burst_is_one_look),
      TEST(an_endless_burst_is_looked_into),
      TEST(without_an_alarm_it_looks_every_second),
      TEST(another_camera_under_the_same_name_is_told),
      TEST(a_look_that_fails_removes_nothing),
      TEST(every_allocation_may_fail),
      TEST(the_real_watch_opens_and_closes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

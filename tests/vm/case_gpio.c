/* The kernel's simulated GPIO chip (gpio-sim) through Placido's driver: lights seen from outside,
 * the pedal and the trigger pulled from outside, a program that dies, a chip that is unplugged.
 *
 *   case_gpio /dev/gpiochipN SYSFS LIVE
 *
 * SYSFS: the chip's directory in sysfs, where sim_gpioN are; LIVE: its switch in configfs. The
 * chip has 8 lines or more; line 5 is named RINGLIGHT, line 7 PEDAL. Times are asserted in their
 * order only: under emulation time is elastic. */
#include <placido/device.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* What the kernel's queue of edges holds in libgpiod 1.6, and more than it holds in 2.x. */
#define QUEUE_OLD 16
#define PULSES_MANY 400

struct test {
  const char *chip, *live;
  char sysfs[300]; /* follows the chip over a replug, which may give it another number */
  int failures;
};

__attribute__((format(printf, 3, 4))) static void expect(struct test *test, bool is_true,
                                                         const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  printf("%s: ", is_true ? "ok" : "FAILED");
  vprintf(format, arguments);
  printf("\n");
  fflush(stdout);
  va_end(arguments);
  test->failures += !is_true;
}

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void sleep_ms(int ms) {
  const struct timespec time = {ms / 1000, ms % 1000 * 1000000L};
  nanosleep(&time, NULL);
}

static bool write_file(const char *path, const char *text) {
  const int fd = open(path, O_WRONLY);
  const ssize_t length = (ssize_t)strlen(text);
  const bool is_written = fd >= 0 && write(fd, text, (size_t)length) == length;
  if (fd >= 0) {
    close(fd);
  }
  return is_written;
}

/* The voltage on a line as gpio-sim tells it; -1: cannot be read. */
static int level_of(const struct test *test, int line) {
  char path[600], text[8] = "";
  snprintf(path, sizeof path, "%s/sim_gpio%d/value", test->sysfs, line);
  FILE *file = fopen(path, "re");
  const bool is_read = file && fgets(text, sizeof text, file);
  if (file) {
    fclose(file);
  }
  return is_read ? atoi(text) : -1;
}

/* Pulls an input up or down, as a pedal's contact does. */
static void pull(struct test *test, int line, int level) {
  char path[600];
  snprintf(path, sizeof path, "%s/sim_gpio%d/pull", test->sysfs, line);
  if (!write_file(path, level ? "pull-up" : "pull-down")) {
    expect(test, false, "write %s: %s", path, strerror(errno));
  }
}

/* Opens the chip with a query; NULL and a failure where it cannot be. */
static placido_device *open_with(struct test *test, const char *address, const char *query) {
  char uri[300];
  placido_error err;
  placido_device *device;
  snprintf(uri, sizeof uri, "gpio:%s?%s", address, query);
  if (placido_device_open(&device, uri, NULL, &err)) {
    expect(test, false, "open %s: %s", uri, err.text);
  }
  return device;
}

/* The address does not open, and the sentence says why. */
static void expect_refused(struct test *test, const char *query, const char *words) {
  char uri[300];
  placido_error err = {0};
  placido_device *device;
  snprintf(uri, sizeof uri, "gpio:%s?%s", test->chip, query);
  const int status = placido_device_open(&device, uri, NULL, &err);
  expect(test, status && strstr(err.text, words), "?%s is refused: \"%s\"", query, err.text);
  placido_device_close(device);
}

static bool set(placido_device *device, const char *control, double value) {
  return placido_device_set(device, control, value, NULL) == PLACIDO_OK;
}

static int is_the_chip(void *user, const char *uri, const char *description) {
  (void)description;
  const struct test *test = user;
  return strcmp(uri + strlen("gpio:"), test->chip) == 0;
}

static void check_lights(struct test *test) {
  expect(test, placido_device_scan("gpio", is_the_chip, test, NULL) == 1, "the scan finds %s",
         test->chip);
  placido_device *device = open_with(test, test->chip, "light=5&fixation=!6&strobe=2");
  if (!device) {
    return;
  }
  expect(test, level_of(test, 5) == 0 && level_of(test, 6) == 1 && level_of(test, 2) == 0,
         "opened dark (an active-low light: high)");
  expect(test, set(device, "light", 1) && level_of(test, 5) == 1, "the ring light shines");
  expect(test, set(device, "fixation", 1) && level_of(test, 6) == 0, "the fixation light shines");
  expect(test, set(device, "light", 0) && level_of(test, 5) == 0, "the ring light is dark");
  set(device, "light", 1);
  set(device, "strobe", 1);
  placido_device_start(device, NULL);
  expect(test, level_of(test, 5) == 1, "a start leaves the light as it is");
  placido_device_stop(device, NULL);
  expect(test, level_of(test, 5) == 0 && level_of(test, 6) == 1 && level_of(test, 2) == 0,
         "a stop darkens all");
  placido_device_close(device);
}

static void check_names(struct test *test, char label[64]) {
  placido_device *device = open_with(test, test->chip, "light=5");
  snprintf(label, 64, "%s", device ? placido_device_info_get(device)->model : "");
  expect_refused(test, "light=5", "used by \"placido\"");
  placido_device_close(device);
  device = open_with(test, label, "light=RINGLIGHT&pedal=PEDAL");
  expect(test, device && set(device, "light", 1) && level_of(test, 5) == 1,
         "RINGLIGHT of the chip %s shines", label);
  placido_device_close(device);
  expect_refused(test, "light=LAMP", "no line called \"LAMP\"");
  expect_refused(test, "light=4096", "no line 4096");
  expect_refused(test, "light=5&pedal=RINGLIGHT", "both line 5");
}

/* The next event, which must be of a name and value and lie between two times. */
static void expect_event(struct test *test, placido_device *device, const char *name, int value,
                         int64_t from_ns, int64_t to_ns) {
  placido_event event;
  placido_error err = {0};
  const int status = placido_device_event(device, &event, 5000, &err);
  expect(test,
         !status && strcmp(event.name, name) == 0 && event.value == value &&
             event.t_ns >= from_ns && event.t_ns <= to_ns,
         "event %s %d, %.3f ms after its cause%s%s", name, value,
         status ? 0.0 : (double)(event.t_ns - from_ns) / 1e6, status ? ": " : "", err.text);
}

static void expect_silence(struct test *test, placido_device *device, const char *when) {
  placido_event event;
  expect(test, placido_device_event(device, &event, 300, NULL) == PLACIDO_TIMEOUT,
         "no event of %s", when);
}

static void check_pedal(struct test *test) {
  pull(test, 7, 0);
  placido_device *device = open_with(test, test->chip, "pedal=7&debounce_ms=100");
  if (!device || placido_device_start(device, NULL)) {
    expect(test, false, "start with a pedal");
    placido_device_close(device);
    return;
  }
  for (int value = 1; value >= 0; value--) {
    const int64_t before_ns = now_ns();
    pull(test, 7, value);
    expect_event(test, device, "pedal", value, before_ns, now_ns());
  }
  const int64_t before_ns = now_ns();
  pull(test, 7, 1);
  const int64_t first_ns = now_ns();
  for (int i = 0; i < 4; i++) { /* it bounces, and ends pressed */
    pull(test, 7, i % 2);
  }
  expect_event(test, device, "pedal", 1, before_ns, first_ns);
  expect_silence(test, device, "the bounces");
  double bounces = 0;
  placido_device_get(device, "bounce_count", &bounces, NULL);
  expect(test, bounces >= 1, "%g bounces counted", bounces);
  pull(test, 7, 0);
  pull(test, 7, 1);
  expect_silence(test, device, "a glitch");
  placido_device_close(device);
  device = open_with(test, test->chip, "pedal=-7&debounce_ms=0&bias=as-is");
  placido_device_start(device, NULL);
  const int64_t low_ns = now_ns();
  pull(test, 7, 0);
  expect_event(test, device, "pedal", 1, low_ns, now_ns());
  placido_device_close(device);
}

static void check_trigger(struct test *test) {
  placido_device *device = open_with(test, test->chip, "trigger=4");
  if (!device || placido_device_start(device, NULL)) {
    expect(test, false, "start with a trigger");
    placido_device_close(device);
    return;
  }
  placido_event event = {0};
  int64_t last_ns = now_ns();
  bool is_right = true;
  for (int i = 0; i < 2 * QUEUE_OLD; i++) {
    pull(test, 4, 1);
    pull(test, 4, 0);
    is_right = placido_device_event(device, &event, 5000, NULL) == PLACIDO_OK && is_right &&
               event.t_ns > last_ns && event.seq == (uint64_t)i + 1;
    last_ns = event.t_ns;
  }
  expect(test, is_right && last_ns <= now_ns(), "%d triggers, numbered, in order", 2 * QUEUE_OLD);
  expect_silence(test, device, "the trigger's ends");
  for (int i = 0; i < PULSES_MANY; i++) {
    pull(test, 4, 1);
    pull(test, 4, 0);
  }
  int given = 0;
  while (placido_device_event(device, &event, 300, NULL) == PLACIDO_OK) {
    given++;
  }
  pull(test, 4, 1);
  pull(test, 4, 0);
  placido_device_event(device, &event, 5000, NULL);
  placido_device_statistics counts;
  placido_device_statistics_get(device, &counts);
  expect(test,
         given >= QUEUE_OLD && given < PULSES_MANY && counts.dropped > 0 &&
             event.seq == 2 * QUEUE_OLD + (uint64_t)given + 1 + counts.dropped,
         "of %d triggers that nobody took %d were kept, and the numbers tell of the loss",
         PULSES_MANY, given);
  placido_device_close(device);
}

/* A program that dies with the light on: what becomes of it is the chip's, and the next open
 * darkens it. */
static void check_killed(struct test *test) {
  int ready[2];
  char byte;
  if (pipe(ready)) {
    expect(test, false, "pipe: %s", strerror(errno));
    return;
  }
  const pid_t child = fork();
  if (child == 0) {
    placido_device *device = open_with(test, test->chip, "light=5");
    const bool is_lit = device && set(device, "light", 1) && write(ready[1], "!", 1) == 1;
    while (is_lit) {
      pause();
    }
    _exit(1);
  }
  close(ready[1]);
  const bool is_lit = read(ready[0], &byte, 1) == 1 && level_of(test, 5) == 1;
  close(ready[0]);
  kill(child, SIGKILL);
  waitpid(child, NULL, 0);
  printf("note: killed with the light on, gpio-sim leaves the line at %d\n", level_of(test, 5));
  placido_device *device = open_with(test, test->chip, "light=5");
  expect(test, is_lit && device && level_of(test, 5) == 0,
         "after a program that was killed, the next open darkens the light");
  placido_device_close(device);
}

/* The chip's directory lies in its device's, which keeps its name. */
static void follow_chip(struct test *test) {
  char *name = strrchr(test->sysfs, '/');
  *name++ = '\0';
  DIR *directory = opendir(test->sysfs);
  const struct dirent *entry;
  name[-1] = '/';
  while (directory && (entry = readdir(directory))) {
    if (strncmp(entry->d_name, "gpiochip", strlen("gpiochip")) == 0) {
      snprintf(name, sizeof test->sysfs - (size_t)(name - test->sysfs), "%s", entry->d_name);
    }
  }
  if (directory) {
    closedir(directory);
  }
}

/* Plugs the chip in again; true once the device has found it. */
static bool replug(struct test *test, placido_device *device) {
  placido_error err = {0};
  expect(test, write_file(test->live, "1"), "%s takes 1", test->live);
  int status = PLACIDO_GONE;
  for (int i = 0; i < 100 && status; i++) {
    sleep_ms(50);
    status = placido_device_start(device, &err);
  }
  follow_chip(test);
  expect(test, status == PLACIDO_OK, "found again in %s%s%s", test->sysfs, status ? ": " : "",
         status ? err.text : "");
  return status == PLACIDO_OK;
}

static void check_unplugged(struct test *test, const char *label) {
  placido_device *device = open_with(test, label, "light=5&pedal=7");
  if (!device || placido_device_start(device, NULL)) {
    expect(test, false, "start before the unplugging");
    placido_device_close(device);
    return;
  }
  set(device, "light", 1);
  const pid_t child = fork();
  if (child == 0) {
    sleep_ms(500);
    _exit(!write_file(test->live, "0"));
  }
  placido_event event;
  placido_error err = {0};
  const int64_t before_ns = now_ns();
  const int status = placido_device_event(device, &event, 20000, &err);
  expect(test, status == PLACIDO_GONE && now_ns() - before_ns < 10000000000,
         "unplugged while it waits, after %.1f s: \"%s\"", (double)(now_ns() - before_ns) / 1e9,
         err.text);
  int exit_status = 1;
  waitpid(child, &exit_status, 0);
  expect(test, exit_status == 0, "%s takes 0", test->live);
  expect(test, placido_device_set(device, "light", 1, &err) == PLACIDO_GONE,
         "switching then: \"%s\"", err.text);
  placido_device_stop(device, NULL);
  expect(test, placido_device_start(device, &err) == PLACIDO_GONE, "starting then: \"%s\"",
         err.text);
  if (!replug(test, device)) {
    placido_device_close(device);
    return;
  }
  expect(test, level_of(test, 5) == 0, "the light comes back dark");
  const int64_t pressed_ns = now_ns();
  pull(test, 7, 1);
  expect_event(test, device, "pedal", 1, pressed_ns, now_ns());
  placido_device_close(device);
}

int main(int count, char **arguments) {
  if (count != 4) {
    fprintf(stderr, "usage: case_gpio /dev/gpiochipN SYSFS LIVE\n");
    return 2;
  }
  struct test test = {.chip = arguments[1], .live = arguments[3]};
  char label[64];
  snprintf(test.sysfs, sizeof test.sysfs, "%s", arguments[2]);
  setvbuf(stdout, NULL, _IOLBF, 0);
  check_lights(&test);
  check_names(&test, label);
  check_pedal(&test);
  check_trigger(&test);
  check_killed(&test);
  check_unplugged(&test, label);
  printf("%d failed\n", test.failures);
  return test.failures ? 1 : 0;
}

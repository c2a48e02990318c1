/* udev is told of every row of the drivers' tables, in words that it understands, and nothing is
 * opened to everybody. */
#include "udev/rules.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef int writer(FILE *file, const placido_driver *const *drivers, size_t count,
                   placido_error *err);

/* What a writer writes of some drivers; free with free. */
static char *text_of(writer *write, const placido_driver *const *drivers, size_t count) {
  char *text = NULL;
  size_t size;
  placido_error err = {0};
  FILE *file = open_memstream(&text, &size);
  assert_non_null(file);
  if (write(file, drivers, count, &err)) {
    fail_msg("%s", err.text);
  }
  fclose(file);
  return text;
}

static void assert_line(const char *text, const char *line) {
  const size_t length = strlen(line);
  for (const char *at = text; at; at = strchr(at, '\n')) {
    at += *at == '\n';
    if (strncmp(at, line, length) == 0 && (at[length] == '\n' || !at[length])) {
      return;
    }
  }
  fail_msg("no line\n%s\nin\n%s", line, text);
}

static const placido_match camera_rows[] = {
    {.subsystem = "usb",
     .usb_class = 0xef,
     .usb_subclass = 5,
     .link = "camera-$env{ID_SERIAL_SHORT}",
     .group = "plugdev"},
    {.subsystem = NULL}};
static const placido_match light_rows[] = {{.subsystem = "gpio",
                                            .usb_class = -1,
                                            .usb_subclass = -1,
                                            .only = "KERNEL==\"gpiochip*\"",
                                            .link = "light-%k"},
                                           {.subsystem = NULL}};
static const placido_driver camera = {
    .scheme = "cam", .summary = "a camera", .matches = camera_rows};
static const placido_driver light = {.scheme = "lit", .summary = "a light", .matches = light_rows};
static const placido_driver file_only = {.scheme = "file", .summary = "no device"};
static const placido_driver *const some[] = {&camera, &file_only, &light};

static void rows_become_rules(void **state) {
  (void)state;
  char *text = text_of(placido_udev_rules, some, 3);
#define IS_CAMERA \
  "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", ENV{ID_USB_INTERFACES}==\"*:ef05??:*\", "
  assert_line(text, IS_CAMERA
              "TAG+=\"uaccess\", ENV{ID_PLACIDO_DRIVER}=\"cam\", GROUP=\"plugdev\"");
  assert_line(text, IS_CAMERA "ENV{ID_SERIAL_SHORT}==\"?*\", "
                              "SYMLINK+=\"placido/camera-$env{ID_SERIAL_SHORT}\"");
  assert_line(text,
              IS_CAMERA "ENV{ID_PATH}==\"?*\", SYMLINK+=\"placido/camera-$env{ID_PATH}\"");
  assert_line(text, "ACTION==\"add\", " IS_CAMERA
                    "TEST==\"power/control\", ATTR{power/control}=\"on\"");
  assert_line(text, "SUBSYSTEM==\"gpio\", KERNEL==\"gpiochip*\", TAG+=\"uaccess\", "
                    "ENV{ID_PLACIDO_DRIVER}=\"lit\"");
  assert_line(text, "SUBSYSTEM==\"gpio\", KERNEL==\"gpiochip*\", SYMLINK+=\"placido/light-%k\"");
  assert_null(strstr(text, "file"
                           ": "));
  free(text);
  text = text_of(placido_udev_hwdb, some, 3);
  assert_line(text, "usb:v*p*d*dc*dsc*dp*icEFisc05ip*");
  assert_line(text, " ID_PLACIDO_DRIVER=cam");
  assert_null(strstr(text, "lit"));
  free(text);
  text = text_of(placido_udev_groups, some, 3);
  assert_line(text, "g plugdev -");
  free(text);
}

static void a_row_that_breaks_out_of_its_rule_is_refused(void **state) {
  (void)state;
  static const placido_match bad[] = {
      {.subsystem = "usb\"", .usb_class = 1, .usb_subclass = 1},
      {.subsystem = "", .usb_class = -1, .usb_subclass = -1},
      {.subsystem = "usb", .usb_class = -1, .usb_subclass = -1}, /* that is every USB device */
      {.subsystem = "gpio", .usb_class = 3, .usb_subclass = -1},
      {.subsystem = "usb", .usb_class = 256, .usb_subclass = 0},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .group = "a\", MODE=\"0666"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "../sda"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = ".."},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = ""},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "a\" RUN+=\"x"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "a-$result"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "a-$env{X"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .link = "a-$env{}"},
      {.subsystem = "gpio", .usb_class = -1, .usb_subclass = -1, .only = "A==\"b\"\nC==\"d\""},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const placido_match rows[] = {bad[i], {.subsystem = NULL}};
    const placido_driver driver = {.scheme = "bad", .summary = "bad", .matches = rows};
    const placido_driver *const table[] = {&driver};
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    placido_error err = {0};
    if (placido_udev_rules(file, table, 1, &err) != PLACIDO_INPUT) {
      fail_msg("row %zu was taken", i);
    }
    assert_non_null(strstr(err.text, "the driver bad"));
    fclose(file);
    assert_null(strstr(text, "MODE"));
    free(text);
  }
}

static void what_cannot_be_written_is_told(void **state) {
  (void)state;
  FILE *file = fopen("/dev/full", "w");
  if (!file) {
    skip();
  }
  placido_error err = {0};
  assert_int_equal(placido_udev_rules(file, some, 3, &err), PLACIDO_SYSTEM);
  fclose(file);
}

/* The drivers of this build. */
static void every_driver_of_hardware_is_in_the_rules(void **state) {
  (void)state;
  size_t count, rows = 0;
  const placido_driver *const *drivers = placido_driver_table(&count);
  char *rules = text_of(placido_udev_rules, drivers, count);
  char *hwdb = text_of(placido_udev_hwdb, drivers, count);
  char *groups = text_of(placido_udev_groups, drivers, count);
  for (size_t i = 0; i < count; i++) {
    char mark[100];
    snprintf(mark, sizeof mark, "ENV{ID_PLACIDO_DRIVER}=\"%s\"", drivers[i]->scheme);
    assert_true((drivers[i]->matches != NULL) == (strstr(rules, mark) != NULL));
    const placido_match *row = drivers[i]->matches;
    for (; row && row->subsystem; row++, rows++) {
      if (row->group) {
        snprintf(mark, sizeof mark, "g %s -", row->group);
        assert_line(groups, mark);
      }
      if (row->usb_class >= 0) {
        snprintf(mark, sizeof mark, "ic%02Xisc", (unsigned)row->usb_class);
        assert_non_null(strstr(hwdb, mark));
      }
    }
  }
  assert_true(rows >= 1);
  free(rules);
  free(hwdb);
  free(groups);
}

/* One "KEY{attribute}OPERATOR"value"" of a rule; returns what stands behind it. */
struct term {
  char key[64], operator[3], value[300];
};

static const char *read_term(struct term *term, const char *at) {
  memset(term, 0, sizeof *term);
  size_t length = strspn(at, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
  const size_t key = length;
  if (at[length] == '{') {
    length = (size_t)(strchr(at, '}') - at) + 1;
  }
  assert_true(length > 0 && length < sizeof term->key);
  memcpy(term->key, at, key);
  at += length;
  static const char *const operators[] = {"==", "!=", "+=", "="};
  for (size_t i = 0; i < 4 && !term->operator[0]; i++) {
    if (strncmp(at, operators[i], strlen(operators[i])) == 0) {
      memcpy(term->operator, operators[i], strlen(operators[i]));
    }
  }
  assert_true(term->operator[0]);
  at += strlen(term->operator);
  assert_int_equal(*at, '"');
  const char *end = strchr(at + 1, '"');
  assert_non_null(end);
  assert_true(end > at + 1 && (size_t)(end - at) < sizeof term->value);
  memcpy(term->value, at + 1, (size_t)(end - at) - 1);
  return end + 1;
}

/* man 7 udev: which keys there are, and whether they are compared or assigned. */
static void check_term(const struct term *term) {
  static const struct {
    const char *key;
    bool compares, assigns;
  } known[] = {
      {"ACTION", true, false}, {"SUBSYSTEM", true, false}, {"KERNEL", true, false},
      {"ENV", true, true},     {"ATTR", true, true},       {"TEST", true, false},
      {"TAG", true, true},     {"GROUP", false, true},     {"SYMLINK", true, true},
      {"GOTO", false, true},   {"LABEL", false, true},
  };
  const bool compares = term->operator[1] == '=' && term->operator[0] != '+';
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    if (strcmp(known[i].key, term->key) == 0) {
      assert_true(compares ? known[i].compares : known[i].assigns);
      return;
    }
  }
  fail_msg("%s is no key of these rules", term->key); /* MODE and RUN among them */
}

/* The file that the build made is what udev can read. */
static void the_built_file_is_in_udevs_grammar(void **state) {
  (void)state;
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  char *expected = text_of(placido_udev_rules, drivers, count);
  FILE *file = fopen(PLACIDO_UDEV_BUILT "/60-placido.rules", "r");
  assert_non_null(file);
  char *line = NULL;
  size_t size = 0, offset = 0;
  int terms = 0, labels = 0, gotos = 0;
  ssize_t length;
  while ((length = getline(&line, &size, file)) > 0) {
    assert_memory_equal(line, expected + offset, (size_t)length);
    offset += (size_t)length;
    const char *at = line;
    while (*line != '#' && *at != '\n') {
      struct term term;
      at = read_term(&term, at);
      check_term(&term);
      terms++;
      labels += strcmp(term.key, "LABEL") == 0;
      gotos += strcmp(term.key, "GOTO") == 0;
      assert_true(*at == '\n' || strncmp(at, ", ", 2) == 0);
      at += *at == ',' ? 2 : 0;
    }
  }
  assert_int_equal(offset, strlen(expected));
  assert_true(terms > 5);
  assert_int_equal(labels, 1);
  assert_int_equal(gotos, 1);
  free(line);
  free(expected);
  fclose(file);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_become_rules),
      cmocka_unit_test(a_row_that_breaks_out_of_its_rule_is_refused),
      cmocka_unit_test(what_cannot_be_written_is_told),
      cmocka_unit_test(every_driver_of_hardware_is_in_the_rules),
      cmocka_unit_test(the_built_file_is_in_udevs_grammar),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

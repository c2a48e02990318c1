/* A chip found by its node or label, and its lines by number or name. */
#include "drivers/gpio/chip.h"

#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The search for one chip by its label, or by the kernel's name for it. */
struct search {
  const placido_gpio_lines *lines;
  const char *label;
  char path[64]; /* of the first that fits */
  int count;
  char refused[64]; /* a chip that could not be asked */
  int code;
};

static int compare(void *user, const char *path) {
  struct search *search = user;
  void *chip;
  placido_gpio_chip_info info;
  int code = search->lines->open(&chip, path);
  if (!code) {
    code = search->lines->chip_info(chip, &info);
    search->lines->close(chip);
  }
  if (code) {
    search->code = code;
    snprintf(search->refused, sizeof search->refused, "%s", path);
  } else if (strcmp(info.label, search->label) == 0 || strcmp(info.name, search->label) == 0) {
    if (search->count++ == 0) {
      snprintf(search->path, sizeof search->path, "%s", path);
    }
  }
  return 0;
}

static int find_label(char path[1024], const char *label, const placido_gpio_lines *lines,
                      placido_error *err) {
  struct search search = {.lines = lines, .label = label};
  lines->list(compare, &search);
  if (search.count == 0 && search.code) {
    char why[200];
    placido_gpio_chip_refusal(why, search.refused, search.code);
    return placido_error_set(err, PLACIDO_SYSTEM, "no GPIO chip \"%.100s\" found; %s", label, why);
  }
  if (search.count == 0) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "no GPIO chip \"%.100s\" is there (placido devices lists them)",
                             label);
  }
  if (search.count > 1) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d GPIO chips are called \"%.100s\"; name the one by its node, such "
                             "as gpio:%s",
                             search.count, label, search.path);
  }
  snprintf(path, 1024, "%s", search.path);
  return PLACIDO_OK;
}

void placido_gpio_chip_refusal(char text[200], const char *path, int code) {
  const char *tail = placido_text_tail(path);
  if (code == EACCES || code == EPERM) {
    snprintf(text, 200,
             "cannot open %s: %s (be in the group gpio, or install Placido's udev rules)", tail,
             strerror(code));
  } else if (code == ENODEV || code == ENOTTY) {
    snprintf(text, 200, "%s is not a GPIO chip", tail);
  } else {
    snprintf(text, 200, "cannot open %s: %s", tail, strerror(code));
  }
}

int placido_gpio_chip_open(placido_gpio_chip *chip, const char *address,
                           const placido_gpio_lines *lines, placido_error *err) {
  *chip = (placido_gpio_chip){.lines = lines};
  if (!*address || strlen(address) >= sizeof chip->path) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "\"gpio:%.100s\" is not gpio:/dev/gpiochipN or gpio:LABEL", address);
  }
  if (*address == '/') {
    snprintf(chip->path, sizeof chip->path, "%s", address);
  } else {
    const int status = find_label(chip->path, address, lines, err);
    if (status) {
      return status;
    }
  }
  int code = lines->open(&chip->chip, chip->path);
  if (!code) {
    code = lines->chip_info(chip->chip, &chip->info);
  }
  if (code) {
    placido_gpio_chip_close(chip);
    char why[200];
    placido_gpio_chip_refusal(why, chip->path, code);
    return placido_error_set(err, PLACIDO_SYSTEM, "%s", why);
  }
  placido_text_line(chip->info.name);
  placido_text_line(chip->info.label);
  return PLACIDO_OK;
}

void placido_gpio_chip_close(placido_gpio_chip *chip) {
  if (chip->chip) {
    chip->lines->close(chip->chip);
  }
  chip->chip = NULL;
}

bool placido_gpio_chip_is_there(const placido_gpio_chip *chip) {
  placido_gpio_line_info info;
  return chip->chip && chip->lines->line_info(chip->chip, 0, &info) == 0;
}

static int find_number(const placido_gpio_chip *chip, const char *digits, unsigned *offset,
                       placido_error *err) {
  const unsigned number = strlen(digits) <= 6 ? (unsigned)atoi(digits) : chip->info.line_count;
  if (number >= chip->info.line_count) {
    return placido_error_set(err, PLACIDO_INPUT, "%s (%s) has %u lines from 0, and no line %.20s",
                             chip->info.name, chip->info.label, chip->info.line_count, digits);
  }
  *offset = number;
  return PLACIDO_OK;
}

int placido_gpio_chip_find(const placido_gpio_chip *chip, const char *line, unsigned *offset,
                           placido_error *err) {
  *offset = 0;
  if (strspn(line, "0123456789") == strlen(line)) {
    return find_number(chip, line, offset, err);
  }
  int count = 0;
  for (unsigned i = 0; i < chip->info.line_count; i++) {
    placido_gpio_line_info info;
    const int code = chip->lines->line_info(chip->chip, i, &info);
    if (code) {
      return placido_gpio_chip_failed(chip, "looking for lines", code, err);
    }
    if (strcmp(info.name, line) == 0 && count++ == 0) {
      *offset = i;
    }
  }
  return count == 1 ? PLACIDO_OK
                    : placido_error_set(err, PLACIDO_INPUT, "%s (%s) has %s line called \"%s\"",
                                        chip->info.name, chip->info.label,
                                        count ? "more than one" : "no", line);
}

int placido_gpio_chip_failed(const placido_gpio_chip *chip, const char *action, int code,
                             placido_error *err) {
  if (!placido_gpio_chip_is_there(chip)) {
    return placido_error_set(err, PLACIDO_GONE, "the GPIO chip %s (%s) is gone: unplugged",
                             chip->info.name, chip->info.label);
  }
  return placido_error_set(err, PLACIDO_SYSTEM, "%s: GPIO chip %s (%s): %s", action,
                           chip->info.name, chip->info.label, strerror(code));
}

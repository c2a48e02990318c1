/* An id that tells nothing of whose it is: names do not fit its alphabet, and dates are refused. */
#include "acquire/cli/subject_id.h"

#include <stdbool.h>
#include <string.h>

#define DIGITS "0123456789"
#define LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
#define YEAR_MIN 1880
#define YEAR_MAX 2100

static int read_digits(const char *text, size_t count) {
  int value = 0;
  for (size_t i = 0; i < count; i++) {
    value = 10 * value + (text[i] - '0');
  }
  return value;
}

static bool is_day(int year, int first, int second) {
  const bool day_first = first >= 1 && first <= 31 && second >= 1 && second <= 12;
  const bool month_first = first >= 1 && first <= 12 && second >= 1 && second <= 31;
  return year >= YEAR_MIN && year <= YEAR_MAX && (day_first || month_first);
}

/* 19700131 or 31011970. */
static bool is_plain_date(const char *run) {
  return is_day(read_digits(run, 4), read_digits(run + 4, 2), read_digits(run + 6, 2)) ||
         is_day(read_digits(run + 4, 4), read_digits(run, 2), read_digits(run + 2, 2));
}

/* 1970-01-31 or 31_1_1970, at the beginning of `text`. */
static bool is_split_date(const char *text) {
  int values[3];
  size_t lengths[3];
  for (int i = 0; i < 3; i++) {
    lengths[i] = strspn(text, DIGITS);
    if (lengths[i] < 1 || lengths[i] > 4 || lengths[i] == 3) {
      return false;
    }
    values[i] = read_digits(text, lengths[i]);
    text += lengths[i];
    if (i < 2 && *text != '-' && *text != '_') {
      return false;
    }
    text += i < 2;
  }
  return (lengths[0] == 4 && lengths[1] < 3 && lengths[2] < 3 &&
          is_day(values[0], values[1], values[2])) ||
         (lengths[2] == 4 && lengths[0] < 3 && lengths[1] < 3 &&
          is_day(values[2], values[0], values[1]));
}

static bool holds_date(const char *id) {
  while (*id) {
    const size_t length = strspn(id, DIGITS);
    if ((length == 8 && is_plain_date(id)) || (length > 0 && is_split_date(id))) {
      return true;
    }
    id += length > 0 ? length : 1;
  }
  return false;
}

int subject_id_check(const char *id, placido_error *err) {
  const size_t length = strlen(id);
  if (length == 0 || length > SUBJECT_ID_MAX || strspn(id, LETTERS DIGITS "-_") != length) {
    return placido_error_set(err, STATUS_USAGE,
                             "--subject is an opaque id of 1 to %d letters, digits, - and _: a "
                             "name is never stored, because pictures of an eye are personal data",
                             SUBJECT_ID_MAX);
  }
  if (holds_date(id)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--subject %s holds what looks like a date: a date of birth is never "
                             "stored, because it tells who it is; choose another id",
                             id);
  }
  return PLACIDO_OK;
}

int parse_eye(void *field, const struct option_row *row, const char *text, placido_error *err) {
  if (strcmp(text, "OD") != 0 && strcmp(text, "OS") != 0) {
    return placido_error_set(err, STATUS_USAGE,
                             "--%s %s: OD (the right) or OS (the left) was expected", row->name,
                             text);
  }
  return parse_text(field, row, text, err);
}

int parse_subject(void *field, const struct option_row *row, const char *text, placido_error *err) {
  const int status = subject_id_check(text, err);
  return status == PLACIDO_OK ? parse_text(field, row, text, err) : status;
}

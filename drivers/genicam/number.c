/* Numbers of a camera's description, from text and rounded. */
#include "drivers/genicam/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

struct number placido_genicam_whole(int64_t value) {
  return (struct number){.is_whole = true, .whole = value, .real = (double)value};
}

struct number placido_genicam_real(double value) {
  return (struct number){.real = value};
}

bool placido_genicam_round(const struct number *number, int64_t *value) {
  *value = number->whole;
  if (number->is_whole) {
    return true;
  }
  const double limit = 0x1p63; /* the first that does not fit */
  if (!(number->real >= -limit && number->real < limit)) {
    return false;
  }
  *value = llround(number->real);
  return true;
}

static bool read_word(struct number *number, const char *text) {
  static const struct {
    const char *word;
    int64_t value;
  } words[] = {{"true", 1}, {"false", 0}, {"True", 1}, {"False", 0}};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    if (strcmp(text, words[i].word) == 0) {
      *number = placido_genicam_whole(words[i].value);
      return true;
    }
  }
  return false;
}

/* Digits behind the sign, decimal (never octal: 010 is ten) or hexadecimal. */
static bool read_whole(struct number *number, const char *text) {
  const bool is_negative = *text == '-';
  text += *text == '-' || *text == '+';
  const bool is_hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
  text += is_hexadecimal ? 2 : 0;
  if (!(is_hexadecimal ? isxdigit((unsigned char)*text) : isdigit((unsigned char)*text))) {
    return false;
  }
  char *end;
  errno = 0;
  const unsigned long long magnitude = strtoull(text, &end, is_hexadecimal ? 16 : 10);
  if (*end || errno) {
    return false;
  }
  const uint64_t wrapped = is_negative ? 0 - (uint64_t)magnitude : (uint64_t)magnitude;
  *number = (struct number){.is_whole = true,
                            .whole = (int64_t)wrapped,
                            .real = is_negative ? -(double)magnitude : (double)magnitude};
  return true;
}

bool placido_genicam_number_read(struct number *number, const char *text) {
  *number = (struct number){0};
  if (read_word(number, text) || read_whole(number, text)) {
    return true;
  }
  if (!*text || isspace((unsigned char)*text)) {
    return false;
  }
  char *end;
  const double value = strtod(text, &end);
  if (*end || isnan(value)) {
    return false;
  }
  *number = placido_genicam_real(value);
  return true;
}

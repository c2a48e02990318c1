/* Numbers and units as people read them. */
#include "report/number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define MEASURE_DECIMALS_MAX 5 /* nothing here is known, or of use, beyond */

void placido_number_write(char *text, size_t size, double value, int decimals) {
  if (!isfinite(value) || fabs(value) >= 1e15) { /* no quantity here is that large */
    snprintf(text, size, isfinite(value) ? "%.3g" : "–", value);
    return;
  }
  char digits[40];
  snprintf(digits, sizeof digits, "%.*f", decimals, fabs(value));
  bool zero = strspn(digits, "0.") == strlen(digits);
  snprintf(text, size, "%s%s", value < 0 && !zero ? "−" : "", digits);
}

/* Decimals that leave `digits` significant ones of a value. */
static int decimals_of(double value, int digits) {
  if (!isfinite(value) || value == 0) {
    return digits - 1;
  }
  double wanted = digits - 1 - floor(log10(fabs(value)));
  return (int)fmin(fmax(wanted, 0), 9);
}

void placido_number_significant(char *text, size_t size, double value, int digits) {
  placido_number_write(text, size, value, decimals_of(value, digits));
}

void placido_number_measure(char *text, size_t size, double value, double sigma) {
  if (!isfinite(sigma) || sigma <= 0 || !isfinite(value)) {
    placido_number_significant(text, size, value, 4);
    return;
  }
  int decimals = (int)fmin(decimals_of(sigma, 2), MEASURE_DECIMALS_MAX);
  double least = pow(10, -MEASURE_DECIMALS_MAX);
  char middle[PLACIDO_NUMBER_SIZE], error[PLACIDO_NUMBER_SIZE];
  placido_number_write(middle, sizeof middle, value, decimals);
  placido_number_write(error, sizeof error, fmax(sigma, least), decimals);
  snprintf(text, size, "%s ± %s%s", middle, sigma < least ? "<" : "", error);
}

const char *placido_unit_text(const char *unit) {
  static const struct {
    const char *plain, *text;
  } units[] = {
      {"um", "µm"},
      {"mm^-2", "mm⁻²"},
      {"deg", "°"},
      {"percent", "%"},
  };
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
    if (strcmp(unit, units[i].plain) == 0) {
      return units[i].text;
    }
  }
  return unit;
}

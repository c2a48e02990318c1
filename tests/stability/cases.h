/* Rows of the table for cases of optics and images: what came out, or how it was refused. */
#ifndef PLACIDO_TESTS_STABILITY_CASES_H
#define PLACIDO_TESTS_STABILITY_CASES_H

#include <placido/status.h>
#include <stddef.h>

/* A case with a bound, without a figure against extended precision. The unit is of the change. */
struct bounded {
  double condition;            /* NaN: does not apply */
  double perturbation;         /* likewise */
  const char *in_unit;
  double change;
  const char *out_unit;
  double bound;
};

/* Adds its row; the name is made as printf does. */
void case_bounded(const struct bounded *bounded, const char *name, ...)
  __attribute__((format(printf, 2, 3)));

/* Fails the test unless `status` is `expected` and the message is a sentence that has `words`. */
void case_refused(int status, int expected, const placido_error *err, const char *words,
                  const char *name, ...) __attribute__((format(printf, 5, 6)));

/* How many of `count` samples are not finite. */
size_t count_spoilt(const float *samples, size_t count);

#endif

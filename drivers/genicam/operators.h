/* The operators and functions of formulas, as tables. */
#ifndef PLACIDO_DRIVERS_GENICAM_OPERATORS_H
#define PLACIDO_DRIVERS_GENICAM_OPERATORS_H

#include "drivers/genicam/number.h"

#include <stdbool.h>
#include <stddef.h>

/* An operator between two numbers. The signs -x, +x and ~x hold tighter than any of them. */
struct operator_row {
  const char *text;
  int precedence;     /* the higher, the tighter */
  bool is_from_right; /* a ** b ** c is a ** (b ** c) */
  enum { LAZY_NO, LAZY_AND, LAZY_OR } lazy; /* the right side may not matter */
  /* Of 64-bit integers, which wrap around. Returns NULL, or why there is no result. */
  const char *(*whole)(int64_t a, int64_t b, int64_t *result);
  /* NULL: an operator of integers, which the numbers must be. */
  double (*real)(double a, double b);
};

/* The operator at the beginning of `text`; NULL where there is none. */
const struct operator_row *placido_genicam_operator(const char *text);

/* Applies it to two numbers of the same kind. Returns NULL or why there is no result. */
const char *placido_genicam_apply(const struct operator_row *row, const struct number *a,
                                  const struct number *b, struct number *result);

#define PLACIDO_GENICAM_ARGUMENTS_MAX 2

/* Calls the function of that name (of any case) with `count` numbers of the same kind. Returns
 * NULL or why there is no result; *is_known tells whether there is such a function. */
const char *placido_genicam_call(const char *name, size_t length, bool is_whole,
                                 const struct number *arguments, size_t count,
                                 struct number *result, bool *is_known);

#endif

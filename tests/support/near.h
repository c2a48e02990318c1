/* Comparison of doubles: cmocka 1.1.5 compares floats only. */
#ifndef PLACIDO_TESTS_NEAR_H
#define PLACIDO_TESTS_NEAR_H

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

/* NaN is near nothing. A macro, for the place of the call. */
#define assert_near(value, expected, tolerance)                                                    \
  assert_near_at((value), (expected), (tolerance), #value, __FILE__, __LINE__)

static inline void assert_near_at(double value, double expected, double tolerance, const char *what,
                                  const char *file, int line) {
  if (!(fabs(value - expected) <= tolerance)) {
    print_error("%s is %.17g, %.17g within %g is expected\n", what, value, expected, tolerance);
    _fail(file, line);
  }
}

#endif

/* Formulas as textbooks have them, in extended precision, and how far the program's numbers may be
 * from them. For gcc with libquadmath only.
 *
 * Every operation rounds by at most half a unit, u. A computation of k operations is as good as its
 * problem allows where its error is what k roundings of every number that goes in, and as many of
 * what comes out, would make of it (Higham, Accuracy and Stability of Numerical Algorithms, 2nd
 * ed., 1.6 and 3.1):
 *
 *   |error| <= k u (Σ |x_i ∂f/∂x_i| + |f|)
 *
 * That is the bound everywhere: the sum over |f| is the condition, and k is counted from the
 * formula. A formula that cancels where its problem does not is beyond it. */
#ifndef PLACIDO_TESTS_STABILITY_EXACT_H
#define PLACIDO_TESTS_STABILITY_EXACT_H

#include <quadmath.h>
#include <stddef.h>

__extension__ typedef __float128 quad;

/* A decimal number as it is written, to the last digit. */
#define EXACT(number) strtoflt128(#number, NULL)

/* One number that the program computes. */
struct exact {
  const char *name;
  quad (*formula)(const quad *x, const void *context);
  int inputs;    /* how many numbers x has */
  int roundings; /* k: operations on the longest way through the program's formula */
  double unit;   /* spacing of the type's numbers at 1: DBL_EPSILON or FLT_EPSILON */
};

/* Of all comparisons the one nearest to its bound, or farthest beyond. */
struct exact_worst {
  double share; /* of the bound */
  double error_ulp, bound_ulp, condition;
  long count;
};

/* Compares what was computed from x with the formula. */
void exact_compare(struct exact_worst *worst, const struct exact *exact, const double *x,
                   const void *context, double computed);

/* Σ |x_i ∂f/∂x_i| + |f| where f is `value`. */
quad exact_amplification(const struct exact *exact, const quad *x, const void *context, quad value);

/* The same for a value and amplification Σ |x_i ∂f/∂x_i| + |f| that are known. */
void exact_compare_value(struct exact_worst *worst, const struct exact *exact, quad value,
                         quad amplification, double computed);

/* Adds the row of what was compared; there must have been something. */
void exact_row(const struct exact *exact, const struct exact_worst *worst);

/* π, which std=c11 has no constant for. */
quad exact_pi(void);

#endif

/* Errors in units of the last place, conditions by central differences in extended precision. */
#include "tests/stability/exact.h"

#include "tests/stability/table.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#define INPUTS_MAX 64
#define STEP_EXPONENT -50 /* of a number's relative step: about the next double */

quad exact_pi(void) {
  return acosq(-1);
}

quad exact_amplification(const struct exact *exact, const quad *x, const void *context,
                         quad value) {
  quad moved[INPUTS_MAX], sum = fabsq(value);
  assert_true(exact->inputs <= INPUTS_MAX);
  for (int i = 0; i < exact->inputs; i++) {
    moved[i] = x[i];
  }
  for (int i = 0; i < exact->inputs; i++) {
    quad step = ldexpq(x[i], STEP_EXPONENT);
    moved[i] = x[i] + step;
    quad above = exact->formula(moved, context);
    moved[i] = x[i] - step;
    quad below = exact->formula(moved, context);
    moved[i] = x[i];
    sum += fabsq(ldexpq(above - below, -STEP_EXPONENT - 1));
  }
  return sum;
}

/* The spacing of the type's numbers at a value; that of the denormal ones below all others. */
static quad place_of(quad value, double unit) {
  quad least = unit == DBL_EPSILON ? (quad)DBL_MIN * DBL_EPSILON : (quad)FLT_MIN * FLT_EPSILON;
  quad place = value == 0 ? 0 : ldexpq(unit, ilogbq(value));
  return fmaxq(place, least);
}

void exact_compare_value(struct exact_worst *worst, const struct exact *exact, quad value,
                         quad amplification, double computed) {
  quad place = place_of(value == 0 ? amplification : value, exact->unit);
  quad least = place_of(0, exact->unit); /* an underflow is an error of half of that */
  double error = (double)(fabsq(computed - value) / place);
  double bound =
      (double)((exact->roundings / (quad)2 * (exact->unit * amplification + least)) / place);
  double share = error / bound;
  worst->count++;
  if (worst->count == 1 || !(share <= worst->share)) {
    worst->share = share;
    worst->error_ulp = error;
    worst->bound_ulp = bound;
    worst->condition = value == 0 ? NAN : (double)((amplification - fabsq(value)) / fabsq(value));
  }
}

void exact_compare(struct exact_worst *worst, const struct exact *exact, const double *x,
                   const void *context, double computed) {
  quad in[INPUTS_MAX];
  for (int i = 0; i < exact->inputs; i++) {
    in[i] = x[i];
  }
  quad value = exact->formula(in, context);
  exact_compare_value(worst, exact, value, exact_amplification(exact, in, context, value),
                      computed);
}

void exact_row(const struct exact *exact, const struct exact_worst *worst) {
  assert_true(worst->count > 0);
  const struct stability_row row = {.name = exact->name,
                                    .condition = worst->condition,
                                    .perturbation = exact->roundings,
                                    .in_unit = "roundings",
                                    .change = worst->error_ulp,
                                    .out_unit = "ulp",
                                    .bound = worst->bound_ulp,
                                    .extended = worst->error_ulp};
  stability_add(&row);
}

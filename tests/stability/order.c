/* The slope of errors on logarithmic scales. */
#include "order.h"

#include "table.h"

#include <math.h>
#include <stdio.h>

double order_of(const double *step, const double *error, int count) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (int i = 0; i < count; i++) {
    double u = log(step[i]), v = log(error[i]);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (count * xy - x * y) / (count * xx - x * x);
}

void order_add(const char *name, const double *step, const double *error, int count,
               double expected, double margin) {
  double order = order_of(step, error, count);
  printf("%s: order %.2f, %.2f expected;", name, order, expected);
  for (int i = 0; i < count; i++) {
    printf(" %.3g at %.4g", error[i], step[i]);
  }
  printf("\n");
  stability_add(&(struct stability_row){.name = name,
                                        .condition = NAN,
                                        .perturbation = expected,
                                        .in_unit = "order",
                                        .change = fabs(order - expected),
                                        .out_unit = "off it",
                                        .bound = margin,
                                        .extended = NAN});
}

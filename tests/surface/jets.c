/* Derivatives by Richardson's extrapolation of central differences (Phil. Trans. A 226, 1927). */
#include "tests/surface/jets.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>

/* Step of the widest difference: the error left is some step^6 times the seventh derivative, and
 * rounding gives 1e-16 / step. */
#define STEP_MM 0.02

/* Half the difference of the jets at the point plus and minus h along a direction. */
static placido_jet difference(const placido_surface *surface, double x, double y, double dx,
                              double dy, double h) {
  placido_jet up, down;
  assert_true(placido_surface_at(surface, x + dx * h, y + dy * h, &up));
  assert_true(placido_surface_at(surface, x - dx * h, y - dy * h, &down));
  return (placido_jet){.sag = (up.sag - down.sag) / (2 * h),
                       .sx = (up.sx - down.sx) / (2 * h),
                       .sy = (up.sy - down.sy) / (2 * h)};
}

static double extrapolate(double wide, double half, double quarter) {
  double first = (4 * half - wide) / 3, second = (4 * quarter - half) / 3;
  return (16 * second - first) / 15;
}

static placido_jet derivative(const placido_surface *surface, double x, double y, double dx,
                              double dy) {
  placido_jet a = difference(surface, x, y, dx, dy, STEP_MM);
  placido_jet b = difference(surface, x, y, dx, dy, STEP_MM / 2);
  placido_jet c = difference(surface, x, y, dx, dy, STEP_MM / 4);
  return (placido_jet){.sag = extrapolate(a.sag, b.sag, c.sag),
                       .sx = extrapolate(a.sx, b.sx, c.sx),
                       .sy = extrapolate(a.sy, b.sy, c.sy)};
}

static void assert_same(const char *name, double x, double y, double value, double expected,
                        double tolerance) {
  if (!(fabs(value - expected) <= tolerance)) {
    fail_msg("%s at (%g, %g) is %.15g, differences say %.15g", name, x, y, value, expected);
  }
}

void assert_jet_is_consistent(const placido_surface *surface, double x_mm, double y_mm,
                              double tolerance) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x_mm, y_mm, &jet));
  placido_jet dx = derivative(surface, x_mm, y_mm, 1, 0);
  placido_jet dy = derivative(surface, x_mm, y_mm, 0, 1);
  assert_same("sx", x_mm, y_mm, jet.sx, dx.sag, tolerance);
  assert_same("sy", x_mm, y_mm, jet.sy, dy.sag, tolerance);
  assert_same("sxx", x_mm, y_mm, jet.sxx, dx.sx, tolerance);
  assert_same("sxy", x_mm, y_mm, jet.sxy, dx.sy, tolerance);
  assert_same("sxy", x_mm, y_mm, jet.sxy, dy.sx, tolerance);
  assert_same("syy", x_mm, y_mm, jet.syy, dy.sy, tolerance);
}

placido_surface *surface_of(const placido_part *part) {
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0, 6, part, 1, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  return surface;
}

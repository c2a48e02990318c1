/* The sheet gives along lines what the surface gives at points. */
#include "base/memory.h"
#include "reconstruct/surface/sheet.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

enum { COLUMNS = 97, SIDE = 23 };

/* A toric base with a spline of the degree on uneven knots, a bump that has no way of its own along
 * lines, and a radius that cuts the corners. */
static placido_surface *mixed(int degree) {
  double knots[SIDE + 6], coefficients[SIDE * SIDE];
  for (int i = 0; i < SIDE + degree + 1; i++) {
    knots[i] = (i - degree) * 0.45 - 4 + 0.1 * sin(i);
  }
  knots[degree + 4] = knots[degree + 3]; /* an empty span */
  for (int i = 0; i < SIDE * SIDE; i++) {
    coefficients[i] = 0.01 * sin(1.7 * i) + 0.003 * cos(0.3 * i);
  }
  const placido_part parts[] = {
    {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, -0.2, 7.4, -0.3, 25, 0.1, -0.2}},
    {.kind = PLACIDO_PART_BSPLINE,
     .as.bspline = {degree, SIDE, SIDE, knots, knots, coefficients}},
    {.kind = PLACIDO_PART_BUMP, .as.bump = {-0.02, 0.8, 1.1, 0.5, -1, 30}}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, parts, 3, NULL, NULL), PLACIDO_OK);
  return surface;
}

static void test_lines_are_what_points_are(void **state) {
  (void)state;
  double x[COLUMNS], sag[COLUMNS], sx[COLUMNS], sy[COLUMNS];
  for (int i = 0; i < COLUMNS; i++) {
    x[i] = -4.8 + 0.1 * i;
  }
  for (int degree = 2; degree <= 5; degree++) {
    placido_surface *surface = mixed(degree);
    placido_sheet *sheet;
    int outside = 0;
    assert_int_equal(placido_sheet_new(&sheet, surface, x, COLUMNS, NULL), PLACIDO_OK);
    double *work = placido_memory_new(placido_sheet_work(sheet), sizeof *work, NULL);
    assert_non_null(work);
    for (double y = -4.9; y < 5; y += 0.1003) {
      size_t first = (size_t)(fabs(y) * 7) % 11, count = COLUMNS - 2 * first;
      placido_sheet_line(sheet, work, y, first, count, sag, sx, sy);
      for (size_t i = 0; i < count; i++) {
        placido_jet jet;
        if (!placido_surface_at(surface, x[first + i], y, &jet)) {
          assert_true(isnan(sag[i]) && isnan(sx[i]) && isnan(sy[i]));
          outside++;
          continue;
        }
        assert_near(sag[i], jet.sag, 1e-14); /* a few units in the last place of a millimetre */
        assert_near(sx[i], jet.sx, 1e-13);
        assert_near(sy[i], jet.sy, 1e-13);
      }
    }
    assert_true(outside > 500);
    placido_memory_free(work);
    placido_sheet_free(sheet);
    placido_surface_free(surface);
  }
}

static void test_every_failed_allocation_is_reported(void **state) {
  (void)state;
  placido_surface *surface = mixed(5);
  const double x[] = {-1, 0, 1};
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status != PLACIDO_OK; n++) {
    placido_sheet *sheet;
    placido_memory_fail_at(n);
    status = placido_sheet_new(&sheet, surface, x, 3, NULL);
    placido_memory_fail_at(0);
    assert_true(status == PLACIDO_OK ? sheet != NULL : sheet == NULL);
    placido_sheet_free(sheet);
    assert_true(n < 20);
  }
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_lines_are_what_points_are),
    cmocka_unit_test(test_every_failed_allocation_is_reported),
  };
  return cmocka_run_group_tests_name("surface_sheet", tests, NULL, NULL);
}

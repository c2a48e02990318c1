/* Derivatives by extrapolated differences, which know nothing of how jets are computed. */
#ifndef PLACIDO_TESTS_JETS_H
#define PLACIDO_TESTS_JETS_H

#include <placido/surface.h>

/* Asserts that the first and second derivatives of the surface at (x, y) are those of its sag and
 * of its first derivatives, to `tolerance` (per mm, and per mm²). */
void assert_jet_is_consistent(const placido_surface *surface, double x_mm, double y_mm,
                              double tolerance);

/* A surface of one part within 6 mm; the test fails where it cannot be made. */
placido_surface *surface_of(const placido_part *part);

#endif

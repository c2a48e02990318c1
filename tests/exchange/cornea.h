/* A cornea that the tests of this folder know, and files in others' formats made of it. */
#ifndef PLACIDO_TESTS_EXCHANGE_CORNEA_H
#define PLACIDO_TESTS_EXCHANGE_CORNEA_H

#include <placido/surface.h>
#include <stdbool.h>

/* Toric, prolate, with a cone of 5 um: R 7.7 and 7.9 mm, Q -0.25. Free with
 * placido_surface_free. */
placido_surface *make_cornea(double radius_mm);

/* Writes what a CSO topographer would export of it: `gap` leaves out the outer rings on a quarter
 * of the meridians. */
void write_cso(const char *path, const placido_surface *surface, bool gap);

/* A file of the working directory, removed by the caller. */
void write_text(const char *path, const char *text);

#endif

/* A surface along the lines of a tensor grid: what does not depend on the height is done once. */
#ifndef PLACIDO_SURFACE_SHEET_H
#define PLACIDO_SURFACE_SHEET_H

#include <placido/surface.h>

/* Immutable once made; any number of threads may read it, each with its own room to work in. */
typedef struct placido_sheet placido_sheet;

/* Prepares `surface`, borrowed, for lines through `count` columns, 1 at least, at x_mm (ascending,
 * copied). Free with placido_sheet_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_sheet_new(placido_sheet **sheet, const placido_surface *surface, const double *x_mm,
                      size_t count, placido_error *err);
void placido_sheet_free(placido_sheet *sheet);

/* How many numbers a line has to work in. */
size_t placido_sheet_work(const placido_sheet *sheet);

/* Sag and slopes at the height y_mm for `count` columns from `first` on: what placido_surface_at
 * gives to the last digit or two, NaN where that is false. */
void placido_sheet_line(const placido_sheet *sheet, double *work, double y_mm, size_t first,
                        size_t count, double *sag, double *sx, double *sy);

#endif

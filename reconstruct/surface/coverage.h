/* The part of the disc that data support: a mask on a grid of its own. */
#ifndef PLACIDO_SURFACE_COVERAGE_H
#define PLACIDO_SURFACE_COVERAGE_H

#include "base/json.h"

#include <placido/surface.h>

/* A copy of `source`; `*mask` gets the memory of its mask (free with placido_memory_free).
 * PLACIDO_INPUT where sizes or numbers make no sense. */
int placido_coverage_copy(placido_coverage *copy, unsigned char **mask,
                          const placido_coverage *source, placido_error *err);

/* Whether the cell nearest to (x, y) is there and supported. */
bool placido_coverage_at(const placido_coverage *coverage, double x_mm, double y_mm);

/* Reads the object "coverage" of a surface file; `*mask` gets the mask's memory (free with
 * placido_memory_free, whatever the status). A polygon is drawn on a grid of 0.05 mm over the disc
 * of radius_mm: a cell is supported where its centre lies inside (even-odd rule). */
int placido_coverage_read(placido_coverage *coverage, unsigned char **mask, double radius_mm,
                          const placido_json *json, placido_notes *notes, placido_error *err);

/* The object "coverage", a new reference; NULL when memory is out. */
json_t *placido_coverage_write(const placido_coverage *coverage, placido_error *err);

#endif

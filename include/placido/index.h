/* Figures of a whole cornea, each with its standard deviation: the rows of indices/table.c.
 * Formulas, sources and validity stand in docs/indices.md. */
#ifndef PLACIDO_INDEX_H
#define PLACIDO_INDEX_H

#include <placido/instrument.h>
#include <placido/mires.h>
#include <placido/reconstruct.h>
#include <placido/surface.h>

/* One index of one cornea. The strings are constants. */
typedef struct placido_index_value {
  const char *name, *unit, *help;
  double value; /* NaN where it cannot be given */
  double sigma; /* 1 standard deviation; NaN without a fit, or where it cannot be given */
  double budget[PLACIDO_SIGMA_SOURCES]; /* what it is made of: the squares of these add up to its
                          square, but for what has a range, whose sigma ends at even odds all over
                          it */
  double zone_mm;     /* diameter of the zone it speaks of; 0: its own points, see the help */
  double covered;     /* share of that zone's area that data support */
  const char *reason; /* why there is no value, as in docs/indices.md; NULL where there is one */
} placido_index_value;

#define PLACIDO_INDICES_MAX 96

/* Evaluates the indices of a surface. What the supported part of the surface does not give is NaN.
 * `fit` is the surface's own and may be NULL; it gives the error bars, by evaluating all indices on
 * each of its variants, in parallel; the result does not depend on the number of threads. Fills at
 * most PLACIDO_INDICES_MAX values and sets *count. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_indices_find(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                         const placido_surface *surface, const placido_fit *fit,
                         placido_error *err);

/* Mires on the cornea as polygons, innermost first, as the Placido indices take them. */
#define PLACIDO_MIRE_RINGS_MAX 15
#define PLACIDO_MIRE_RING_POINTS 256

typedef struct placido_mire_rings {
  int count; /* complete mires from the inside without a gap, at most the maximum */
  bool cso;  /* seen by a topographer with the mires of CSO's, whose radii AR and GLPI need */
  double points_mm[PLACIDO_MIRE_RINGS_MAX][PLACIDO_MIRE_RING_POINTS][2]; /* x, y at equal angles */
} placido_mire_rings;

/* Where a surface mirrors the bright mires that were seen all around: the middle between each one's
 * two edges, at equal angles about the vertex. A mire is complete where both edges were seen on 90
 * % of the meridians, nowhere 15 degrees on end are missing, and the fit used 70 % of their points.
 * No ring where there is no vertex. */
void placido_mire_rings_find(placido_mire_rings *rings, const placido_surface *surface,
                             const placido_mires *mires, const placido_instrument *instrument);

/* Appends the Placido indices (indices/placido.c) to values[*count...]. Of rings alone: without
 * error bars. Of a fit: of the rings that placido_mire_rings_find gives, the error bars from those
 * of the variants. `mires` and `instrument` are the fit's. The latter returns PLACIDO_OK or
 * PLACIDO_MEMORY. */
void placido_indices_of_rings(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                              const placido_mire_rings *rings);
int placido_indices_of_mires(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                             const placido_fit *fit, const placido_mires *mires,
                             const placido_instrument *instrument, placido_error *err);

/* Writes indices.json (`placido-indices/1`, docs/formats.md) by way of a temporary name. */
int placido_indices_save(const placido_index_value *values, size_t count, const char *path,
                         placido_error *err);

#endif

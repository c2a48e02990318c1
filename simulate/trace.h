/* Light from a distant point on the axis, through a thin lens on the cornea and the surface, to a
 * plane behind it. */
#ifndef PLACIDO_SIMULATE_TRACE_H
#define PLACIDO_SIMULATE_TRACE_H

#include "simulate/eye.h"

#include <placido/surface.h>
#include <stdbool.h>
#include <stddef.h>

/* The crosshatch: N×N nodes over the pupil's square, its edges included, and the (N-1)×(N-1)
 * middles of their cells. Counted in half cells from the pupil's centre, a ray stands at whole
 * numbers, so that whether it is inside the pupil is decided exactly. */
typedef struct placido_crosshatch {
  int samples;                 /* N */
  int rows;                    /* 2 N - 1: first the N node rows, then the N - 1 middle rows */
  double half_cell_mm;
  double x_mm, y_mm;           /* the pupil's centre */
} placido_crosshatch;

placido_crosshatch placido_crosshatch_of(const placido_eye *eye, int samples);

/* N² + (N-1)²: the seed's 100 gives 19,801. */
long placido_crosshatch_total(const placido_crosshatch *pattern);

/* The rays of a row that are inside the pupil: `*count` of them from *first_x_mm on, two half cells
 * apart, at *y_mm. */
void placido_crosshatch_row(const placido_crosshatch *pattern, int row, double *first_x_mm,
                            int *count, double *y_mm);

/* Where a ray meets the surface: position, depth behind the surface's point on the axis, slopes. */
typedef struct placido_entry {
  double x_mm, y_mm, depth_mm, sx, sy;
} placido_entry;

/* False where the surface is not defined. */
bool placido_entry_at(placido_entry *entry, const placido_surface *surface,
                      const placido_apex *apex, double x_mm, double y_mm);

/* Where the refracted ray meets the plane at retina_mm. False for a ray that cannot enter: it
 * meets the surface from behind or leaves it towards the camera. */
bool placido_entry_trace(const placido_entry *entry, const placido_eye *eye, double retina_mm,
                         double *x_mm, double *y_mm);

/* The entries of a whole pupil, kept so that the search of the focus asks the surface once. */
typedef struct placido_rays {
  placido_entry *entries;
  size_t count;
  long missed;     /* inside the pupil, where the surface is not defined */
  long uncovered;  /* of `count`: where no data support the surface */
} placido_rays;

/* Free with placido_rays_free. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_rays_new(placido_rays *rays, const placido_surface *surface, const placido_apex *apex,
                     const placido_eye *eye, int samples, placido_error *err);
void placido_rays_free(placido_rays *rays);

#endif

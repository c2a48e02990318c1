/* Where a cornea is sampled for its indices: on rings about the vertex and on a grid about the
 * axis. Which points data support is settled once, on the fitted surface, so that its variants are
 * held against it at the same points. */
#ifndef PLACIDO_INDICES_LAYOUT_H
#define PLACIDO_INDICES_LAYOUT_H

#include <placido/surface.h>

/* 256 semi-meridians as the TMS instruments have; rings in the middle of annuli 0.2 mm wide, so
 * that a ring's area weight (ISO 19980, annex C) is its annulus's. They fill the central 8 mm. */
#define PLACIDO_RINGS 20
#define PLACIDO_AZIMUTHS 256
#define PLACIDO_RING_STEP_MM 0.2
#define PLACIDO_ZONE_MAX_MM 8.0

/* Where the cornea faces the instrument squarely; NaN where data show no such place. */
typedef struct placido_vertex {
  double x_mm, y_mm;
} placido_vertex;

placido_vertex placido_vertex_find(const placido_surface *surface);

/* Sums over the azimuths before each one, of a ring: a circle's arcs in two look-ups. */
typedef struct placido_arcs {
  double before[PLACIDO_RINGS][PLACIDO_AZIMUTHS + 1];
} placido_arcs;

/* The sum over the azimuths from `from` to `to`, in numbers of azimuths; azimuth a stands for a to
 * a + 1. Parts of one count as parts; both may lie beyond a turn, `to` by at most one from `from`.
 */
double placido_arcs_sum(const placido_arcs *arcs, int ring, double from, double to);

typedef struct placido_layout {
  placido_vertex vertex; /* of the surface that it was made for */
  double cosine[PLACIDO_AZIMUTHS], sine[PLACIDO_AZIMUTHS];
  unsigned char covered[PLACIDO_RINGS][PLACIDO_AZIMUTHS];
  placido_arcs support;            /* of `covered` */
  size_t grid_count, grid_sampled; /* points with data; points of the whole grid */
  double (*grid)[2]; /* about the axis, mm: the supported points of the central 8 mm */
  double analysed;   /* share of the surface's disc that is supported */
} placido_layout;

/* Free with placido_layout_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_layout_new(placido_layout **layout, const placido_surface *surface, placido_error *err);
void placido_layout_free(placido_layout *layout);

double placido_ring_radius(int ring);

/* Area (mm²) of the part of a ring's annulus that lies between two circles, for one azimuth. */
double placido_ring_area(int ring, double from_diameter_mm, double to_diameter_mm);

/* Share of the area between two circles that is supported. */
double placido_layout_share(const placido_layout *layout, double from_diameter_mm,
                            double to_diameter_mm);

#endif

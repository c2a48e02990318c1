/* What the indices are computed from: a surface, sampled once, and the figures that several indices
 * share. An index is a row of a group; a group is a file. */
#ifndef PLACIDO_INDICES_CORNEA_H
#define PLACIDO_INDICES_CORNEA_H

#include "reconstruct/indices/layout.h"
#include "reconstruct/maps/zone.h"

#include <placido/index.h>

/* Of a zone's area, data must support so much for a figure of the zone. */
#define PLACIDO_SHARE_MIN 0.7

/* Keratometry of diameters of the 3 mm circle; NaN where data do not support it. */
typedef struct placido_simk {
  double flat_D, flat_axis_deg;   /* the flattest diameter; its axis 0 to 180, NaN: no cylinder */
  double across_flat_D;           /* the diameter perpendicular to it */
  double steep_D, steep_axis_deg; /* the steepest diameter */
  double across_steep_D;
} placido_simk;

/* A conicoid: asphericity and mean radius of curvature at its apex. */
typedef struct placido_conicoid {
  double q, radius_mm;
} placido_conicoid;

/* A place and its power. */
typedef struct placido_peak {
  double x_mm, y_mm, power_D;
} placido_peak;

/* The zones of which asphericity is given, by their diameters. */
enum { PLACIDO_ZONE_4_5, PLACIDO_ZONE_6, PLACIDO_ZONE_8, PLACIDO_ZONES };

typedef struct placido_cornea {
  const placido_layout *layout;
  const placido_surface *surface;
  placido_vertex vertex;
  /* Samples about the vertex: axial power about the line through it, NaN where not supported; the
   * sag against the vertex. */
  double axial_D[PLACIDO_RINGS][PLACIDO_AZIMUTHS];
  double sag_mm[PLACIDO_RINGS][PLACIDO_AZIMUTHS];
  placido_arcs power; /* sums of axial_D where supported */
  placido_zone grid;  /* points of the layout's grid about the axis */

  placido_simk simk;
  placido_conicoid conicoids[PLACIDO_ZONES];
  placido_conicoid flat[PLACIDO_ZONES], steep[PLACIDO_ZONES]; /* of the principal meridians */
  double sphere_radius_mm;
  placido_peak steepest; /* tangential */
  double central_k_D, inferior_superior_D, srax_deg;
  double clmi_D;
  placido_vertex cone; /* centre of the steepest disc, from the vertex; NaN: nothing stands out */
  double sai_D, sri_D, iai_D;
  double dsi_D, osi_D, csi_D;
} placido_cornea;

/* One index. */
typedef struct placido_index_row {
  const char *name, *unit, *help;
  double zone_mm; /* diameter of the zone about the vertex that PLACIDO_SHARE_MIN of must be
                     supported; 0: it has points of its own */
  double period;  /* of the value: 180 for an axis, else 0 */
  double range;   /* width of the range of a value that has one: then no error is wider than even
                     odds all over it, range/sqrt(12); 0: it has none */
  double (*at)(const placido_cornea *cornea);          /* NaN where it cannot be given */
  const char *(*reason)(const placido_cornea *cornea); /* why `at` gives NaN; NULL: the usual */
} placido_index_row;

/* Indices of one idea. */
typedef struct placido_index_group {
  void (*measure)(placido_cornea *cornea); /* the figures that its rows share; may be NULL */
  const placido_index_row *rows;
  size_t count;
} placido_index_group;

extern const placido_index_group placido_vertex_group, placido_simk_group, placido_power_group,
    placido_asphericity_group, placido_meridian_group, placido_sphere_group, placido_steepest_group,
    placido_rabinowitz_group, placido_clmi_group, placido_regularity_group, placido_sector_group;

/* The groups of table.c, `*count` of them. A group may use the figures of those before it. */
const placido_index_group *const *placido_index_groups(size_t *count);

/* Reasons. */
#define PLACIDO_REASON_NOT_COVERED "not_covered"
#define PLACIDO_REASON_NO_VERTEX "no_vertex"
#define PLACIDO_REASON_NO_CYLINDER "no_cylinder"

/* Samples the surface at the layout's points and measures all groups. Free with
 * placido_cornea_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_cornea_new(placido_cornea **cornea, const placido_layout *layout,
                       const placido_surface *surface, placido_error *err);
void placido_cornea_free(placido_cornea *cornea);

/* Axial power and sag at a distance from the vertex along a semi-meridian, exactly there; NaN where
 * the nearest sample is not supported. */
double placido_cornea_axial(const placido_cornea *cornea, double r_mm, double angle_deg);
double placido_cornea_sag(const placido_cornea *cornea, double r_mm, double angle_deg);

/* Area-weighted mean of axial power between two circles about the vertex, where supported (ISO
 * 19980, annex C). */
double placido_cornea_mean(const placido_cornea *cornea, double from_diameter_mm,
                           double to_diameter_mm);

/* Where between its neighbours a peak (or trough) of three equally spaced values lies, -0.5 to 0.5
 * in steps, by the parabola through them. */
double placido_peak_offset(double before, double peak, double behind);

#endif

/* What the indices are computed from: the surface and figures that several of them share. */
#ifndef PLACIDO_INDICES_CORNEA_H
#define PLACIDO_INDICES_CORNEA_H

#include <placido/map.h>

/* Simulated keratometry; NaN where data do not support it. */
typedef struct placido_simk {
  double flat_D, flat_axis_deg; /* axis 0 to 180; NaN without cylinder */
  double steep_D, steep_axis_deg;
  double sigma_flat_D, sigma_steep_D;
} placido_simk;

/* A conicoid: asphericity and mean radius of curvature at its apex. */
typedef struct placido_conicoid {
  double q, radius_mm;
  double sigma_q, sigma_radius_mm;
} placido_conicoid;

/* A place and its power. */
typedef struct placido_peak {
  double x_mm, y_mm, power_D;
} placido_peak;

/* Where the cornea faces the instrument squarely; NaN where data show no such place. */
typedef struct placido_vertex {
  double x_mm, y_mm;
} placido_vertex;

typedef struct placido_cornea {
  placido_vertex vertex;
  placido_simk simk;
  placido_conicoid conicoid;
  double sphere_radius_mm, sphere_sigma_mm; /* best-fit sphere */
  placido_peak steepest;                    /* tangential */
} placido_cornea;

/* One index: its value, and its standard deviation (NaN where it cannot be given). */
typedef struct placido_index_row {
  const char *name, *unit, *help;
  double (*at)(const placido_cornea *cornea, double *sigma);
} placido_index_row;

/* The rows of table.c, `*count` of them. */
const placido_index_row *placido_index_rows(size_t *count);

/* The shared figures. The fits return PLACIDO_OK or PLACIDO_MEMORY. */
placido_vertex placido_vertex_find(const placido_surface *surface);
placido_simk placido_simk_find(const placido_surface *surface, const placido_fit *fit,
                               placido_vertex vertex);
int placido_conicoid_fit(placido_conicoid *conicoid, const placido_surface *surface,
                         const placido_fit *fit, placido_error *err);
int placido_sphere_radius_find(double *radius_mm, double *sigma_mm, const placido_surface *surface,
                               const placido_fit *fit, placido_error *err);
placido_peak placido_steepest_find(const placido_surface *surface);

/* Mean of the standard deviations of axial curvature on the circle of radius r_mm about the axis,
 * where covered: that of the circle's mean power if the errors along it are fully correlated, which
 * is an upper bound. NaN without a fit. */
double placido_ring_sigma(const placido_surface *surface, const placido_fit *fit, double r_mm);

/* The values in the rows' order of their groups. */
double placido_index_vertex_x(const placido_cornea *cornea, double *sigma);
double placido_index_vertex_y(const placido_cornea *cornea, double *sigma);
double placido_index_simk_flat(const placido_cornea *cornea, double *sigma);
double placido_index_simk_flat_axis(const placido_cornea *cornea, double *sigma);
double placido_index_simk_steep(const placido_cornea *cornea, double *sigma);
double placido_index_simk_steep_axis(const placido_cornea *cornea, double *sigma);
double placido_index_simk_cylinder(const placido_cornea *cornea, double *sigma);
double placido_index_simk_mean(const placido_cornea *cornea, double *sigma);
double placido_index_asphericity(const placido_cornea *cornea, double *sigma);
double placido_index_apical_radius(const placido_cornea *cornea, double *sigma);
double placido_index_sphere_radius(const placido_cornea *cornea, double *sigma);
double placido_index_steepest(const placido_cornea *cornea, double *sigma);
double placido_index_steepest_x(const placido_cornea *cornea, double *sigma);
double placido_index_steepest_y(const placido_cornea *cornea, double *sigma);

#endif

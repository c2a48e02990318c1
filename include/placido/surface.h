/* The cornea: a sag that is the sum of parts, asked for through one jet. The second narrow waist.
 * File format `placido-surface/1` (docs/formats.md). */
#ifndef PLACIDO_SURFACE_H
#define PLACIDO_SURFACE_H

#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* Sag (mm, growing away from the camera: z = vertex_z - sag) and its derivatives at a point. */
typedef struct placido_jet {
  double sag, sx, sy, sxx, sxy, syy;
} placido_jet;

/* Immutable once made; any number of threads may read it. */
typedef struct placido_surface placido_surface;

enum placido_part_kind {
  PLACIDO_PART_BICONIC,
  PLACIDO_PART_BUMP,
  PLACIDO_PART_ABLATION,
  PLACIDO_PART_ZERNIKE,
  PLACIDO_PART_RIDGE,
  PLACIDO_PART_BSPLINE,
  PLACIDO_PART_KINDS
};

#define PLACIDO_ZERNIKE_TERMS 136 /* OSA indices 0 to 135: up to order 15 */

/* One part of the sum; formulas in docs/formats.md. */
typedef struct placido_part {
  enum placido_part_kind kind;
  union {
    struct { double r1, q1, r2, q2, axis_deg, cx, cy; } biconic;
    struct { double height_mm, sigma_x_mm, sigma_y_mm, x_mm, y_mm, axis_deg; } bump;
    struct { double dioptres, zone_mm, blend_mm, r0, n, cx, cy; } ablation;
    struct { double coefficients_um[PLACIDO_ZERNIKE_TERMS]; double radius_mm; } zernike;
    struct { double slope, width_mm, offset_mm, axis_deg; } ridge;
    struct {
      int degree, columns, rows;       /* coefficients along x and y */
      const double *knots_x_mm;        /* columns + degree + 1 of them */
      const double *knots_y_mm;        /* rows + degree + 1 */
      const double *coefficients_mm;   /* rows * columns, y outer */
    } bspline;
  } as;
} placido_part;

/* The part of the disc that data support, as a mask on a square grid. A point belongs to the cell
 * whose centre is nearest; points beyond the grid are not supported. */
typedef struct placido_coverage {
  double x0_mm, y0_mm, step_mm; /* centre of cell (0, 0) and pitch */
  int columns, rows;
  const unsigned char *mask;    /* rows * columns, y outer, 1 = supported */
} placido_coverage;

/* Makes a surface of 1 to 256 parts with a radius of at most 20 mm; parts and coverage (may be
 * NULL: everywhere) are copied. A B-spline has degree 2 to 5 and is defined between its knots
 * number `degree` and `columns` (`rows`).
 * Free with placido_surface_free. Returns PLACIDO_OK, PLACIDO_INPUT (a parameter that is not
 * finite or out of its range, named in err), PLACIDO_MEMORY. */
int placido_surface_new(placido_surface **surface, double vertex_z_mm, double radius_mm,
                        const placido_part *parts, size_t part_count,
                        const placido_coverage *coverage, placido_error *err);

/* Reads a surface file. Missing: vertex_z_mm is 0, radius_mm 4.5, r2 and q2 are r1 and q1,
 * axis_deg, cx and cy 0, n of an ablation 1.376. A coverage that is a polygon becomes a mask of
 * 0.05 mm: a cell is supported where its centre lies inside. Unknown keys give one warning line in
 * `notes` (may be NULL). Refuses, naming file, line and field, what placido_surface_new refuses.
 * Free with placido_surface_free. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT,
 * PLACIDO_MEMORY. */
int placido_surface_load(placido_surface **surface, const char *path, placido_notes *notes,
                         placido_error *err);

/* Writes a surface file that reads back bit for bit, by way of a temporary name.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_MEMORY. */
int placido_surface_save(const placido_surface *surface, const char *path, placido_error *err);
void placido_surface_free(placido_surface *surface);

double placido_surface_vertex_z_mm(const placido_surface *surface);
double placido_surface_radius_mm(const placido_surface *surface);

/* The jet at (x, y). Returns false, with a jet of NaN, outside the surface's radius or where a
 * part is not defined (a conic beyond its equator). Never fails otherwise. */
bool placido_surface_at(const placido_surface *surface, double x_mm, double y_mm,
                        placido_jet *jet);

/* Whether data support the surface at (x, y); true inside the radius where no coverage is given. */
bool placido_surface_covered(const placido_surface *surface, double x_mm, double y_mm);

#endif

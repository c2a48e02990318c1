/* The wavefront behind a tensor grid of places on the cornea, line by line: what a pupil's samples
 * are interpolated from. */
#ifndef PLACIDO_SIMULATE_LATTICE_H
#define PLACIDO_SIMULATE_LATTICE_H

#include "simulate/ocular/sight.h"

/* What is known of a place on the cornea. */
typedef struct placido_node {
  placido_standing standing;
  double entry_mm[2]; /* where its light crosses the plane of the entrance pupil, from its centre */
} placido_node;

/* Node (column, row) stands at x0_mm + column step_mm, y0_mm + row step_mm. */
typedef struct placido_lattice {
  int columns, rows;
  double x0_mm, y0_mm, step_mm;
  placido_node *nodes; /* rows outer; NaN where no light goes on */
} placido_lattice;

/* Traces a lattice over the rectangle from low_mm to high_mm. Free with placido_lattice_free.
 * PLACIDO_OK, PLACIDO_QUALITY (it would be larger than any pupil), PLACIDO_MEMORY. */
int placido_lattice_new(placido_lattice *lattice, const placido_sight *sight,
                        const double low_mm[2], const double high_mm[2], double step_mm,
                        int threads, placido_error *err);
void placido_lattice_free(placido_lattice *lattice);

/* The node between four others at (x, y) on the cornea, linearly; false beside the lattice. */
bool placido_lattice_at(const placido_lattice *lattice, double x_mm, double y_mm,
                        placido_node *node);

/* The path difference at a place of the pupil near which (x, y) stands: each of the four nodes
 * around leads there by its slope and the mean one, which is exact for parabolas. NaN beside the
 * lattice. */
double placido_lattice_opd_mm(const placido_lattice *lattice, double x_mm, double y_mm,
                              const double place[2]);

#endif

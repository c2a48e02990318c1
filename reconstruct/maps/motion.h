/* A measured cornea moved as a rigid body. */
#ifndef PLACIDO_MAPS_MOTION_H
#define PLACIDO_MAPS_MOTION_H

#include <placido/difference.h>

/* Turned about the origin by `turn`, then shifted. */
typedef struct placido_motion {
  double turn[3][3], shift_mm[3];
} placido_motion;

/* Of the terms of an alignment. */
placido_motion placido_motion_of(const double terms[PLACIDO_MOTION_TERMS]);

/* Where a vertical line meets the moved cornea. */
typedef struct placido_moved {
  double z_mm;
  placido_jet jet;   /* sag counted from z = 0 */
  double from_mm[2]; /* where that point was before, in the measurement's own x and y */
  bool covered;
} placido_moved;

/* At (x, y); false where the cornea is not defined. */
bool placido_moved_at(placido_moved *moved, const placido_measured *measured,
                      const placido_motion *motion, double x_mm, double y_mm);

/* The error bar of a kind at a place in the measurement's own x and y, between the grid's points;
 * NaN where it is not known. */
double placido_measured_sigma(const placido_measured *measured, enum placido_difference_kind kind,
                              const double at_mm[2]);

#endif

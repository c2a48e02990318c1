/* A fit under way: what its stages share. */
#ifndef PLACIDO_SOLVE_SOLUTION_H
#define PLACIDO_SOLVE_SOLUTION_H

#include "reconstruct/solve/distance.h"

#include <placido/reconstruct.h>

#define PLACIDO_POINTS_MIN 200 /* fewer make no cornea */

/* Relative fall of the cost at which an iteration ends. In the last one 2e-4 is a few units of chi
 * square, far less than the hundreds of unknowns scatter by. The cost is about the residuals' sum
 * of squares, and at its minimum a step that moves them by a share of their noise makes it fall by
 * the square of that share. */
#define PLACIDO_SETTLED 2e-4
#define PLACIDO_SETTLED_ROUGHLY 1e-2

/* Spread over rough noise at which finer knots are tried, and other numbers. */
#define PLACIDO_MISFIT 1.3

/* What the stages of a fit hand on. */
typedef struct placido_solution {
  placido_mires *mires;
  placido_sample *samples;
  size_t count;
  placido_sightlines rays; /* of all samples */
  placido_conicoid base;
  placido_axis axis;
  double reach_mm;
  double coarse_px, misfit;    /* spread with the coarsest knots, and that over the rough noise */
  double kin_px;               /* along an edge, over which points err alike */
  double cut;                  /* share of the points that were set aside */
  int shift;                   /* that all numbers ask for */
  double geometry_px;          /* of the instrument's uncertainty, what no smooth surface follows */
  bool starts_anew, continues; /* whether a start that was given is passed over; was of use */
  placido_refinement refinement;
  const placido_instrument *instrument;
  const placido_fit_options *options;
  int threads;
} placido_solution;

/* How many modes of the geometry's uncertainty count; 0: nothing is known of it. */
int placido_solution_modes(const placido_fit_options *options);

/* The relative fall of the cost that the options' tolerance stands for; `usual` without one. */
double placido_solution_settled(const placido_fit_options *options, double usual);

/* The conicoid, and how far the points reach. PLACIDO_QUALITY where that is no cornea. */
int placido_solution_base(placido_solution *p, placido_error *err);

/* The spline on it, knots as fine as the points ask for, or continued from a fit before. */
int placido_solution_spline(placido_solution *p, placido_grid *grid, placido_error *err);

/* Sets `shift` where all mires together are misnumbered by one: another numbering leaves far less.
 */
int placido_solution_shift(placido_solution *p, placido_error *err);

/* The whole: spline, noise, outliers. Ends early where `shift` is set. */
int placido_solution_robust(placido_solution *p, placido_grid *grid, placido_notes *notes,
                            placido_error *err);

/* PLACIDO_QUALITY where the points' contradictions together with a hole of this area in the middle
 * of the map tell of a fold. */
int placido_solution_check_hole(const placido_solution *p, double hole_mm2, placido_error *err);

#endif

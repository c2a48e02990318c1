/* The fit from mires to surface: conicoid, spline with as fine knots as the residuals ask for,
 * outliers cut, numbers verified, error bars. */
#include <placido/reconstruct.h>

#include "base/memory.h"
#include "reconstruct/solve/doubt/contradict.h"
#include "reconstruct/solve/doubt/explain.h"
#include "reconstruct/solve/doubt/fold.h"
#include "reconstruct/solve/doubt/numbering.h"
#include "reconstruct/solve/doubt/power.h"
#include "reconstruct/solve/engine/conic.h"
#include "reconstruct/solve/errors/result.h"
#include "reconstruct/solve/given.h"
#include "reconstruct/solve/solution.h"

#include <math.h>

#define KNOT_LEAST_MM 0.15 /* finer ones cost minutes and follow the noise */
#define KNOT_MOST_MM 2.0
#define TOLERANCE_LEAST 1e-6
#define RENUMBERINGS 3 /* at most */
#define RENUMBER 6.0   /* spreads within which a point agrees with an edge */
#define OPEN_D 1.0     /* an error bar beyond which the map says nothing */

/* Where data support the surface; folds are left out. */
static int cover(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                 const placido_solution *p, placido_notes *notes, placido_error *err) {
  placido_place *folds = placido_memory_new(p->count, sizeof *folds, err);
  int status = folds ? placido_mask_new(coverage, mask, radius_mm, p->samples, p->count, err)
                     : PLACIDO_MEMORY;
  size_t folded = status ? 0 : placido_fold_find(folds, p->samples, p->count, p->mires);
  if (folded) {
    double share = placido_fold_mask(coverage, *mask, folds, folded, PLACIDO_FOLD_REACH_MM);
    placido_notes_add(notes,
                      "the cornea folds the mires about x = %.1f, y = %.1f mm: %.0f %% of the map "
                      "are left out",
                      folds[folded / 2].x_mm, folds[folded / 2].y_mm, 100 * share);
  }
  double hole_mm2 = 0;
  if (!status) {
    status = placido_fold_hole(&hole_mm2, coverage, *mask, err);
  }
  if (!status) {
    status = placido_solution_check_hole(p, hole_mm2, err);
  }
  if (!status) {
    status = placido_contradict_find(folds, &folded, p->samples, p->count,
                                     p->refinement.sigma_px, err);
  }
  if (!status && folded) {
    double share =
        placido_fold_mask(coverage, *mask, folds, folded, PLACIDO_CONTRADICT_REACH_MM);
    placido_notes_add(notes,
                      "most edge points about x = %.1f, y = %.1f mm contradict the surface: %.1f "
                      "%% of the map are left out",
                      folds[folded / 2].x_mm, folds[folded / 2].y_mm, 100 * share);
  }
  placido_memory_free(folds);
  return status;
}

/* Knots and coefficients as a part of the surface file. */
static int build_surface(placido_fit *fit, placido_solution *p, placido_notes *notes,
                         placido_error *err) {
  const placido_grid *g = &fit->grid;
  placido_coverage coverage;
  unsigned char *mask = NULL;
  size_t knots = (size_t)(g->side + g->order);
  double *places = placido_memory_new(knots, sizeof *places, err);
  int status = places ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = cover(&coverage, &mask, &fit->summary.radius_mm, p, notes, err);
  }
  if (!status) {
    for (size_t i = 0; i < knots; i++) {
      places[i] = ((double)i - (g->order - 1)) * g->knot_mm - g->half_mm;
    }
    /* the spline was fitted to z, the file holds sags */
    size_t n = (size_t)g->side * (size_t)g->side;
    for (size_t i = 0; i < n; i++) {
      p->refinement.coefficients[i] = -p->refinement.coefficients[i];
    }
    placido_part parts[2] = {placido_conic_part(&p->base),
                             {.kind = PLACIDO_PART_BSPLINE,
                              .as.bspline = {g->order - 1, g->side, g->side, places, places,
                                             p->refinement.coefficients}}};
    status = placido_surface_new(&fit->surface, p->base.apex_z_mm, fit->summary.radius_mm, parts, 2,
                                 &coverage, err);
    fit->base = p->base;
    fit->axis_z_mm = p->axis.z_mm;
    fit->sags_mm = p->refinement.coefficients;
    p->refinement.coefficients = NULL;
  }
  placido_memory_free(places);
  placido_memory_free(mask);
  return status;
}

static void summarise(placido_fit *fit, const placido_solution *p) {
  double sum = 0;
  for (size_t i = 0; i < p->count; i++) {
    const placido_sample *s = &p->samples[i];
    placido_mire_point *point = &p->mires->points[s->point];
    point->used = s->used && !isnan(s->residual_px);
    point->residual_px = s->residual_px * s->noise;
    if (point->used) {
      sum += point->residual_px * point->residual_px;
      fit->summary.points_used++;
    }
  }
  fit->summary.axis_z_mm = p->axis.z_mm;
  fit->summary.axis_z_sigma_mm = p->axis.sigma_mm;
  fit->summary.axis_z_solved = p->axis.solved;
  fit->summary.points = p->count;
  fit->summary.rms_px = sqrt(sum / (double)fit->summary.points_used);
  fit->summary.sigma_px = p->refinement.sigma_px;
  fit->summary.steps = p->refinement.steps;
  fit->summary.knot_mm = fit->grid.knot_mm;
  fit->summary.condition = 1 / placido_normal_rcond(fit->normal);
}

/* Hands the normal equations over to the fit and takes its error bars from them. */
static int find_errors(placido_fit *fit, placido_solution *p, placido_error *err) {
  const placido_fit_options *o = p->options;
  const placido_refinement *r = &p->refinement;
  placido_moves moves = {0};
  int status = PLACIDO_OK, modes = placido_solution_modes(o);
  placido_refinement_tell(&p->refinement);
  if (modes > 0) {
    status = placido_moves_new(&moves, r, p->mires, p->instrument, o->geometry, modes, err);
    if (!status) {
      status = placido_normal_outer(r->normal, moves.coefficients, modes, &fit->geometry, err);
    }
  }
  if (!status) {
    status = placido_residuals_explain(r, p->mires, fit->geometry ? &moves : NULL, err);
  }
  if (!status) {
    status = placido_normal_inverse(r->normal, &fit->inverse, err);
  }
  if (!status) {
    status = placido_scatter_find(&fit->scatter, r, p->mires, r->work, p->kin_px, fit->inverse, err);
  }
  if (!status) {
    fit->modes = moves.coefficients;
    fit->mode_count = modes;
    moves.coefficients = NULL;
  }
  placido_moves_free(&moves);
  fit->axis_z_sigma_mm = p->axis.sigma_mm;
  fit->normal = p->refinement.normal;
  p->refinement.normal = NULL;
  return status ? status : placido_fit_covariance(fit, err);
}

static int check_options(const placido_fit_options *options, const placido_instrument *instrument,
                         placido_error *err) {
  double knot_mm = options ? options->knot_mm : 0;
  if (knot_mm != 0 && !(knot_mm >= KNOT_LEAST_MM && knot_mm <= KNOT_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT, "knots every %g mm, expected %g to %g mm", knot_mm,
                             KNOT_LEAST_MM, KNOT_MOST_MM);
  }
  double tolerance = options ? options->tolerance : 0;
  if (tolerance != 0 && !(tolerance >= TOLERANCE_LEAST && tolerance <= 1)) {
    return placido_error_set(err, PLACIDO_INPUT, "a tolerance of %g of the noise, expected %g to 1",
                             tolerance, TOLERANCE_LEAST);
  }
  int degree = options ? options->degree : 0;
  if (degree != 0 && degree != 3 && degree != 5) {
    return placido_error_set(err, PLACIDO_INPUT, "a spline of degree %d, expected 3 or 5", degree);
  }
  const placido_uncertainty *geometry = options ? options->geometry : NULL;
  if (geometry && geometry->mode_count > 0 && geometry->edge_count != instrument->edge_count) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the geometry's uncertainty is of %d edges, the instrument has %d",
                             geometry->edge_count, instrument->edge_count);
  }
  return PLACIDO_OK;
}

static void forget(placido_solution *p) {
  placido_refinement_free(&p->refinement);
  placido_sightlines_free(&p->rays);
  placido_memory_free(p->samples);
  p->samples = NULL;
  p->shift = 0;
}

/* From the points to a surface that agrees with their numbers, as far as these go. */
static int fit_points(placido_solution *p, placido_grid *grid, placido_notes *notes,
                      placido_error *err) {
  size_t doubtful;
  p->count = p->mires->count;
  int status = placido_samples_new(&p->samples, p->mires, p->instrument, p->axis.z_mm, err);
  if (!status) {
    status = placido_numbering_doubt(p->samples, p->count, p->mires, &doubtful, err);
  }
  if (!status && !(status = placido_sightlines_new(&p->rays, p->samples, p->count, err))) {
    status = placido_solution_robust(p, grid, notes, err);
  }
  return status;
}

/* Corrects numbers that the surface contradicts. `changed`: it did. */
static int renumber(placido_solution *p, bool *changed, placido_notes *notes, placido_error *err) {
  size_t moved = 0;
  int status = PLACIDO_OK;
  if (p->shift) {
    placido_numbering_shift(p->mires, p->shift);
    placido_notes_add(notes,
                      "all mires were numbered one too far %s: corrected, since only so does "
                      "a smooth cornea fit",
                      p->shift < 0 ? "out" : "in");
  } else {
    placido_refinement_tell(&p->refinement);
    status = placido_numbering_settle(p->mires, p->samples, p->count, p->instrument,
                                      RENUMBER * p->refinement.sigma_px, &moved, err);
    if (moved) {
      placido_notes_add(notes,
                        "%zu edge points were numbered anew: they lie where the surface "
                        "mirrors another mire",
                        moved);
    }
  }
  *changed = p->shift || moved;
  return status;
}

/* Says which part of the map the mires leave undetermined. */
static void tell_open(const placido_fit *fit, placido_notes *notes) {
  placido_open worst;
  double share = placido_fit_open_share(fit, OPEN_D, &worst);
  if (share > 0) {
    placido_notes_add(
        notes,
        "the mires leave %.1f %% of the map open, to more than %g D, most at x = %.1f, "
        "y = %.1f mm (%.1f D; condition number %.0e)",
        100 * share, OPEN_D, worst.x_mm, worst.y_mm, worst.sigma_D, fit->summary.condition);
  }
}

/* Fits until the numbers are in order. */
static int fit_numbered(placido_solution *p, placido_grid *grid, placido_notes *notes,
                        placido_error *err) {
  bool changed = true;
  int status = PLACIDO_OK;
  for (int pass = 0; pass <= RENUMBERINGS && changed && !status; pass++) {
    forget(p);
    status = fit_points(p, grid, notes, err);
    if (status == PLACIDO_QUALITY && p->continues) {
      forget(p);
      p->starts_anew = true; /* the start may have led astray */
      status = fit_points(p, grid, notes, err);
    }
    changed = false;
    if (!status && pass < RENUMBERINGS) {
      status = renumber(p, &changed, notes, err);
    }
  }
  return status;
}

/* Solves for the distance where the mires tell it. What was cut, and how fine the knots are, was
 * decided at the given distance, so a second round starts from the first one's. */
static int fit_distance(placido_solution *p, placido_grid *grid, placido_notes *notes,
                        placido_error *err) {
  const placido_fit_options *o = p->options;
  const placido_distance_source source = {p->mires, p->instrument, o ? o->geometry : NULL,
                                          placido_solution_modes(o),
                                          placido_solution_settled(o, PLACIDO_SETTLED)};
  int status = placido_distance_solve(&p->axis, &p->refinement, &source, notes, err);
  if (!status && p->axis.solved) {
    forget(p);
    p->starts_anew = true;
    status = fit_points(p, grid, notes, err);
    if (!status) {
      status = placido_distance_solve(&p->axis, &p->refinement, &source, notes, err);
    }
  }
  p->base = p->refinement.shape.base;
  if (!status && p->axis.solved) {
    placido_notes_add(notes,
                      "the mires tell the distance themselves: z on the axis is %.4f mm, standard "
                      "deviation %.4f mm",
                      p->axis.z_mm, p->axis.sigma_mm);
  }
  return status;
}

int placido_fit_new(placido_fit **fit, placido_mires *mires, const placido_instrument *instrument,
                    const placido_fit_options *options, placido_notes *notes, placido_error *err) {
  *fit = NULL;
  placido_solution p = {.mires = mires,
                        .count = mires->count,
                        .axis = placido_axis_given(options ? options->axis_z_mm : 0,
                                                   options ? options->axis_z_sigma_mm : 0),
                        .instrument = instrument,
                        .options = options,
                        .threads = options && options->threads > 0 ? options->threads : 1};
  if (mires->count < PLACIDO_POINTS_MIN) {
    return placido_error_set(err, PLACIDO_QUALITY, "only %zu edge points, at least %d are needed",
                             mires->count, PLACIDO_POINTS_MIN);
  }
  int status = check_options(options, instrument, err);
  if (!status) {
    status = placido_given_check(mires, instrument, options, err);
  }
  placido_fit *f = status ? NULL : placido_memory_new(1, sizeof *f, err);
  if (!status && !f) {
    status = PLACIDO_MEMORY;
  }
  if (status || (status = fit_numbered(&p, &f->grid, notes, err)) ||
      (status = fit_distance(&p, &f->grid, notes, err)) || (status = find_errors(f, &p, err)) ||
      (status = build_surface(f, &p, notes, err)) || (status = placido_fit_level_find(f, err)) ||
      (status = placido_power_check(f->surface, err))) {
    goto done;
  }
  summarise(f, &p);
  tell_open(f, notes);
  *fit = f;
  f = NULL;
done:
  placido_fit_free(f);
  forget(&p);
  return status;
}

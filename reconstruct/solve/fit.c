/* The fit from mires to surface: conicoid, spline with as fine knots as the residuals ask for,
 * outliers cut, error bars. */
#include <placido/reconstruct.h>

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/conic.h"
#include "reconstruct/solve/distance.h"
#include "reconstruct/solve/explain.h"
#include "reconstruct/solve/fold.h"
#include "reconstruct/solve/mask.h"
#include "reconstruct/solve/noise.h"
#include "reconstruct/solve/numbering.h"
#include "reconstruct/solve/outliers.h"
#include "reconstruct/solve/power.h"
#include "reconstruct/solve/refine.h"
#include "reconstruct/solve/result.h"
#include "reconstruct/solve/warm.h"

#include <math.h>
#include <string.h>

#define POINTS_MIN 200
#define BASE_POINTS 1000 /* about so many tell the conicoid */
#define MARGIN_MM 0.6   /* of spline beyond the outermost point */
#define RADIUS_MAX_MM 7
/* A point this far from the conicoid says nothing of how far the data reach. */
#define FAR_PX 20.0
#define CUT_MOST 0.3 /* share of the points: more means that the model is wrong, not the points */
#define CUT_MANY 0.1    /* share that the user is told of */

/* A fold leaves a small residual and a wrong surface; it shows in points that do not fit together
 * with edges that cannot be numbered. Lashes give the one, a broken tear film the other. */
#define FOLD_CUT 0.06
#define FOLD_STRAY 0.05

/* Relative fall of the cost at which an iteration ends. In the last one 2e-4 is a few units of chi
 * square, far less than the hundreds of unknowns scatter by. */
#define SETTLED 2e-4
#define SETTLED_ROUGHLY 1e-2
#define SETTLED_TO_CUT 0.1 /* what is left is a small part of an outlier's distance */
#define POINTS_PLENTY 4.0  /* a coefficient: what these tell is good enough to cut by */

/* How fine the knots must be is explored on every third meridian, coarse to fine. */
#define EXPLORE_STRIDE 3
#define SHIFTED 0.6     /* of the spread, which another numbering of all mires must stay below */
#define RENUMBERINGS 3  /* at most */
#define RENUMBER 6.0    /* spreads within which a point agrees with an edge */
#define GAIN 0.85       /* finer knots must bring the spread below this share of what it was */
#define MISFIT 1.3      /* spread over rough noise at which finer knots are tried */
#define MISFIT_FAR 2.5  /* and at which the next finer ones would not do: they about halve it */

static const double KNOTS_MM[] = {0.5, 0.35, 0.25};
#define KNOT_LEAST_MM 0.15 /* finer ones cost minutes and follow the noise */
#define KNOT_MOST_MM 2.0
#define KNOT_CHOICES (int)(sizeof KNOTS_MM / sizeof KNOTS_MM[0])

/* What the stages hand on. */
typedef struct progress {
  placido_mires *mires;
  placido_sample *samples;
  size_t count;
  placido_bundle rays; /* of all samples */
  placido_conicoid base;
  placido_axis axis;
  double reach_mm;
  double coarse_px, misfit; /* spread with the coarsest knots, and that over the rough noise */
  int shift;          /* that all numbers ask for */
  double geometry_px; /* of the instrument's uncertainty, what no smooth surface follows */
  bool starts_anew, continues; /* whether a start that was given is passed over; was of use */
  placido_refinement refinement;
  const placido_instrument *instrument;
  const placido_fit_options *options;
  int threads;
} progress;

/* How many modes of the geometry's uncertainty count; 0: nothing is known of it. */
static int modes_of(const placido_fit_options *options) {
  if (!options || !options->geometry) {
    return 0;
  }
  int all = options->geometry->mode_count, asked = options->geometry_modes;
  return asked > 0 && asked < all ? asked : all;
}

/* The conicoid is found from every stride-th sample: it has four unknowns. */
static int find_base(progress *p, placido_error *err) {
  size_t stride = p->count / BASE_POINTS + 1, few = 0;
  placido_bundle rays = {0};
  placido_sample *some = placido_memory_new(p->count / stride + 1, sizeof *some, err);
  if (!some) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < p->count; i += stride) {
    some[few++] = p->samples[i];
  }
  int status = placido_bundle_new(&rays, some, few, err);
  if (!status) {
    status = placido_conic_fit(&p->base, &rays, p->axis.z_mm, p->threads, err);
  }
  placido_bundle_free(&rays);
  placido_memory_free(some);
  return status;
}

static int fit_base(progress *p, placido_error *err) {
  int status = find_base(p, err);
  if (status) {
    return status;
  }
  placido_target target = {.base = p->base};
  placido_bundle_trace(&p->rays, &target, p->threads);
  placido_bundle_tell(&p->rays);
  p->reach_mm = 0;
  for (size_t i = 0; i < p->count; i++) {
    const placido_sample *s = &p->samples[i];
    if (fabs(s->residual_px) < FAR_PX) {
      p->reach_mm = fmax(p->reach_mm, fmax(fabs(s->hit.x), fabs(s->hit.y)));
    }
  }
  int modes = modes_of(p->options);
  if (modes > 0) {
    placido_bundle_tell_all(&p->rays, &target, p->threads);
    p->geometry_px = placido_geometry_rough(p->samples, p->count, p->mires, p->instrument,
                                            p->options->geometry, modes);
  }
  if (!(p->reach_mm > 0.5) || p->reach_mm > RADIUS_MAX_MM) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires would lie within %.2f mm of the axis, 0.5 to %d mm are "
                             "possible: instrument, distance or numbering is wrong",
                             p->reach_mm, RADIUS_MAX_MM);
  }
  return PLACIDO_OK;
}

static double smoothing_of(const placido_fit_options *options) {
  return options && options->smoothing > 0 ? options->smoothing : 1e3;
}

static int steps_of(const placido_fit_options *options) {
  return options && options->steps_max > 0 ? options->steps_max : 40;
}

/* A fresh refinement of some rays on a grid. */
static int refinement_of(placido_refinement *r, const progress *p, const placido_grid *grid,
                         placido_bundle *rays, placido_error *err) {
  const placido_fit_options *o = p->options;
  return placido_refinement_new(r, &p->base, grid, rays,
                                smoothing_of(o), steps_of(o), p->threads, err);
}

/* The samples on every third meridian: enough to choose knots by, at a third of the cost. */
static size_t thin_out(placido_sample *some, const progress *p) {
  size_t few = 0;
  for (size_t i = 0; i < p->count; i++) {
    double meridian = p->mires->points[i].meridian_deg * p->mires->meridian_count / 360;
    if (lrint(meridian) % EXPLORE_STRIDE == 0) {
      some[few++] = p->samples[i];
    }
  }
  return few;
}

/* Chooses the grid: knots as fine as the samples ask for, or as the caller asked. Finer knots that
 * do not help are given up again: then it is the instrument's geometry that does not fit, not the
 * spline. Leaves the chosen grid's refinement, where the one of all samples starts. */
static int explore(placido_refinement *coarse, placido_grid *grid, progress *p,
                   placido_bundle *rays, placido_error *err) {
  double asked = p->options ? p->options->knot_mm : 0;
  placido_refinement finer = {0};
  placido_grid finer_grid;
  int choices = asked > 0 ? 1 : KNOT_CHOICES, status = PLACIDO_OK;
  for (int choice = 0; choice < choices && !status; choice++) {
    finer_grid = placido_grid_covering(p->reach_mm + MARGIN_MM,
                                       asked > 0 ? asked : KNOTS_MM[choice]);
    status = refinement_of(&finer, p, &finer_grid, rays, err);
    if (!status) {
      status = placido_refinement_run(&finer, SETTLED_ROUGHLY, err);
    }
    if (status || (choice && finer.sigma_px > GAIN * coarse->sigma_px)) {
      break;
    }
    placido_refinement_free(coarse);
    *coarse = finer;
    *grid = finer_grid;
    coarse->shape.grid = grid;
    finer = (placido_refinement){0};
    double rough = placido_noise_rough(rays->samples, rays->count, p->mires, EXPLORE_STRIDE,
                                       coarse->work);
    rough = hypot(rough, p->geometry_px); /* finer knots would follow the edges' errors */
    if (choice == 0) {
      p->coarse_px = coarse->sigma_px;
      p->misfit = coarse->sigma_px / rough;
    }
    if (coarse->sigma_px < MISFIT * rough) {
      break;
    }
    choice += coarse->sigma_px > MISFIT_FAR * rough && choice + 2 < choices;
  }
  placido_refinement_free(&finer);
  return status;
}

/* From the previous frame's fit, where there is one that is near enough: else `coarse` stays empty. */
static int continue_start(placido_refinement *coarse, placido_grid *grid, progress *p,
                          placido_bundle *rays, placido_error *err) {
  const placido_fit_options *o = p->options;
  if (!o || !o->start || p->starts_anew ||
      (o->knot_mm > 0 && o->knot_mm != o->start->grid.knot_mm)) {
    return PLACIDO_OK;
  }
  const placido_warm_options warm = {.axis_z_mm = p->axis.z_mm,
                                     .margin_mm = MARGIN_MM,
                                     .smoothing = smoothing_of(o),
                                     .settled = SETTLED_ROUGHLY,
                                     .steps_max = steps_of(o),
                                     .threads = p->threads};
  int status = placido_warm_start(coarse, &p->base, grid, o->start, rays, &warm, err);
  p->continues = !status && coarse->coefficients;
  return status;
}

static int fit_spline(progress *p, placido_grid *grid, placido_error *err) {
  placido_refinement coarse = {0};
  placido_bundle rays = {0};
  placido_sample *some = placido_memory_new(p->count, sizeof *some, err);
  int status = some ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = placido_bundle_new(&rays, some, thin_out(some, p), err);
  }
  if (!status) {
    status = continue_start(&coarse, grid, p, &rays, err);
  }
  if (!status && !coarse.coefficients && !(status = fit_base(p, err))) {
    status = explore(&coarse, grid, p, &rays, err);
  }
  if (!status) {
    status = placido_refinement_aim(&coarse, &p->rays, err);
  }
  if (!status) {
    p->refinement = coarse;
    coarse = (placido_refinement){0};
    if ((double)rays.count < POINTS_PLENTY * (double)grid->side * grid->side) {
      status = placido_refinement_run(&p->refinement, SETTLED_TO_CUT, err);
    }
  }
  if (!status) {
    placido_refinement_trace(&p->refinement);
  }
  placido_refinement_free(&coarse);
  placido_bundle_free(&rays);
  placido_memory_free(some);
  return status;
}

/* The spread that the coarsest knots leave if all numbers are `shift` larger; INFINITY where there
 * is no such cornea. */
static int try_shift(double *spread_px, const progress *p, int shift, placido_error *err) {
  placido_mires mires;
  progress q = {.mires = &mires,
                .axis = p->axis,
                .instrument = p->instrument,
                .options = p->options,
                .threads = p->threads};
  placido_grid grid;
  *spread_px = INFINITY;
  int status = placido_numbering_shifted(&mires, p->mires, shift, EXPLORE_STRIDE, err);
  q.count = status ? 0 : mires.count;
  if (status || q.count < POINTS_MIN / EXPLORE_STRIDE ||
      (status = placido_samples_new(&q.samples, &mires, p->instrument, p->axis.z_mm, err)) ||
      (status = placido_bundle_new(&q.rays, q.samples, q.count, err)) ||
      (status = fit_base(&q, err))) {
    goto done;
  }
  grid = placido_grid_covering(q.reach_mm + MARGIN_MM, KNOTS_MM[0]);
  status = refinement_of(&q.refinement, &q, &grid, &q.rays, err);
  if (!status && !(status = placido_refinement_run(&q.refinement, SETTLED_ROUGHLY, err))) {
    *spread_px = q.refinement.sigma_px;
  }
done:
  placido_refinement_free(&q.refinement);
  placido_bundle_free(&q.rays);
  placido_memory_free(q.samples);
  placido_mires_free(&mires);
  return status == PLACIDO_QUALITY ? PLACIDO_OK : status;
}

/* Whether all mires together are misnumbered by one: then another numbering leaves far less. */
static int find_shift(progress *p, placido_error *err) {
  double best = SHIFTED * p->coarse_px, spread;
  placido_error ignored = {0};
  for (int shift = -2; shift <= 2; shift += 4) {
    int status = try_shift(&spread, p, shift, &ignored);
    if (status) {
      return placido_error_set(err, status, "%s", ignored.text);
    }
    if (spread < best) {
      best = spread;
      p->shift = shift;
    }
  }
  return PLACIDO_OK;
}

/* Cuts the outliers and fits again until that changes nothing, at most twice. */
static int fit_robust(progress *p, placido_grid *grid, placido_notes *notes,
                      placido_error *err) {
  placido_refinement *r = &p->refinement;
  size_t cut = 0;
  bool changed = true;
  int status = fit_spline(p, grid, err);
  if (!status && p->misfit > MISFIT && (status = find_shift(p, err)) == PLACIDO_OK && p->shift) {
    return PLACIDO_OK;
  }
  if (!status) {
    status = placido_noise_find(p->samples, p->count, p->mires, err);
  }
  if (!status) {
    placido_refinement_trace(r);
  }
  for (int pass = 0; pass < 2 && changed && !status; pass++) {
    status = placido_outliers_cut(p->samples, p->count, r->work, &cut, &changed, err);
    if (!status && (double)cut > CUT_MOST * (double)p->count) {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "%.0f %% of the edge points do not lie on any smooth cornea "
                                 "(limit %.0f %%)",
                                 100.0 * (double)cut / (double)p->count, 100 * CUT_MOST);
    }
    if (!status) {
      status = placido_refinement_run(r, pass ? SETTLED : SETTLED_ROUGHLY, err);
    }
  }
  if (!status && (double)cut > FOLD_CUT * (double)p->count && p->mires->stray > FOLD_STRAY) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "the mires contradict each other: %.0f %% of the edge points do not "
                               "lie on any smooth cornea, and on %.0f %% of the meridians edges "
                               "among them cannot be numbered, as where a cornea folds the mires",
                               100.0 * (double)cut / (double)p->count, 100 * p->mires->stray);
  }
  if (!status) {
    status = placido_outliers_judge(p->samples, p->count, p->mires, r->work, notes, err);
  }
  if (!status && (double)cut > CUT_MANY * (double)p->count) {
    placido_notes_add(notes, "%.0f %% of the edge points were set aside as outliers",
                      100.0 * (double)cut / (double)p->count);
  }
  return status;
}

/* Where data support the surface; folds are left out. */
static int cover(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                 const progress *p, placido_notes *notes, placido_error *err) {
  placido_place *folds = placido_memory_new(p->count, sizeof *folds, err);
  int status = folds ? placido_mask_new(coverage, mask, radius_mm, p->samples, p->count, err)
                     : PLACIDO_MEMORY;
  size_t folded = status ? 0 : placido_fold_find(folds, p->samples, p->count, p->mires);
  if (folded) {
    double share = placido_fold_mask(coverage, *mask, folds, folded);
    placido_notes_add(notes,
                      "the cornea folds the mires about x = %.1f, y = %.1f mm: %.0f %% of the map "
                      "are left out",
                      folds[folded / 2].x_mm, folds[folded / 2].y_mm, 100 * share);
  }
  placido_memory_free(folds);
  return status;
}

/* Knots and coefficients as a part of the surface file. */
static int build_surface(placido_fit *fit, progress *p, placido_notes *notes,
                         placido_error *err) {
  const placido_grid *g = &fit->grid;
  placido_coverage coverage;
  unsigned char *mask = NULL;
  size_t knots = (size_t)(g->side + PLACIDO_SPLINE_ORDER);
  double *places = placido_memory_new(knots, sizeof *places, err);
  int status = places ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = cover(&coverage, &mask, &fit->summary.radius_mm, p, notes, err);
  }
  if (!status) {
    for (size_t i = 0; i < knots; i++) {
      places[i] = ((double)i - PLACIDO_SPLINE_DEGREE) * g->knot_mm - g->half_mm;
    }
    /* the spline was fitted to z, the file holds sags */
    size_t n = (size_t)g->side * (size_t)g->side;
    for (size_t i = 0; i < n; i++) {
      p->refinement.coefficients[i] = -p->refinement.coefficients[i];
    }
    placido_part parts[2] = {placido_conic_part(&p->base),
                             {.kind = PLACIDO_PART_BSPLINE,
                              .as.bspline = {PLACIDO_SPLINE_DEGREE, g->side, g->side, places,
                                             places, p->refinement.coefficients}}};
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

static void summarise(placido_fit *fit, const progress *p) {
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
static int find_errors(placido_fit *fit, progress *p, placido_error *err) {
  const placido_fit_options *o = p->options;
  const placido_refinement *r = &p->refinement;
  placido_moves moves = {0};
  int status = PLACIDO_OK, modes = modes_of(o);
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
    status = placido_scatter_find(&fit->scatter, r, p->mires, r->work, fit->inverse, err);
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
  const placido_uncertainty *geometry = options ? options->geometry : NULL;
  if (geometry && geometry->mode_count > 0 && geometry->edge_count != instrument->edge_count) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the geometry's uncertainty is of %d edges, the instrument has %d",
                             geometry->edge_count, instrument->edge_count);
  }
  return PLACIDO_OK;
}

static void forget(progress *p) {
  placido_refinement_free(&p->refinement);
  placido_bundle_free(&p->rays);
  placido_memory_free(p->samples);
  p->samples = NULL;
  p->shift = 0;
}

/* From the points to a surface that agrees with their numbers, as far as these go. */
static int fit_points(progress *p, placido_grid *grid, placido_notes *notes, placido_error *err) {
  size_t doubtful;
  p->count = p->mires->count;
  int status = placido_samples_new(&p->samples, p->mires, p->instrument, p->axis.z_mm, err);
  if (!status) {
    status = placido_numbering_doubt(p->samples, p->count, p->mires, &doubtful, err);
  }
  if (!status && !(status = placido_bundle_new(&p->rays, p->samples, p->count, err))) {
    status = fit_robust(p, grid, notes, err);
  }
  return status;
}

/* Corrects numbers that the surface contradicts. `changed`: it did. */
static int renumber(progress *p, bool *changed, placido_notes *notes, placido_error *err) {
  size_t moved = 0;
  int status = PLACIDO_OK;
  if (p->shift) {
    placido_numbering_shift(p->mires, p->shift);
    placido_notes_add(notes, "all mires were numbered one too far %s: corrected, since only so does "
                             "a smooth cornea fit",
                      p->shift < 0 ? "out" : "in");
  } else {
    placido_refinement_tell(&p->refinement);
    status = placido_numbering_settle(p->mires, p->samples, p->count, p->instrument,
                                      RENUMBER * p->refinement.sigma_px, &moved, err);
    if (moved) {
      placido_notes_add(notes, "%zu edge points were numbered anew: they lie where the surface "
                               "mirrors another mire",
                        moved);
    }
  }
  *changed = p->shift || moved;
  return status;
}

/* Fits until the numbers are in order. */
static int fit_numbered(progress *p, placido_grid *grid, placido_notes *notes,
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
static int fit_distance(progress *p, placido_grid *grid, placido_notes *notes,
                        placido_error *err) {
  const placido_fit_options *o = p->options;
  const placido_distance_source source = {p->mires, p->instrument, o ? o->geometry : NULL,
                                          modes_of(o), SETTLED};
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

int placido_fit_new(placido_fit **fit, placido_mires *mires,
                    const placido_instrument *instrument, const placido_fit_options *options,
                    placido_notes *notes, placido_error *err) {
  *fit = NULL;
  progress p = {.mires = mires,
                .count = mires->count,
                .axis = placido_axis_given(options ? options->axis_z_mm : 0,
                                           options ? options->axis_z_sigma_mm : 0),
                .instrument = instrument,
                .options = options,
                .threads = options && options->threads > 0 ? options->threads : 1};
  if (mires->count < POINTS_MIN) {
    return placido_error_set(err, PLACIDO_QUALITY, "only %zu edge points, at least %d are needed",
                             mires->count, POINTS_MIN);
  }
  int status = check_options(options, instrument, err);
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
  *fit = f;
  f = NULL;
done:
  placido_fit_free(f);
  forget(&p);
  return status;
}

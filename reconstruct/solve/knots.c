/* The second stage of a fit: the spline, its knots as fine as the residuals ask for. How fine that
 * is is explored on every third meridian, coarse to fine; so are other numberings of all mires. */
#include "base/memory.h"
#include "reconstruct/solve/doubt/misfit.h"
#include "reconstruct/solve/doubt/numbering.h"
#include "reconstruct/solve/engine/prolong.h"
#include "reconstruct/solve/errors/noise.h"
#include "reconstruct/solve/solution.h"
#include "reconstruct/solve/warm.h"

#include <math.h>

#define MARGIN_MM 0.6 /* of spline beyond the outermost point */
#define EXPLORE_STRIDE 3
#define GAIN 0.85 /* finer knots must bring the spread below this share of what it was */
/* Spread over rough noise at which the next finer knots would not do: they about halve it. */
#define MISFIT_FAR 2.5
#define SHIFTED 0.6        /* of the spread, which another numbering of all mires must stay below */
#define SETTLED_TO_CUT 0.1 /* what is left is a small part of an outlier's distance */
#define POINTS_PLENTY 4.0  /* a coefficient: what these tell is good enough to cut by */

static const double KNOTS_MM[] = {0.5, 0.35, 0.25};
#define KNOT_CHOICES (int)(sizeof KNOTS_MM / sizeof KNOTS_MM[0])

static double smoothing_of(const placido_fit_options *options) {
  return options && options->smoothing > 0 ? options->smoothing : 1e3;
}

static int steps_of(const placido_fit_options *options) {
  return options && options->steps_max > 0 ? options->steps_max : 40;
}

static int degree_of(const placido_fit_options *options) {
  return options && options->degree ? options->degree : PLACIDO_SPLINE_DEGREE;
}

/* A fresh refinement of some rays on a grid. */
static int refinement_of(placido_refinement *r, const placido_solution *p, const placido_grid *grid,
                         placido_sightlines *rays, placido_error *err) {
  const placido_fit_options *o = p->options;
  return placido_refinement_new(r, &p->base, grid, rays, smoothing_of(o), steps_of(o), p->threads,
                                err);
}

/* The samples on every third meridian: enough to choose knots by, at a third of the cost. */
static size_t thin_out(placido_sample *some, const placido_solution *p) {
  size_t few = 0;
  for (size_t i = 0; i < p->count; i++) {
    double meridian = p->mires->points[i].meridian_deg * p->mires->meridian_count / 360;
    if (lrint(meridian) % EXPLORE_STRIDE == 0) {
      some[few++] = p->samples[i];
    }
  }
  return few;
}

/* Refines on a grid from where the one on coarser knots ended, if there is one: from the conicoid
 * alone fine knots find folds where there are none. */
static int refine_from(placido_refinement *finer, const placido_refinement *coarse,
                       const placido_solution *p, const placido_grid *grid,
                       placido_sightlines *rays, placido_error *err) {
  int status = refinement_of(finer, p, grid, rays, err);
  if (!status && coarse->coefficients) {
    status = placido_grid_prolong(finer->coefficients, grid, coarse->coefficients,
                                  coarse->shape.grid, err);
  }
  return status ? status : placido_refinement_run(finer, PLACIDO_SETTLED_ROUGHLY, err);
}

/* The knot spacings to try one after the other; returns how many. The caller's own comes behind the
 * coarsest, from which finer ones start. */
static int list_knots(double knots_mm[KNOT_CHOICES], double asked_mm) {
  int count = 0;
  for (int i = 0; i < KNOT_CHOICES; i++) {
    if (asked_mm == 0 || (i == 0 && asked_mm < KNOTS_MM[0])) {
      knots_mm[count++] = KNOTS_MM[i];
    }
  }
  if (asked_mm > 0) {
    knots_mm[count++] = asked_mm;
  }
  return count;
}

/* How far a refinement follows the points: their spread, that over their rough noise, and the same
 * in the worst place. */
typedef struct following {
  double spread_px, left, left_local;
} following;

/* Finer knots would follow the edges' own errors, so that the geometry's count as noise. */
static int look(following *f, const placido_refinement *r, const placido_solution *p,
                const placido_sightlines *rays, placido_error *err) {
  double rough =
      placido_noise_rough(rays->samples, rays->count, p->mires, EXPLORE_STRIDE, r->work);
  int status = placido_misfit_worst(&f->left_local, NULL, rays->samples, rays->count, p->mires,
                                    EXPLORE_STRIDE, err);
  f->spread_px = r->sigma_px;
  f->left = r->sigma_px / hypot(rough, p->geometry_px);
  f->left_local *= rough / hypot(rough, p->geometry_px);
  return status;
}

static bool helps(const following *finer, const following *coarse) {
  return finer->spread_px <= GAIN * coarse->spread_px ||
         (coarse->left_local > PLACIDO_MISFIT_LOCAL &&
          finer->left_local <= GAIN * coarse->left_local);
}

static bool is_enough(const following *f) {
  return f->left < PLACIDO_MISFIT && f->left_local < PLACIDO_MISFIT_LOCAL;
}

/* Chooses the grid: knots as fine as the samples ask for, or as the caller asked. Finer knots that
 * do not help are given up again: then it is the instrument's geometry that does not fit, not the
 * spline. Leaves the chosen grid's refinement, where the one of all samples starts. */
static int explore(placido_refinement *coarse, placido_grid *grid, placido_solution *p,
                   placido_sightlines *rays, placido_error *err) {
  double asked = p->options ? p->options->knot_mm : 0, knots_mm[KNOT_CHOICES];
  placido_refinement finer = {0};
  placido_grid finer_grid;
  following now, before = {0};
  int choices = list_knots(knots_mm, asked), status = PLACIDO_OK;
  for (int choice = 0; choice < choices; choice++) {
    finer_grid = placido_grid_covering(p->reach_mm + MARGIN_MM, knots_mm[choice],
                                       degree_of(p->options));
    status = refine_from(&finer, coarse, p, &finer_grid, rays, err);
    if (!status) {
      status = look(&now, &finer, p, rays, err);
    }
    if (status || (choice && asked == 0 && !helps(&now, &before))) {
      break;
    }
    placido_refinement_free(coarse);
    *coarse = finer;
    *grid = finer_grid;
    coarse->shape.grid = grid;
    finer = (placido_refinement){0};
    before = now;
    if (choice == 0) {
      p->coarse_px = now.spread_px;
      p->misfit = now.left;
    }
    if (asked == 0 && is_enough(&now)) {
      break;
    }
    choice += asked == 0 && now.left > MISFIT_FAR && choice + 2 < choices;
  }
  placido_refinement_free(&finer);
  return status;
}

static bool may_continue(const placido_solution *p) {
  const placido_fit_options *o = p->options;
  return o && o->start && !p->starts_anew &&
         (o->knot_mm == 0 || o->knot_mm == o->start->grid.knot_mm) &&
         degree_of(o) == o->start->grid.order - 1;
}

/* From the previous frame's fit, where that is near enough: else `coarse` stays empty. */
static int continue_start(placido_refinement *coarse, placido_grid *grid, placido_solution *p,
                          placido_sightlines *rays, placido_error *err) {
  const placido_fit_options *o = p->options;
  const placido_warm_options warm = {.axis_z_mm = p->axis.z_mm,
                                     .margin_mm = MARGIN_MM,
                                     .smoothing = smoothing_of(o),
                                     .settled = PLACIDO_SETTLED_ROUGHLY,
                                     .steps_max = steps_of(o),
                                     .threads = p->threads};
  int status = placido_warm_start(coarse, &p->base, grid, o->start, rays, &warm, err);
  p->continues = !status && coarse->coefficients;
  return status;
}

int placido_solution_spline(placido_solution *p, placido_grid *grid, placido_error *err) {
  placido_refinement coarse = {0};
  placido_sightlines rays = {0};
  placido_sample *some = placido_memory_new(p->count, sizeof *some, err);
  int status = some ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = placido_sightlines_new(&rays, some, thin_out(some, p), err);
  }
  if (!status && may_continue(p)) {
    status = continue_start(&coarse, grid, p, &rays, err);
  }
  if (!status && !coarse.coefficients && !(status = placido_solution_base(p, err))) {
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
  placido_sightlines_free(&rays);
  placido_memory_free(some);
  return status;
}

/* The spread that the first knots of all leave if all numbers are `shift` larger; INFINITY where there
 * is no such cornea. */
static int try_shift(double *spread_px, const placido_solution *p, int shift, placido_error *err) {
  placido_mires mires;
  placido_solution q = {.mires = &mires,
                        .axis = p->axis,
                        .instrument = p->instrument,
                        .options = p->options,
                        .threads = p->threads};
  placido_grid grid;
  double knots_mm[KNOT_CHOICES];
  list_knots(knots_mm, p->options ? p->options->knot_mm : 0);
  *spread_px = INFINITY;
  int status = placido_numbering_shifted(&mires, p->mires, shift, EXPLORE_STRIDE, err);
  q.count = status ? 0 : mires.count;
  if (status || q.count < PLACIDO_POINTS_MIN / EXPLORE_STRIDE ||
      (status = placido_samples_new(&q.samples, &mires, p->instrument, p->axis.z_mm, err)) ||
      (status = placido_sightlines_new(&q.rays, q.samples, q.count, err)) ||
      (status = placido_solution_base(&q, err))) {
    goto done;
  }
  grid = placido_grid_covering(q.reach_mm + MARGIN_MM, knots_mm[0], degree_of(p->options));
  status = refinement_of(&q.refinement, &q, &grid, &q.rays, err);
  if (!status && !(status = placido_refinement_run(&q.refinement, PLACIDO_SETTLED_ROUGHLY, err))) {
    *spread_px = q.refinement.sigma_px;
  }
done:
  placido_refinement_free(&q.refinement);
  placido_sightlines_free(&q.rays);
  placido_memory_free(q.samples);
  placido_mires_free(&mires);
  return status == PLACIDO_QUALITY ? PLACIDO_OK : status;
}

/* Whether all mires together are misnumbered by one: then another numbering leaves far less. */
int placido_solution_shift(placido_solution *p, placido_error *err) {
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

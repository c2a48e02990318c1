/* The third stage of a fit: the noise of the points, outliers cut, folds refused. */
#include "reconstruct/solve/doubt/misfit.h"
#include "reconstruct/solve/doubt/outliers.h"
#include "reconstruct/solve/errors/noise.h"
#include "reconstruct/solve/solution.h"

#include <math.h>

#define CUT_MOST 0.3 /* share of the points: more means that the model is wrong, not the points */
#define CUT_MANY 0.1 /* share that the user is told of */
#define CUTS 2       /* rounds of cutting and fitting again */
#define CUTS_MOST 6  /* and where points that were kept lie far off still */
#define ROUGH 2.0    /* their root mean square over their robust spread: noise leaves 1 */

/* A fold leaves a small residual and a wrong surface; it shows in points that do not fit together
 * with edges that cannot be numbered. Lashes give the one, a broken tear film the other. Where
 * there is a hole in the middle of the map as well, fewer such points tell: lashes leave under 0.01
 * of them, and holes that are open to the outside. */
#define FOLD_CUT 0.06
#define FOLD_CUT_HOLE 0.02
#define FOLD_HOLE_MM2 0.5
#define FOLD_STRAY 0.05

/* Of noise in one place: where the finest knots leave it, not what a lash at the rim of a gap does. */
#define MISFIT_TOLD (2 * PLACIDO_MISFIT_LOCAL)

static int refuse_fold(const placido_solution *p, placido_error *err) {
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the mires contradict each other: %.0f %% of the edge points do not lie "
                           "on any smooth cornea, and on %.0f %% of the meridians edges among them "
                           "cannot be numbered, as where a cornea folds the mires",
                           100 * p->cut, 100 * p->mires->stray);
}

double placido_solution_settled(const placido_fit_options *options, double usual) {
  double tolerance = options ? options->tolerance : 0;
  return tolerance > 0 ? tolerance * tolerance : usual;
}

/* Says where the knots are too coarse for a place that is too small to show in all points. */
static int tell_misfit(const placido_solution *p, double knot_mm, placido_notes *notes,
                       placido_error *err) {
  placido_place place;
  double worst;
  int status =
      placido_misfit_worst(&worst, &place, p->samples, p->count, p->mires, 1, err);
  if (!status && worst > MISFIT_TOLD) {
    placido_notes_add(notes,
                      "about x = %.1f, y = %.1f mm the edges lie off the surface by %.0f times their "
                      "noise: the cornea is too steep there for knots every %g mm, and the error "
                      "bars do not know of it",
                      place.x_mm, place.y_mm, worst, knot_mm);
  }
  return status;
}

/* Whether a few of the points that were kept are no noise. */
static bool is_rough(const placido_solution *p) {
  double sum = 0;
  size_t used = 0;
  for (size_t i = 0; i < p->count; i++) {
    const placido_sample *s = &p->samples[i];
    if (s->used && !isnan(s->residual_px)) {
      sum += s->residual_px * s->residual_px;
      used++;
    }
  }
  return sqrt(sum / (double)used) > ROUGH * p->refinement.sigma_px;
}

/* Cuts the outliers and fits again until that changes nothing, at most twice unless something is
 * far off. */
int placido_solution_robust(placido_solution *p, placido_grid *grid, placido_notes *notes,
                            placido_error *err) {
  placido_refinement *r = &p->refinement;
  size_t cut = 0;
  bool changed = true;
  double last = placido_solution_settled(p->options, PLACIDO_SETTLED), settled = INFINITY;
  double most = placido_solution_settled(p->options, PLACIDO_SETTLED_ROUGHLY);
  int status = placido_solution_spline(p, grid, err);
  if (!status && p->misfit > PLACIDO_MISFIT &&
      (status = placido_solution_shift(p, err)) == PLACIDO_OK && p->shift) {
    return PLACIDO_OK;
  }
  if (!status) {
    status = placido_noise_find(p->samples, &p->kin_px, p->count, p->mires, err);
  }
  if (!status) {
    placido_refinement_trace(r);
  }
  for (int pass = 0; changed && !status && (pass < CUTS || (pass < CUTS_MOST && is_rough(p)));
       pass++) {
    status = placido_outliers_cut(p->samples, p->count, r->work, &cut, &changed, err);
    if (!status && (double)cut > CUT_MOST * (double)p->count) {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "%.0f %% of the edge points do not lie on any smooth cornea "
                                 "(limit %.0f %%)",
                                 100.0 * (double)cut / (double)p->count, 100 * CUT_MOST);
    }
    if (!status) {
      settled = pass ? last : fmax(last, PLACIDO_SETTLED_ROUGHLY);
      status = placido_refinement_run(r, settled, err);
    }
  }
  if (!status && settled > most) { /* nothing was cut, and more was asked for */
    status = placido_refinement_run(r, most, err);
  }
  p->cut = (double)cut / (double)p->count;
  if (!status && p->cut > FOLD_CUT && p->mires->stray > FOLD_STRAY) {
    status = refuse_fold(p, err);
  }
  if (!status) {
    status = placido_outliers_judge(p->samples, p->count, p->mires, r->work, notes, err);
  }
  if (!status) {
    status = tell_misfit(p, grid->knot_mm, notes, err);
  }
  if (!status && p->cut > CUT_MANY) {
    placido_notes_add(notes, "%.0f %% of the edge points were set aside as outliers", 100 * p->cut);
  }
  return status;
}

int placido_solution_check_hole(const placido_solution *p, double hole_mm2, placido_error *err) {
  bool fold = p->cut > FOLD_CUT_HOLE && p->mires->stray > FOLD_STRAY && hole_mm2 > FOLD_HOLE_MM2;
  return fold ? refuse_fold(p, err) : PLACIDO_OK;
}

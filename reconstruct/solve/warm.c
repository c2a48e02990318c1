/* The earlier spline is taken over as it stands: knots are multiples of their spacing from the
 * axis, so that a wider or narrower square has the same ones. */
#include "reconstruct/solve/warm.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

/* From this near Gauss-Newton needs a step or two. An eye that moves by 0.1 mm between frames moves
 * its mires by some 5 px; those of another eye are off by more. */
#define NEAR_PX 8.0
#define SHARE_LEAST 0.95 /* of the rays must meet the earlier surface */
#define WORSE 1.25       /* times the earlier spread: not the same cornea, or other knots */

/* The earlier coefficients on a square of the same knots; beyond the earlier square the outermost
 * ones go on. */
static void take_over(double *coefficients, const placido_grid *grid, const placido_fit *start) {
  int off = (grid->side - start->grid.side) / 2, last = start->grid.side - 1;
  for (int j = 0; j < grid->side; j++) {
    int row = j - off < 0 ? 0 : j - off > last ? last : j - off;
    for (int i = 0; i < grid->side; i++) {
      int column = i - off < 0 ? 0 : i - off > last ? last : i - off;
      coefficients[j * grid->side + i] = -start->sags_mm[row * start->grid.side + column];
    }
  }
}

/* Where the rays meet the earlier shape: their spread, which is INFINITY where too few do, and how
 * far out they lie. */
static int trace(double *spread_px, double *reach_mm, const placido_conicoid *base,
                 const placido_fit *start, placido_sightlines *rays, int threads,
                 placido_error *err) {
  size_t met = 0, numbers = (size_t)start->grid.side * (size_t)start->grid.side;
  double *work = placido_memory_new(numbers + rays->count, sizeof *work, err);
  *reach_mm = 0;
  int status = work ? placido_sightlines_fit_grid(rays, &start->grid, err) : PLACIDO_MEMORY;
  if (!status) {
    double *residuals = work + numbers;
    const placido_target target = {*base, &start->grid, work};
    take_over(work, &start->grid, start);
    placido_sightlines_trace(rays, &target, threads);
    placido_sightlines_tell(rays);
    for (size_t i = 0; i < rays->count; i++) {
      const placido_sample *s = &rays->samples[i];
      if (!isnan(s->residual_px)) {
        residuals[met++] = fabs(s->residual_px);
        *reach_mm = fmax(*reach_mm, fmax(fabs(s->hit.x), fabs(s->hit.y)));
      }
    }
    *spread_px = (double)met < SHARE_LEAST * (double)rays->count
                     ? (double)INFINITY
                     : 1.4826 * placido_quantile(residuals, met, 0.5);
  }
  placido_memory_free(work);
  return status;
}

/* Refines from the earlier coefficients; status PLACIDO_QUALITY where that leads nowhere. */
static int refine(placido_refinement *r, const placido_conicoid *base, const placido_grid *grid,
                  const placido_fit *start, placido_sightlines *rays,
                  const placido_warm_options *options, placido_error *err) {
  int status = placido_refinement_new(r, base, grid, rays, options->smoothing, options->steps_max,
                                      options->threads, err);
  if (!status) {
    take_over(r->coefficients, grid, start);
    status = placido_refinement_run(r, options->settled, err);
  }
  if (!status && r->sigma_px > WORSE * start->summary.sigma_px) {
    status = PLACIDO_QUALITY;
  }
  return status;
}

int placido_warm_start(placido_refinement *r, placido_conicoid *base, placido_grid *grid,
                       const placido_fit *start, placido_sightlines *rays,
                       const placido_warm_options *options, placido_error *err) {
  placido_error ignored = {0};
  double spread_px, reach_mm;
  *r = (placido_refinement){0};
  *base = start->base;
  base->apex_z_mm += options->axis_z_mm - start->axis_z_mm;
  int status = trace(&spread_px, &reach_mm, base, start, rays, options->threads, err);
  if (status) {
    return status;
  }
  *grid = placido_grid_covering(reach_mm + options->margin_mm, start->grid.knot_mm,
                                start->grid.order - 1);
  if (spread_px < NEAR_PX) {
    status = refine(r, base, grid, start, rays, options, &ignored);
    if (status) {
      placido_refinement_free(r);
    }
  }
  return status == PLACIDO_MEMORY ? placido_error_set(err, status, "%s", ignored.text) : PLACIDO_OK;
}

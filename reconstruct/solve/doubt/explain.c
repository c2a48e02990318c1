/* Part of a wrong geometry the surface cannot follow: it stays in the residuals, alike along whole
 * edges, and is no noise of theirs. How far each mode shows is estimated by ridge regression with
 * the mode's standard deviation as its prior (Rasmussen & Williams, Gaussian Processes, 2006,
 * eq. 2.8); what it explains counts as geometry, not as noise once more. */
#include "reconstruct/solve/doubt/explain.h"

#include "base/dense.h"
#include "base/memory.h"
#include "reconstruct/solve/errors/noise.h"

#include <math.h>

#define PASSES 3 /* noise and amplitudes, each from the other; settles at once */

/* The residuals' equations for the modes' amplitudes: (1 + matrix/noise) amplitude = side/noise. */
struct equations {
  int modes;
  double *matrix, *side; /* modes × modes (lower triangle), modes */
  double *factor, *amplitude;
};

static void equations_free(struct equations *e) {
  placido_memory_free(e->matrix);
  placido_memory_free(e->side);
  placido_memory_free(e->factor);
  placido_memory_free(e->amplitude);
}

static int equations_new(struct equations *e, int modes, placido_error *err) {
  size_t n = (size_t)modes;
  *e = (struct equations){.modes = modes,
                          .matrix = placido_memory_new(n * n, sizeof *e->matrix, err),
                          .side = placido_memory_new(n, sizeof *e->side, err),
                          .factor = placido_memory_new(n * n, sizeof *e->factor, err),
                          .amplitude = placido_memory_new(n, sizeof *e->amplitude, err)};
  return e->matrix && e->side && e->factor && e->amplitude ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* Turns the change of the residuals under a surface that is held into what is left of it once the
 * surface has answered. */
static void let_surface_answer(placido_moves *moves, const placido_refinement *r) {
  int side = r->shape.grid->side, order = r->shape.grid->order;
  size_t n = (size_t)side * (size_t)side;
#pragma omp parallel for num_threads(r->threads)
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (!s->used || isnan(s->residual_px)) {
      continue;
    }
    double row[PLACIDO_SPLINE_CELL], *change = moves->change + i * (size_t)moves->modes;
    placido_sample_row(row, s, r->sigma_px);
    for (int m = 0; m < moves->modes; m++) {
      const double *corner =
          moves->coefficients + (size_t)m * n + s->basis.row * side + s->basis.column;
      for (int k = 0; k < order * order; k++) {
        change[m] += row[k] * corner[k / order * side + k % order];
      }
    }
  }
}

static void fill(struct equations *e, const placido_refinement *r, const placido_moves *moves) {
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (!s->used || isnan(s->residual_px)) {
      continue;
    }
    double row[PLACIDO_SPLINE_CELL], weight = placido_sample_row(row, s, r->sigma_px);
    const double *change = moves->change + i * (size_t)e->modes;
    for (int m = 0; m < e->modes; m++) {
      double left = weight * change[m], *line = e->matrix + (size_t)m * (size_t)e->modes;
      e->side[m] += left * s->residual_px / r->sigma_px;
      for (int k = 0; k <= m; k++) {
        line[k] += left * change[k];
      }
    }
  }
}

/* 1 on the diagonal keeps the matrix positive definite. */
static void solve(struct equations *e, double noise) {
  size_t n = (size_t)e->modes;
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k <= i; k++) {
      e->factor[i * n + k] = e->matrix[i * n + k] / noise + (i == k);
    }
    e->amplitude[i] = e->side[i] / noise;
  }
  placido_dense_factor(e->factor, e->modes, e->modes, 0);
  placido_dense_solve(e->factor, e->modes, e->modes, e->amplitude);
}

/* The residuals less what the amplitudes explain, px. Returns the share of the variance left. */
static double subtract(double *residual_px, const placido_refinement *r,
                       const placido_moves *moves, const double *amplitude) {
  double before = 0, after = 0;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    double explained = 0;
    for (int m = 0; m < moves->modes; m++) {
      explained += amplitude[m] * moves->change[i * (size_t)moves->modes + (size_t)m];
    }
    residual_px[i] = s->residual_px - explained * r->sigma_px;
    if (s->used && !isnan(s->residual_px)) {
      before += s->residual_px * s->residual_px;
      after += residual_px[i] * residual_px[i];
    }
  }
  return before > 0 ? fmin(1, after / before) : 1;
}

int placido_residuals_explain(const placido_refinement *r, const placido_mires *mires,
                              placido_moves *moves, placido_error *err) {
  for (size_t i = 0; i < r->count; i++) {
    r->work[i] = r->samples[i].residual_px;
  }
  if (!moves) {
    return PLACIDO_OK;
  }
  double scale = placido_noise_inflation(r->samples, r->work, r->count, mires);
  struct equations e;
  int status = equations_new(&e, moves->modes, err);
  if (!status) {
    let_surface_answer(moves, r);
    fill(&e, r, moves);
    for (int pass = 0; pass < PASSES; pass++) {
      solve(&e, scale);
      double share = subtract(r->work, r, moves, e.amplitude);
      scale = share * placido_noise_inflation(r->samples, r->work, r->count, mires);
    }
  }
  equations_free(&e);
  return status;
}

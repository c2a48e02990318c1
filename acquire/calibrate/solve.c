/* Levenberg-Marquardt on the joint problem. The normal matrix is an arrow: a dense block of the
 * shared unknowns and a 3 × 3 block a view, which are eliminated first (Triggs et al., Bundle
 * Adjustment: A Modern Synthesis, 2000, sec. 6). Unknowns are in prior standard deviations, so the
 * prior adds the unit matrix. */
#include "acquire/calibrate/solve.h"

#include "base/dense.h"
#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

#define SIGMA_LEAST_PX 0.005 /* no edge is measured better */
#define ROBUST 3.0           /* standard deviations beyond which a point counts for less */
#define PASSED_PX 50.0       /* what a point costs whose ray passes the ball */
#define SETTLED 1e-3         /* fall of the cost, a chi square, that moves nothing worth a sigma */
#define SETTLED_ROUGHLY 1e-3 /* its share of the cost, while the noise level is not known yet */
#define SETTLED_SIGMA 0.02
#define ROUNDS 12
#define STEPS 40
/* Added to the prior's unit matrix. It must begin small: the weakest directions, which the data
 * hold a million times less firmly than the strongest, would otherwise stay behind. */
#define DAMPING_FIRST 1e-2
#define DAMPING_MOST 1e12

int placido_calibrate_solver_new(placido_calibrate_solver *solver,
                                 const placido_calibrate_problem *problem, placido_error *err) {
  size_t n = (size_t)problem->shared, views = (size_t)problem->view_count;
  *solver = (placido_calibrate_solver){.problem = problem, .inflation = 1};
  solver->q = placido_memory_new(n + 3 * views, sizeof(double), err);
  solver->trial = placido_memory_new(n + 3 * views, sizeof(double), err);
  solver->normal = placido_memory_new(n * n, sizeof(double), err);
  solver->reduced = placido_memory_new(n * n, sizeof(double), err);
  solver->gradient = placido_memory_new(n, sizeof(double), err);
  solver->right = placido_memory_new(n, sizeof(double), err);
  solver->blocks = placido_memory_new(views, sizeof *solver->blocks, err);
  bool ok = solver->q && solver->trial && solver->normal && solver->reduced && solver->gradient &&
            solver->right && solver->blocks;
  for (size_t v = 0; ok && v < views; v++) {
    solver->blocks[v].across = placido_memory_new(3 * n, sizeof(double), err);
    ok = solver->blocks[v].across != NULL;
  }
  if (!ok) {
    placido_calibrate_solver_free(solver);
    return PLACIDO_MEMORY;
  }
  return PLACIDO_OK;
}

void placido_calibrate_solver_free(placido_calibrate_solver *solver) {
  for (int v = 0; solver->blocks && v < solver->problem->view_count; v++) {
    placido_memory_free(solver->blocks[v].across);
  }
  placido_memory_free(solver->blocks);
  placido_memory_free(solver->q);
  placido_memory_free(solver->trial);
  placido_memory_free(solver->normal);
  placido_memory_free(solver->reduced);
  placido_memory_free(solver->gradient);
  placido_memory_free(solver->right);
  *solver = (placido_calibrate_solver){0};
}

/* Pseudo-Huber loss of a residual in standard deviations, and the weight of its square. */
static double loss(double e, double *weight) {
  double root = sqrt(1 + e * e / (ROBUST * ROBUST));
  *weight = 1 / root;
  return 2 * ROBUST * ROBUST * (root - 1);
}

/* The residuals of every point in order; `out` has room for all. */
static size_t residuals(double *out, const placido_calibrate_problem *problem, const double *q) {
  size_t count = 0;
  for (int v = 0; v < problem->view_count; v++) {
    const placido_mires *mires = problem->views[v].mires;
    placido_calibrate_geometry geometry = placido_calibrate_geometry_of(problem, q, v);
    for (size_t i = 0; i < mires->count; i++) {
      placido_calibrate_row row;
      out[count++] = placido_calibrate_row_at(&row, &geometry, &mires->points[i], false)
                         ? row.residual_px
                         : PASSED_PX;
    }
  }
  return count;
}

static double cost_of(const placido_calibrate_solver *s, const double *q) {
  const placido_calibrate_problem *problem = s->problem;
  double sum = 0, weight;
  int unknowns = problem->shared + 3 * problem->view_count;
  for (int i = 0; i < unknowns; i++) {
    sum += q[i] * q[i];
  }
  for (int v = 0; v < problem->view_count; v++) {
    const placido_mires *mires = problem->views[v].mires;
    placido_calibrate_geometry geometry = placido_calibrate_geometry_of(problem, q, v);
    for (size_t i = 0; i < mires->count; i++) {
      placido_calibrate_row row;
      bool met = placido_calibrate_row_at(&row, &geometry, &mires->points[i], false);
      sum += loss((met ? row.residual_px : PASSED_PX) / s->sigma_px, &weight);
    }
  }
  return sum;
}

/* Adds a row (in prior standard deviations and standard deviations of the noise) to the normal
 * equations; of the symmetric matrices only the lower triangle. */
static void add_row(placido_calibrate_solver *s, placido_calibrate_block *block,
                    const int places[PLACIDO_CALIBRATE_SHARED_MAX],
                    const placido_calibrate_row *row, double weight) {
  size_t n = (size_t)s->problem->shared;
  for (int i = 0; i < PLACIDO_CALIBRATE_SHARED_MAX; i++) {
    double a = weight * row->shared[i];
    double *line = s->normal + (size_t)places[i] * n;
    for (int j = 0; j <= i; j++) {
      line[places[j]] += a * row->shared[j];
    }
    for (int j = 0; j < 3; j++) {
      block->across[3 * places[i] + j] += a * row->view[j];
    }
    s->gradient[places[i]] += a * row->residual_px;
  }
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      block->own[i][j] += weight * row->view[i] * row->view[j];
    }
    block->gradient[i] += weight * row->view[i] * row->residual_px;
  }
}

static void linearise_view(placido_calibrate_solver *s, int v, double sigma_px) {
  const placido_calibrate_problem *problem = s->problem;
  const placido_calibrate_view *view = &problem->views[v];
  placido_calibrate_block *block = &s->blocks[v];
  placido_calibrate_geometry geometry = placido_calibrate_geometry_of(problem, s->q, v);
  memset(block->across, 0, 3 * (size_t)problem->shared * sizeof *block->across);
  for (int i = 0; i < 3; i++) {
    memset(block->own[i], 0, sizeof block->own[i]);
    block->own[i][i] = 1;
    block->gradient[i] = s->q[problem->shared + 3 * v + i];
  }
  for (size_t k = 0; k < view->mires->count; k++) {
    const placido_mire_point *point = &view->mires->points[k];
    placido_calibrate_row row;
    int places[PLACIDO_CALIBRATE_SHARED_MAX];
    if (!placido_calibrate_row_at(&row, &geometry, point, true)) {
      continue;
    }
    double weight;
    loss(row.residual_px / s->sigma_px, &weight);
    placido_calibrate_places(places, problem, point->edge, view->ball);
    for (int i = 0; i < PLACIDO_CALIBRATE_SHARED_MAX; i++) {
      row.shared[i] *= problem->sigma[places[i]];
    }
    for (int i = 0; i < 3; i++) {
      row.view[i] *= view->sigma_mm[i];
    }
    add_row(s, block, places, &row, weight / (sigma_px * sigma_px));
  }
}

/* The normal equations at q, with points of standard deviation sigma_px. */
static void linearise(placido_calibrate_solver *s, double sigma_px) {
  size_t n = (size_t)s->problem->shared;
  memset(s->normal, 0, n * n * sizeof *s->normal);
  for (size_t i = 0; i < n; i++) {
    s->normal[i * n + i] = 1;
    s->gradient[i] = s->q[i];
  }
  for (int v = 0; v < s->problem->view_count; v++) {
    linearise_view(s, v, sigma_px);
  }
}

/* The damped 3 × 3 block's Cholesky factor. */
static void own_factor(double factor[9], const placido_calibrate_block *block, double damping) {
  for (int i = 0; i < 9; i++) {
    factor[i] = block->own[i / 3][i % 3] + (i % 4 == 0 ? damping : 0);
  }
  placido_dense_factor(factor, 3, 3, 0);
}

/* Eliminates the views: the factor of what is left in `reduced`, its right side in `right`. */
static bool reduce(placido_calibrate_solver *s, double damping) {
  size_t n = (size_t)s->problem->shared;
  memcpy(s->reduced, s->normal, n * n * sizeof *s->reduced);
  for (size_t i = 0; i < n; i++) {
    s->reduced[i * n + i] += damping;
    s->right[i] = -s->gradient[i];
  }
  for (int v = 0; v < s->problem->view_count; v++) {
    const placido_calibrate_block *block = &s->blocks[v];
    double factor[9];
    own_factor(factor, block, damping);
    for (size_t i = 0; i < n; i++) {
      double solved[3] = {block->across[3 * i], block->across[3 * i + 1], block->across[3 * i + 2]};
      placido_dense_solve(factor, 3, 3, solved);
      for (size_t j = 0; j <= i; j++) {
        const double *b = block->across + 3 * j;
        s->reduced[i * n + j] -= solved[0] * b[0] + solved[1] * b[1] + solved[2] * b[2];
      }
      for (int k = 0; k < 3; k++) {
        s->right[i] += solved[k] * block->gradient[k];
      }
    }
  }
  return placido_dense_factor(s->reduced, (int)n, (int)n, 0);
}

/* The step at a damping, added to q in `trial`. */
static bool take_step(placido_calibrate_solver *s, double damping) {
  int n = s->problem->shared;
  if (!reduce(s, damping)) {
    return false;
  }
  placido_dense_solve(s->reduced, n, n, s->right);
  for (int i = 0; i < n; i++) {
    s->trial[i] = s->q[i] + s->right[i];
  }
  for (int v = 0; v < s->problem->view_count; v++) {
    const placido_calibrate_block *block = &s->blocks[v];
    double factor[9], step[3] = {0};
    for (int k = 0; k < 3; k++) {
      step[k] = -block->gradient[k];
      for (int i = 0; i < n; i++) {
        step[k] -= block->across[3 * i + k] * s->right[i];
      }
    }
    own_factor(factor, block, damping);
    placido_dense_solve(factor, 3, 3, step);
    for (int k = 0; k < 3; k++) {
      s->trial[n + 3 * v + k] = s->q[n + 3 * v + k] + step[k];
    }
  }
  return true;
}

/* Steps with one noise level until the cost hardly falls. */
static int descend(placido_calibrate_solver *s, bool roughly, placido_error *err) {
  double damping = DAMPING_FIRST, cost = cost_of(s, s->q);
  size_t unknowns = (size_t)s->problem->shared + 3 * (size_t)s->problem->view_count;
  for (int step = 0; step < STEPS; step++) {
    linearise(s, s->sigma_px);
    double trial = INFINITY;
    while (!(trial <= cost) && damping < DAMPING_MOST) {
      trial = take_step(s, damping) ? cost_of(s, s->trial) : INFINITY;
      damping *= trial <= cost ? 0.1 : 10;
    }
    if (!(trial <= cost)) {
      return PLACIDO_OK; /* no direction leads down: this is the bottom, to rounding */
    }
    memcpy(s->q, s->trial, unknowns * sizeof *s->q);
    double fall = cost - trial;
    cost = trial;
    s->steps++;
    if (fall <= (roughly ? SETTLED_ROUGHLY * cost : SETTLED)) {
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the calibration does not converge within %d steps: do radii and "
                           "distances belong to their pictures?",
                           STEPS);
}

static double robust_sigma(double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    values[i] = fabs(values[i]);
  }
  return fmax(SIGMA_LEAST_PX, 1.4826 * placido_quantile(values, count, 0.5));
}

int placido_calibrate_solver_run(placido_calibrate_solver *solver, placido_error *err) {
  size_t room = 0;
  for (int v = 0; v < solver->problem->view_count; v++) {
    room += solver->problem->views[v].mires->count;
  }
  double *work = placido_memory_new(room, sizeof *work, err);
  int status = work ? PLACIDO_OK : PLACIDO_MEMORY;
  double before = INFINITY;
  for (int round = 0; round < ROUNDS && !status; round++) {
    size_t count = residuals(work, solver->problem, solver->q);
    solver->sigma_px = robust_sigma(work, count);
    bool known = fabs(solver->sigma_px / before - 1) < SETTLED_SIGMA;
    before = solver->sigma_px;
    status = descend(solver, !known, err);
    if (known) {
      break;
    }
  }
  placido_memory_free(work);
  return status;
}

/* Sums along one edge of a view: of the residuals' parts that an edge as a whole has, its mean and
 * its first harmonic. */
typedef struct whole_edge {
  double part[3], square[3];
} whole_edge;

static void add_to_edge(whole_edge *e, const placido_mire_point *point, double residual_px,
                        double weight) {
  double angle = point->meridian_deg * M_PI / 180;
  const double shape[3] = {1, cos(angle), sin(angle)};
  for (int i = 0; i < 3; i++) {
    e->part[i] += weight * residual_px * shape[i];
    e->square[i] += weight * shape[i] * shape[i];
  }
}

/* Mean square of the edges' errors as a whole, against what independent points would give. */
static double edge_inflation(const placido_calibrate_solver *s) {
  const placido_calibrate_problem *problem = s->problem;
  double sum = 0;
  size_t parts = 0;
  for (int v = 0; v < problem->view_count; v++) {
    const placido_mires *mires = problem->views[v].mires;
    placido_calibrate_geometry geometry = placido_calibrate_geometry_of(problem, s->q, v);
    for (size_t i = 0; i < mires->count;) {
      whole_edge e = {{0}, {0}};
      for (int edge = mires->points[i].edge; i < mires->count && mires->points[i].edge == edge;
           i++) {
        placido_calibrate_row row;
        double weight;
        if (placido_calibrate_row_at(&row, &geometry, &mires->points[i], false)) {
          loss(row.residual_px / s->sigma_px, &weight);
          add_to_edge(&e, &mires->points[i], row.residual_px, weight);
        }
      }
      for (int k = 0; k < 3; k++) {
        bool any = e.square[k] > 0;
        sum += any ? e.part[k] * e.part[k] / (e.square[k] * s->sigma_px * s->sigma_px) : 0;
        parts += any;
      }
    }
  }
  return parts ? fmax(1, sum / (double)parts) : 1;
}

int placido_calibrate_solver_information(placido_calibrate_solver *solver, const double **factor,
                                         placido_error *err) {
  solver->inflation = edge_inflation(solver);
  linearise(solver, solver->sigma_px * sqrt(solver->inflation));
  *factor = solver->reduced;
  if (!reduce(solver, 0)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the calibration's normal matrix is singular to rounding");
  }
  return PLACIDO_OK;
}

/* The covariance of the instrument's parameters from the reduced normal matrix: standard
 * deviations, the modes that move a picture's mires most, and the directions that the prior alone
 * holds. */
#include "acquire/calibrate/covariance.h"

#include "acquire/calibrate/dense.h"
#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define UNDETERMINED_SHARE 0.5 /* of the prior standard deviation */
#define TOLD 0.05              /* share of a direction's square that is worth a word */

static const char *const names[PLACIDO_UNCERTAINTY_CAMERA] = {
    "focal u", "focal v", "principal u", "principal v", "k1",       "k2",
    "p1",      "p2",      "k3",          "camera x",    "camera y", "camera z"};

/* Room for four n × n matrices and n values. */
typedef struct work {
  int n; /* parameters of the instrument */
  double *covariance, *factor, *picture, *vectors, *values;
} work;

static int work_new(work *w, int n, int shared, placido_error *err) {
  size_t room = (size_t)shared * (size_t)shared;
  *w = (work){.n = n};
  w->covariance = placido_memory_new(room, sizeof(double), err);
  w->factor = placido_memory_new(room, sizeof(double), err);
  w->picture = placido_memory_new(room, sizeof(double), err);
  w->vectors = placido_memory_new(room, sizeof(double), err);
  w->values = placido_memory_new((size_t)shared, sizeof(double), err);
  return w->covariance && w->factor && w->picture && w->vectors && w->values ? PLACIDO_OK
                                                                             : PLACIDO_MEMORY;
}

static void work_free(work *w) {
  placido_memory_free(w->covariance);
  placido_memory_free(w->factor);
  placido_memory_free(w->picture);
  placido_memory_free(w->vectors);
  placido_memory_free(w->values);
}

/* The leading n × n part of a matrix with `stride` columns, in place. */
static void crop(double *matrix, int n, int stride) {
  for (int i = 0; i < n; i++) {
    memmove(matrix + (size_t)i * (size_t)n, matrix + (size_t)i * (size_t)stride,
            (size_t)n * sizeof *matrix);
  }
}

/* Sum over a view's points of row·rowᵀ, in prior standard deviations: how strongly each direction
 * moves its mires. */
static void weigh_picture(double *picture, const placido_calibrate_solver *s, int view) {
  const placido_calibrate_problem *problem = s->problem;
  const placido_calibrate_view *v = &problem->views[view];
  size_t n = (size_t)problem->parameters;
  placido_calibrate_geometry geometry = placido_calibrate_geometry_of(problem, s->q, view);
  memset(picture, 0, n * n * sizeof *picture);
  for (size_t k = 0; k < v->mires->count; k++) {
    placido_calibrate_row row;
    int places[PLACIDO_CALIBRATE_SHARED_MAX];
    if (!placido_calibrate_row_at(&row, &geometry, &v->mires->points[k], true)) {
      continue;
    }
    placido_calibrate_places(places, problem, v->mires->points[k].edge, v->ball);
    for (int i = 0; i < PLACIDO_CALIBRATE_SHARED_MAX - 1; i++) { /* all but the ball's radius */
      double a = row.shared[i] * problem->sigma[places[i]];
      for (int j = 0; j < PLACIDO_CALIBRATE_SHARED_MAX - 1; j++) {
        picture[(size_t)places[i] * n + (size_t)places[j]] +=
            a * row.shared[j] * problem->sigma[places[j]];
      }
    }
  }
}

/* out = aᵀ·b, all n × n. */
static void multiply_transposed(double *out, const double *a, const double *b, int n) {
  memset(out, 0, (size_t)n * (size_t)n * sizeof *out);
  for (int k = 0; k < n; k++) {
    for (int i = 0; i < n; i++) {
      double x = a[(size_t)k * (size_t)n + (size_t)i];
      for (int j = 0; x != 0 && j < n; j++) {
        out[(size_t)i * (size_t)n + (size_t)j] += x * b[(size_t)k * (size_t)n + (size_t)j];
      }
    }
  }
}

/* The modes: columns of L·V, where L·Lᵀ is the covariance and V diagonalises Lᵀ·picture·L. */
static int find_modes(placido_calibration *c, work *w, const placido_calibrate_problem *problem,
                      placido_error *err) {
  int n = w->n;
  size_t size = (size_t)n * (size_t)n;
  int modes = n < PLACIDO_UNCERTAINTY_MODES ? n : PLACIDO_UNCERTAINTY_MODES;
  int status = placido_uncertainty_new(&c->uncertainty, problem->start.edge_count, modes, err);
  if (status) {
    return status;
  }
  memcpy(w->factor, w->covariance, size * sizeof(double));
  if (!placido_dense_factor(w->factor, n, n, 0)) {
    return placido_error_set(err, PLACIDO_QUALITY, "the calibration's covariance is singular");
  }
  multiply_transposed(w->vectors, w->picture, w->factor, n);
  multiply_transposed(w->picture, w->factor, w->vectors, n);
  placido_dense_eigen(w->values, w->vectors, w->picture, n);
  for (int i = 0; i < n; i++) {
    const double *l = w->factor + (size_t)i * (size_t)n;
    c->uncertainty.sigma[i] =
        problem->sigma[i] * sqrt(w->covariance[(size_t)i * (size_t)(n + 1)]);
    for (int m = 0; m < modes; m++) {
      const double *v = w->vectors + (size_t)m * (size_t)n;
      double sum = 0;
      for (int k = 0; k <= i; k++) {
        sum += l[k] * v[k];
      }
      c->uncertainty.factor[(size_t)m * (size_t)n + (size_t)i] = problem->sigma[i] * sum;
    }
  }
  return PLACIDO_OK;
}

/* Adds a word to a direction's text where its share is worth it. */
static void tell(char *text, size_t size, const char *what, double component, bool sign) {
  size_t used = strlen(text);
  if (component * component > TOLD && used < size) {
    snprintf(text + used, size - used, sign ? "%s%s %+.2f" : "%s%s %.2f", used ? ", " : "", what,
             component);
  }
}

static void describe(placido_undetermined *u, const double *v, int edges) {
  double radii = 0, heights = 0, common = 0;
  u->text[0] = '\0';
  for (int i = 0; i < PLACIDO_UNCERTAINTY_CAMERA; i++) {
    tell(u->text, sizeof u->text, names[i], v[i], true);
  }
  const double *edge = v + PLACIDO_UNCERTAINTY_CAMERA;
  for (int k = 0; k < edges; k++) {
    radii += edge[k] * edge[k];
    heights += edge[edges + k] * edge[edges + k];
    common += edge[edges + k] / sqrt(edges);
  }
  tell(u->text, sizeof u->text, "radii of the edges", sqrt(radii), false);
  tell(u->text, sizeof u->text, "height of all edges together", common, true);
  tell(u->text, sizeof u->text, "heights of the edges", sqrt(fmax(0, heights - common * common)),
       false);
}

/* Directions of what was free to move, by how much the prior alone holds them. */
static void find_undetermined(placido_calibration *c, work *w,
                              const placido_calibrate_problem *problem) {
  int n = w->n, found = 0;
  size_t size = (size_t)n * (size_t)n;
  memcpy(w->factor, w->covariance, size * sizeof(double));
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      bool held = problem->sigma[i] <= 0 || problem->sigma[j] <= 0;
      w->factor[(size_t)i * (size_t)n + (size_t)j] *= held ? 0 : 1;
    }
  }
  placido_dense_eigen(w->values, w->vectors, w->factor, n);
  double least = w->values[0];
  for (int i = 0; i < n; i++) {
    least = w->values[i] > 0 ? fmin(least, w->values[i]) : least;
    double share = sqrt(fmax(0, w->values[i]));
    if (share > UNDETERMINED_SHARE && found < PLACIDO_UNDETERMINED_MAX) {
      c->undetermined[found].share = fmin(share, 1);
      describe(&c->undetermined[found++], w->vectors + (size_t)i * (size_t)n,
               problem->start.edge_count);
    }
  }
  c->undetermined_count = found;
  c->condition = w->values[0] / least;
}

int placido_calibrate_covariance(placido_calibration *calibration,
                                 placido_calibrate_solver *solver, int ordinary,
                                 placido_error *err) {
  const placido_calibrate_problem *problem = solver->problem;
  const double *factor;
  work w;
  int status = work_new(&w, problem->parameters, problem->shared, err);
  if (!status) {
    status = placido_calibrate_solver_information(solver, &factor, err);
  }
  if (!status) {
    placido_dense_inverse(w.covariance, factor, problem->shared);
    for (int b = 0; b < problem->ball_count; b++) {
      int i = problem->parameters + b;
      calibration->balls[b].sigma_mm =
          problem->sigma[i] * sqrt(w.covariance[(size_t)i * (size_t)(problem->shared + 1)]);
    }
    crop(w.covariance, w.n, problem->shared);
    weigh_picture(w.picture, solver, ordinary);
    status = find_modes(calibration, &w, problem, err);
  }
  if (!status) {
    calibration->inflation = solver->inflation;
    find_undetermined(calibration, &w, problem);
  }
  work_free(&w);
  return status;
}

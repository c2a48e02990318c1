/* From pictures of balls to the instrument: mires found, everything solved, mires found again with
 * the better instrument, and solved again. */
#include <placido/calibrate.h>

#include "acquire/calibrate/covariance.h"
#include "acquire/calibrate/setup.h"
#include "acquire/calibrate/solve.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

#define ROUNDS 2
#define MERIDIANS 360
#define VIEWS_LEAST 3
#define BALLS_WANTED 3
#define DISTANCES_WANTED 5
#define ORDINARY_MM 7.8
#define SHARED_MAX \
  (PLACIDO_UNCERTAINTY_CAMERA + 2 * PLACIDO_EDGES_MAX + PLACIDO_CALIBRATE_BALLS_MAX)
#define ODD_PX 0.3 /* edges that lie so far from every ball: something is wrongly told */

typedef struct job {
  placido_calibration *out;
  const placido_instrument *nominal;
  const placido_uncertainty *prior;
  const placido_ball_view *views;
  size_t count;
  int meridians, threads;
  placido_notes *notes;
  placido_mires *mires; /* a view each; points NULL: not used */
  size_t *chosen;       /* the solved views' places in `views` */
  int *ball;            /* of each view */
  double *shared;       /* the shared unknowns where the next solution starts */
  int solved;
} job;

/* Gives every view its ball: equal radii are one ball. */
static int list_balls(job *j, placido_error *err) {
  placido_calibration *c = j->out;
  for (size_t v = 0; v < j->count; v++) {
    const placido_ball_view *view = &j->views[v];
    size_t b = 0;
    while (b < c->ball_count && c->balls[b].start_mm != view->radius_mm) {
      b++;
    }
    if (b == PLACIDO_CALIBRATE_BALLS_MAX) {
      return placido_error_set(err, PLACIDO_INPUT, "more than %d balls of different radius",
                               PLACIDO_CALIBRATE_BALLS_MAX);
    }
    if (b == c->ball_count) {
      c->balls[c->ball_count++] =
          (placido_ball_result){.start_mm = view->radius_mm,
                                .start_sigma_mm = view->radius_sigma_mm};
    }
    j->ball[v] = (int)b;
  }
  return PLACIDO_OK;
}

/* Finds the mires of every view that takes part; one that shows none is left out and told. */
static int find_mires(job *j, const placido_instrument *instrument, placido_error *err) {
  placido_mires_options options = {.meridians = j->meridians, .threads = j->threads};
  j->solved = 0;
  for (size_t v = 0; v < j->count; v++) {
    placido_error why = {0};
    placido_mires_free(&j->mires[v]);
    if (j->views[v].held_out) {
      continue;
    }
    int status = placido_mires_find(&j->mires[v], &j->views[v].frame, instrument, &options, NULL,
                                    &why);
    if (status == PLACIDO_QUALITY) {
      placido_notes_add(j->notes, "%s is left out: %s", j->views[v].path, why.text);
    } else if (status) {
      return placido_error_set(err, status, "%s: %s", j->views[v].path, why.text);
    } else {
      j->chosen[j->solved++] = v;
    }
  }
  if (j->solved < VIEWS_LEAST) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "%d pictures show mires, at least %d are needed", j->solved,
                             VIEWS_LEAST);
  }
  return PLACIDO_OK;
}

static int make_problem(placido_calibrate_problem *problem, const job *j, placido_error *err) {
  const placido_calibration *c = j->out;
  int status = placido_calibrate_problem_new(problem, j->nominal, j->prior, (int)c->ball_count,
                                             j->solved, err);
  for (size_t b = 0; !status && b < c->ball_count; b++) {
    placido_calibrate_ball_set(problem, (int)b, c->balls[b].start_mm,
                               c->balls[b].start_sigma_mm);
  }
  for (int i = 0; !status && i < j->solved; i++) {
    size_t v = j->chosen[i];
    placido_calibrate_view_set(problem, i, &j->mires[v], j->ball[v], j->views[v].z_mm,
                               j->views[v].z_sigma_mm);
  }
  return status;
}

/* Residuals by view and by edge. */
static void summarise(job *j, const placido_calibrate_solver *s) {
  placido_calibration *c = j->out;
  double sum = 0;
  memset(c->edge_rms_px, 0, sizeof c->edge_rms_px);
  memset(c->edge_mean_px, 0, sizeof c->edge_mean_px);
  memset(c->edge_points, 0, sizeof c->edge_points);
  c->points = 0;
  for (int i = 0; i < j->solved; i++) {
    const placido_mires *mires = &j->mires[j->chosen[i]];
    placido_view_result *view = &c->views[j->chosen[i]];
    placido_calibrate_geometry g = placido_calibrate_geometry_of(s->problem, s->q, i);
    *view = (placido_view_result){.solved = true, .points = mires->count};
    for (int k = 0; k < 3; k++) {
      view->vertex_mm[k] = g.centre_mm[k] + (k == 2 ? g.radius_mm : 0);
    }
    view->z_less_plan_mm = view->vertex_mm[2] - j->views[j->chosen[i]].z_mm;
    double own = 0;
    for (size_t k = 0; k < mires->count; k++) {
      placido_calibrate_row row;
      int edge = mires->points[k].edge;
      if (placido_calibrate_row_at(&row, &g, &mires->points[k], false)) {
        own += row.residual_px * row.residual_px;
        c->edge_rms_px[edge] += row.residual_px * row.residual_px;
        c->edge_mean_px[edge] += row.residual_px;
        c->edge_points[edge]++;
        c->points++;
      }
    }
    view->rms_px = sqrt(own / (double)mires->count);
    sum += own;
    c->instrument = g.instrument;
  }
  for (int k = 0; k < c->instrument.edge_count; k++) {
    c->edge_rms_px[k] = sqrt(c->edge_rms_px[k] / (double)c->edge_points[k]);
    c->edge_mean_px[k] /= (double)c->edge_points[k];
  }
  for (size_t b = 0; b < c->ball_count; b++) {
    size_t at = (size_t)s->problem->parameters + b;
    c->balls[b].radius_mm = c->balls[b].start_mm + s->problem->sigma[at] * s->q[at];
  }
  c->instrument.calibrated = true;
  c->rms_px = sqrt(sum / (double)c->points);
  c->sigma_px = s->sigma_px;
  c->steps += s->steps;
}

/* The view that is most like an eye: its picture weighs the modes of the uncertainty. */
static int ordinary_view(const job *j) {
  int best = 0;
  double least = INFINITY;
  for (int i = 0; i < j->solved; i++) {
    const placido_ball_view *view = &j->views[j->chosen[i]];
    double far = hypot(view->radius_mm - ORDINARY_MM, view->z_mm);
    if (far < least) {
      least = far;
      best = i;
    }
  }
  return best;
}

/* Where the round before ended, or where the plan says. */
static void start_from(placido_calibrate_solver *s, const job *j) {
  memcpy(s->q, j->shared, (size_t)s->problem->shared * sizeof *s->q);
  for (int i = 0; i < j->solved; i++) {
    const placido_view_result *before = &j->out->views[j->chosen[i]];
    const placido_calibrate_view *view = &s->problem->views[i];
    for (int k = 0; before->solved && k < 3; k++) {
      if (view->sigma_mm[k] > 0) {
        s->q[s->problem->shared + 3 * i + k] =
            (before->vertex_mm[k] - view->start_mm[k]) / view->sigma_mm[k];
      }
    }
  }
}

static int solve(job *j, bool last, placido_error *err) {
  placido_calibrate_problem problem;
  placido_calibrate_solver solver = {0};
  int status = make_problem(&problem, j, err);
  if (status) {
    return status;
  }
  status = placido_calibrate_solver_new(&solver, &problem, err);
  if (!status) {
    start_from(&solver, j);
    status = placido_calibrate_solver_run(&solver, err);
  }
  if (!status) {
    memcpy(j->shared, solver.q, (size_t)problem.shared * sizeof *solver.q);
    summarise(j, &solver);
    j->out->rounds++;
  }
  if (!status && last) {
    status = placido_calibrate_covariance(j->out, &solver, ordinary_view(j), err);
  }
  placido_calibrate_solver_free(&solver);
  placido_calibrate_problem_free(&problem);
  return status;
}

/* What the pictures lack, and what they contradict. */
static void warn(const job *j) {
  const placido_calibration *c = j->out;
  size_t used = 0;
  for (size_t b = 0; b < c->ball_count; b++) {
    int views = 0;
    for (int i = 0; i < j->solved; i++) {
      views += j->ball[j->chosen[i]] == (int)b;
    }
    used += views > 0;
    if (views > 0 && views < DISTANCES_WANTED) {
      placido_notes_add(j->notes,
                        "the ball of %g mm was seen %d times; at least %d distances are "
                        "recommended",
                        c->balls[b].start_mm, views, DISTANCES_WANTED);
    }
  }
  if (used < BALLS_WANTED) {
    placido_notes_add(j->notes, "only %zu balls; at least %d of different radius are recommended",
                      used, BALLS_WANTED);
  }
  if (c->sigma_px > ODD_PX) {
    placido_notes_add(j->notes,
                      "the mires lie %.2f px off: a radius, a distance or the number of edges is "
                      "not what the plan and the instrument say",
                      c->sigma_px);
  }
}

/* Measures the balls that took no part. */
static int check_held_out(job *j, placido_error *err) {
  const placido_calibration *c = j->out;
  placido_mires_options options = {.threads = j->threads};
  for (size_t v = 0; v < j->count; v++) {
    const placido_ball_view *view = &j->views[v];
    placido_view_result *result = &j->out->views[v];
    placido_error why = {0};
    placido_mires mires = {0};
    if (!view->held_out) {
      continue;
    }
    int status =
        placido_mires_find(&mires, &view->frame, &c->instrument, &options, j->notes, &why);
    if (!status) {
      result->points = mires.count;
      placido_ball ball = {.radius_mm = view->radius_mm, .z_mm = view->z_mm};
      status = placido_ball_check_run(&result->check, &mires, &c->instrument, &ball, j->threads,
                                      j->notes, &why);
    }
    placido_mires_free(&mires);
    if (status == PLACIDO_QUALITY) {
      placido_notes_add(j->notes, "%s was held out and could not be measured: %s", view->path,
                        why.text);
    } else if (status) {
      return placido_error_set(err, status, "%s: %s", view->path, why.text);
    } else {
      result->checked = true;
      memcpy(result->vertex_mm, result->check.vertex_mm, sizeof result->vertex_mm);
      result->rms_px = result->check.mires_rms_px;
    }
  }
  return PLACIDO_OK;
}

static int run(job *j, placido_error *err) {
  int status = list_balls(j, err);
  for (int round = 0; round < ROUNDS && !status; round++) {
    status = find_mires(j, round ? &j->out->instrument : j->nominal, err);
    if (!status) {
      status = solve(j, round == ROUNDS - 1, err);
    }
  }
  if (!status) {
    warn(j);
    status = check_held_out(j, err);
  }
  return status;
}

int placido_calibrate(placido_calibration *calibration, const placido_instrument *nominal,
                      const placido_uncertainty *prior, const placido_ball_view *views,
                      size_t view_count, const placido_calibrate_options *options,
                      placido_notes *notes, placido_error *err) {
  *calibration = (placido_calibration){.view_count = view_count};
  if (view_count < VIEWS_LEAST || view_count > PLACIDO_BALL_VIEWS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "%zu pictures, %d to %d are expected",
                             view_count, VIEWS_LEAST, PLACIDO_BALL_VIEWS_MAX);
  }
  job j = {.out = calibration,
           .nominal = nominal,
           .prior = prior,
           .views = views,
           .count = view_count,
           .meridians = options && options->meridians > 0 ? options->meridians : MERIDIANS,
           .threads = options && options->threads > 0 ? options->threads : 1,
           .notes = notes};
  calibration->views = placido_memory_new(view_count, sizeof *calibration->views, err);
  calibration->balls =
      placido_memory_new(PLACIDO_CALIBRATE_BALLS_MAX, sizeof *calibration->balls, err);
  j.mires = placido_memory_new(view_count, sizeof *j.mires, err);
  j.chosen = placido_memory_new(view_count, sizeof *j.chosen, err);
  j.ball = placido_memory_new(view_count, sizeof *j.ball, err);
  j.shared = placido_memory_new(SHARED_MAX, sizeof *j.shared, err);
  int status = PLACIDO_MEMORY;
  if (calibration->views && calibration->balls && j.mires && j.chosen && j.ball &&
      j.shared) {
    status = run(&j, err);
  }
  for (size_t v = 0; j.mires && v < view_count; v++) {
    placido_mires_free(&j.mires[v]);
  }
  placido_memory_free(j.mires);
  placido_memory_free(j.chosen);
  placido_memory_free(j.ball);
  placido_memory_free(j.shared);
  if (status) {
    placido_calibration_free(calibration);
  }
  return status;
}

void placido_calibration_free(placido_calibration *calibration) {
  placido_uncertainty_free(&calibration->uncertainty);
  placido_memory_free(calibration->views);
  placido_memory_free(calibration->balls);
  *calibration = (placido_calibration){0};
}

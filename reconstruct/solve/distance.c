/* The profile likelihood of the distance, linearised: with u the residuals' change per mm once the
 * surface has answered, the step is -Σ w u r / Σ w u², and its variance that of its numerator,
 * summed over edges as clusters (Liang and Zeger, Biometrika 73:13, 1986). */
#include "reconstruct/solve/distance.h"

#include "base/memory.h"

#include <math.h>

#define KNOWN 0.5 /* of the given one's standard deviation: the mires tell it better */
#define FAR 4.0   /* standard deviations beyond which the two contradict each other */
#define CLOSE 0.1 /* of one: a step as small as this is the last */
#define STEPS_MOST 4

/* The step of z on the axis that the residuals ask for, and its standard deviation: from the edges'
 * noise, each edge one witness, and the geometry. NaN and INFINITY where nothing is said. */
struct answer {
  double step_mm, sigma_mm;
};

int placido_distance_answer(double *by_distance, placido_normal *normal, const placido_grid *grid,
                            placido_error *err) {
  size_t n = (size_t)grid->side * (size_t)grid->side;
  double *right = placido_memory_new(n, sizeof *right, err);
  if (!right) {
    return PLACIDO_MEMORY;
  }
  /* the spring at the axis pulls to the distance: its push per millimetre is weight · B(0, 0) */
  placido_basis basis;
  placido_grid_basis(grid, 0, 0, &basis);
  for (int j = 0; j < grid->order; j++) {
    for (int i = 0; i < grid->order; i++) {
      right[(basis.row + j) * grid->side + basis.column + i] =
          PLACIDO_DISTANCE_WEIGHT * basis.y[0][j] * basis.x[0][i];
    }
  }
  int status = placido_normal_solve_more(normal, right, 1, by_distance, err);
  placido_memory_free(right);
  return status;
}

/* A sample's residual per mm of distance, in sigmas, and its weight. */
static double change_of(double *weight, const placido_refinement *r, const placido_sample *s,
                        const double *by_distance) {
  int side = r->shape.grid->side, order = r->shape.grid->order;
  double row[PLACIDO_SPLINE_CELL], sum = 0;
  const double *corner = by_distance + s->basis.row * side + s->basis.column;
  *weight = placido_sample_row(row, s, r->sigma_px);
  for (int j = 0; j < order; j++) {
    for (int i = 0; i < order; i++) {
      sum += row[j * order + i] * corner[j * side + i];
    }
  }
  return sum;
}

/* Sums over one edge. */
struct witness {
  double information, pull;
};

/* Adds what a mode of the geometry by one standard deviation would be taken for. */
static double variance_by_geometry(const placido_refinement *r, const double *by_distance,
                                   const placido_moves *moves, double information) {
  double sum = 0;
  for (int m = 0; moves && m < moves->modes; m++) {
    double pull = 0, weight;
    for (size_t i = 0; i < r->count; i++) {
      double change = moves->change[i * (size_t)moves->modes + (size_t)m];
      if (change != 0) {
        double by = change_of(&weight, r, &r->samples[i], by_distance);
        pull += weight * by * change;
      }
    }
    sum += pull * pull / (information * information);
  }
  return sum;
}

static struct answer find(const placido_refinement *r, const placido_mires *mires,
                          const double *by_distance, const placido_moves *moves) {
  struct witness witnesses[PLACIDO_EDGES_MAX] = {{0}};
  double information = 0, pull = 0, scatter = 0;
  int edges = 0;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (s->used && !isnan(s->residual_px)) {
      double weight, by = change_of(&weight, r, s, by_distance);
      struct witness *here = &witnesses[mires->points[s->point].edge];
      here->information += weight * by * by;
      here->pull += weight * by * s->residual_px / r->sigma_px;
    }
  }
  for (int k = 0; k < mires->edge_count; k++) {
    information += witnesses[k].information;
    pull += witnesses[k].pull;
    edges += witnesses[k].information > 0;
  }
  if (!(information > 0) || edges < 3) {
    return (struct answer){NAN, INFINITY};
  }
  double step = -pull / information;
  for (int k = 0; k < mires->edge_count; k++) {
    double left = witnesses[k].pull + step * witnesses[k].information;
    scatter += left * left;
  }
  double variance = fmax(scatter * edges / (edges - 2), information) / (information * information) +
                    variance_by_geometry(r, by_distance, moves, information);
  return (struct answer){step, sqrt(variance)};
}

/* Moves base and coefficients by a step of the distance as they answer to it. */
static void move_by(placido_refinement *r, const double *by_distance, double step_mm) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  r->shape.base.apex_z_mm += step_mm;
  for (size_t i = 0; i < n; i++) {
    r->coefficients[i] += step_mm * (by_distance[i] - 1); /* the base brings the lift itself */
  }
  r->traced = false;
}

placido_axis placido_axis_given(double z_mm, double sigma_mm) {
  return (placido_axis){z_mm, sigma_mm, z_mm, sigma_mm, false};
}

/* One look at what the mires say. The geometry is asked only where it matters. */
static int ask(struct answer *answer, double *by_distance, const placido_axis *axis,
               placido_refinement *r, const placido_distance_source *source, placido_error *err) {
  placido_moves moves = {0};
  placido_refinement_tell(r);
  int status = placido_distance_answer(by_distance, r->normal, r->shape.grid, err);
  if (!status) {
    *answer = find(r, source->mires, by_distance, NULL);
  }
  if (!status && source->modes > 0 && answer->sigma_mm < KNOWN * axis->given_sigma_mm) {
    status = placido_moves_new(&moves, r, source->mires, source->instrument, source->geometry,
                               source->modes, err);
    if (!status) {
      *answer = find(r, source->mires, by_distance, &moves);
    }
    placido_moves_free(&moves);
  }
  return status;
}

/* The weighted mean of what was given and what the mires say. Returns false where they contradict
 * each other. */
static bool weigh(placido_axis *axis, const struct answer *answer, placido_notes *notes) {
  double given = axis->given_sigma_mm * axis->given_sigma_mm;
  double seen = answer->sigma_mm * answer->sigma_mm;
  double off = axis->z_mm + answer->step_mm - axis->given_mm;
  if (!(fabs(off) < FAR * sqrt(given + seen))) {
    placido_notes_add(notes,
                      "the mires put the cornea %.3f mm from the distance that was given, far "
                      "beyond its standard deviation of %.3f mm: the instrument's geometry or the "
                      "distance is wrong",
                      off, axis->given_sigma_mm);
    return false;
  }
  axis->z_mm = axis->given_mm + off * given / (given + seen);
  axis->sigma_mm = sqrt(given * seen / (given + seen));
  axis->solved = true;
  return true;
}

int placido_distance_solve(placido_axis *axis, placido_refinement *r,
                           const placido_distance_source *source, placido_notes *notes,
                           placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  if (!(axis->given_sigma_mm > 0)) {
    return PLACIDO_OK;
  }
  double *by_distance = placido_memory_new(n, sizeof *by_distance, err);
  int status = by_distance ? PLACIDO_OK : PLACIDO_MEMORY;
  for (int pass = 0; pass < STEPS_MOST && !status; pass++) {
    struct answer answer;
    double before = axis->z_mm;
    status = ask(&answer, by_distance, axis, r, source, err);
    if (status || !(answer.sigma_mm < KNOWN * axis->given_sigma_mm) ||
        !weigh(axis, &answer, notes)) {
      break;
    }
    move_by(r, by_distance, axis->z_mm - before);
    status = placido_refinement_run(r, source->settled, err);
    if (fabs(axis->z_mm - before) < CLOSE * answer.sigma_mm) {
      break;
    }
  }
  placido_memory_free(by_distance);
  return status;
}

/* The derivative of the solution by the instrument: where the residuals change by d r, the
 * coefficients c change by -(JᵀWJ + penalty)⁻¹ JᵀW d r (implicit function theorem, Gauss-Newton).
 *
 * An intrinsic parameter moves the image of a ray that stands still, so that its effect is that of
 * moving the image point the other way; a camera that moves without turning shifts the ray's
 * origin; an edge changes the miss itself. */
#include "reconstruct/solve/errors/geometry.h"

#include "base/memory.h"

#include <math.h>

/* How the image of the camera's coordinates (x, y) moves with focal length, principal point and
 * Brown's five terms, as in camera.c. `seen` are the coordinates with the distortion in them. */
static void image_by_intrinsics(double by[9][2], const double focal_px[2], const double seen[2],
                                double x, double y) {
  double r2 = x * x + y * y;
  const double moved[9][2] = {{seen[0], 0},
                              {0, seen[1]},
                              {1, 0},
                              {0, 1},
                              {x * r2, y * r2},
                              {x * r2 * r2, y * r2 * r2},
                              {2 * x * y, r2 + 2 * y * y},
                              {r2 + 2 * x * x, 2 * x * y},
                              {x * r2 * r2 * r2, y * r2 * r2 * r2}};
  for (int k = 0; k < 9; k++) {
    for (int i = 0; i < 2; i++) {
      by[k][i] = moved[k][i] * (k < 4 ? 1 : focal_px[i]);
    }
  }
}

void placido_sample_by_geometry(double by[PLACIDO_SAMPLE_PARAMETERS], const placido_sample *sample,
                                const placido_mire_point *point,
                                const placido_instrument *instrument) {
  const placido_ray *ray = &sample->ray;
  bool pinhole = instrument->model == PLACIDO_PINHOLE;
  const double *position = instrument->position_mm, *focal = instrument->focal_px;
  double x = pinhole ? ray->direction[0] : ray->origin[0] - position[0];
  double y = pinhole ? -ray->direction[1] : position[1] - ray->origin[1];
  double seen[2] = {(point->u_px - instrument->principal_px[0]) / focal[0],
                    (point->v_px - instrument->principal_px[1]) / focal[1]};
  double image[9][2];
  image_by_intrinsics(image, focal, seen, x, y);
  for (int k = 0; k < 9; k++) {
    by[k] = -(sample->miss.by_u * image[k][0] + sample->miss.by_v * image[k][1]);
  }
  /* the same equation, asked for a shift of the origin in place of the image point */
  placido_ray probe = {.origin_u = {1, 0, 0}, .origin_v = {0, 1, 0}};
  for (int i = 0; i < 3; i++) {
    probe.origin[i] = ray->origin[i];
    probe.direction[i] = ray->direction[i];
  }
  placido_miss shifted = placido_mirror_miss(&probe, &sample->hit, sample->edge);
  by[9] = shifted.by_u;
  by[10] = shifted.by_v;
  /* along the ray nothing changes, and the direction's z is -1 */
  by[11] = ray->direction[0] * by[9] + ray->direction[1] * by[10];
  by[12] = sample->miss.by_radius;
  by[13] = sample->miss.by_height;
  for (int k = 0; k < PLACIDO_SAMPLE_PARAMETERS; k++) {
    by[k] /= sample->slope;
  }
}

/* What a mode changes of a sample's residual, px. */
static double change_along(const double *mode, const double *by, int edge, int edge_count) {
  double sum = by[12] * mode[PLACIDO_UNCERTAINTY_CAMERA + edge] +
               by[13] * mode[PLACIDO_UNCERTAINTY_CAMERA + edge_count + edge];
  for (int k = 0; k < PLACIDO_UNCERTAINTY_CAMERA; k++) {
    sum += by[k] * mode[k];
  }
  return sum;
}

static const double *mode_of(const placido_uncertainty *u, int mode) {
  return u->factor + (size_t)mode * (size_t)u->parameter_count;
}

/* An edge's samples taken together. */
struct edge_mean {
  double by[PLACIDO_SAMPLE_PARAMETERS];
  size_t count;
};

static void average(struct edge_mean *means, const placido_sample *samples, size_t count,
                    const placido_mires *mires, const placido_instrument *instrument) {
  for (size_t i = 0; i < count; i++) {
    const placido_mire_point *point = &mires->points[samples[i].point];
    double by[PLACIDO_SAMPLE_PARAMETERS];
    if (!isnan(samples[i].residual_px)) {
      struct edge_mean *mean = &means[point->edge];
      placido_sample_by_geometry(by, &samples[i], point, instrument);
      mean->count++;
      for (int k = 0; k < PLACIDO_SAMPLE_PARAMETERS; k++) {
        mean->by[k] += (by[k] - mean->by[k]) / (double)mean->count;
      }
    }
  }
}

double placido_geometry_rough(const placido_sample *samples, size_t count,
                              const placido_mires *mires, const placido_instrument *instrument,
                              const placido_uncertainty *uncertainty, int modes) {
  struct edge_mean means[PLACIDO_EDGES_MAX] = {0};
  average(means, samples, count, mires, instrument);
  double sum = 0;
  int edges = instrument->edge_count, triples = 0;
  for (int k = 1; k + 1 < edges; k++) {
    if (!means[k - 1].count || !means[k].count || !means[k + 1].count) {
      continue;
    }
    triples++;
    for (int m = 0; m < modes; m++) {
      const double *mode = mode_of(uncertainty, m);
      double bend = change_along(mode, means[k - 1].by, k - 1, edges) -
                    2 * change_along(mode, means[k].by, k, edges) +
                    change_along(mode, means[k + 1].by, k + 1, edges);
      sum += bend * bend / 6; /* the second difference of independent errors has 6 variances */
    }
  }
  return triples ? sqrt(sum / triples) : 0;
}

/* Fills `change`, in sigmas; 0 for samples that do not count. */
static void differentiate(placido_moves *moves, const placido_refinement *r,
                          const placido_mires *mires, const placido_instrument *instrument,
                          const placido_uncertainty *uncertainty) {
#pragma omp parallel for num_threads(r->threads)
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (!s->used || isnan(s->residual_px)) {
      continue;
    }
    const placido_mire_point *point = &mires->points[s->point];
    double by[PLACIDO_SAMPLE_PARAMETERS];
    placido_sample_by_geometry(by, s, point, instrument);
    for (int m = 0; m < moves->modes; m++) {
      moves->change[i * (size_t)moves->modes + (size_t)m] =
          change_along(mode_of(uncertainty, m), by, point->edge, uncertainty->edge_count) /
          r->sigma_px;
    }
  }
}

int placido_moves_new(placido_moves *moves, const placido_refinement *r,
                      const placido_mires *mires, const placido_instrument *instrument,
                      const placido_uncertainty *uncertainty, int modes, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side, rights = n * (size_t)modes;
  *moves = (placido_moves){.modes = modes};
  moves->change = placido_memory_new(r->count, (size_t)modes * sizeof *moves->change, err);
  moves->coefficients = placido_memory_new(rights, sizeof *moves->coefficients, err);
  double *right = placido_memory_new(rights, sizeof *right, err);
  int status = moves->change && moves->coefficients && right ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    differentiate(moves, r, mires, instrument, uncertainty);
    placido_refinement_push(right, r, NULL, moves->change, modes);
    for (size_t i = 0; i < rights; i++) {
      right[i] = -right[i];
    }
    status = placido_normal_solve_more(r->normal, right, modes, moves->coefficients, err);
  }
  placido_memory_free(right);
  if (status) {
    placido_moves_free(moves);
  }
  return status;
}

void placido_moves_free(placido_moves *moves) {
  placido_memory_free(moves->change);
  placido_memory_free(moves->coefficients);
  *moves = (placido_moves){0};
}

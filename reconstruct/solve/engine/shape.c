/* Newton's method along a ray to the shape, and the residual there. */
#include "reconstruct/solve/engine/shape.h"

#include "base/memory.h"
#include "reconstruct/camera.h"
#include "reconstruct/median.h"

#include <math.h>

#define STEPS_MAX 30
#define CLOSE_MM 1e-10

static bool shape_at(const placido_shape *shape, double x, double y, placido_hit *hit,
                     placido_spot *spot) {
  placido_jet jet;
  if (!placido_surface_at(shape->base, x, y, &jet)) {
    return false;
  }
  *hit = (placido_hit){.x = x,
                       .y = y,
                       .z = placido_surface_vertex_z_mm(shape->base) - jet.sag,
                       .p = -jet.sx,
                       .q = -jet.sy,
                       .xx = -jet.sxx,
                       .xy = -jet.sxy,
                       .yy = -jet.syy};
  if (shape->coefficients) {
    double s[6];
    placido_basis basis;
    spot->knot_mm = shape->grid->knot_mm;
    spot->order = shape->grid->order;
    if (!placido_grid_locate(shape->grid, x, y, &spot->column, &spot->row, &spot->x,
                             &spot->y) ||
        !placido_grid_basis(shape->grid, x, y, &basis)) {
      return false;
    }
    placido_grid_value(shape->grid, shape->coefficients, &basis, s);
    hit->z += s[0];
    hit->p += s[1];
    hit->q += s[2];
    hit->xx += s[3];
    hit->xy += s[4];
    hit->yy += s[5];
  }
  return true;
}

static bool meet(placido_sample *sample, const placido_shape *shape) {
  const double *o = sample->ray.origin, *d = sample->ray.direction;
  double t = sample->t;
  for (int step = 0; step < STEPS_MAX; step++) {
    if (!shape_at(shape, o[0] + t * d[0], o[1] + t * d[1], &sample->hit, &sample->basis)) {
      return false;
    }
    double over = o[2] + t * d[2] - sample->hit.z;
    double descent = d[2] - sample->hit.p * d[0] - sample->hit.q * d[1];
    if (fabs(over) < CLOSE_MM) {
      sample->t = t;
      return true;
    }
    t -= over / descent;
  }
  return false;
}

void placido_sample_trace(placido_sample *sample, const placido_shape *shape) {
  sample->residual_px = NAN;
  if (!meet(sample, shape)) {
    return;
  }
  sample->miss = placido_mirror_miss(&sample->ray, &sample->hit, sample->edge);
  sample->slope =
      sqrt(sample->miss.by_u * sample->miss.by_u + sample->miss.by_v * sample->miss.by_v);
  sample->residual_px = sample->slope > 0 ? sample->miss.f / sample->slope : NAN;
}

int placido_samples_new(placido_sample **samples, const placido_mires *mires,
                        const placido_instrument *instrument, double axis_z_mm,
                        placido_error *err) {
  placido_sample *s = *samples = placido_memory_new(mires->count, sizeof *s, err);
  if (!s) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    s[i] = (placido_sample){.ray = placido_camera_ray(instrument, p->u_px, p->v_px),
                            .edge = &instrument->edges[p->edge],
                            .point = i,
                            .used = true,
                            .shared = 1,
                            .noise = 1,
                            .residual_px = NAN};
    s[i].t = s[i].ray.origin[2] - axis_z_mm;
  }
  return PLACIDO_OK;
}

double placido_samples_spread(const placido_sample *samples, size_t count, double *work) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used && !isnan(samples[i].residual_px)) {
      work[n++] = fabs(samples[i].residual_px);
    }
  }
  return 1.4826 * placido_quantile(work, n, 0.5);
}

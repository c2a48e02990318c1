/* The first stage of a fit: the conicoid, from some of the points. */
#include "base/memory.h"
#include "reconstruct/solve/engine/conic.h"
#include "reconstruct/solve/solution.h"

#include <math.h>

#define BASE_POINTS 1000 /* about so many tell the conicoid */
#define RADIUS_MAX_MM 7
/* A point this far from the conicoid says nothing of how far the data reach. */
#define FAR_PX 20.0

int placido_solution_modes(const placido_fit_options *options) {
  if (!options || !options->geometry) {
    return 0;
  }
  int all = options->geometry->mode_count, asked = options->geometry_modes;
  return asked > 0 && asked < all ? asked : all;
}

/* The conicoid is found from every stride-th sample: it has four unknowns. */
static int find_base(placido_solution *p, placido_error *err) {
  size_t stride = p->count / BASE_POINTS + 1, few = 0;
  placido_sightlines rays = {0};
  placido_sample *some = placido_memory_new(p->count / stride + 1, sizeof *some, err);
  if (!some) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < p->count; i += stride) {
    some[few++] = p->samples[i];
  }
  int status = placido_sightlines_new(&rays, some, few, err);
  if (!status) {
    status = placido_conic_fit(&p->base, &rays, p->axis.z_mm, p->threads, err);
  }
  placido_sightlines_free(&rays);
  placido_memory_free(some);
  return status;
}

int placido_solution_base(placido_solution *p, placido_error *err) {
  int status = find_base(p, err);
  if (status) {
    return status;
  }
  placido_target target = {.base = p->base};
  placido_sightlines_trace(&p->rays, &target, p->threads);
  placido_sightlines_tell(&p->rays);
  p->reach_mm = 0;
  for (size_t i = 0; i < p->count; i++) {
    const placido_sample *s = &p->samples[i];
    if (fabs(s->residual_px) < FAR_PX) {
      p->reach_mm = fmax(p->reach_mm, fmax(fabs(s->hit.x), fabs(s->hit.y)));
    }
  }
  int modes = placido_solution_modes(p->options);
  if (modes > 0) {
    placido_sightlines_tell_all(&p->rays, &target, p->threads);
    p->geometry_px = placido_geometry_rough(p->samples, p->count, p->mires, p->instrument,
                                            p->options->geometry, modes);
  }
  if (!(p->reach_mm > 0.5) || p->reach_mm > RADIUS_MAX_MM) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires would lie within %.2f mm of the axis, 0.5 to %d mm are "
                             "possible: instrument, distance or numbering is wrong",
                             p->reach_mm, RADIUS_MAX_MM);
  }
  return PLACIDO_OK;
}

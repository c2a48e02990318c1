/* Tracer: a run's places, the surface there, and what its refraction makes of the light. The
 * crosshatch is two tensor grids, so that the surface is asked row by row. */
#include "simulate/rays/tracer.h"

#include "base/memory.h"
#include "simulate/rays/refract.h"

#include <math.h>

/* Nodes stand at the even columns, counted in half cells from the pupil's left, middles at the odd
 * ones. */
static int make_sheet(placido_tracer *tracer, int middles, double *x_mm, placido_error *err) {
  const placido_crosshatch *c = &tracer->pattern.crosshatch;
  int count = c->samples - middles, edge = c->samples - 1;
  for (int i = 0; i < count; i++) {
    x_mm[i] = c->x_mm + (2 * i + middles - edge) * c->half_cell_mm;
  }
  return placido_sheet_new(&tracer->sheets[middles], tracer->surface, x_mm, (size_t)count, err);
}

static int make_sheets(placido_tracer *tracer, placido_error *err) {
  size_t samples = (size_t)tracer->pattern.crosshatch.samples;
  double *x_mm = placido_memory_new(samples, sizeof *x_mm, err);
  int status = x_mm == NULL ? PLACIDO_MEMORY : PLACIDO_OK;
  for (int middles = 0; middles < 2 && status == PLACIDO_OK; middles++) {
    status = make_sheet(tracer, middles, x_mm, err);
  }
  placido_memory_free(x_mm);
  if (status == PLACIDO_OK) {
    size_t nodes = placido_sheet_work(tracer->sheets[0]);
    size_t middles = placido_sheet_work(tracer->sheets[1]);
    tracer->work = nodes > middles ? nodes : middles;
  }
  return status;
}

int placido_tracer_new(placido_tracer *tracer, const placido_surface *surface,
                       const placido_apex *apex, const placido_eye *eye,
                       enum placido_pattern_kind pattern, long rays, placido_error *err) {
  *tracer = (placido_tracer){.surface = surface,
                             .axis_sag_mm = apex->axis_sag_mm,
                             .eye = *eye,
                             .pattern = placido_pattern_of(eye, pattern, rays)};
  if (pattern != PLACIDO_PATTERN_CROSSHATCH) {
    return PLACIDO_OK;
  }
  int status = make_sheets(tracer, err);
  if (status != PLACIDO_OK) {
    placido_tracer_free(tracer);
  }
  return status;
}

void placido_tracer_free(placido_tracer *tracer) {
  if (tracer != NULL) {
    placido_sheet_free(tracer->sheets[0]);
    placido_sheet_free(tracer->sheets[1]);
    *tracer = (placido_tracer){0};
  }
}

static void ask_row(const placido_tracer *tracer, long row, int count,
                    const placido_ray_columns *c) {
  const placido_crosshatch *crosshatch = &tracer->pattern.crosshatch;
  int middles = row >= crosshatch->samples;
  size_t first = (size_t)(crosshatch->samples - middles - count) / 2;
  placido_sheet_line(tracer->sheets[middles], c->work, c->y_mm[0], first, (size_t)count,
                     c->depth_mm, c->sx, c->sy);
}

static void ask_points(const placido_tracer *tracer, int count, const placido_ray_columns *c) {
  for (int i = 0; i < count; i++) {
    placido_jet jet; /* NaN where the surface is not defined */
    placido_surface_at(tracer->surface, c->x_mm[i], c->y_mm[i], &jet);
    c->depth_mm[i] = jet.sag;
    c->sx[i] = jet.sx;
    c->sy[i] = jet.sy;
    if (c->sxx != NULL) {
      c->sxx[i] = jet.sxx;
      c->sxy[i] = jet.sxy;
      c->syy[i] = jet.syy;
    }
  }
}

int placido_tracer_run(const placido_tracer *tracer, long run,
                       const placido_ray_columns *columns) {
  int count = placido_pattern_run(&tracer->pattern, run, columns->x_mm, columns->y_mm,
                                  columns->weight);
  if (count == 0) {
    return 0;
  }
  if (tracer->pattern.kind == PLACIDO_PATTERN_CROSSHATCH) {
    ask_row(tracer, run, count, columns);
  } else {
    ask_points(tracer, count, columns);
  }
  for (int i = 0; i < count; i++) {
    columns->depth_mm[i] -= tracer->axis_sag_mm;
  }
  placido_refract(columns->u, columns->v, columns->x_mm, columns->y_mm, columns->sx, columns->sy,
                  (size_t)count, &tracer->eye);
  return count;
}

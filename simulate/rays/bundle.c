/* Bundle: runs of the pattern traced one by one into columns, closed up where rays are lost. */
#include "simulate/rays/bundle.h"

#include "base/memory.h"
#include "simulate/rays/refract.h"
#include "simulate/rays/tracer.h"

#include <math.h>

enum { KEPT = 6, COLUMNS = 8 };

/* What is needed while the bundle is filled. */
typedef struct filling {
  placido_tracer tracer;
  placido_bundle *bundle;
  size_t *first;             /* ray of every run */
  double *sx, *sy, *work;    /* the surface's slopes; room to work in for every thread */
  unsigned char *fate, *covered;
} filling;

static void trace_run(const filling *f, long run, double *work) {
  const placido_bundle *b = f->bundle;
  size_t first = f->first[run], end = f->first[run + 1];
  const placido_ray_columns columns = {.x_mm = b->x_mm + first,
                                       .y_mm = b->y_mm + first,
                                       .depth_mm = b->depth_mm + first,
                                       .sx = f->sx + first,
                                       .sy = f->sy + first,
                                       .u = b->u + first,
                                       .v = b->v + first,
                                       .weight = b->weight + first,
                                       .work = work};
  placido_tracer_run(&f->tracer, run, &columns);
  for (size_t i = first; i < end; i++) {
    f->fate[i] = isfinite(b->u[i]) ? PLACIDO_FATE_ARRIVED
                                   : placido_refract_fate(b->x_mm[i], b->y_mm[i], f->sx[i],
                                                          f->sy[i], &f->tracer.eye);
    f->covered[i] = placido_surface_covered(f->tracer.surface, b->x_mm[i], b->y_mm[i]);
  }
}

/* Counts what is lost and closes the gaps. */
static void close_up(const filling *f) {
  placido_bundle *b = f->bundle;
  long *lost[] = {NULL, &b->missed, &b->grazed, &b->reflected};
  for (size_t i = 0; i < (size_t)b->asked; i++) {
    if (f->fate[i] != PLACIDO_FATE_ARRIVED) {
      ++*lost[f->fate[i]];
      b->lost += b->weight[i];
      continue;
    }
    size_t to = b->count++;
    b->x_mm[to] = b->x_mm[i];
    b->y_mm[to] = b->y_mm[i];
    b->depth_mm[to] = b->depth_mm[i];
    b->u[to] = b->u[i];
    b->v[to] = b->v[i];
    b->weight[to] = b->weight[i];
    b->uncovered += f->covered[i] ? 0 : b->weight[i];
  }
}

static int allocate(filling *f, int threads, placido_error *err) {
  size_t runs = (size_t)f->tracer.pattern.runs;
  f->first = placido_memory_new(runs + 1, sizeof *f->first, err);
  if (f->first == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t run = 0; run < runs; run++) {
    f->first[run + 1] =
      f->first[run] + (size_t)placido_pattern_count(&f->tracer.pattern, (long)run);
  }
  size_t count = f->first[runs];
  placido_bundle *b = f->bundle;
  b->asked = (long)count;
  b->x_mm = placido_memory_new(count, KEPT * sizeof *b->x_mm, err);
  f->sx = placido_memory_new(count, (COLUMNS - KEPT) * sizeof *f->sx, err);
  f->work = placido_memory_new(f->tracer.work + 1, (size_t)threads * sizeof *f->work, err);
  f->fate = placido_memory_new(count, 2, err);
  if (b->x_mm == NULL || f->sx == NULL || f->work == NULL || f->fate == NULL) {
    return PLACIDO_MEMORY;
  }
  f->sy = f->sx + count;
  f->covered = f->fate + count;
  double **columns[KEPT - 1] = {&b->y_mm, &b->depth_mm, &b->u, &b->v, &b->weight};
  for (size_t i = 0; i < KEPT - 1; i++) {
    *columns[i] = b->x_mm + (i + 1) * count;
  }
  return PLACIDO_OK;
}

/* Every `threads`-th run from `thread` on. */
static void trace_runs(const filling *f, int thread, int threads) {
  double *work = f->work + (size_t)thread * f->tracer.work;
  for (long run = thread; run < f->tracer.pattern.runs; run += threads) {
    trace_run(f, run, work);
  }
}

int placido_bundle_new(placido_bundle *bundle, const placido_surface *surface,
                       const placido_apex *apex, const placido_eye *eye,
                       enum placido_pattern_kind pattern, long rays, int threads,
                       placido_error *err) {
  *bundle = (placido_bundle){0};
  filling f = {.bundle = bundle};
  int status = placido_tracer_new(&f.tracer, surface, apex, eye, pattern, rays, err);
  if (status == PLACIDO_OK) {
    status = allocate(&f, threads, err);
  }
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (int thread = 0; thread < threads; thread++) {
      trace_runs(&f, thread, threads);
    }
    close_up(&f);
  } else {
    placido_bundle_free(bundle);
  }
  placido_tracer_free(&f.tracer);
  placido_memory_free(f.first);
  placido_memory_free(f.sx);
  placido_memory_free(f.work);
  placido_memory_free(f.fate);
  return status;
}

void placido_bundle_free(placido_bundle *bundle) {
  if (bundle != NULL) {
    placido_memory_free(bundle->x_mm); /* the block's first column */
    *bundle = (placido_bundle){0};
  }
}

double placido_path_mm(const placido_eye *eye, double x_mm, double y_mm, double depth_mm,
                       const double focus_mm[3]) {
  const placido_correction *lens = &eye->correction;
  double rx = x_mm - eye->pupil_x_mm, ry = y_mm - eye->pupil_y_mm;
  double bend = lens->m_D * (rx * rx + ry * ry) + lens->j0_D * (rx * rx - ry * ry) +
                2 * lens->j45_D * rx * ry;
  double dx = x_mm - focus_mm[0], dy = y_mm - focus_mm[1], dz = depth_mm - focus_mm[2];
  return depth_mm + eye->index * sqrt(dx * dx + dy * dy + dz * dz) - bend / 2000;
}

void placido_bundle_opd(double *opd_um, const placido_bundle *bundle, const placido_eye *eye,
                        const double focus_mm[3], double chief_path_um) {
  for (size_t i = 0; i < bundle->count; i++) {
    double path_mm = placido_path_mm(eye, bundle->x_mm[i], bundle->y_mm[i], bundle->depth_mm[i],
                                     focus_mm);
    opd_um[i] = chief_path_um - 1000 * path_mm;
  }
}

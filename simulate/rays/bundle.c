/* Bundle: runs of the pattern traced one by one into columns, then closed up where rays are lost. */
#include "simulate/rays/bundle.h"

#include "base/memory.h"
#include "simulate/rays/pattern.h"
#include "simulate/rays/refract.h"

#include <math.h>

enum { COLUMNS = 9 };

/* Columns while they are filled: those of the bundle, the surface's slopes, and what became of each
 * ray. */
typedef struct filling {
  const placido_surface *surface;
  const placido_apex *apex;
  const placido_eye *eye;
  placido_pattern pattern;
  placido_bundle *bundle;
  double *sx, *sy;
  unsigned char *fate, *covered;
  size_t *first; /* ray of every run */
} filling;

static void trace_run(const filling *f, long run) {
  const placido_bundle *b = f->bundle;
  size_t first = f->first[run], count = f->first[run + 1] - first;
  placido_pattern_run(&f->pattern, run, b->x_mm + first, b->y_mm + first, b->weight + first);
  for (size_t i = first; i < first + count; i++) {
    placido_jet jet; /* NaN where the surface is not defined */
    placido_surface_at(f->surface, b->x_mm[i], b->y_mm[i], &jet);
    b->depth_mm[i] = jet.sag - f->apex->axis_sag_mm;
    f->sx[i] = jet.sx;
    f->sy[i] = jet.sy;
    f->covered[i] = placido_surface_covered(f->surface, b->x_mm[i], b->y_mm[i]);
  }
  placido_refract(b->u + first, b->v + first, b->x_mm + first, b->y_mm + first, f->sx + first,
                  f->sy + first, count, f->eye);
  for (size_t i = first; i < first + count; i++) {
    f->fate[i] = isfinite(b->u[i]) ? PLACIDO_FATE_ARRIVED
                                   : placido_refract_fate(b->x_mm[i], b->y_mm[i], f->sx[i],
                                                          f->sy[i], f->eye);
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

static int allocate(filling *f, placido_error *err) {
  size_t runs = (size_t)f->pattern.runs;
  f->first = placido_memory_new(runs + 1, sizeof *f->first, err);
  if (f->first == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t run = 0; run < runs; run++) {
    f->first[run + 1] = f->first[run] + (size_t)placido_pattern_count(&f->pattern, (long)run);
  }
  size_t count = f->first[runs];
  placido_bundle *b = f->bundle;
  b->asked = (long)count;
  f->fate = placido_memory_new(count, 2, err);
  f->sx = placido_memory_new(count, 2 * sizeof *f->sx, err);
  b->x_mm = placido_memory_new(count, (COLUMNS - 3) * sizeof *b->x_mm, err);
  if (f->fate == NULL || f->sx == NULL || b->x_mm == NULL) {
    return PLACIDO_MEMORY;
  }
  f->covered = f->fate + count;
  f->sy = f->sx + count;
  double **columns[] = {&b->y_mm, &b->depth_mm, &b->u, &b->v, &b->weight};
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
    *columns[i] = b->x_mm + (i + 1) * count;
  }
  return PLACIDO_OK;
}

int placido_bundle_new(placido_bundle *bundle, const placido_surface *surface,
                       const placido_apex *apex, const placido_eye *eye,
                       enum placido_pattern_kind pattern, long rays, int threads,
                       placido_error *err) {
  *bundle = (placido_bundle){0};
  filling f = {.surface = surface,
               .apex = apex,
               .eye = eye,
               .pattern = placido_pattern_of(eye, pattern, rays),
               .bundle = bundle};
  int status = allocate(&f, err);
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(threads) schedule(static, 8) if (threads > 1)
    for (long run = 0; run < f.pattern.runs; run++) {
      trace_run(&f, run);
    }
    close_up(&f);
  } else {
    placido_bundle_free(bundle);
  }
  placido_memory_free(f.first);
  placido_memory_free(f.fate);
  placido_memory_free(f.sx);
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

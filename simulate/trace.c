/* Rays: the crosshatch over the pupil, the thin lens, Snell's law in vector form, the plane retina.
 *
 * The light comes along -z. A thin lens on the cornea changes a ray's slope by -S r (Prentice's
 * rule), S = [[M + J0, J45], [J45, M - J0]] and r the position from the pupil's centre. The surface
 * then refracts it exactly: with d the ray, N the normal towards the light and c = -d.N,
 * t = d / n + (c / n - sqrt(1 - (1 - c²) / n²)) N. */
#include "simulate/trace.h"

#include "base/memory.h"

#include <math.h>

bool placido_entry_at(placido_entry *entry, const placido_surface *surface,
                      const placido_apex *apex, double x_mm, double y_mm) {
  placido_jet jet;
  if (!placido_surface_at(surface, x_mm, y_mm, &jet)) {
    return false;
  }
  *entry = (placido_entry){x_mm, y_mm, jet.sag - apex->axis_sag_mm, jet.sx, jet.sy};
  return true;
}

bool placido_entry_trace(const placido_entry *entry, const placido_eye *eye, double retina_mm,
                         double *x_mm, double *y_mm) {
  const placido_correction *lens = &eye->correction;
  double rx = (entry->x_mm - eye->pupil_x_mm) / 1000, ry = (entry->y_mm - eye->pupil_y_mm) / 1000;
  double ax = -((lens->m_D + lens->j0_D) * rx + lens->j45_D * ry);
  double ay = -(lens->j45_D * rx + (lens->m_D - lens->j0_D) * ry);
  double along_ray = 1 / sqrt(1 + ax * ax + ay * ay);
  double along_normal = 1 / sqrt(1 + entry->sx * entry->sx + entry->sy * entry->sy);
  double cosine = (1 - ax * entry->sx - ay * entry->sy) * along_ray * along_normal;
  double slowness = 1 / eye->index;
  double root = 1 - slowness * slowness * (1 - cosine * cosine);
  double on_ray = slowness * along_ray;
  double on_normal = (slowness * cosine - sqrt(root)) * along_normal;
  double down = on_ray - on_normal;
  if (!(cosine > 0 && root > 0 && down > 0)) {
    return false;
  }
  double reach = (retina_mm - entry->depth_mm) / down;
  *x_mm = entry->x_mm + reach * (on_ray * ax + on_normal * entry->sx);
  *y_mm = entry->y_mm + reach * (on_ray * ay + on_normal * entry->sy);
  return true;
}

static void enter_row(placido_rays *rays, const placido_surface *surface,
                      const placido_apex *apex, const placido_crosshatch *pattern, int row) {
  double x, y;
  int count;
  placido_crosshatch_row(pattern, row, &x, &count, &y);
  for (int i = 0; i < count; i++) {
    double at = x + 2 * i * pattern->half_cell_mm;
    if (placido_entry_at(&rays->entries[rays->count], surface, apex, at, y)) {
      rays->count++;
      rays->uncovered += !placido_surface_covered(surface, at, y);
    } else {
      rays->missed++;
    }
  }
}

int placido_rays_new(placido_rays *rays, const placido_surface *surface, const placido_apex *apex,
                     const placido_eye *eye, int samples, placido_error *err) {
  *rays = (placido_rays){0};
  placido_crosshatch pattern = placido_crosshatch_of(eye, samples);
  rays->entries = placido_memory_new((size_t)placido_crosshatch_total(&pattern),
                                     sizeof *rays->entries, err);
  if (rays->entries == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int row = 0; row < pattern.rows; row++) {
    enter_row(rays, surface, apex, &pattern, row);
  }
  return PLACIDO_OK;
}

void placido_rays_free(placido_rays *rays) {
  if (rays != NULL) {
    placido_memory_free(rays->entries);
    *rays = (placido_rays){0};
  }
}

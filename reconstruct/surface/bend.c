/* A surface beside another: the same parts, the spline's coefficients moved. */
#include "base/memory.h"
#include "reconstruct/surface/surface.h"

/* Index of the last B-spline; the number of parts where there is none. */
static size_t spline_of(const placido_surface *surface) {
  for (size_t i = surface->term_count; i-- > 0;) {
    if (surface->terms[i].part.kind == PLACIDO_PART_BSPLINE) {
      return i;
    }
  }
  return surface->term_count;
}

int placido_surface_bend(placido_surface **bent, const placido_surface *surface,
                         const double *change_mm, placido_error *err) {
  *bent = NULL;
  size_t at = spline_of(surface);
  if (at == surface->term_count) {
    return placido_error_set(err, PLACIDO_INPUT, "the surface has no B-spline that could bend");
  }
  const placido_part *spline = &surface->terms[at].part;
  size_t count = (size_t)spline->as.bspline.columns * (size_t)spline->as.bspline.rows;
  placido_part *parts = placido_memory_new(surface->term_count, sizeof *parts, err);
  double *moved = placido_memory_new(count, sizeof *moved, err);
  int status = parts && moved ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < surface->term_count; i++) {
      parts[i] = surface->terms[i].part;
    }
    for (size_t i = 0; i < count; i++) {
      moved[i] = spline->as.bspline.coefficients_mm[i] + change_mm[i];
    }
    parts[at].as.bspline.coefficients_mm = moved;
    status = placido_surface_new(bent, surface->vertex_z_mm, surface->radius_mm, parts,
                                 surface->term_count,
                                 surface->has_coverage ? &surface->coverage : NULL, err);
  }
  placido_memory_free(parts);
  placido_memory_free(moved);
  return status;
}

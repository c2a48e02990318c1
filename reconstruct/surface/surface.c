/* The surface: a sum of parts, made once and asked by many threads. */
#include "reconstruct/surface/surface.h"

#include "base/memory.h"
#include "reconstruct/surface/coverage.h"

#include <math.h>

static int refuse(placido_error *err, const char *field, double value, const char *expected) {
  return placido_error_set(err, PLACIDO_INPUT, "surface: %s is %g, %s is expected", field, value,
                           expected);
}

static int check_frame(double vertex_z_mm, double radius_mm, size_t part_count,
                       placido_error *err) {
  if (!(fabs(vertex_z_mm) <= 1000)) {
    return refuse(err, "vertex_z_mm", vertex_z_mm, "-1000 to 1000");
  }
  if (!(radius_mm > 0 && radius_mm <= PLACIDO_SURFACE_RADIUS_MAX_MM)) {
    return refuse(err, "radius_mm", radius_mm, "more than 0, at most 20");
  }
  if (part_count < 1 || part_count > PLACIDO_SURFACE_PARTS_MAX) {
    return refuse(err, "the number of parts", (double)part_count, "1 to 256");
  }
  return PLACIDO_OK;
}

static int make_term(placido_surface_term *term, const placido_part *part, size_t index,
                     placido_error *err) {
  placido_complaint complaint;
  if (!placido_part_check(part, &complaint)) {
    bool known = (int)part->kind >= 0 && part->kind < PLACIDO_PART_KINDS;
    return placido_error_set(err, PLACIDO_INPUT, "surface: part %zu (%s): %s: %s", index,
                             known ? placido_part_rows[part->kind]->name : "unknown",
                             complaint.field, complaint.reason);
  }
  term->part = *part;
  term->row = placido_part_rows[part->kind];
  return term->row->prepare(&term->state, &term->part, err);
}

int placido_surface_new(placido_surface **surface, double vertex_z_mm, double radius_mm,
                        const placido_part *parts, size_t part_count,
                        const placido_coverage *coverage, placido_error *err) {
  *surface = NULL;
  int status = check_frame(vertex_z_mm, radius_mm, part_count, err);
  if (status) {
    return status;
  }
  placido_surface *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  made->vertex_z_mm = vertex_z_mm;
  made->radius_mm = radius_mm;
  made->terms = placido_memory_new(part_count, sizeof *made->terms, err);
  status = made->terms ? PLACIDO_OK : PLACIDO_MEMORY;
  for (size_t i = 0; i < part_count && !status; i++) {
    status = make_term(&made->terms[i], &parts[i], i, err);
    made->term_count = i + 1;
  }
  if (!status && coverage) {
    status = placido_coverage_copy(&made->coverage, &made->mask, coverage, err);
    made->has_coverage = true;
  }
  if (status) {
    placido_surface_free(made);
    return status;
  }
  *surface = made;
  return PLACIDO_OK;
}

void placido_surface_free(placido_surface *surface) {
  if (!surface) {
    return;
  }
  for (size_t i = 0; i < surface->term_count; i++) {
    if (surface->terms[i].state) {
      surface->terms[i].row->release(surface->terms[i].state);
    }
  }
  placido_memory_free(surface->terms);
  placido_memory_free(surface->mask);
  placido_memory_free(surface);
}

double placido_surface_vertex_z_mm(const placido_surface *surface) {
  return surface->vertex_z_mm;
}

double placido_surface_radius_mm(const placido_surface *surface) {
  return surface->radius_mm;
}

static bool is_inside(const placido_surface *surface, double x_mm, double y_mm) {
  double limit = surface->radius_mm + PLACIDO_SURFACE_EDGE_MM;
  return x_mm * x_mm + y_mm * y_mm <= limit * limit;
}

static bool add_terms(const placido_surface *surface, double x_mm, double y_mm, placido_jet *jet) {
  for (size_t i = 0; i < surface->term_count; i++) {
    const placido_surface_term *term = &surface->terms[i];
    if (!term->row->add(term->state, x_mm, y_mm, jet)) {
      return false;
    }
  }
  return isfinite(jet->sag + jet->sx + jet->sy + jet->sxx + jet->sxy + jet->syy);
}

bool placido_surface_at(const placido_surface *surface, double x_mm, double y_mm,
                        placido_jet *jet) {
  *jet = (placido_jet){0};
  if (is_inside(surface, x_mm, y_mm) && add_terms(surface, x_mm, y_mm, jet)) {
    return true;
  }
  *jet = (placido_jet){NAN, NAN, NAN, NAN, NAN, NAN};
  return false;
}

bool placido_surface_covered(const placido_surface *surface, double x_mm, double y_mm) {
  return is_inside(surface, x_mm, y_mm) &&
         (!surface->has_coverage || placido_coverage_at(&surface->coverage, x_mm, y_mm));
}

/* Maps: every kind of map evaluated on one grid, row by row. */
#include "base/memory.h"
#include "reconstruct/maps/sigma.h"
#include "reconstruct/maps/sphere.h"

#include <placido/map.h>

#include <math.h>

/* A point this far outside the radius still lies within, as for the surface. */
#define EDGE_MM 1e-12

/* Steps such as 0.1 divide 1: then i/10 is the number nearest to the decimal, i * 0.1 is not. */
double placido_maps_position(const placido_maps *maps, int index) {
  double per_mm = round(1 / maps->step_mm);
  return 1 / per_mm == maps->step_mm ? (index - maps->half) / per_mm
                                     : (index - maps->half) * maps->step_mm;
}

static int allocate(placido_maps *maps, bool with_sigma, placido_error *err) {
  size_t kinds, points = (size_t)maps->size * (size_t)maps->size;
  placido_map_kinds(&kinds);
  maps->valid = placido_memory_new(points, sizeof *maps->valid, err);
  maps->z_mm = placido_memory_new(points, sizeof *maps->z_mm, err);
  maps->values = placido_memory_new(kinds, sizeof *maps->values, err);
  if (!maps->valid || !maps->z_mm || !maps->values) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < kinds; i++) {
    maps->values[i] = placido_memory_new(points, sizeof **maps->values, err);
    if (!maps->values[i]) {
      return PLACIDO_MEMORY;
    }
  }
  if (with_sigma) {
    maps->sigma_z_um = placido_memory_new(points, sizeof *maps->sigma_z_um, err);
    maps->sigma_axial_D = placido_memory_new(points, sizeof *maps->sigma_axial_D, err);
    return maps->sigma_z_um && maps->sigma_axial_D ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  return PLACIDO_OK;
}

static int fit_sphere(placido_maps *maps, const placido_surface *surface, placido_error *err) {
  placido_zone zone;
  int status = placido_zone_new(&zone, surface, PLACIDO_SPHERE_ZONE_MM, err);
  if (!status) {
    maps->sphere = placido_sphere_fit(&zone);
    placido_zone_free(&zone);
  }
  return status;
}

/* z of the surface at (x, y), with its jet; NaN where there is none. */
static double height_at(const placido_surface *surface, double x, double y, placido_jet *jet) {
  return placido_surface_at(surface, x, y, jet) ? placido_surface_vertex_z_mm(surface) - jet->sag
                                                : NAN;
}

static void fill_point(placido_maps *maps, const placido_surface *surface, const placido_fit *fit,
                       placido_map_point point, size_t index) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  point.z_mm = height_at(surface, point.x_mm, point.y_mm, &point.jet);
  bool valid = isfinite(point.z_mm) && placido_surface_covered(surface, point.x_mm, point.y_mm);
  maps->valid[index] = valid;
  maps->z_mm[index] = valid ? point.z_mm : NAN;
  for (size_t i = 0; i < count; i++) {
    maps->values[i][index] = valid ? kinds[i].at(&point) : NAN;
  }
  if (fit) {
    maps->sigma_z_um[index] = maps->sigma_axial_D[index] = NAN;
    if (valid) {
      placido_sigma_at(fit, point.x_mm, point.y_mm, &maps->sigma_z_um[index],
                       &maps->sigma_axial_D[index]);
    }
  }
}

static void fill(placido_maps *maps, const placido_surface *surface, const placido_fit *fit) {
  placido_jet jet;
  double axis_z_mm = height_at(surface, 0, 0, &jet);
#pragma omp parallel for schedule(dynamic, 1)
  for (int j = 0; j < maps->size; j++) {
    for (int i = 0; i < maps->size; i++) {
      placido_map_point point = {.x_mm = placido_maps_position(maps, i),
                                 .y_mm = placido_maps_position(maps, j),
                                 .axis_z_mm = axis_z_mm,
                                 .sphere = maps->sphere};
      fill_point(maps, surface, fit, point, (size_t)j * (size_t)maps->size + (size_t)i);
    }
  }
}

static int check_any_valid(const placido_maps *maps, placido_error *err) {
  for (size_t i = 0; i < (size_t)maps->size * (size_t)maps->size; i++) {
    if (maps->valid[i]) {
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the maps have no valid point: the surface is nowhere both defined and "
                           "supported by data");
}

int placido_maps_new(placido_maps *maps, const placido_surface *surface, const placido_fit *fit,
                     double step_mm, placido_error *err) {
  *maps = (placido_maps){.step_mm = step_mm, .radius_mm = placido_surface_radius_mm(surface)};
  if (!(step_mm >= 0.01 && step_mm <= 1)) {
    return placido_error_set(err, PLACIDO_INPUT, "the maps' step is %g mm, 0.01 to 1 is expected",
                             step_mm);
  }
  maps->half = (int)floor((maps->radius_mm + EDGE_MM) / step_mm + 1e-9);
  maps->size = 2 * maps->half + 1;
  int status = allocate(maps, fit != NULL, err);
  if (!status) {
    status = fit_sphere(maps, surface, err);
  }
  if (!status) {
    fill(maps, surface, fit);
    status = check_any_valid(maps, err);
  }
  if (status) {
    placido_maps_free(maps);
  }
  return status;
}

void placido_maps_free(placido_maps *maps) {
  if (!maps) {
    return;
  }
  size_t kinds;
  placido_map_kinds(&kinds);
  for (size_t i = 0; maps->values && i < kinds; i++) {
    placido_memory_free(maps->values[i]);
  }
  placido_memory_free(maps->values);
  placido_memory_free(maps->valid);
  placido_memory_free(maps->z_mm);
  placido_memory_free(maps->sigma_z_um);
  placido_memory_free(maps->sigma_axial_D);
  *maps = (placido_maps){0};
}

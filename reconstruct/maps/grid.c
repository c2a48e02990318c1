/* Maps: every kind of map, and its error bar, evaluated on one grid, row by row. */
#include "base/memory.h"
#include "reconstruct/indices/layout.h"
#include "reconstruct/maps/errors.h"
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/shape.h"
#include "reconstruct/maps/sphere.h"

#include <placido/map.h>

#include <math.h>

/* A point this far outside the radius still lies within, as for the surface. */
#define EDGE_MM 1e-12

#define INDEX 1.3375
#define RETINA_ZONE_MM 3.0 /* whose mean curvature tells where the focus is */

/* Steps such as 0.1 divide 1: then i/10 is the number nearest to the decimal, i * 0.1 is not. */
double placido_maps_position(const placido_maps *maps, int index) {
  double per_mm = round(1 / maps->step_mm);
  return 1 / per_mm == maps->step_mm ? (index - maps->half) / per_mm
                                     : (index - maps->half) * maps->step_mm;
}

/* One array a kind; NULL with the error set. */
static double **new_arrays(size_t points, placido_error *err) {
  size_t kinds;
  placido_map_kinds(&kinds);
  double **arrays = placido_memory_new(kinds, sizeof *arrays, err);
  for (size_t i = 0; arrays && i < kinds; i++) {
    arrays[i] = placido_memory_new(points, sizeof **arrays, err);
    if (!arrays[i]) {
      while (i-- > 0) {
        placido_memory_free(arrays[i]);
      }
      placido_memory_free(arrays);
      return NULL;
    }
  }
  return arrays;
}

static void free_arrays(double **arrays) {
  size_t kinds;
  placido_map_kinds(&kinds);
  for (size_t i = 0; arrays && i < kinds; i++) {
    placido_memory_free(arrays[i]);
  }
  placido_memory_free(arrays);
}

static int allocate(placido_maps *maps, bool with_sigma, placido_error *err) {
  size_t points = (size_t)maps->size * (size_t)maps->size;
  maps->valid = placido_memory_new(points, sizeof *maps->valid, err);
  maps->z_mm = placido_memory_new(points, sizeof *maps->z_mm, err);
  maps->values = maps->valid && maps->z_mm ? new_arrays(points, err) : NULL;
  if (maps->values && with_sigma) {
    maps->sigma_z_um = placido_memory_new(points, sizeof *maps->sigma_z_um, err);
    maps->sigmas = maps->sigma_z_um ? new_arrays(points, err) : NULL;
    maps->sigma_axial_D = maps->sigmas ? maps->sigmas[placido_maps_find("axial")] : NULL;
  }
  return maps->values && (maps->sigmas || !with_sigma) ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* z of the surface at (x, y), with its jet; NaN where there is none. */
static double height_at(const placido_surface *surface, double x, double y, placido_jet *jet) {
  return placido_surface_at(surface, x, y, jet) ? placido_surface_vertex_z_mm(surface) - jet->sag
                                                : NAN;
}

/* The point at (x, y); `common` holds what all have in common. */
static placido_map_point point_at(const placido_map_point *common, const placido_surface *surface,
                                  double x, double y) {
  placido_map_point point = *common;
  point.x_mm = x;
  point.y_mm = y;
  point.z_mm = height_at(surface, x, y, &point.jet);
  return point;
}

/* The paraxial focus n R / (n - 1) of the central zone's mean curvature; NaN where nothing of it is
 * covered. */
static double focus_mm(const placido_map_point *common, const placido_surface *surface,
                       const placido_zone *zone) {
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    if (hypot(p[0], p[1]) <= RETINA_ZONE_MM / 2) {
      placido_map_point point = point_at(common, surface, p[0], p[1]);
      sum += placido_map_mean(&point) / PLACIDO_KERATOMETRIC;
      count++;
    }
  }
  return common->index / (common->index - 1) / (sum / count);
}

/* What all points have in common. */
static placido_map_point find_common(const placido_surface *surface, const placido_zone *zone,
                                     const placido_maps_options *options) {
  placido_jet jet;
  placido_vertex vertex = placido_vertex_find(surface);
  placido_map_point common = {.axis_z_mm = height_at(surface, 0, 0, &jet),
                              .vertex_mm = {vertex.x_mm, vertex.y_mm},
                              .index = options->index > 0 ? options->index : INDEX};
  placido_shapes_fit(common.references, &common.sphere, zone);
  common.retina_mm = options->retina_mm > 0 ? options->retina_mm : focus_mm(&common, surface, zone);
  return common;
}

static void keep_common(placido_maps *maps, const placido_map_point *common) {
  maps->sphere = common->sphere;
  maps->index = common->index;
  maps->retina_mm = common->retina_mm;
  for (int k = 0; k < PLACIDO_REFERENCES; k++) {
    maps->references[k] = common->references[k];
  }
  for (int k = 0; k < 2; k++) {
    maps->vertex_mm[k] = common->vertex_mm[k];
  }
}

#define KINDS_MAX 32

static void fill_sigmas(placido_maps *maps, const placido_map_errors *errors,
                        const placido_map_point *point, size_t index) {
  double values[KINDS_MAX], sigmas[KINDS_MAX];
  size_t count;
  placido_map_kinds(&count);
  for (size_t i = 0; i < count; i++) {
    values[i] = maps->values[i][index];
  }
  if (maps->valid[index]) {
    placido_map_errors_at(errors, point, values, &maps->sigma_z_um[index], sigmas);
  } else {
    maps->sigma_z_um[index] = NAN;
  }
  for (size_t i = 0; i < count; i++) {
    maps->sigmas[i][index] = maps->valid[index] ? sigmas[i] : (double)NAN;
  }
}

static void fill_point(placido_maps *maps, const placido_surface *surface,
                       const placido_map_point *point, size_t index) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  bool valid = isfinite(point->z_mm) && placido_surface_covered(surface, point->x_mm, point->y_mm);
  maps->valid[index] = valid;
  maps->z_mm[index] = valid ? point->z_mm : NAN;
  for (size_t i = 0; i < count; i++) {
    maps->values[i][index] = valid ? kinds[i].at(point) : NAN;
  }
}

static void fill(placido_maps *maps, const placido_surface *surface,
                 const placido_map_errors *errors, const placido_map_point *common) {
#pragma omp parallel for schedule(dynamic, 1)
  for (int j = 0; j < maps->size; j++) {
    for (int i = 0; i < maps->size; i++) {
      placido_map_point point =
          point_at(common, surface, placido_maps_position(maps, i), placido_maps_position(maps, j));
      size_t index = (size_t)j * (size_t)maps->size + (size_t)i;
      fill_point(maps, surface, &point, index);
      if (errors) {
        fill_sigmas(maps, errors, &point, index);
      }
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

/* Zero asks for the default. */
static int check_option(double value, double least, double most, const char *name,
                        placido_error *err) {
  if (value == 0 || (value >= least && value <= most)) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT, "the maps' %s is %g, %g to %g is expected", name,
                           value, least, most);
}

static int check(const placido_maps_options *options, double step_mm, placido_error *err) {
  int status = check_option(options->zone_mm, 1, 20, "zone", err);
  if (!status) {
    status = check_option(options->index, 1.01, 2, "refractive index", err);
  }
  if (!status) {
    status = check_option(options->retina_mm, 5, 200, "distance of the retina", err);
  }
  return status || (step_mm >= 0.01 && step_mm <= 1)
             ? status
             : placido_error_set(err, PLACIDO_INPUT,
                                 "the maps' step is %g mm, 0.01 to 1 is expected", step_mm);
}

static int find_maps(placido_maps *maps, const placido_surface *surface, const placido_fit *fit,
                     const placido_maps_options *options, placido_error *err) {
  placido_zone zone;
  placido_map_errors errors = {0};
  int status = placido_zone_new(
      &zone, surface, options->zone_mm > 0 ? options->zone_mm : PLACIDO_SPHERE_ZONE_MM, err);
  if (status) {
    return status;
  }
  placido_map_point common = find_common(surface, &zone, options);
  keep_common(maps, &common);
  if (fit) {
    status = placido_map_errors_new(&errors, fit, surface, &zone, &common, err);
  }
  if (!status) {
    fill(maps, surface, fit ? &errors : NULL, &common);
  }
  placido_map_errors_free(&errors);
  placido_zone_free(&zone);
  return status ? status : check_any_valid(maps, err);
}

int placido_maps_find_all(placido_maps *maps, const placido_surface *surface,
                          const placido_fit *fit, const placido_maps_options *options,
                          double step_mm, placido_error *err) {
  static const placido_maps_options defaults = {0};
  options = options ? options : &defaults;
  *maps = (placido_maps){.step_mm = step_mm, .radius_mm = placido_surface_radius_mm(surface)};
  int status = check(options, step_mm, err);
  if (status) {
    return status;
  }
  maps->half = (int)floor((maps->radius_mm + EDGE_MM) / step_mm + 1e-9);
  maps->size = 2 * maps->half + 1;
  status = allocate(maps, fit != NULL, err);
  if (!status) {
    status = find_maps(maps, surface, fit, options, err);
  }
  if (status) {
    placido_maps_free(maps);
  }
  return status;
}

int placido_maps_new(placido_maps *maps, const placido_surface *surface, const placido_fit *fit,
                     double step_mm, placido_error *err) {
  return placido_maps_find_all(maps, surface, fit, NULL, step_mm, err);
}

void placido_maps_free(placido_maps *maps) {
  if (!maps) {
    return;
  }
  free_arrays(maps->values);
  free_arrays(maps->sigmas);
  placido_memory_free(maps->valid);
  placido_memory_free(maps->z_mm);
  placido_memory_free(maps->sigma_z_um);
  *maps = (placido_maps){0};
}

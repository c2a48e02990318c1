/* The figures of a Corneal Topography Map (PS3.3, C.8.30.3). */
#include "base/memory.h"
#include "exchange/dicom.h"
#include "reconstruct/maps/equations.h"

#include <placido/index.h>

#include <math.h>
#include <string.h>

#define INDEX 1.3375
#define KERATOMETRIC 337.5

#define AREA_STEP_MM 0.05

static double index_called(const placido_index_value *values, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return values[i].value;
    }
  }
  return NAN;
}

static double or_zero(double value) {
  return isfinite(value) ? value : 0;
}

/* Area of the supported surface itself, not of its projection. */
static double area_mm2(const placido_surface *surface) {
  int half = (int)(placido_surface_radius_mm(surface) / AREA_STEP_MM) + 1;
  double sum = 0;
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * AREA_STEP_MM, y = j * AREA_STEP_MM;
      placido_jet jet;
      if (placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet)) {
        sum += sqrt(1 + jet.sx * jet.sx + jet.sy * jet.sy);
      }
    }
  }
  return sum * AREA_STEP_MM * AREA_STEP_MM;
}

static int find_figures(placido_dicom_figures *f, const placido_surface *surface,
                        placido_error *err) {
  placido_index_value *values =
      placido_memory_new(PLACIDO_INDICES_MAX, sizeof *values, err);
  size_t count;
  int status = values ? placido_indices_find(values, &count, surface, NULL, err) : PLACIDO_MEMORY;
  if (!status) {
    f->flat_D = index_called(values, count, "simk_flat_D");
    f->steep_D = index_called(values, count, "simk_steep_D");
    /* without cylinder any axis is one */
    f->flat_deg = or_zero(index_called(values, count, "simk_flat_axis_deg"));
    f->steep_deg = fmod(f->flat_deg + 90, 180);
    f->least_D = index_called(values, count, "min_k_D");
    f->least_D = isfinite(f->least_D) ? f->least_D : f->flat_D;
    f->least_deg = f->flat_deg;
    f->inferior_superior_D = index_called(values, count, "inferior_superior_D");
    f->peak_D = index_called(values, count, "max_tangential_D");
    f->peak_mm[0] = index_called(values, count, "max_tangential_x_mm");
    f->peak_mm[1] = index_called(values, count, "max_tangential_y_mm");
    f->eccentricity = index_called(values, count, "eccentricity");
    f->kpi = index_called(values, count, "kpi");
    f->vertex_mm[0] = or_zero(index_called(values, count, "vertex_x_mm"));
    f->vertex_mm[1] = or_zero(index_called(values, count, "vertex_y_mm"));
    f->area_mm2 = area_mm2(surface);
  }
  placido_memory_free(values);
  return status;
}

static double distance_mm(const placido_dicom_map *map, int i, int j) {
  return hypot(placido_maps_position(&map->points, i) - map->figures.vertex_mm[0],
               placido_maps_position(&map->points, j) - map->figures.vertex_mm[1]);
}

/* Mean axial power over the pupil, every point of the square grid alike. */
static double average_D(const placido_dicom_map *map) {
  const double *axial = map->points.values[placido_maps_find("axial")];
  double sum = 0;
  int count = 0;
  for (int j = 0; j < map->points.size; j++) {
    for (int i = 0; i < map->points.size; i++) {
      double value = axial[(size_t)j * (size_t)map->points.size + (size_t)i];
      if (isfinite(value) && distance_mm(map, i, j) <= PLACIDO_DICOM_PUPIL_MM) {
        sum += value;
        count++;
      }
    }
  }
  return count > 0 ? sum / count : (double)NAN;
}

/* The front surface's wavefront: to first order, what its sag lacks to the ellipsoid without
 * aberration, Q = -1/n², times n - 1; piston, tilt and defocus (the Zernike terms 0, 1, 2 and 4),
 * which are no aberration of the shape, are fitted and taken off. */
static int find_wavefront(placido_dicom_map *map, placido_error *err) {
  const placido_maps *m = &map->points;
  size_t count = (size_t)m->size * (size_t)m->size;
  double *w = map->wavefront_um = placido_memory_new(count, sizeof *w, err);
  if (!w) {
    return PLACIDO_MEMORY;
  }
  double c = map->figures.average_D / KERATOMETRIC, q = -1 / (INDEX * INDEX);
  placido_equations equations = {.unknowns = 4};
  for (int pass = 0; pass < 2; pass++) {
    double low[4] = {0};
    if (pass > 0 && !placido_equations_solve(&equations, low)) {
      return placido_error_set(err, PLACIDO_QUALITY, "too few points for a wavefront");
    }
    for (size_t i = 0; i < count; i++) {
      double x = placido_maps_position(m, (int)(i % (size_t)m->size)) - map->figures.vertex_mm[0];
      double y = placido_maps_position(m, (int)(i / (size_t)m->size)) - map->figures.vertex_mm[1];
      double r2 = x * x + y * y, sag = map->figures.vertex_mm[2] - m->z_mm[i];
      double ideal = c * r2 / (1 + sqrt(1 - (1 + q) * c * c * r2));
      const double row[4] = {1, x, y, r2};
      w[i] = 1e3 * (INDEX - 1) * (ideal - sag);
      if (pass == 0 && isfinite(w[i])) {
        placido_equations_add(&equations, row, w[i]);
      }
      w[i] -= low[0] + low[1] * x + low[2] * y + low[3] * r2;
    }
  }
  return PLACIDO_OK;
}

/* What DICOM demands and the map may not give. */
static int check(const placido_dicom_figures *f, placido_error *err) {
  const struct {
    const char *name;
    double value;
  } demanded[] = {{"simulated keratometry", f->flat_D + f->steep_D},
                  {"the I-S value", f->inferior_superior_D},
                  {"the average power of the pupil", f->average_D}};
  for (size_t i = 0; i < sizeof demanded / sizeof demanded[0]; i++) {
    if (!isfinite(demanded[i].value)) {
      return placido_error_set(err, PLACIDO_QUALITY,
                               "data do not support %s, which DICOM's map must have",
                               demanded[i].name);
    }
  }
  return PLACIDO_OK;
}

int placido_dicom_measure(placido_dicom_map *map, const placido_surface *surface, double step_mm,
                          placido_error *err) {
  placido_dicom_figures *f = &map->figures;
  placido_jet jet;
  int status = placido_maps_new(&map->points, surface, NULL, step_mm, err);
  if (!status) {
    status = find_figures(f, surface, err);
  }
  if (status) {
    return status;
  }
  if (!placido_surface_at(surface, f->vertex_mm[0], f->vertex_mm[1], &jet)) {
    return placido_error_set(err, PLACIDO_QUALITY, "the surface has no vertex");
  }
  f->vertex_mm[2] = placido_surface_vertex_z_mm(surface) - jet.sag;
  f->average_D = average_D(map);
  status = check(f, err);
  return status ? status : find_wavefront(map, err);
}

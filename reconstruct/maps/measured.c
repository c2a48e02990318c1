/* A measured cornea, read back from an exam's directory. */
#include "base/file.h"
#include "base/memory.h"
#include "reconstruct/maps/csv.h"

#include <placido/difference.h>

#include <math.h>
#include <unistd.h>

#define STEP_MM 0.1 /* the grid of maps.csv, docs/formats.md */

/* Moves an array onto the wider or narrower grid of the measurement. */
static int take(placido_measured *measured, int kind, const double *values, int half,
                placido_error *err) {
  size_t size = (size_t)measured->size;
  double *taken = measured->sigmas[kind] = placido_memory_new(size * size, sizeof *taken, err);
  if (!taken) {
    return PLACIDO_MEMORY;
  }
  for (int j = -measured->half; j <= measured->half; j++) {
    for (int i = -measured->half; i <= measured->half; i++) {
      size_t to = (size_t)(j + measured->half) * size + (size_t)(i + measured->half);
      bool inside = i >= -half && i <= half && j >= -half && j <= half;
      taken[to] = inside && values ? values[(j + half) * (2 * half + 1) + i + half] : (double)NAN;
    }
  }
  return PLACIDO_OK;
}

static int read_heights(placido_measured *measured, const char *directory, placido_error *err) {
  static const char *const names[] = {"sigma_z_um"};
  char path[PLACIDO_PATH_MAX];
  double *values = NULL;
  int status = placido_path_join(path, directory, "maps.csv", err);
  if (!status) {
    status = placido_map_columns_load(&values, &measured->half, names, 1, STEP_MM, path, err);
  }
  if (!status) {
    measured->step_mm = STEP_MM;
    measured->size = 2 * measured->half + 1;
    status = take(measured, PLACIDO_DIFFERENCE_ELEVATION, values, measured->half, err);
  }
  placido_memory_free(values);
  return status;
}

static int read_curvatures(placido_measured *measured, const char *directory, placido_notes *notes,
                           placido_error *err) {
  static const char *const names[] = {"sigma_axial_vertex_D", "sigma_tangential_vertex_D"};
  char path[PLACIDO_PATH_MAX];
  double *values[2] = {NULL, NULL};
  int half = 0;
  int status = placido_path_join(path, directory, "maps_sigma.csv", err);
  if (!status && access(path, F_OK) != 0) {
    placido_notes_add(notes, "%s is missing: the error bars of its curvatures are not known", path);
  } else if (!status) {
    status = placido_map_columns_load(values, &half, names, 2, STEP_MM, path, err);
  }
  for (int k = 0; k < 2; k++) {
    if (!status) {
      status = take(measured, PLACIDO_DIFFERENCE_AXIAL + k, values[k], half, err);
    }
  }
  placido_memory_free(values[0]);
  placido_memory_free(values[1]);
  return status;
}

static void note_missing(const placido_measured *measured, const char *directory,
                         placido_notes *notes) {
  for (size_t k = 0; k < (size_t)measured->size * (size_t)measured->size; k++) {
    if (isfinite(measured->sigmas[PLACIDO_DIFFERENCE_ELEVATION][k])) {
      return;
    }
  }
  placido_notes_add(notes, "%s has no error bars: what is significant cannot be told", directory);
}

int placido_measured_load(placido_measured *measured, const char *directory, placido_notes *notes,
                          placido_error *err) {
  *measured = (placido_measured){0};
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, directory, "surface.json", err);
  if (!status) {
    status = placido_surface_load(&measured->surface, path, notes, err);
  }
  if (!status) {
    status = read_heights(measured, directory, err);
  }
  if (!status) {
    status = read_curvatures(measured, directory, notes, err);
  }
  if (!status) {
    note_missing(measured, directory, notes);
  } else {
    placido_measured_free(measured);
  }
  return status;
}

void placido_measured_free(placido_measured *measured) {
  if (!measured) {
    return;
  }
  placido_surface_free(measured->surface);
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    placido_memory_free(measured->sigmas[k]);
  }
  *measured = (placido_measured){0};
}

/* Which map figure is drawn: a kind of map, or the error bars of one, with its scale and title. */
#include "report/report.h"

#include "report/map_picture.h"
#include "report/number.h"
#include "report/range.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* What is about the axis ends where the tilt there makes over a step of it, at the latest where
 * ISO 19980's central zone of 1 mm begins. */
#define HOLE_MAX_MM 0.5

static const double degrees = 57.29577951308232;

/* Inclination of the surface on the axis, from the heights beside it; 0 where these are missing. */
static double tilt_at_axis(const placido_maps *maps) {
  size_t size = (size_t)maps->size, centre = (size_t)maps->half * size + (size_t)maps->half;
  if (maps->z_mm == NULL || maps->half < 1) {
    return 0;
  }
  const double *z = maps->z_mm + centre;
  double tilt = hypot(z[1] - z[-1], z[size] - *(z - size)) / (2 * maps->step_mm);
  return isfinite(tilt) ? tilt : 0;
}

static double hole_of(const placido_maps *maps, const placido_map_kind *kind) {
  double hole_mm = kind->about_axis ? 337.5 * tilt_at_axis(maps) / kind->step : 0;
  return hole_mm < maps->step_mm ? 0 : fmin(hole_mm, HOLE_MAX_MM);
}

/* "Q −0.61". */
static void write_q(char text[PLACIDO_NUMBER_SIZE], double p) {
  placido_number_write(text, PLACIDO_NUMBER_SIZE, p - 1, 3);
}

/* What a kind is measured from, or what it takes for granted. */
static void describe_reference(char *note, size_t size, const placido_maps *maps,
                               const placido_map_kind *kind, double hole_mm) {
  char x[PLACIDO_NUMBER_SIZE];
  note[0] = '\0';
  const placido_sphere *sphere = &maps->sphere;
  const placido_conicoid_shape *conic = &maps->references[PLACIDO_REFERENCE_CONIC];
  const placido_conicoid_shape *toric = &maps->references[PLACIDO_REFERENCE_TORIC];
  double cross = hypot(toric->d_mm1, toric->e_mm1);
  if (kind->needs == PLACIDO_MAP_NEEDS_SPHERE && isfinite(sphere->radius_mm)) {
    snprintf(note, size, "sphere of %.3f mm fitted over %g mm", sphere->radius_mm, sphere->zone_mm);
  } else if (kind->needs == PLACIDO_MAP_NEEDS_CONIC && isfinite(conic->c_mm1)) {
    write_q(x, conic->p);
    snprintf(note, size, "conicoid of %.3f mm, Q %s, fitted over %g mm", 1 / conic->c_mm1, x,
             conic->zone_mm);
  } else if (kind->needs == PLACIDO_MAP_NEEDS_TORIC && isfinite(toric->c_mm1)) {
    double axis = 0.5 * degrees * atan2(-toric->e_mm1, -toric->d_mm1);
    write_q(x, toric->p);
    snprintf(note, size, "toric conicoid of %.3f mm × %.0f° and %.3f mm, Q %s, over %g mm",
             1 / (toric->c_mm1 - cross), axis < 0 ? axis + 180 : axis, 1 / (toric->c_mm1 + cross),
             x, toric->zone_mm);
  } else if (kind->needs == PLACIDO_MAP_NEEDS_VERTEX && isfinite(maps->vertex_mm[0])) {
    char y[PLACIDO_NUMBER_SIZE];
    placido_number_write(x, sizeof x, maps->vertex_mm[0], 2);
    placido_number_write(y, sizeof y, maps->vertex_mm[1], 2);
    snprintf(note, size, "about the vertex at x %s mm, y %s mm", x, y);
  } else if (strcmp(kind->unit, "mm") == 0) {
    snprintf(note, size, "fovea on the axis, %.2f mm behind the cornea, index %g", maps->retina_mm,
             maps->index);
  } else if (hole_mm > 0) {
    snprintf(note, size,
             "grey: not defined on the axis, where the cornea is tilted by %.1f°; beside it, in "
             "part the tilt",
             degrees * atan(tilt_at_axis(maps)));
  }
}

int placido_figure_map_scaled(const placido_maps *maps, int kind, enum placido_scale_mode mode,
                              const char *path, placido_error *err) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  if (kind < 0 || (size_t)kind >= count) {
    return placido_error_set(err, PLACIDO_INPUT, "map %d: expected 0 to %zu", kind, count - 1);
  }
  char note[256], second[256];
  placido_range r;
  placido_map_picture picture = {.maps = maps,
                                 .values = maps->values[kind],
                                 .title = kinds[kind].title,
                                 .unit = placido_unit_text(kinds[kind].unit),
                                 .note = note,
                                 .hole_mm = hole_of(maps, &kinds[kind])};
  int status = placido_range_find(&r, maps, picture.values, picture.hole_mm, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  picture.scale = placido_scale_for(&kinds[kind], mode, r.low, r.high);
  placido_range_describe(note, sizeof note, &r, picture.scale.step, picture.unit);
  describe_reference(second, sizeof second, maps, &kinds[kind], picture.hole_mm);
  picture.second_note = second[0] != '\0' ? second : NULL;
  return placido_map_picture_write(&picture, path, err);
}

int placido_figure_map(const placido_maps *maps, int kind, const char *path, placido_error *err) {
  return placido_figure_map_scaled(maps, kind, PLACIDO_SCALE_FIXED, path, err);
}

/* The array of error bars that a figure's name asks for, with its kind (NULL: z). */
static int find_sigmas(const double **sigmas, const placido_map_kind **kind,
                       const placido_maps *maps, const char *which, placido_error *err) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  bool is_z = strcmp(which, "sigma_z") == 0;
  int index = strncmp(which, "sigma_", 6) == 0 ? placido_maps_find(which + 6) : -1;
  if (!is_z && index < 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "error-bar map \"%s\": expected sigma_z or sigma_ and a kind of map",
                             which);
  }
  *kind = is_z ? NULL : &kinds[index];
  *sigmas = is_z ? maps->sigma_z_um : maps->sigmas ? maps->sigmas[index] : NULL;
  if (*sigmas == NULL) {
    return placido_error_set(
        err, PLACIDO_INPUT, "error-bar map %s: this surface was not fitted, so it has none", which);
  }
  return PLACIDO_OK;
}

int placido_figure_sigma(const placido_maps *maps, const char *which, const char *path,
                         placido_error *err) {
  const double *sigmas;
  const placido_map_kind *kind = NULL;
  int status = find_sigmas(&sigmas, &kind, maps, which, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  char title[160], note[256], second[256];
  placido_range r;
  placido_map_picture picture = {.maps = maps,
                                 .values = sigmas,
                                 .title = title,
                                 .note = note,
                                 .unit = kind ? placido_unit_text(kind->unit) : "µm",
                                 .hole_mm = kind ? hole_of(maps, kind) : 0};
  status = placido_range_find(&r, maps, sigmas, picture.hole_mm, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int start = snprintf(title, sizeof title, "Uncertainty (1 σ): ");
  snprintf(title + start, sizeof title - (size_t)start, "%s", kind ? kind->title : "height");
  title[start] = (char)tolower((unsigned char)title[start]);
  picture.scale = placido_scale_from_zero(r.high);
  placido_range_describe(note, sizeof note, &r, picture.scale.step, picture.unit);
  if (kind) {
    describe_reference(second, sizeof second, maps, kind, picture.hole_mm);
    picture.second_note = second[0] != '\0' ? second : NULL;
  }
  return placido_map_picture_write(&picture, path, err);
}

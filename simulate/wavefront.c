/* Optical paths over the pupil against the best reference sphere, and their Zernike terms.
 *
 * A plane wave comes along the axis. A ray that enters at P, at a depth d behind the surface's point
 * on the axis, reaches the centre F of the reference sphere after the path d + n |F - P|; were all
 * paths alike the light would meet at F. By Fermat's principle no refracted direction appears: the
 * slope of the path over the surface is n times the angle between the refracted ray (Snell) and
 * F - P (Born and Wolf, Principles of Optics, 3.3 and 5.1). F is found by Gauss-Newton in
 * (x, y, 1 / depth), in which the paths are nearly linear. */
#include <placido/wavefront.h>

#include "base/dense.h"
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/trace.h"
#include "simulate/wavefront.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { RINGS_MIN = 8, STEPS_MAX = 50 };

static const double depth_min_mm = 5, depth_max_mm = 500;
static const double usual_curvature = 1 / 7.8;
static const double missing_worth_a_note = 0.001;

/* Products of two terms of this order come out exact. */
static int rings_least(int order) {
  int needed = (2 * order + 3) / 3;
  return needed > RINGS_MIN ? needed : RINGS_MIN;
}

static int settle(placido_wavefront *w, int *rings, placido_wavefront_options *settled,
                  const placido_eye *eye, const placido_wavefront_options *options,
                  placido_error *err) {
  *settled = options ? *options : (placido_wavefront_options){0};
  int status = placido_eye_settle(&w->eye, eye, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  settled->order = settled->order ? settled->order : 8;
  settled->rays = settled->rays ? settled->rays : 768;
  settled->missing_max = settled->missing_max != 0 ? settled->missing_max : 0.15;
  if (settled->order < 2 || settled->order > PLACIDO_WAVEFRONT_ORDER_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "terms of order %d, expected 2 to %d",
                             settled->order, PLACIDO_WAVEFRONT_ORDER_MAX);
  }
  int least = 3 * rings_least(settled->order) * rings_least(settled->order);
  if (settled->rays < least || settled->rays > 1000000) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d rays for terms of order %d, expected %d to 1000000",
                             settled->rays, settled->order, least);
  }
  if (!(settled->missing_max >= 0 && settled->missing_max < 1)) {
    return placido_error_set(err, PLACIDO_INPUT, "a missing share of %g, expected 0 to below 1",
                             settled->missing_max);
  }
  *rings = (int)ceil(sqrt(settled->rays / 3.0));
  w->order = settled->order;
  w->term_count = placido_zernike_count(settled->order);
  w->count = 3 * (size_t)*rings * (size_t)*rings;
  return PLACIDO_OK;
}

/* Depth of every entry behind the surface's point on the axis; PLACIDO_QUALITY where the surface is
 * not defined on the axis or at a ray. */
static int find_depths(double *depth_mm, const placido_wavefront *w,
                       const placido_surface *surface, placido_error *err) {
  placido_apex apex;
  placido_entry entry = {0};
  int status = placido_apex_find(&apex, surface, &w->eye, err);
  for (size_t i = 0; i < w->count && status == PLACIDO_OK; i++) {
    if (!placido_entry_at(&entry, surface, &apex, w->x_mm[i], w->y_mm[i])) {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "the surface, known to a radius of %.2f mm, does not fill the "
                                 "pupil of %g mm about (%g, %g) mm",
                                 placido_surface_radius_mm(surface), w->eye.pupil_mm,
                                 w->eye.pupil_x_mm, w->eye.pupil_y_mm);
    }
    depth_mm[i] = entry.depth_mm;
  }
  return status;
}

/* What the lens takes from a ray's path, mm. */
static double lens_path(const placido_wavefront *w, double x_mm, double y_mm) {
  const placido_correction *lens = &w->eye.correction;
  double rx = x_mm - w->eye.pupil_x_mm, ry = y_mm - w->eye.pupil_y_mm;
  return (lens->m_D * (rx * rx + ry * ry) + lens->j0_D * (rx * rx - ry * ry) +
          2 * lens->j45_D * rx * ry) /
         2000;
}

/* Path of a ray to the reference sphere's centre, mm. */
static double path_of(const placido_wavefront *w, double x_mm, double y_mm, double depth_mm) {
  double dx = x_mm - w->focus_mm[0], dy = y_mm - w->focus_mm[1];
  double dz = depth_mm - w->focus_mm[2];
  return depth_mm + w->eye.index * sqrt(dx * dx + dy * dy + dz * dz) - lens_path(w, x_mm, y_mm);
}

/* Path of the chief ray, which the lens takes nothing from, less that of a ray, mm. Both are some
 * 30 mm: the difference of their distances a and b to the centre is (a² - b²) / (a + b), with the
 * squares' difference taken place by place, which keeps the digits of paths nearly alike. */
static double path_difference(const placido_wavefront *w, const placido_entry *chief, double x_mm,
                              double y_mm, double depth_mm) {
  const double a[3] = {chief->x_mm, chief->y_mm, chief->depth_mm}, b[3] = {x_mm, y_mm, depth_mm};
  double squares = 0, from_chief = 0, from_ray = 0;
  for (int i = 0; i < 3; i++) {
    double to_a = a[i] - w->focus_mm[i], to_b = b[i] - w->focus_mm[i];
    squares += (a[i] - b[i]) * (to_a + to_b);
    from_chief += to_a * to_a;
    from_ray += to_b * to_b;
  }
  return chief->depth_mm - depth_mm +
         w->eye.index * squares / (sqrt(from_chief) + sqrt(from_ray)) + lens_path(w, x_mm, y_mm);
}

static int find_chief(placido_entry *chief, const placido_wavefront *w,
                      const placido_surface *surface, placido_error *err) {
  placido_apex apex;
  int status = placido_apex_find(&apex, surface, &w->eye, err);
  if (status == PLACIDO_OK) { /* the apex was found: the surface is defined here */
    placido_entry_at(chief, surface, &apex, w->eye.pupil_x_mm, w->eye.pupil_y_mm);
  }
  return status;
}

/* One step towards the centre of least spread, in (x, y, 1 / depth) as far as `unknowns` goes, and
 * by how much it lessens the paths' mean square. */
static bool step_focus(placido_wavefront *w, const double *depth_mm, int unknowns,
                       double step[3], double *gain_mm2) {
  double mean[4] = {0}, square[3][3] = {{0}}, right[3];
  *gain_mm2 = NAN;
  memset(step, 0, 3 * sizeof *step);
  for (int pass = 0; pass < 2; pass++) { /* the means first: the paths' own piston is free */
    for (size_t i = 0; i < w->count; i++) {
      double d[3] = {w->focus_mm[0] - w->x_mm[i], w->focus_mm[1] - w->y_mm[i],
                     w->focus_mm[2] - depth_mm[i]};
      double slope = w->eye.index / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
      double row[4] = {slope * d[0], slope * d[1],
                       -slope * d[2] * w->focus_mm[2] * w->focus_mm[2],
                       path_of(w, w->x_mm[i], w->y_mm[i], depth_mm[i])};
      for (int j = 0; j < 4 && pass == 0; j++) {
        mean[j] += w->weight[i] * row[j];
      }
      for (int j = 0; j < 3 && pass == 1; j++) {
        step[j] -= w->weight[i] * (row[j] - mean[j]) * (row[3] - mean[3]);
        for (int k = 0; k <= j; k++) {
          square[j][k] += w->weight[i] * (row[j] - mean[j]) * (row[k] - mean[k]);
        }
      }
    }
  }
  if (!placido_dense_factor(&square[0][0], unknowns, 3, 1e-12)) {
    return false;
  }
  memcpy(right, step, sizeof right);
  placido_dense_solve(&square[0][0], unknowns, 3, step);
  *gain_mm2 = 0;
  for (int j = 0; j < unknowns; j++) {
    *gain_mm2 += right[j] * step[j];
  }
  return true;
}

static int find_focus(placido_wavefront *w, const placido_surface *surface,
                      const double *depth_mm, placido_error *err) {
  placido_apex apex;
  int status = placido_apex_find(&apex, surface, &w->eye, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  bool depth_open = w->eye.retina_mm == 0;
  double curvature = apex.radius_mm > 4 && apex.radius_mm < 20 ? 1 / apex.radius_mm
                                                              : usual_curvature;
  w->focus_mm[0] = w->focus_mm[1] = 0;
  w->focus_mm[2] = depth_open ? w->eye.index / ((w->eye.index - 1) * curvature)
                              : w->eye.retina_mm;
  bool found = false;
  for (int k = 0; k < STEPS_MAX && !found; k++) {
    double step[3], gain_mm2;
    if (!step_focus(w, depth_mm, depth_open ? 3 : 2, step, &gain_mm2)) {
      break;
    }
    w->focus_mm[0] += step[0];
    w->focus_mm[1] += step[1];
    double vergence = 1 / w->focus_mm[2] + (depth_open ? step[2] : 0);
    if (!(vergence > 1 / depth_max_mm && vergence < 1 / depth_min_mm)) {
      break;
    }
    double change = fabs(1 / vergence - w->focus_mm[2]);
    w->focus_mm[2] = depth_open ? 1 / vergence : w->eye.retina_mm;
    double rounding_mm = 4 * DBL_EPSILON * w->eye.index * w->focus_mm[2];
    found = (hypot(step[0], step[1]) < 1e-9 && change < 1e-9) ||
            gain_mm2 <= rounding_mm * rounding_mm; /* a tiny pupil's depth of focus hides the rest */
  }
  w->eye.retina_mm = w->focus_mm[2];
  return found ? PLACIDO_OK
               : placido_error_set(err, PLACIDO_QUALITY,
                                   "the light of this cornea has no focus %g to %g mm behind it",
                                   depth_min_mm, depth_max_mm);
}

static int find_differences(double *opd_um, const placido_wavefront *w,
                            const placido_surface *surface, const double *depth_mm,
                            placido_error *err) {
  placido_entry chief;
  int status = find_chief(&chief, w, surface, err);
  for (size_t i = 0; i < w->count && status == PLACIDO_OK; i++) {
    opd_um[i] = 1e3 * path_difference(w, &chief, w->x_mm[i], w->y_mm[i], depth_mm[i]);
  }
  return status;
}

static void project(double coefficients_um[PLACIDO_WAVEFRONT_TERMS], const placido_wavefront *w,
                    const double *opd_um) {
  memset(coefficients_um, 0, PLACIDO_WAVEFRONT_TERMS * sizeof *coefficients_um);
  for (int j = 0; j < w->term_count; j++) {
    const double *term = w->terms + (size_t)j * w->count;
    for (size_t i = 0; i < w->count; i++) {
      coefficients_um[j] += w->weight[i] * term[i] * opd_um[i];
    }
  }
}

/* The terms being orthonormal, mean squares add up. */
static void summarise(placido_wavefront *w) {
  double square = 0, left = 0;
  for (size_t i = 0; i < w->count; i++) {
    double rest = w->opd_um[i], about_mean = w->opd_um[i] - w->coefficients_um[0];
    for (int j = 0; j < w->term_count; j++) {
      rest -= w->coefficients_um[j] * w->terms[(size_t)j * w->count + i];
    }
    square += w->weight[i] * about_mean * about_mean;
    left += w->weight[i] * rest * rest;
  }
  w->rms_um = sqrt(square);
  w->rest_um = sqrt(left);
}

static int check_missing(placido_wavefront *w, const placido_surface *surface,
                         double missing_max, placido_notes *notes, placido_error *err) {
  w->missing = 0;
  for (size_t i = 0; i < w->count; i++) {
    w->missing += placido_surface_covered(surface, w->x_mm[i], w->y_mm[i]) ? 0 : w->weight[i];
  }
  if (w->missing > missing_max) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no data support %.0f %% of the pupil of %g mm, at most %.0f %% may "
                             "be missing",
                             100 * w->missing, w->eye.pupil_mm, 100 * missing_max);
  }
  if (w->missing > missing_worth_a_note) {
    placido_notes_add(notes, "wavefront of the pupil of %g mm: %.1f %% of it has no data, and the "
                      "surface's smooth continuation stands in", w->eye.pupil_mm,
                      100 * w->missing);
  }
  return PLACIDO_OK;
}

static int allocate(placido_wavefront *w, double **depth_mm, placido_error *err) {
  w->x_mm = placido_memory_new(w->count, sizeof(double), err);
  w->y_mm = placido_memory_new(w->count, sizeof(double), err);
  w->weight = placido_memory_new(w->count, sizeof(double), err);
  w->opd_um = placido_memory_new(w->count, sizeof(double), err);
  w->terms = placido_memory_new(w->count * (size_t)w->term_count, sizeof(double), err);
  *depth_mm = placido_memory_new(w->count, sizeof(double), err);
  bool whole = w->x_mm && w->y_mm && w->weight && w->opd_um && w->terms && *depth_mm;
  return whole ? PLACIDO_OK : PLACIDO_MEMORY;
}

static void place_rays(placido_wavefront *w, int rings) {
  placido_disc_quadrature(w->x_mm, w->y_mm, w->weight, rings);
  placido_zernike_terms(w->terms, w->order, w->x_mm, w->y_mm, w->count);
  for (size_t i = 0; i < w->count; i++) {
    w->x_mm[i] = w->eye.pupil_x_mm + w->eye.pupil_mm / 2 * w->x_mm[i];
    w->y_mm[i] = w->eye.pupil_y_mm + w->eye.pupil_mm / 2 * w->y_mm[i];
  }
}

int placido_wavefront_new(placido_wavefront *wavefront, const placido_surface *surface,
                          const placido_eye *eye, const placido_wavefront_options *options,
                          placido_notes *notes, placido_error *err) {
  *wavefront = (placido_wavefront){0};
  placido_wavefront_options settled;
  double *depth_mm = NULL;
  int rings = 0, status = settle(wavefront, &rings, &settled, eye, options, err);
  if (status == PLACIDO_OK) {
    status = allocate(wavefront, &depth_mm, err);
  }
  if (status == PLACIDO_OK) {
    place_rays(wavefront, rings);
    status = find_depths(depth_mm, wavefront, surface, err);
  }
  if (status == PLACIDO_OK) {
    status = check_missing(wavefront, surface, settled.missing_max, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = find_focus(wavefront, surface, depth_mm, err);
  }
  if (status == PLACIDO_OK) {
    status = find_differences(wavefront->opd_um, wavefront, surface, depth_mm, err);
  }
  placido_memory_free(depth_mm);
  if (status != PLACIDO_OK) {
    placido_wavefront_free(wavefront);
    return status;
  }
  project(wavefront->coefficients_um, wavefront, wavefront->opd_um);
  summarise(wavefront);
  return PLACIDO_OK;
}

void placido_wavefront_free(placido_wavefront *wavefront) {
  if (wavefront != NULL) {
    placido_memory_free(wavefront->x_mm);
    placido_memory_free(wavefront->y_mm);
    placido_memory_free(wavefront->weight);
    placido_memory_free(wavefront->opd_um);
    placido_memory_free(wavefront->terms);
    *wavefront = (placido_wavefront){0};
  }
}

int placido_wavefront_again(double coefficients_um[PLACIDO_WAVEFRONT_TERMS],
                            const placido_wavefront *wavefront, const placido_surface *surface,
                            placido_error *err) {
  double *depth_mm = placido_memory_new(wavefront->count, sizeof *depth_mm, err);
  double *opd_um = placido_memory_new(wavefront->count, sizeof *opd_um, err);
  int status = depth_mm && opd_um ? PLACIDO_OK : PLACIDO_MEMORY;
  memset(coefficients_um, 0, PLACIDO_WAVEFRONT_TERMS * sizeof *coefficients_um);
  if (status == PLACIDO_OK) {
    status = find_depths(depth_mm, wavefront, surface, err);
  }
  if (status == PLACIDO_OK) {
    status = find_differences(opd_um, wavefront, surface, depth_mm, err);
  }
  if (status == PLACIDO_OK) {
    project(coefficients_um, wavefront, opd_um);
  }
  placido_memory_free(depth_mm);
  placido_memory_free(opd_um);
  return status;
}

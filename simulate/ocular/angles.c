/* Where rays are seen: few for a sketch, many for the point of fixation. */
#include "simulate/ocular/ocular.h"

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/light.h"
#include "simulate/ocular/landing.h"
#include "simulate/ocular/sight.h"
#include "simulate/trace.h"

#include <math.h>

enum { CHUNK = 128, CLIMB_MAX = 50 };

static const double still_arcmin = 1e-4;

static const double axis_deg[2] = {0, 0}, no_offset[2] = {0, 0};

/* Angles of what has landed. */
static void take_angles(float *angle_x, float *angle_y, const placido_sight *sight,
                        const placido_beam *beam, int count) {
  for (int i = 0; i < count; i++) {
    double angle[2];
    placido_sight_angle(sight, beam, (size_t)i, angle);
    angle_x[i] = (float)(angle[0] / PLACIDO_ARCMIN_RAD);
    angle_y[i] = (float)(angle[1] / PLACIDO_ARCMIN_RAD);
  }
}

void placido_ocular_angles(float *angle_x, float *angle_y, const float *x_mm, const float *y_mm,
                           int count, const placido_surface *surface, const placido_eye *eye,
                           const placido_ocular *ocular, const double field_deg[2],
                           const double offset_arcmin[2]) {
  double block[PLACIDO_BEAM_COLUMNS * CHUNK];
  placido_eye settled;
  placido_sight sight;
  bool arrives = placido_eye_settle(&settled, eye, NULL) == PLACIDO_OK &&
                 placido_sight_new(&sight, surface, &settled, ocular, field_deg, offset_arcmin, 0,
                                   NULL) == PLACIDO_OK;
  for (int first = 0; first < count; first += CHUNK) {
    int some = count - first < CHUNK ? count - first : CHUNK;
    placido_beam beam = placido_beam_of(block, (size_t)some);
    for (int i = 0; i < some && arrives; i++) {
      placido_sight_aim(&sight, &beam, (size_t)i, sight.pupil_x_mm + (double)x_mm[first + i],
                        sight.pupil_y_mm + (double)y_mm[first + i]);
    }
    if (arrives) {
      placido_sight_land(&sight, &beam);
      take_angles(angle_x + first, angle_y + first, &sight, &beam, some);
    }
  }
  for (int i = 0; i < count && !arrives; i++) {
    angle_x[i] = angle_y[i] = NAN;
  }
}

void placido_landing_angles(float *angle_x, float *angle_y, const placido_sight *sight,
                            const placido_entry *entries, size_t count) {
  double block[PLACIDO_BEAM_COLUMNS * CHUNK];
  for (size_t first = 0; first < count; first += CHUNK) {
    size_t some = count - first < CHUNK ? count - first : CHUNK;
    placido_beam beam = placido_beam_of(block, some);
    for (size_t i = 0; i < some; i++) {
      const placido_entry *entry = &entries[first + i];
      beam.x_mm[i] = entry->x_mm;
      beam.y_mm[i] = entry->y_mm;
      beam.depth_mm[i] = entry->depth_mm;
      beam.sx[i] = entry->sx;
      beam.sy[i] = entry->sy;
    }
    placido_sight_land(sight, &beam);
    take_angles(angle_x + first, angle_y + first, sight, &beam, (int)some);
  }
}

void placido_landing_middle(double middle[2], const float *x, const float *y, const float *u,
                            const float *v, size_t count, const double at[2]) {
  const double per2 = 1 / (PLACIDO_FOCUS_WIDTH_ARCMIN * PLACIDO_FOCUS_WIDTH_ARCMIN);
  double sum = 0, sum_x = 0, sum_y = 0;
  for (size_t i = 0; i < count; i++) {
    double dx = (double)u[i] - at[0], dy = (double)v[i] - at[1];
    double near = 1 / (1 + (dx * dx + dy * dy) * per2), weight = near * near * sqrt(near);
    if (isfinite(x[i]) && isfinite(y[i]) && isfinite(weight)) {
      sum += weight;
      sum_x += weight * (double)x[i];
      sum_y += weight * (double)y[i];
    }
  }
  middle[0] = sum > 0 ? sum_x / sum : 0;
  middle[1] = sum > 0 ? sum_y / sum : 0;
}

void placido_landing_climb(double peak_arcmin[2], const float *x, const float *y, size_t count) {
  double moved = INFINITY;
  for (int step = 0; step < CLIMB_MAX && moved > still_arcmin; step++) {
    const double before[2] = {peak_arcmin[0], peak_arcmin[1]};
    placido_landing_middle(peak_arcmin, x, y, x, y, count, before);
    moved = hypot(peak_arcmin[0] - before[0], peak_arcmin[1] - before[1]);
  }
}

size_t placido_landing_close_up(float *x, float *y, size_t count) {
  size_t left = 0;
  for (size_t i = 0; i < count; i++) {
    x[left] = x[i];
    y[left] = y[i];
    left += isfinite(x[i]) && isfinite(y[i]);
  }
  return left;
}

static int find_peak(double peak_arcmin[2], const placido_sight *sight, const placido_rays *rays,
                     const placido_ocular *ocular, placido_error *err) {
  float *x = placido_memory_new(rays->count, 2 * sizeof *x, err);
  if (x == NULL) {
    return PLACIDO_MEMORY;
  }
  float *y = x + rays->count;
  placido_landing_angles(x, y, sight, rays->entries, rays->count);
  if (ocular->gazes) {
    peak_arcmin[0] = ocular->gaze_arcmin[0];
    peak_arcmin[1] = ocular->gaze_arcmin[1];
    placido_landing_climb(peak_arcmin, x, y, rays->count);
  } else {
    size_t landed = placido_landing_close_up(x, y, rays->count);
    placido_light_peak(x, y, landed, PLACIDO_FOCUS_WIDTH_ARCMIN, peak_arcmin);
  }
  placido_memory_free(x);
  return PLACIDO_OK;
}

int placido_ocular_fixation(double offset_arcmin[2], const placido_surface *surface,
                            const placido_eye *eye, const placido_ocular *ocular,
                            placido_error *err) {
  placido_eye settled;
  placido_sight sight;
  placido_apex apex;
  placido_rays rays = {0};
  placido_ocular flat = *ocular;
  flat.curved = false;
  offset_arcmin[0] = offset_arcmin[1] = 0;
  int status = placido_eye_settle(&settled, eye, err);
  if (status != PLACIDO_OK ||
      (status = placido_apex_find(&apex, surface, &settled, err)) != PLACIDO_OK ||
      (status = placido_sight_new(&sight, surface, &settled, &flat, axis_deg, no_offset, 0,
                                  err)) != PLACIDO_OK) {
    return status;
  }
  status = placido_rays_new(&rays, surface, &apex, &settled, PLACIDO_FOCUS_SETTLE_SAMPLES, err);
  if (status == PLACIDO_OK) {
    status = find_peak(offset_arcmin, &sight, &rays, ocular, err);
  }
  placido_rays_free(&rays);
  return status;
}

/* Linear optics about the lens worn, in columns that the compiler's vector units take.
 *
 * For light from one direction a retina L behind the apex is met at p + (L - depth) q, p the entry
 * and q the slope behind the cornea: divided by L that is linear in the vergence 1/L without any
 * approximation. In the cross-cylinder q is linear to second order in its prism, J r: 0.1' for 3 D
 * at the rim of 8 mm, and nothing where the lens is the one that was traced. */
#include "simulate/pencil.h"

#include "base/memory.h"

#include <math.h>

enum { COLUMNS = 13 };

int placido_pencil_new(placido_pencil *pencil, size_t rays, placido_error *err) {
  *pencil = (placido_pencil){0};
  float *block = placido_memory_new(rays, COLUMNS * sizeof *block, err);
  if (block == NULL) {
    return PLACIDO_MEMORY;
  }
  float **columns[COLUMNS] = {
    &pencil->x,    &pencil->y,    &pencil->slope_x, &pencil->slope_y, &pencil->m_x,
    &pencil->m_y,  &pencil->j0_x, &pencil->j0_y,    &pencil->j45_x,   &pencil->j45_y,
    &pencil->u,    &pencil->v,    &pencil->weight};
  for (size_t i = 0; i < COLUMNS; i++) {
    *columns[i] = block + i * rays;
  }
  return PLACIDO_OK;
}

void placido_pencil_free(placido_pencil *pencil) {
  if (pencil != NULL) {
    placido_memory_free(pencil->x); /* the block's first column */
    *pencil = (placido_pencil){0};
  }
}

/* The slope behind the cornea with a cross-cylinder more. */
static bool find_slope(const placido_entry *entry, const placido_eye *eye, double j0_D,
                       double j45_D, double slope[2]) {
  placido_eye worn = *eye;
  worn.correction.j0_D += j0_D;
  worn.correction.j45_D += j45_D;
  double x, y;
  if (!placido_entry_trace(entry, &worn, entry->depth_mm + 1, &x, &y)) {
    return false;
  }
  slope[0] = x - entry->x_mm;
  slope[1] = y - entry->y_mm;
  return true;
}

void placido_pencil_trace(placido_pencil *pencil, const placido_rays *rays,
                          const placido_eye *eye) {
  size_t n = 0;
  double per_D = 1 / (1000 * eye->index);
  pencil->index = eye->index;
  pencil->j0_D = eye->correction.j0_D;
  pencil->j45_D = eye->correction.j45_D;
  for (size_t i = 0; i < rays->count; i++) {
    const placido_entry *entry = &rays->entries[i];
    double slope[2], j0[2], j45[2];
    if (!find_slope(entry, eye, 0, 0, slope) || !find_slope(entry, eye, 1, 0, j0) ||
        !find_slope(entry, eye, 0, 1, j45)) {
      continue;
    }
    double x = entry->x_mm - eye->pupil_x_mm, y = entry->y_mm - eye->pupil_y_mm;
    pencil->x[n] = (float)x;
    pencil->y[n] = (float)y;
    pencil->slope_x[n] = (float)slope[0];
    pencil->slope_y[n] = (float)slope[1];
    pencil->m_x[n] = (float)(per_D * (x - entry->depth_mm * slope[0]));
    pencil->m_y[n] = (float)(per_D * (y - entry->depth_mm * slope[1]));
    pencil->j0_x[n] = (float)(j0[0] - slope[0]);
    pencil->j0_y[n] = (float)(j0[1] - slope[1]);
    pencil->j45_x[n] = (float)(j45[0] - slope[0]);
    pencil->j45_y[n] = (float)(j45[1] - slope[1]);
    n++;
  }
  pencil->count = n;
}

void placido_pencil_aim(placido_pencil *pencil, const placido_aim *aim) {
  float m = (float)aim->vergence_D, j0 = (float)(aim->j0_D - pencil->j0_D);
  float j45 = (float)(aim->j45_D - pencil->j45_D), x = (float)aim->x, y = (float)aim->y;
#pragma omp simd
  for (size_t i = 0; i < pencil->count; i++) {
    pencil->u[i] = pencil->slope_x[i] + m * pencil->m_x[i] + j0 * pencil->j0_x[i] +
                   j45 * pencil->j45_x[i] - x;
    pencil->v[i] = pencil->slope_y[i] + m * pencil->m_y[i] + j0 * pencil->j0_y[i] +
                   j45 * pencil->j45_y[i] - y;
  }
}

void placido_pencil_select(placido_pencil *pencil, const placido_patch *patch) {
  for (size_t i = 0; i < pencil->count; i++) {
    double r = hypot(pencil->x[i] - patch->x_mm, pencil->y[i] - patch->y_mm);
    pencil->weight[i] = r >= patch->inner_mm && r <= patch->outer_mm;
  }
}

double placido_pencil_gather(placido_pencil *pencil, double width) {
  const float *u = pencil->u, *v = pencil->v;
  float scale = (float)(1 / (width * width)), gathered = 0;
#pragma omp simd reduction(+ : gathered)
  for (size_t i = 0; i < pencil->count; i++) {
    float near = 1 / (1 + (u[i] * u[i] + v[i] * v[i]) * scale);
    gathered += near * near;
    pencil->weight[i] = near * near * near;
  }
  return gathered;
}

/* Weighted sums over the rays. */
typedef struct sums {
  double n, x, y, xx, xy, yy, u, v, ux, uy, vx, vy, dd;
} sums;

static sums add_up(const placido_pencil *pencil) {
  const float *x = pencil->x, *y = pencil->y, *u = pencil->u, *v = pencil->v;
  float n = 0, sx = 0, sy = 0, xx = 0, xy = 0, yy = 0, su = 0, sv = 0, ux = 0, uy = 0, vx = 0,
        vy = 0, dd = 0;
#pragma omp simd reduction(+ : n, sx, sy, xx, xy, yy, su, sv, ux, uy, vx, vy, dd)
  for (size_t i = 0; i < pencil->count; i++) {
    float w = pencil->weight[i], wx = w * x[i], wy = w * y[i];
    n += w;
    sx += wx;
    sy += wy;
    xx += wx * x[i];
    xy += wx * y[i];
    yy += wy * y[i];
    su += w * u[i];
    sv += w * v[i];
    ux += wx * u[i];
    uy += wy * u[i];
    vx += wx * v[i];
    vy += wy * v[i];
    dd += w * (u[i] * u[i] + v[i] * v[i]);
  }
  return (sums){n, sx, sy, xx, xy, yy, su, sv, ux, uy, vx, vy, dd};
}

/* Paraxially a lens (M, J0, J45) more turns a ray at (x, y) by -(M + J0) x - J45 y and
 * -J45 x - (M - J0) y; more vergence to the retina is less lens. With the sums about their means
 * the normal equations are 3 by 3 and solved by hand. */
bool placido_pencil_fit(const placido_pencil *pencil, bool vergence_open, bool cylinder_open,
                        placido_aim *change, double *rms) {
  sums s = add_up(pencil);
  double xx = s.xx - s.x * s.x / s.n, xy = s.xy - s.x * s.y / s.n, yy = s.yy - s.y * s.y / s.n;
  double ux = s.ux - s.u * s.x / s.n, uy = s.uy - s.u * s.y / s.n;
  double vx = s.vx - s.v * s.x / s.n, vy = s.vy - s.v * s.y / s.n;
  double square = xx + yy, d = yy - xx, p = 2 * xy;
  double m = -(ux + vy), j0 = ux - vy, j45 = uy + vx;
  double rest = square - (d * d + p * p) / square;
  *change = (placido_aim){0};
  if (!(s.n > 0 && rest > 1e-3 * square)) {
    return false;
  }
  if (vergence_open) {
    m = cylinder_open ? (m - (d * j0 - p * j45) / square) / rest : m / square;
  } else {
    m = 0;
  }
  j0 = cylinder_open ? (j0 - d * m) / square : 0;
  j45 = cylinder_open ? (j45 + p * m) / square : 0;
  double mean_x = s.x / s.n, mean_y = s.y / s.n, dioptres = 1000 * pencil->index;
  change->x = s.u / s.n + (m - j0) * mean_x - j45 * mean_y;
  change->y = s.v / s.n - j45 * mean_x + (m + j0) * mean_y;
  change->vergence_D = dioptres * m;
  change->j0_D = dioptres * j0;
  change->j45_D = dioptres * j45;
  *rms = sqrt(fmax(s.dd / s.n - (s.u * s.u + s.v * s.v) / (s.n * s.n), 0));
  return true;
}

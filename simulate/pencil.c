/* Linear optics about the lens worn, in columns that the compiler's vector units take.
 *
 * For light from one direction a retina L behind the apex is met at p + (L - depth) q, p the entry
 * and q the slope behind the cornea: divided by L that is linear in the vergence 1/L without any
 * approximation. In the lens q is linear to second order in its prism, S r: 0.1' for 3 D at the rim
 * of 8 mm, and nothing where the lens is the one that was traced.
 * Sums are made in LANES interleaved parts, so that they are the same for every vector width. */
#include "simulate/pencil.h"

#include "base/dense.h"
#include "base/dispatch.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { UNKNOWNS = PLACIDO_PENCIL_UNKNOWNS, COLUMNS = 7 + 2 * UNKNOWNS, LANES = 16 };

static const float far_away = 1e6f;

int placido_pencil_new(placido_pencil *pencil, size_t rays, placido_error *err) {
  *pencil = (placido_pencil){0};
  size_t room = (rays / LANES + 1) * LANES;
  float *block = placido_memory_new(room, COLUMNS * sizeof *block, err);
  if (block == NULL) {
    return PLACIDO_MEMORY;
  }
  pencil->room = rays;
  float **columns[COLUMNS] = {&pencil->x,       &pencil->y, &pencil->slope_x,
                              &pencil->slope_y, &pencil->u, &pencil->v,
                              &pencil->weight};
  for (size_t k = 0; k < UNKNOWNS; k++) {
    columns[7 + 2 * k] = &pencil->change_x[k];
    columns[8 + 2 * k] = &pencil->change_y[k];
  }
  for (size_t i = 0; i < COLUMNS; i++) {
    *columns[i] = block + i * room;
  }
  return PLACIDO_OK;
}

void placido_pencil_free(placido_pencil *pencil) {
  if (pencil != NULL) {
    placido_memory_free(pencil->x); /* the block's first column */
    *pencil = (placido_pencil){0};
  }
}

/* The slope behind the cornea with more of a lens. */
static bool find_slope(const placido_entry *entry, const placido_eye *eye,
                       const placido_correction *more, double slope[2]) {
  placido_eye worn = *eye;
  worn.correction.m_D += more->m_D;
  worn.correction.j0_D += more->j0_D;
  worn.correction.j45_D += more->j45_D;
  double x, y;
  if (!placido_entry_trace(entry, &worn, entry->depth_mm + 1, &x, &y)) {
    return false;
  }
  slope[0] = x - entry->x_mm;
  slope[1] = y - entry->y_mm;
  return true;
}

/* Fills row `at`; false for a ray that cannot enter. */
static bool trace_ray(placido_pencil *pencil, size_t at, const placido_entry *entry,
                      const placido_eye *eye) {
  static const placido_correction more[1 + UNKNOWNS] = {
    {0}, {.m_D = 1}, {.j0_D = 1}, {.j45_D = 1}};
  double slope[1 + UNKNOWNS][2];
  for (int k = 0; k <= UNKNOWNS; k++) {
    if (!find_slope(entry, eye, &more[k], slope[k])) {
      return false;
    }
  }
  double x = entry->x_mm - eye->pupil_x_mm, y = entry->y_mm - eye->pupil_y_mm;
  double *q = slope[0], per_D = 1 / (1000 * eye->index);
  double vergence[2] = {per_D * (x - entry->depth_mm * q[0]), per_D * (y - entry->depth_mm * q[1])};
  bool given = eye->retina_mm > 0;
  double fixed_D = given ? 1000 * eye->index / eye->retina_mm : 0;
  for (int k = 0; k < UNKNOWNS; k++) {
    bool of_retina = k == 0 && !given;
    pencil->change_x[k][at] = (float)(of_retina ? vergence[0] : slope[1 + k][0] - q[0]);
    pencil->change_y[k][at] = (float)(of_retina ? vergence[1] : slope[1 + k][1] - q[1]);
  }
  pencil->slope_x[at] = (float)(q[0] + fixed_D * vergence[0]);
  pencil->slope_y[at] = (float)(q[1] + fixed_D * vergence[1]);
  pencil->x[at] = (float)x;
  pencil->y[at] = (float)y;
  return true;
}

void placido_pencil_close(placido_pencil *pencil) {
  for (pencil->padded = pencil->count; pencil->padded % LANES != 0; pencil->padded++) {
    size_t at = pencil->padded;
    pencil->x[at] = pencil->y[at] = pencil->slope_x[at] = pencil->slope_y[at] = far_away;
    for (int k = 0; k < UNKNOWNS; k++) {
      pencil->change_x[k][at] = pencil->change_y[k][at] = 0;
    }
  }
}

void placido_pencil_trace(placido_pencil *pencil, const placido_rays *rays,
                          const placido_eye *eye) {
  pencil->count = 0;
  pencil->about_D[0] = eye->retina_mm > 0 ? eye->correction.m_D : 0;
  pencil->about_D[1] = eye->correction.j0_D;
  pencil->about_D[2] = eye->correction.j45_D;
  for (size_t i = 0; i < rays->count && pencil->count < pencil->room; i++) {
    pencil->count += trace_ray(pencil, pencil->count, &rays->entries[i], eye);
  }
  placido_pencil_close(pencil);
}

size_t placido_pencil_select(placido_pencil *pencil, const placido_patch *patch) {
  const float x = (float)patch->x_mm, y = (float)patch->y_mm;
  const float inner2 = (float)(patch->inner_mm * patch->inner_mm);
  const float outer2 = (float)(patch->outer_mm * patch->outer_mm);
  size_t inside = 0;
  for (size_t i = 0; i < pencil->padded; i++) {
    float dx = pencil->x[i] - x, dy = pencil->y[i] - y, r2 = dx * dx + dy * dy;
    bool is_inside = r2 >= inner2 && r2 <= outer2;
    pencil->weight[i] = is_inside;
    inside += is_inside;
  }
  return inside;
}

static double add_lanes(const float lanes[LANES]) {
  double sum = 0;
  for (int i = 0; i < LANES; i++) {
    sum += (double)lanes[i];
  }
  return sum;
}

/* What a trial needs of the aim. */
typedef struct target {
  float c[UNKNOWNS], x, y, scale;
} target;

/* Fills u, v and weight, and adds the light to its lanes. */
PLACIDO_WIDE static void gather(float gathered[LANES], const placido_pencil *pencil,
                                const target *t) {
  const float *a = pencil->change_x[0], *b = pencil->change_x[1], *c = pencil->change_x[2];
  const float *d = pencil->change_y[0], *e = pencil->change_y[1], *f = pencil->change_y[2];
  const float *p = pencil->slope_x, *q = pencil->slope_y;
  float *us = pencil->u, *vs = pencil->v, *weight = pencil->weight;
  for (size_t i = 0; i < pencil->padded; i += LANES) {
#pragma omp simd
    for (size_t k = 0; k < LANES; k++) {
      float u = p[i + k] - t->x + t->c[0] * a[i + k] + t->c[1] * b[i + k] + t->c[2] * c[i + k];
      float v = q[i + k] - t->y + t->c[0] * d[i + k] + t->c[1] * e[i + k] + t->c[2] * f[i + k];
      float near = 1 / (1 + (u * u + v * v) * t->scale);
      float share = near * sqrtf(near);
      us[i + k] = u;
      vs[i + k] = v;
      weight[i + k] = share * near;
      gathered[k] += share;
    }
  }
}

double placido_pencil_gather(placido_pencil *pencil, const placido_aim *aim, double width) {
  float gathered[LANES] = {0};
  target t = {.x = (float)aim->x, .y = (float)aim->y, .scale = (float)(1 / (width * width))};
  for (int k = 0; k < UNKNOWNS; k++) {
    t.c[k] = (float)(aim->power_D[k] - pencil->about_D[k]);
  }
  gather(gathered, pencil, &t);
  return add_lanes(gathered);
}

void placido_pencil_aim(placido_pencil *pencil, const placido_aim *aim) {
  placido_pencil_gather(pencil, aim, INFINITY);
}

/* Weighted sums over the rays: of 1, the changes, the offsets, and of their products. */
typedef struct sums {
  double n, a[UNKNOWNS], b[UNKNOWNS], u, v;
  double square[UNKNOWNS][UNKNOWNS], product[UNKNOWNS], spread;
} sums;

enum { SUMS = 19 };

PLACIDO_WIDE static void add_up(float lanes[SUMS][LANES], const placido_pencil *pencil) {
  const float *a = pencil->change_x[0], *b = pencil->change_x[1], *c = pencil->change_x[2];
  const float *d = pencil->change_y[0], *e = pencil->change_y[1], *f = pencil->change_y[2];
  const float *weight = pencil->weight, *us = pencil->u, *vs = pencil->v;
  for (size_t i = 0; i < pencil->padded; i += LANES) {
#pragma omp simd
    for (size_t k = 0; k < LANES; k++) {
      float w = weight[i + k], u = us[i + k], v = vs[i + k];
      float a0 = a[i + k], a1 = b[i + k], a2 = c[i + k];
      float b0 = d[i + k], b1 = e[i + k], b2 = f[i + k];
      float wa0 = w * a0, wa1 = w * a1, wa2 = w * a2, wb0 = w * b0, wb1 = w * b1, wb2 = w * b2;
      lanes[0][k] += w;
      lanes[1][k] += wa0;
      lanes[2][k] += wa1;
      lanes[3][k] += wa2;
      lanes[4][k] += wb0;
      lanes[5][k] += wb1;
      lanes[6][k] += wb2;
      lanes[7][k] += w * u;
      lanes[8][k] += w * v;
      lanes[9][k] += wa0 * a0 + wb0 * b0;
      lanes[10][k] += wa1 * a0 + wb1 * b0;
      lanes[11][k] += wa1 * a1 + wb1 * b1;
      lanes[12][k] += wa2 * a0 + wb2 * b0;
      lanes[13][k] += wa2 * a1 + wb2 * b1;
      lanes[14][k] += wa2 * a2 + wb2 * b2;
      lanes[15][k] += wa0 * u + wb0 * v;
      lanes[16][k] += wa1 * u + wb1 * v;
      lanes[17][k] += wa2 * u + wb2 * v;
      lanes[18][k] += w * (u * u + v * v);
    }
  }
}

static sums sums_of(const placido_pencil *pencil) {
  float lanes[SUMS][LANES];
  memset(lanes, 0, sizeof lanes);
  add_up(lanes, pencil);
  double t[SUMS];
  for (int i = 0; i < SUMS; i++) {
    t[i] = add_lanes(lanes[i]);
  }
  return (sums){.n = t[0],
                .a = {t[1], t[2], t[3]},
                .b = {t[4], t[5], t[6]},
                .u = t[7],
                .v = t[8],
                .square = {{t[9], t[10], t[12]}, {t[10], t[11], t[13]}, {t[12], t[13], t[14]}},
                .product = {t[15], t[16], t[17]},
                .spread = t[18]};
}

/* Solves square × x = x in place, where `open`; false where it is singular. */
static bool solve(double square[UNKNOWNS][UNKNOWNS], double x[UNKNOWNS],
                  const bool open[UNKNOWNS]) {
  for (int j = 0; j < UNKNOWNS; j++) {
    if (!open[j]) {
      for (int i = 0; i < UNKNOWNS; i++) {
        square[i][j] = square[j][i] = i == j;
      }
      x[j] = 0;
    }
  }
  if (!placido_dense_factor(&square[0][0], UNKNOWNS, UNKNOWNS, 1e-4)) {
    return false;
  }
  placido_dense_solve(&square[0][0], UNKNOWNS, UNKNOWNS, x);
  return true;
}

bool placido_pencil_fit(const placido_pencil *pencil, const bool open[UNKNOWNS],
                        placido_aim *change, double *rms) {
  sums s = sums_of(pencil);
  *change = (placido_aim){0};
  if (!(s.n > 0)) {
    return false;
  }
  double *x = change->power_D, wanted[UNKNOWNS];
  double left = s.spread - (s.u * s.u + s.v * s.v) / s.n;
  for (int i = 0; i < UNKNOWNS; i++) { /* about the means: the place is free */
    x[i] = wanted[i] = (s.a[i] * s.u + s.b[i] * s.v) / s.n - s.product[i];
    for (int k = 0; k <= i; k++) {
      s.square[i][k] -= (s.a[i] * s.a[k] + s.b[i] * s.b[k]) / s.n;
    }
  }
  if (!solve(s.square, x, open)) {
    return false;
  }
  change->x = s.u / s.n;
  change->y = s.v / s.n;
  for (int i = 0; i < UNKNOWNS; i++) {
    change->x += x[i] * s.a[i] / s.n;
    change->y += x[i] * s.b[i] / s.n;
    left -= x[i] * wanted[i];
  }
  *rms = sqrt(fmax(left, 0) / s.n);
  return true;
}

/* A batch of rays in plain loops over arrays, which compilers turn into vector code; a number that
 * is not one (NaN) is a ray that misses. */
#include "reconstruct/solve/engine/batch.h"

#include "reconstruct/mirror_inside.h"
#include "reconstruct/vector.h"

#define ORDER PLACIDO_SPLINE_ORDER
#define CELL PLACIDO_SPLINE_CELL
#define LANES 8

void placido_batch_gather(placido_batch *b, const placido_sightlines *sightlines,
                          const size_t *which, int count) {
  b->count = count;
  b->lanes = (count + LANES - 1) / LANES * LANES;
  for (int k = 0; k <= PLACIDO_RAY_PLACE_Y; k++) {
    if (k <= PLACIDO_RAY_T || k >= PLACIDO_RAY_PLACE_X) {
      for (int i = 0; i < b->lanes; i++) {
        b->in[k][i] = sightlines->numbers[k][which[i < b->count ? i : b->count - 1]];
      }
    }
  }
}

PLACIDO_WIDE static void add_base(placido_batch *b, const placido_conicoid *base) {
  const placido_conicoid k = *base;
  for (int i = 0; i < b->lanes; i++) {
    placido_hit hit = {.x = b->in[PLACIDO_RAY_ORIGIN_X][i] +
                            b->in[PLACIDO_RAY_T][i] * b->in[PLACIDO_RAY_DIRECTION_X][i],
                       .y = b->in[PLACIDO_RAY_ORIGIN_Y][i] +
                            b->in[PLACIDO_RAY_T][i] * b->in[PLACIDO_RAY_DIRECTION_Y][i]};
    placido_conicoid_at(&k, &hit);
    b->x[i] = hit.x;
    b->y[i] = hit.y;
    b->z[i] = hit.z;
    b->p[i] = hit.p;
    b->q[i] = hit.q;
    b->xx[i] = hit.xx;
    b->xy[i] = hit.xy;
    b->yy[i] = hit.yy;
  }
}

/* The cell's polynomial and its derivatives by Horner's rule, in x inside, in y outside. */
PLACIDO_WIDE static void add_spline(placido_batch *b, const double polynomial[CELL],
                                    double knot_mm) {
  double slope = 1 / knot_mm, bend = slope * slope;
  for (int i = 0; i < b->lanes; i++) {
    double x = b->in[PLACIDO_RAY_PLACE_X][i], y = b->in[PLACIDO_RAY_PLACE_Y][i];
    double z = 0, zy = 0, zyy = 0, zx = 0, zxy = 0, zxx = 0;
#pragma GCC unroll 6
    for (int m = ORDER - 1; m >= 0; m--) {
      const double *line = polynomial + m * ORDER;
      double v = line[5], d = 0, dd = 0;
#pragma GCC unroll 5
      for (int n = ORDER - 2; n >= 0; n--) {
        dd = dd * x + d;
        d = d * x + v;
        v = v * x + line[n];
      }
      zyy = zyy * y + zy;
      zy = zy * y + z;
      z = z * y + v;
      zxy = zxy * y + zx;
      zx = zx * y + d;
      zxx = zxx * y + 2 * dd;
    }
    b->z[i] += z;
    b->p[i] += slope * zx;
    b->q[i] += slope * zy;
    b->xx[i] += bend * zxx;
    b->xy[i] += bend * zxy;
    b->yy[i] += bend * 2 * zyy;
  }
}

/* One step of Newton's along the rays, and the jet where they come to be. */
PLACIDO_WIDE static void step(placido_batch *b, double origin_z_mm) {
  for (int i = 0; i < b->lanes; i++) {
    double dx = b->in[PLACIDO_RAY_DIRECTION_X][i], dy = b->in[PLACIDO_RAY_DIRECTION_Y][i];
    double over = origin_z_mm - b->in[PLACIDO_RAY_T][i] - b->z[i];
    double dt = over / (1 + b->p[i] * dx + b->q[i] * dy);
    double ax = dt * dx, ay = dt * dy;
    b->in[PLACIDO_RAY_T][i] += dt;
    b->x[i] += ax;
    b->y[i] += ay;
    b->z[i] = origin_z_mm - b->in[PLACIDO_RAY_T][i];
    b->p[i] += b->xx[i] * ax + b->xy[i] * ay;
    b->q[i] += b->xy[i] * ax + b->yy[i] * ay;
    b->in[PLACIDO_RAY_ASIDE][i] = fabs(ax) + fabs(ay);
  }
}

PLACIDO_WIDE static void mirror(placido_batch *b, double origin_z_mm, bool moves_origin) {
  double origin = moves_origin, direction = !moves_origin;
  for (int i = 0; i < b->lanes; i++) {
    double ux = b->in[PLACIDO_RAY_U_X][i], uy = b->in[PLACIDO_RAY_U_Y][i];
    double vx = b->in[PLACIDO_RAY_V_X][i], vy = b->in[PLACIDO_RAY_V_Y][i];
    placido_ray ray = {
        .origin = {0, 0, origin_z_mm},
        .direction = {b->in[PLACIDO_RAY_DIRECTION_X][i], b->in[PLACIDO_RAY_DIRECTION_Y][i], -1},
        .origin_u = {origin * ux, origin * uy, 0},
        .direction_u = {direction * ux, direction * uy, 0},
        .origin_v = {origin * vx, origin * vy, 0},
        .direction_v = {direction * vx, direction * vy, 0}};
    placido_hit hit = {b->x[i], b->y[i], b->z[i], b->p[i], b->q[i], b->xx[i], b->xy[i], b->yy[i]};
    placido_miss miss;
    placido_mirror_miss_inside(&miss, &ray, &hit, b->in[PLACIDO_RAY_EDGE_RADIUS][i],
                               b->in[PLACIDO_RAY_EDGE_Z][i]);
    double slope =
        b->in[PLACIDO_RAY_NOISE][i] * sqrt(miss.by_u * miss.by_u + miss.by_v * miss.by_v);
    double share = 1 / slope;
    b->f[i] = miss.f;
    b->by_z[i] = miss.by_z;
    b->by_p[i] = miss.by_p;
    b->by_q[i] = miss.by_q;
    b->by_u[i] = miss.by_u;
    b->by_v[i] = miss.by_v;
    b->by_radius[i] = miss.by_radius;
    b->by_height[i] = miss.by_height;
    b->slope[i] = slope;
    b->in[PLACIDO_RAY_RESIDUAL_PX][i] = miss.f * share;
    b->in[PLACIDO_RAY_BY_Z][i] = miss.by_z * share;
    b->in[PLACIDO_RAY_BY_P][i] = miss.by_p * share;
    b->in[PLACIDO_RAY_BY_Q][i] = miss.by_q * share;
  }
}

void placido_batch_evaluate(placido_batch *b, const placido_conicoid *base,
                            const double *polynomial, double knot_mm, double origin_z_mm,
                            bool moves_origin) {
  add_base(b, base);
  if (polynomial) {
    add_spline(b, polynomial, knot_mm);
  }
  step(b, origin_z_mm);
  mirror(b, origin_z_mm, moves_origin);
}

void placido_batch_scatter(const placido_batch *b, placido_sightlines *sightlines,
                           const size_t *which) {
  for (int k = PLACIDO_RAY_T; k < PLACIDO_RAY_NUMBERS; k++) {
    if (k < PLACIDO_RAY_PLACE_X || k > PLACIDO_RAY_PLACE_Y) {
      for (int i = 0; i < b->count; i++) {
        sightlines->numbers[k][which[i]] = b->in[k][i];
      }
    }
  }
}

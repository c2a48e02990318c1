/* A conicoid as the fit evaluates it: millions of times, so without a surface's generality. */
#ifndef PLACIDO_SOLVE_CONICOID_H
#define PLACIDO_SOLVE_CONICOID_H

#include "reconstruct/mirror.h"
#include "reconstruct/vector.h"

#include <math.h>

/* Radius of curvature and asphericity of the apex at (cx, cy, apex_z_mm). */
typedef struct placido_conicoid {
  double radius_mm, q, cx_mm, cy_mm, apex_z_mm;
} placido_conicoid;

/* The jet of z at (hit->x, hit->y): z = apex - c ρ² / (1 + w), w² = 1 - (1 + q) c² ρ². All NaN
 * beyond the equator. */
PLACIDO_INSIDE void placido_conicoid_at(const placido_conicoid *k, placido_hit *hit) {
  double c = 1 / k->radius_mm, bend = (1 + k->q) * c * c;
  double x = hit->x - k->cx_mm, y = hit->y - k->cy_mm, square = x * x + y * y;
  double w = sqrt(1 - bend * square), steep = c / w, turn = bend * steep / (w * w);
  hit->z = k->apex_z_mm - c * square / (1 + w);
  hit->p = -steep * x;
  hit->q = -steep * y;
  hit->xx = -steep - turn * x * x;
  hit->xy = -turn * x * y;
  hit->yy = -steep - turn * y * y;
}

#endif

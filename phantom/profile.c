/* Where a ray meets the mires: its crossing with the cones through consecutive edges. */
#include "phantom/profile.h"

#include <math.h>

/* A ray's crossing with the unlimited cone (or plane, or cylinder) through two edges. */
typedef struct crossing {
  double distance; /* along the ray, in units of its direction */
  double share;    /* 0 at the first edge, 1 at the second; any number beyond */
} crossing;

placido_phantom_profile placido_phantom_profile_of(const placido_instrument *instrument) {
  placido_phantom_profile profile = {
      .edges = instrument->edges, .edge_count = instrument->edge_count, .funnel = true};
  for (int i = 0; i + 1 < instrument->edge_count; i++) {
    const placido_edge *a = &instrument->edges[i], *b = a + 1;
    if (b->radius_mm < a->radius_mm || b->z_mm > a->z_mm) {
      profile.funnel = false;
    }
  }
  return profile;
}

static double radius_at(const placido_phantom_ray *ray, double distance) {
  double x = ray->from[0] + distance * ray->along[0];
  double y = ray->from[1] + distance * ray->along[1];
  return sqrt(x * x + y * y);
}

/* Appends the crossing at `distance`, where it lies ahead and on the cone's own nappe. */
static int keep(crossing *found, int count, const placido_phantom_ray *ray, const placido_edge *a,
                const placido_edge *b, double distance) {
  double dr = b->radius_mm - a->radius_mm, dz = b->z_mm - a->z_mm;
  if (!(distance > 0) || !isfinite(distance)) {
    return count;
  }
  double rise = ray->from[2] + distance * ray->along[2] - a->z_mm;
  if (dz != 0 && fabs(dz) > 1e-8 * fabs(dr) && a->radius_mm + rise * (dr / dz) < 0) {
    return count;
  }
  double out = radius_at(ray, distance) - a->radius_mm;
  found[count] = (crossing){distance, (out * dr + rise * dz) / (dr * dr + dz * dz)};
  return count + 1;
}

/* All crossings ahead of the ray with the cone through two edges, at most two. */
static int cross(crossing found[2], const placido_phantom_ray *ray, const placido_edge *a,
                 const placido_edge *b) {
  double dr = b->radius_mm - a->radius_mm, dz = b->z_mm - a->z_mm;
  const double *p = ray->from, *d = ray->along;
  /* A cone this flat is a plane to within 1e-8 of its width, and its quadratic would cancel. */
  if (fabs(dz) <= 1e-8 * fabs(dr)) {
    return keep(found, 0, ray, a, b, (a->z_mm - p[2]) / d[2]);
  }
  double flare = dr / dz;
  double radius = a->radius_mm + (p[2] - a->z_mm) * flare; /* of the cone at the ray's start */
  double qa = d[0] * d[0] + d[1] * d[1] - flare * flare * d[2] * d[2];
  double qb = p[0] * d[0] + p[1] * d[1] - flare * radius * d[2];
  double qc = p[0] * p[0] + p[1] * p[1] - radius * radius;
  double discriminant = qb * qb - qa * qc;
  if (!(discriminant >= 0)) {
    return 0;
  }
  double q = -(qb + copysign(sqrt(discriminant), qb));
  int count = keep(found, 0, ray, a, b, qc / q);
  return keep(found, count, ray, a, b, q / qa);
}

/* A ray that meets no band passes either through the innermost edge or outside all of them. */
static int beside(const placido_phantom_profile *profile, const placido_phantom_ray *ray) {
  const placido_edge *inner = &profile->edges[0];
  double distance = (inner->z_mm - ray->from[2]) / ray->along[2];
  bool inside = distance > 0 && radius_at(ray, distance) < inner->radius_mm;
  return inside ? -1 : profile->edge_count - 1;
}

/* The nearest crossing with any band: right for every profile. */
static int scan(const placido_phantom_profile *profile, const placido_phantom_ray *ray) {
  const double slack = 1e-12; /* no ray may slip between two bands by rounding */
  double nearest = INFINITY;
  int band = -2;
  for (int i = 0; i + 1 < profile->edge_count; i++) {
    crossing found[2];
    int count = cross(found, ray, &profile->edges[i], &profile->edges[i + 1]);
    for (int c = 0; c < count; c++) {
      if (found[c].share >= -slack && found[c].share <= 1 + slack && found[c].distance < nearest) {
        nearest = found[c].distance;
        band = i;
      }
    }
  }
  return band == -2 ? beside(profile, ray) : band;
}

/* Goes from the guessed band towards the right one. In a funnel, a ray that rises outwards crosses
 * the falling profile once, and on which side of an edge it does so says where to go. Returns false
 * where a cone is not crossed once. */
static bool walk(const placido_phantom_profile *profile, const placido_phantom_ray *ray, int guess,
                 int *band) {
  int last = profile->edge_count - 2, step = 0;
  int at = guess < 0 ? 0 : guess > last ? last : guess;
  for (;;) {
    crossing found[2];
    if (cross(found, ray, &profile->edges[at], &profile->edges[at + 1]) != 1) {
      return false;
    }
    int next = found[0].share < 0 ? -1 : found[0].share > 1 ? 1 : 0;
    if (next == 0 || next == -step || at + next < 0 || at + next > last) {
      *band = next == 0 || next == -step ? at : at + next;
      return true;
    }
    at += next;
    step = next;
  }
}

int placido_phantom_profile_band(const placido_phantom_profile *profile,
                                 const placido_phantom_ray *ray, int guess) {
  const double *p = ray->from, *d = ray->along;
  int count = profile->edge_count, band;
  if (profile->funnel && count > 1 && p[0] * d[0] + p[1] * d[1] >= 0) {
    if (d[2] <= 0 && p[2] <= profile->edges[count - 1].z_mm) {
      return count - 1;
    }
    if (d[2] > 0 && walk(profile, ray, guess, &band)) {
      return band;
    }
  }
  return scan(profile, ray);
}

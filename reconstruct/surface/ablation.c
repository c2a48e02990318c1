/* Ablation: the tissue that a myopic laser treatment removes, which adds sag.
 * Inside the zone the difference of two spheres (Munnerlyn et al., J. Cataract Refract. Surg. 14,
 * 46-52, 1988); outside, a quintic Hermite blend down to zero with equal value, slope and second
 * derivative at both ends, so that the second derivatives are continuous everywhere. */
#include "base/memory.h"
#include "reconstruct/surface/jet.h"
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stddef.h>

struct ablation {
  double cx, cy;
  double zone, blend; /* radius of the zone, width of the blend */
  double r0, r1;      /* before and after */
  double apart;       /* r0 - r1 */
  double offset;      /* makes the profile start the blend at the rim's height */
  double rim, second; /* the blend is (1 - t)³ (rim (1 + t) + second t² / 2), its t from 0 to 1 */
};

static const placido_part_field fields[] = {
    {.name = "dioptres", .offset = offsetof(placido_part, as.ablation.dioptres)},
    {.name = "zone_mm",
     .offset = offsetof(placido_part, as.ablation.zone_mm),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "blend_mm",
     .offset = offsetof(placido_part, as.ablation.blend_mm),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "r0",
     .offset = offsetof(placido_part, as.ablation.r0),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "n",
     .offset = offsetof(placido_part, as.ablation.n),
     .optional = true,
     .fallback = 1.376},
    {.name = "cx", .offset = offsetof(placido_part, as.ablation.cx), .optional = true},
    {.name = "cy", .offset = offsetof(placido_part, as.ablation.cy), .optional = true},
};

/* What the treatment takes from the cornea's curvature, and what it leaves. */
static double curvature_taken(const placido_part *part) {
  return part->as.ablation.dioptres / 1000 / (part->as.ablation.n - 1);
}

static double curvature_after(const placido_part *part) {
  return 1 / part->as.ablation.r0 - curvature_taken(part);
}

static bool check(const placido_part *part, placido_complaint *complaint) {
  double zone = part->as.ablation.zone_mm / 2, r0 = part->as.ablation.r0;
  if (part->as.ablation.n <= 1) {
    return placido_part_complain(complaint, "n",
                                 "is %.9g, a refractive index greater than 1 is expected",
                                 part->as.ablation.n);
  }
  if (r0 <= zone) {
    return placido_part_complain(
        complaint, "r0", "is %.9g mm, more than half of zone_mm (%.9g mm) is expected", r0, zone);
  }
  double after = curvature_after(part);
  if (after <= 0 || after * zone >= 1) {
    return placido_part_complain(
        complaint, "dioptres",
        "of %.9g leaves a curvature of %.6g/mm, which spans no zone of %.9g mm",
        part->as.ablation.dioptres, after, 2 * zone);
  }
  return true;
}

static double root(double radius, double rho) {
  return sqrt(radius * radius - rho * rho);
}

/* A radial profile g as g, g'/rho and (g'' - g'/rho)/rho², which stay finite in the zone's centre.
 */
struct profile {
  double value, slope, bend;
};

/* The difference of the spheres' sags. Every difference is made of that of their radii, so that a
 * treatment as small as any keeps its digits. */
static struct profile between(const struct ablation *a, double rho) {
  double s0 = root(a->r0, rho), s1 = root(a->r1, rho), both = s0 * s1;
  double apart = a->apart * (a->r0 + a->r1) / (s0 + s1); /* s0 - s1 */
  return (struct profile){
      .value = rho * rho * (a->apart + apart) / ((a->r0 + s0) * (a->r1 + s1)),
      .slope = apart / both,
      .bend = apart * (s0 * s0 + both + s1 * s1) / (both * both * both)};
}

/* The quintic's value, slope and second derivative at t = 1 are 0, so that (1 - t)³ is a factor of
 * it; with the rim at minus half of the slope at t = 0 what is left is as simple as this. */
static void fill_blend(struct ablation *a) {
  struct profile end = between(a, a->zone);
  a->rim = -0.5 * end.slope * a->zone * a->blend;
  a->second = (end.slope + end.bend * a->zone * a->zone) * a->blend * a->blend;
  a->offset = a->rim - end.value;
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  struct ablation *a = placido_memory_new(1, sizeof *a, err);
  *state = a;
  if (!a) {
    return PLACIDO_MEMORY;
  }
  a->cx = part->as.ablation.cx;
  a->cy = part->as.ablation.cy;
  a->zone = part->as.ablation.zone_mm / 2;
  a->blend = part->as.ablation.blend_mm;
  a->r0 = part->as.ablation.r0;
  a->r1 = 1 / curvature_after(part);
  a->apart = -curvature_taken(part) * a->r0 * a->r1;
  fill_blend(a);
  return PLACIDO_OK;
}

static struct profile inside(const struct ablation *a, double rho) {
  struct profile p = between(a, rho);
  p.value += a->offset;
  return p;
}

static struct profile blending(const struct ablation *a, double rho) {
  double t = (rho - a->zone) / a->blend, e = (a->zone + a->blend - rho) / a->blend;
  double q = a->rim * (1 + t) + a->second * t * t / 2, q1 = a->rim + a->second * t;
  double first = e * e * (e * q1 - 3 * q);
  double second = e * (6 * q - 6 * e * q1 + e * e * a->second);
  double slope = first / (a->blend * rho);
  return (struct profile){.value = e * e * e * q,
                          .slope = slope,
                          .bend = (second / (a->blend * a->blend) - slope) / (rho * rho)};
}

static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const struct ablation *a = state;
  double x = x_mm - a->cx, y = y_mm - a->cy, rho = hypot(x, y);
  if (rho >= a->zone + a->blend) {
    return true;
  }
  struct profile p = rho < a->zone ? inside(a, rho) : blending(a, rho);
  jet->sag += p.value;
  jet->sx += p.slope * x;
  jet->sy += p.slope * y;
  jet->sxx += p.slope + p.bend * x * x;
  jet->sxy += p.bend * x * y;
  jet->syy += p.slope + p.bend * y * y;
  return true;
}

const placido_part_row placido_part_ablation = {
    .name = "ablation",
    .fields = fields,
    .field_count = sizeof fields / sizeof fields[0],
    .check = check,
    .prepare = prepare,
    .release = placido_memory_free,
    .add = add,
};

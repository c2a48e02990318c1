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
  double offset;      /* makes the profile start the blend at the rim's height */
  double quintic[6];  /* of the blend, in t = (rho - zone) / blend */
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

/* Curvature of the cornea after the treatment. */
static double curvature_after(const placido_part *part) {
  return 1 / part->as.ablation.r0 - part->as.ablation.dioptres / 1000 / (part->as.ablation.n - 1);
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

static void fill_blend(struct ablation *a) {
  double s0 = root(a->r0, a->zone), s1 = root(a->r1, a->zone), w = a->blend;
  double slope = (a->zone / s1 - a->zone / s0) * w;
  double second = (a->r1 * a->r1 / (s1 * s1 * s1) - a->r0 * a->r0 / (s0 * s0 * s0)) * w * w;
  double rim = -0.5 * slope;
  a->offset = rim - (s0 - s1);
  a->quintic[0] = rim;
  a->quintic[1] = slope;
  a->quintic[2] = 0.5 * second;
  a->quintic[3] = -10 * rim - 6 * slope - 1.5 * second;
  a->quintic[4] = 15 * rim + 8 * slope + 1.5 * second;
  a->quintic[5] = -6 * rim - 3 * slope - 0.5 * second;
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
  fill_blend(a);
  return PLACIDO_OK;
}

/* A radial profile g as g, g'/rho and (g'' - g'/rho)/rho², which stay finite in the zone's centre.
 */
struct profile {
  double value, slope, bend;
};

static struct profile inside(const struct ablation *a, double rho) {
  double s0 = root(a->r0, rho), s1 = root(a->r1, rho);
  return (struct profile){.value = s0 - s1 + a->offset,
                          .slope = 1 / s1 - 1 / s0,
                          .bend = 1 / (s1 * s1 * s1) - 1 / (s0 * s0 * s0)};
}

static struct profile blending(const struct ablation *a, double rho) {
  const double *q = a->quintic;
  double t = (rho - a->zone) / a->blend;
  double first = q[1] + t * (2 * q[2] + t * (3 * q[3] + t * (4 * q[4] + t * 5 * q[5])));
  double second = 2 * q[2] + t * (6 * q[3] + t * (12 * q[4] + t * 20 * q[5]));
  double slope = first / (a->blend * rho);
  return (struct profile){.value =
                              q[0] + t * (q[1] + t * (q[2] + t * (q[3] + t * (q[4] + t * q[5])))),
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

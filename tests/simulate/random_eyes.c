/* Random corneas. Radius 7.8 ± 0.25 mm, asphericity -0.26 ± 0.12; higher orders as corneal
 * wavefronts of 6 mm have them, some 0.15 um a term (Salmon and van de Pol 2006), as sag 3 times
 * that, scaled to a radius of 4.5 mm by the power of their order; cones of 3 to 15 D at their tips;
 * ablations of 2 to 8 D, up to 1 mm off the centre. */
#include "random_eyes.h"

#include "base/random.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

enum kind { NORMAL, ASTIGMATIC, HIGH_ORDER, ABLATED, CONE, DECENTRED, KINDS };

static const double radius_mm = 4.5;
static const double pi = 3.14159265358979323846;

/* Numbers are drawn in order. */
typedef struct draw {
  uint64_t eye, number;
} draw;

static double uniform(draw *d, double low, double high) {
  return placido_random_uniform(6, d->eye, d->number++, low, high);
}

static double normal(draw *d, double sigma) {
  return sigma * placido_random_normal(7, d->eye, d->number++);
}

/* How the eye is turned and mirrored. */
typedef struct pose {
  double turn_rad;
  bool mirrored;
} pose;

static void place(const pose *p, double radius, double angle, double *x, double *y) {
  angle = p->turn_rad + (p->mirrored ? pi - angle : angle);
  *x = radius * cos(angle);
  *y = radius * sin(angle);
}

static double axis_deg(const pose *p, double axis) {
  return p->turn_rad * 180 / pi + (p->mirrored ? 180 - axis : axis);
}

static placido_part base(draw *d, const pose *p, enum kind kind) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC};
  double cylinder_D = kind == ASTIGMATIC ? uniform(d, 1, 6) : uniform(d, 0, 1);
  part.as.biconic.r1 = 7.8 + fmax(-0.6, fmin(0.6, normal(d, 0.25)));
  part.as.biconic.r2 = 337.5 / (337.5 / part.as.biconic.r1 + cylinder_D);
  part.as.biconic.q1 = part.as.biconic.q2 = -0.26 + normal(d, 0.12);
  part.as.biconic.axis_deg = axis_deg(p, uniform(d, 0, 180));
  return part;
}

/* A term and its sine partner, turned and mirrored together. */
static void set_pair(placido_part *part, const pose *p, int n, int m, double cosine_um,
                     double sine_um) {
  if (p->mirrored) {
    cosine_um *= m % 2 == 0 ? 1 : -1;
    sine_um *= m % 2 == 0 ? -1 : 1;
  }
  double c = cos(m * p->turn_rad), s = sin(m * p->turn_rad);
  double *terms = part->as.zernike.coefficients_um;
  terms[placido_zernike_index(n, m)] = c * cosine_um - s * sine_um;
  if (m > 0) {
    terms[placido_zernike_index(n, -m)] = s * cosine_um + c * sine_um;
  }
}

static placido_part higher_orders(draw *d, const pose *p, enum kind kind) {
  static const double amounts[KINDS] = {1, 1, 3, 0.5, 0.5, 1};
  static const struct { int n, m; double sigma_um; } pairs[] = {
    {3, 1, 1.7}, {3, 3, 1.4}, {4, 0, 1}, {4, 2, 0.8}, {4, 4, 0.8}};
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE};
  part.as.zernike.radius_mm = radius_mm;
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    double sigma_um = amounts[kind] * pairs[i].sigma_um;
    double cosine_um = normal(d, sigma_um), sine_um = normal(d, sigma_um);
    set_pair(&part, p, pairs[i].n, pairs[i].m, cosine_um, sine_um);
  }
  return part;
}

static placido_part ablation(draw *d, const pose *p, double r0_mm) {
  placido_part part = {.kind = PLACIDO_PART_ABLATION};
  part.as.ablation.dioptres = uniform(d, 2, 8);
  part.as.ablation.zone_mm = uniform(d, 5, 6.5);
  part.as.ablation.blend_mm = uniform(d, 0.5, 1.2);
  part.as.ablation.r0 = r0_mm;
  part.as.ablation.n = 1.376;
  double off_mm = uniform(d, 0, 1);
  place(p, off_mm, uniform(d, 0, 2 * pi), &part.as.ablation.cx, &part.as.ablation.cy);
  return part;
}

static placido_part bump(draw *d, const pose *p) {
  placido_part part = {.kind = PLACIDO_PART_BUMP};
  double sigma_mm = uniform(d, 0.6, 1.5), power_D = uniform(d, 3, 15);
  part.as.bump.height_mm = power_D * sigma_mm * sigma_mm / 337.5;
  part.as.bump.sigma_x_mm = sigma_mm * uniform(d, 0.8, 1.2);
  part.as.bump.sigma_y_mm = sigma_mm * uniform(d, 0.8, 1.2);
  double off_mm = uniform(d, 0.2, 2);
  place(p, off_mm, uniform(d, 0, 2 * pi), &part.as.bump.x_mm, &part.as.bump.y_mm);
  part.as.bump.axis_deg = axis_deg(p, uniform(d, 0, 180));
  return part;
}

placido_surface *random_eye(placido_eye *eye, int number, double turn_deg, bool mirrored) {
  enum kind kind = (enum kind)(number % KINDS);
  draw d = {.eye = (uint64_t)number};
  pose p = {.turn_rad = turn_deg * pi / 180, .mirrored = mirrored};
  placido_part parts[3] = {base(&d, &p, kind), higher_orders(&d, &p, kind)};
  size_t count = 2;
  int rest = number / KINDS % 3; /* a third of the decentred eyes has a cone, one an ablation */
  if (kind == ABLATED || (kind == DECENTRED && rest == 1)) {
    parts[count++] = ablation(&d, &p, parts[0].as.biconic.r1);
  } else if (kind == CONE || (kind == DECENTRED && rest == 2)) {
    parts[count++] = bump(&d, &p);
  }
  *eye = (placido_eye){.pupil_mm = floor(uniform(&d, 2, 9)), .correct = PLACIDO_CORRECT_FULL};
  double off_mm = kind == DECENTRED ? uniform(&d, 0.2, 0.7) : 0;
  off_mm = fmin(off_mm, 0.98 * radius_mm - eye->pupil_mm / 2);
  place(&p, off_mm, uniform(&d, 0, 2 * pi), &eye->pupil_x_mm, &eye->pupil_y_mm);
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0, radius_mm, parts, count, NULL, &err) != PLACIDO_OK) {
    fail_msg("eye %d: %s", number, err.text);
  }
  return surface;
}

const char *random_eye_kind(int number) {
  static const char *const kinds[KINDS] = {"normal", "astigmatic", "high-order",
                                           "post-PRK", "keratoconic", "decentred"};
  return kinds[number % KINDS];
}

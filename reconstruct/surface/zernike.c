/* Zernike: a sum of OSA/ANSI normalised circle polynomials.
 * Indices, signs and normalisation: ANSI Z80.28; Thibos et al., "Standards for reporting the
 * optical aberrations of eyes", J. Refract. Surg. 18, S652-S660 (2002), eqs. 1 to 4.
 * The terms of one |m| share rho^|m| cos(m theta) and rho^|m| sin(m theta), the real and imaginary
 * part of (x + iy)^|m|; what is left of each radial polynomial is one in s = x² + y². So no angle
 * and no division by rho appears, and the derivatives at the origin are exact. */
#include "base/memory.h"
#include "reconstruct/surface/jet.h"
#include "reconstruct/surface/part.h"
#include "reconstruct/surface/zernike.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ORDER_MAX PLACIDO_ZERNIKE_ORDER_MAX
#define POWERS PLACIDO_ZERNIKE_POWERS

struct zernike {
  double scale;                             /* 1 / radius */
  int order;                                /* highest |m| with a coefficient */
  int counts[ORDER_MAX + 1];                /* of polynomials in s for each |m|; 0: none */
  double cosine[ORDER_MAX + 1][POWERS];     /* mm, with the norm, by |m| and the polynomial */
  double sine[ORDER_MAX + 1][POWERS];
  placido_zernike_step steps[ORDER_MAX + 1][POWERS];
};

static const placido_part_field fields[] = {
    {.name = "radius_mm",
     .offset = offsetof(placido_part, as.zernike.radius_mm),
     .range = PLACIDO_FIELD_POSITIVE},
};

static const char *const other_keys[] = {"coefficients_um", NULL};

static bool check(const placido_part *part, placido_complaint *complaint) {
  char field[48];
  for (int j = 0; j < PLACIDO_ZERNIKE_TERMS; j++) {
    if (!isfinite(part->as.zernike.coefficients_um[j])) {
      snprintf(field, sizeof field, "coefficients_um.%d", j);
      return placido_part_complain(complaint, field, "is not finite");
    }
  }
  if (part->as.zernike.radius_mm < 0.01) {
    return placido_part_complain(complaint, "radius_mm", "is %.9g mm, at least 0.01 mm is expected",
                                 part->as.zernike.radius_mm);
  }
  return true;
}

/* Adds coefficient (mm) times the term of order n and frequency m. */
static void add_term(struct zernike *z, int n, int m, double coefficient) {
  int frequency = abs(m), k = (n - frequency) / 2;
  double *list = m < 0 ? z->sine[frequency] : z->cosine[frequency];
  list[k] = coefficient * placido_zernike_norm(n, m);
  z->counts[frequency] = k + 1 > z->counts[frequency] ? k + 1 : z->counts[frequency];
  z->order = frequency > z->order ? frequency : z->order;
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  struct zernike *z = placido_memory_new(1, sizeof *z, err);
  *state = z;
  if (!z) {
    return PLACIDO_MEMORY;
  }
  z->scale = 1 / part->as.zernike.radius_mm;
  for (int m = 0; m <= ORDER_MAX; m++) {
    for (int k = 0; k < POWERS; k++) {
      z->steps[m][k] = placido_zernike_step_of(m, k);
    }
  }
  int j = 0;
  for (int n = 0; n <= ORDER_MAX; n++) {
    for (int m = -n; m <= n; m += 2, j++) {
      if (part->as.zernike.coefficients_um[j] != 0) {
        add_term(z, n, m, part->as.zernike.coefficients_um[j] * 1e-3);
      }
    }
  }
  return PLACIDO_OK;
}

/* Sums of the polynomials of one frequency with their first two derivatives by s. */
static void add_up(const struct zernike *z, int m, double s, double cosine[3], double sine[3]) {
  double now[3] = {1, 0, 0}, before[3] = {0, 0, 0};
  for (int k = 0; k < z->counts[m]; k++) {
    const placido_zernike_step step = z->steps[m][k];
    double factor = step.by_s * s + step.constant, next[3];
    for (int d = 0; d < 3; d++) {
      cosine[d] += z->cosine[m][k] * now[d];
      sine[d] += z->sine[m][k] * now[d];
      double raised = d > 0 ? d * step.by_s * now[d - 1] : 0;
      next[d] = factor * now[d] + raised - step.before * before[d];
    }
    memcpy(before, now, sizeof before);
    memcpy(now, next, sizeof now);
  }
}

/* Adds the product of a radial polynomial in s and a harmonic h: value, x- and y-derivatives, xx
 * and xy (a harmonic's yy is -xx). */
static void add_product(placido_jet *jet, double x, double y, const double p[3],
                        const double h[5]) {
  double px = 2 * x * p[1], py = 2 * y * p[1];
  double pxx = 2 * p[1] + 4 * x * x * p[2], pxy = 4 * x * y * p[2];
  double pyy = 2 * p[1] + 4 * y * y * p[2];
  jet->sag += p[0] * h[0];
  jet->sx += px * h[0] + p[0] * h[1];
  jet->sy += py * h[0] + p[0] * h[2];
  jet->sxx += pxx * h[0] + 2 * px * h[1] + p[0] * h[3];
  jet->sxy += pxy * h[0] + px * h[2] + py * h[1] + p[0] * h[4];
  jet->syy += pyy * h[0] + 2 * py * h[2] - p[0] * h[3];
}

static void add_frequency(const struct zernike *z, int m, double x, double y,
                          const double power[3][2], placido_jet *jet) {
  double radial_cosine[3] = {0}, radial_sine[3] = {0};
  double d = m, dd = (double)m * (m - 1);
  const double *now = power[2], *before = power[1], *first = power[0];
  const double cosine[5] = {now[0], d * before[0], -d * before[1], dd * first[0], -dd * first[1]};
  const double sine[5] = {now[1], d * before[1], d * before[0], dd * first[1], dd * first[0]};
  add_up(z, m, x * x + y * y, radial_cosine, radial_sine);
  add_product(jet, x, y, radial_cosine, cosine);
  add_product(jet, x, y, radial_sine, sine);
}

static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const struct zernike *z = state;
  double x = x_mm * z->scale, y = y_mm * z->scale;
  placido_jet unit = {0};
  double power[3][2] = {{0, 0}, {0, 0}, {1, 0}}; /* (x + iy)^(m-2), ^(m-1), ^m */
  for (int m = 0; m <= z->order; m++) {
    if (z->counts[m] > 0) {
      add_frequency(z, m, x, y, (const double(*)[2])power, &unit);
    }
    memmove(power[0], power[1], sizeof power - sizeof power[0]);
    power[2][0] = power[1][0] * x - power[1][1] * y;
    power[2][1] = power[1][0] * y + power[1][1] * x;
  }
  double k = z->scale;
  jet->sag += unit.sag;
  jet->sx += k * unit.sx;
  jet->sy += k * unit.sy;
  jet->sxx += k * k * unit.sxx;
  jet->sxy += k * k * unit.sxy;
  jet->syy += k * k * unit.syy;
  return true;
}

/* The OSA index that a key spells; false where it is none of ours. */
static bool parse_index(const char *key, int *index) {
  char *end;
  long value = strtol(key, &end, 10);
  *index = (int)value;
  return key[0] >= '0' && key[0] <= '9' && !*end && value < PLACIDO_ZERNIKE_TERMS;
}

static int read_coefficients(placido_part *part, void **storage, const placido_json *json,
                             const char *path, placido_error *err) {
  char place[160];
  (void)storage;
  snprintf(place, sizeof place, "%s.coefficients_um", path);
  json_t *object = placido_json_find(json, place);
  if (!json_is_object(object)) {
    return placido_json_refuse(json, place, err,
                               "missing or not an object {\"OSA index\": micrometres}");
  }
  const char *key;
  json_t *value;
  json_object_foreach(object, key, value) {
    int index;
    snprintf(place, sizeof place, "%s.coefficients_um.%.40s", path, key);
    if (!parse_index(key, &index)) {
      return placido_json_refuse(json, place, err, "not an OSA index from 0 to %d",
                                 PLACIDO_ZERNIKE_TERMS - 1);
    }
    int status = placido_json_number(json, place, &part->as.zernike.coefficients_um[index], err);
    if (status) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int write_coefficients(json_t *object, const placido_part *part) {
  json_t *list = json_object();
  int failed = json_object_set_new(object, "coefficients_um", list);
  for (int j = 0; j < PLACIDO_ZERNIKE_TERMS && !failed; j++) {
    char key[16];
    snprintf(key, sizeof key, "%d", j);
    if (part->as.zernike.coefficients_um[j] != 0) {
      failed =
          json_object_set_new(list, key, placido_json_real(part->as.zernike.coefficients_um[j]));
    }
  }
  return failed;
}

const placido_part_row placido_part_zernike = {
    .name = "zernike",
    .fields = fields,
    .field_count = sizeof fields / sizeof fields[0],
    .other_keys = other_keys,
    .check = check,
    .prepare = prepare,
    .release = placido_memory_free,
    .add = add,
    .read = read_coefficients,
    .write = write_coefficients,
};

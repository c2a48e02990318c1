/* Biconic: a conic of its own radius and asphericity along each of two perpendicular meridians.
 * Sag as in docs/formats.md; the derivatives are of f = n / (1 + w), n = c1 u² + c2 v²,
 * w² = 1 - (1 + q1) c1² u² - (1 + q2) c2² v². */
#include "base/dispatch.h"
#include "base/memory.h"
#include "reconstruct/surface/jet.h"
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stddef.h>

struct biconic {
  placido_turn turn;
  double cx, cy;
  double c1, c2; /* curvatures */
  double k1, k2; /* (1 + q) c² */
};

static const placido_part_field fields[] = {
    {.name = "r1", .offset = offsetof(placido_part, as.biconic.r1), .range = PLACIDO_FIELD_NONZERO},
    {.name = "q1", .offset = offsetof(placido_part, as.biconic.q1)},
    {.name = "r2",
     .offset = offsetof(placido_part, as.biconic.r2),
     .range = PLACIDO_FIELD_NONZERO,
     .optional = true,
     .fallback_offset = offsetof(placido_part, as.biconic.r1)},
    {.name = "q2",
     .offset = offsetof(placido_part, as.biconic.q2),
     .optional = true,
     .fallback_offset = offsetof(placido_part, as.biconic.q1)},
    {.name = "axis_deg", .offset = offsetof(placido_part, as.biconic.axis_deg), .optional = true},
    {.name = "cx", .offset = offsetof(placido_part, as.biconic.cx), .optional = true},
    {.name = "cy", .offset = offsetof(placido_part, as.biconic.cy), .optional = true},
};

/* Radii so small that their squared curvature leaves the range of numbers. */
static bool check(const placido_part *part, placido_complaint *complaint) {
  if (fabs(part->as.biconic.r1) < 0.01) {
    return placido_part_complain(complaint, "r1", "is %.9g mm, at least 0.01 mm is expected",
                                 part->as.biconic.r1);
  }
  if (fabs(part->as.biconic.r2) < 0.01) {
    return placido_part_complain(complaint, "r2", "is %.9g mm, at least 0.01 mm is expected",
                                 part->as.biconic.r2);
  }
  return true;
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  struct biconic *b = placido_memory_new(1, sizeof *b, err);
  *state = b;
  if (!b) {
    return PLACIDO_MEMORY;
  }
  double angle = part->as.biconic.axis_deg * PLACIDO_DEGREE;
  b->turn = (placido_turn){.c = cos(angle), .s = sin(angle)};
  b->cx = part->as.biconic.cx;
  b->cy = part->as.biconic.cy;
  b->c1 = 1 / part->as.biconic.r1;
  b->c2 = 1 / part->as.biconic.r2;
  b->k1 = (1 + part->as.biconic.q1) * b->c1 * b->c1;
  b->k2 = (1 + part->as.biconic.q2) * b->c2 * b->c2;
  return PLACIDO_OK;
}

static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const struct biconic *b = state;
  double x = x_mm - b->cx, y = y_mm - b->cy;
  double u = b->turn.c * x + b->turn.s * y, v = b->turn.c * y - b->turn.s * x;
  double root = 1 - b->k1 * u * u - b->k2 * v * v;
  if (!(root > 0)) {
    return false;
  }
  double w = sqrt(root), d = 1 / (1 + w);
  double n = b->c1 * u * u + b->c2 * v * v, nu = 2 * b->c1 * u, nv = 2 * b->c2 * v;
  double wu = -b->k1 * u / w, wv = -b->k2 * v / w;
  double wuu = -(b->k1 + wu * wu) / w, wuv = -wu * wv / w, wvv = -(b->k2 + wv * wv) / w;
  double f = n * d;
  double fu = d * (nu - f * wu), fv = d * (nv - f * wv);
  placido_jet uv = {.sag = f,
                    .sx = fu,
                    .sy = fv,
                    .sxx = d * (2 * b->c1 - 2 * fu * wu - f * wuu),
                    .sxy = d * (-fu * wv - fv * wu - f * wuv),
                    .syy = d * (2 * b->c2 - 2 * fv * wv - f * wvv)};
  placido_jet_add(jet, b->turn, &uv);
  return true;
}

/* The same for a line, without second derivatives. */
PLACIDO_WIDE
static void add_line(const void *state, const void *columns, const placido_line *line) {
  (void)columns;
  const struct biconic b = *(const struct biconic *)state;
  const double *restrict x_mm = line->x_mm;
  double *restrict sag = line->sag, *restrict sx = line->sx, *restrict sy = line->sy;
  double y = line->y_mm - b.cy;
  for (size_t i = 0; i < line->count; i++) {
    double x = x_mm[i] - b.cx;
    double u = b.turn.c * x + b.turn.s * y, v = b.turn.c * y - b.turn.s * x;
    double root = 1 - b.k1 * u * u - b.k2 * v * v;
    double w = root > 0 ? sqrt(root) : NAN, d = 1 / (w * (1 + w)); /* of both quotients */
    double f = (b.c1 * u * u + b.c2 * v * v) * w * d;
    double fu = d * u * (2 * b.c1 * w + f * b.k1), fv = d * v * (2 * b.c2 * w + f * b.k2);
    sag[i] += f;
    sx[i] += b.turn.c * fu - b.turn.s * fv;
    sy[i] += b.turn.s * fu + b.turn.c * fv;
  }
}

const placido_part_row placido_part_biconic = {
    .name = "biconic",
    .fields = fields,
    .field_count = sizeof fields / sizeof fields[0],
    .check = check,
    .prepare = prepare,
    .release = placido_memory_free,
    .add = add,
    .add_line = add_line,
};

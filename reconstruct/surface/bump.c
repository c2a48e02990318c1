/* Bump: an elliptic Gaussian cone that stands forward of the cornea, as in keratoconus. */
#include "base/memory.h"
#include "reconstruct/surface/jet.h"
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stddef.h>

struct bump {
  placido_turn turn;
  double x, y, height;
  double a, b; /* 1 / sigma² along u and v */
};

static const placido_part_field fields[] = {
    {.name = "height_mm", .offset = offsetof(placido_part, as.bump.height_mm)},
    {.name = "sigma_x_mm",
     .offset = offsetof(placido_part, as.bump.sigma_x_mm),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "sigma_y_mm",
     .offset = offsetof(placido_part, as.bump.sigma_y_mm),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "x_mm", .offset = offsetof(placido_part, as.bump.x_mm)},
    {.name = "y_mm", .offset = offsetof(placido_part, as.bump.y_mm)},
    {.name = "axis_deg", .offset = offsetof(placido_part, as.bump.axis_deg), .optional = true},
};

/* Widths so small that their inverse square leaves the range of numbers. */
static bool check(const placido_part *part, placido_complaint *complaint) {
  double x = part->as.bump.sigma_x_mm, y = part->as.bump.sigma_y_mm;
  if (x < 1e-3 || y < 1e-3) {
    return placido_part_complain(complaint, x < 1e-3 ? "sigma_x_mm" : "sigma_y_mm",
                                 "is %.9g mm, at least 0.001 mm is expected", x < 1e-3 ? x : y);
  }
  return true;
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  struct bump *b = placido_memory_new(1, sizeof *b, err);
  *state = b;
  if (!b) {
    return PLACIDO_MEMORY;
  }
  double angle = part->as.bump.axis_deg * PLACIDO_DEGREE;
  b->turn = (placido_turn){.c = cos(angle), .s = sin(angle)};
  b->x = part->as.bump.x_mm;
  b->y = part->as.bump.y_mm;
  b->height = part->as.bump.height_mm;
  b->a = 1 / (part->as.bump.sigma_x_mm * part->as.bump.sigma_x_mm);
  b->b = 1 / (part->as.bump.sigma_y_mm * part->as.bump.sigma_y_mm);
  return PLACIDO_OK;
}

static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const struct bump *b = state;
  double x = x_mm - b->x, y = y_mm - b->y;
  double u = b->turn.c * x + b->turn.s * y, v = b->turn.c * y - b->turn.s * x;
  double au = b->a * u, bv = b->b * v;
  double f = -b->height * exp(-0.5 * (au * u + bv * v));
  placido_jet uv = {.sag = f,
                    .sx = -f * au,
                    .sy = -f * bv,
                    .sxx = f * (au * au - b->a),
                    .sxy = f * au * bv,
                    .syy = f * (bv * bv - b->b)};
  placido_jet_add(jet, b->turn, &uv);
  return true;
}

const placido_part_row placido_part_bump = {
    .name = "bump",
    .fields = fields,
    .field_count = sizeof fields / sizeof fields[0],
    .check = check,
    .prepare = prepare,
    .release = placido_memory_free,
    .add = add,
};

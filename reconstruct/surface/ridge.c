/* Ridge: a smooth change of slope across a line, which doubles the image of one eye. */
#include "base/memory.h"
#include "reconstruct/surface/jet.h"
#include "reconstruct/surface/part.h"

#include <math.h>
#include <stddef.h>

struct ridge {
  double normal_x, normal_y; /* across the line */
  double slope, width, offset;
};

static const placido_part_field fields[] = {
    {.name = "slope", .offset = offsetof(placido_part, as.ridge.slope)},
    {.name = "width_mm",
     .offset = offsetof(placido_part, as.ridge.width_mm),
     .range = PLACIDO_FIELD_POSITIVE},
    {.name = "offset_mm", .offset = offsetof(placido_part, as.ridge.offset_mm)},
    {.name = "axis_deg", .offset = offsetof(placido_part, as.ridge.axis_deg), .optional = true},
};

/* A width so small that the second derivative leaves the range of numbers. */
static bool check(const placido_part *part, placido_complaint *complaint) {
  double width = part->as.ridge.width_mm;
  return width >= 1e-6 || placido_part_complain(complaint, "width_mm",
                                                "is %.9g mm, at least 1e-6 mm is expected", width);
}

static int prepare(void **state, placido_part *part, placido_error *err) {
  struct ridge *r = placido_memory_new(1, sizeof *r, err);
  *state = r;
  if (!r) {
    return PLACIDO_MEMORY;
  }
  double angle = part->as.ridge.axis_deg * PLACIDO_DEGREE;
  r->normal_x = -sin(angle);
  r->normal_y = cos(angle);
  r->slope = part->as.ridge.slope;
  r->width = part->as.ridge.width_mm;
  r->offset = part->as.ridge.offset_mm;
  return PLACIDO_OK;
}

/* With e = exp(-|t|) nothing overflows: ln(1 + exp t) = max(t, 0) + ln(1 + e). */
static bool add(const void *state, double x_mm, double y_mm, placido_jet *jet) {
  const struct ridge *r = state;
  double t = (r->normal_x * x_mm + r->normal_y * y_mm - r->offset) / r->width;
  double e = exp(-fabs(t));
  double first = r->slope * (t >= 0 ? 1 : e) / (1 + e);
  double second = r->slope * e / ((1 + e) * (1 + e) * r->width);
  jet->sag += r->slope * r->width * (fmax(t, 0) + log1p(e));
  jet->sx += first * r->normal_x;
  jet->sy += first * r->normal_y;
  jet->sxx += second * r->normal_x * r->normal_x;
  jet->sxy += second * r->normal_x * r->normal_y;
  jet->syy += second * r->normal_y * r->normal_y;
  return true;
}

const placido_part_row placido_part_ridge = {
    .name = "ridge",
    .fields = fields,
    .field_count = sizeof fields / sizeof fields[0],
    .check = check,
    .prepare = prepare,
    .release = placido_memory_free,
    .add = add,
};

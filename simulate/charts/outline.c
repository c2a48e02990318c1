/* Shapes bounded by straight lines and arcs, kept as edges along which x and y run one way. */
#include "simulate/charts/outline.h"

#include <math.h>

static const double cosines[8] = {1, M_SQRT1_2, 0, -M_SQRT1_2, -1, -M_SQRT1_2, 0, M_SQRT1_2};

/* Exact where the angle is a multiple of 45 degrees: letters fall on whole pixels. */
static double cos_deg(double angle) {
  double eighths = angle / 45;
  if (eighths == floor(eighths)) {
    return cosines[(int)(eighths - 8 * floor(eighths / 8))];
  }
  return cos(angle * M_PI / 180);
}

static double sin_deg(double angle) {
  return cos_deg(angle - 90);
}

placido_outline placido_outline_new(double x_px, double y_px, double px_per_unit, int eighths) {
  return (placido_outline){
    .origin = {x_px, y_px}, .px_per_unit = px_per_unit, .eighths = eighths};
}

static placido_corner place(const placido_outline *outline, double x, double y) {
  double c = cos_deg(45.0 * outline->eighths), s = sin_deg(45.0 * outline->eighths);
  return (placido_corner){outline->origin.x + outline->px_per_unit * (c * x + s * y),
                          outline->origin.y + outline->px_per_unit * (c * y - s * x)};
}

static void add(placido_outline *outline, placido_edge edge) {
  edge.from = outline->at;
  outline->at = edge.to;
  if (edge.from.y != edge.to.y && outline->count < PLACIDO_EDGES_MAX) {
    outline->edges[outline->count++] = edge; /* a level edge bounds no area */
  }
}

void placido_outline_move(placido_outline *outline, double x, double y) {
  outline->start = outline->at = place(outline, x, y);
}

void placido_outline_line(placido_outline *outline, double x, double y) {
  add(outline, (placido_edge){.to = place(outline, x, y)});
}

void placido_outline_close(placido_outline *outline) {
  add(outline, (placido_edge){.to = outline->start});
}

void placido_outline_polygon(placido_outline *outline, const placido_corner *corners, int count) {
  placido_outline_move(outline, corners[0].x, corners[0].y);
  for (int i = 1; i < count; i++) {
    placido_outline_line(outline, corners[i].x, corners[i].y);
  }
  placido_outline_close(outline);
}

/* Quarter by quarter. */
void placido_outline_arc(placido_outline *outline, double x, double y, double radius,
                         double from_deg, double to_deg) {
  placido_corner centre = place(outline, x, y);
  double r = radius * outline->px_per_unit, turn = 45.0 * outline->eighths;
  double from = from_deg + turn, to = to_deg + turn;
  placido_edge lead = {.to = {centre.x + r * cos_deg(from), centre.y - r * sin_deg(from)}};
  add(outline, lead);
  while (from != to) {
    double next = to > from ? fmin(to, 90 * (floor(from / 90) + 1))
                            : fmax(to, 90 * (ceil(from / 90) - 1));
    double middle = (from + next) / 2;
    placido_edge edge = {.to = {centre.x + r * cos_deg(next), centre.y - r * sin_deg(next)},
                         .centre = centre,
                         .radius = r,
                         .side_x = cos_deg(middle) > 0 ? 1 : -1,
                         .side_y = sin_deg(middle) > 0 ? -1 : 1};
    add(outline, edge);
    from = next;
  }
}

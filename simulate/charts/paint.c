/* Area coverage of convex polygons: cut with the pixel's four sides (Sutherland and Hodgman, CACM
 * 17 (1974) 32), then the shoelace formula. */
#include "simulate/charts/paint.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Every cut with a line adds at most one corner. */
typedef struct polygon {
  placido_corner corners[PLACIDO_CORNERS_MAX + 4];
  int count;
} polygon;

/* Signed distance of a corner from an upright or level line, positive on the side that is kept. */
static double kept_side(placido_corner c, bool upright, double at, double sign) {
  return sign * ((upright ? c.x : c.y) - at);
}

static polygon cut(const polygon *shape, bool upright, double at, double sign) {
  polygon rest = {.count = 0};
  for (int i = 0; i < shape->count; i++) {
    placido_corner a = shape->corners[i], b = shape->corners[(i + 1) % shape->count];
    double side_a = kept_side(a, upright, at, sign), side_b = kept_side(b, upright, at, sign);
    if (side_a >= 0) {
      rest.corners[rest.count++] = a;
    }
    if ((side_a > 0 && side_b < 0) || (side_a < 0 && side_b > 0)) {
      double share = side_a / (side_a - side_b);
      placido_corner crossing = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
      rest.corners[rest.count++] = crossing;
    }
  }
  return rest;
}

static double area(const polygon *shape) {
  double twice = 0;
  for (int i = 0; i < shape->count; i++) {
    placido_corner a = shape->corners[i], b = shape->corners[(i + 1) % shape->count];
    twice += a.x * b.y - b.x * a.y;
  }
  return fabs(twice) / 2;
}

/* The pixels from *first to *last that the shape reaches in x or y, of `size` there are. */
static void reach(const polygon *shape, bool in_x, int size, int *first, int *last) {
  double low = INFINITY, high = -INFINITY;
  for (int i = 0; i < shape->count; i++) {
    double at = in_x ? shape->corners[i].x : shape->corners[i].y;
    low = fmin(low, at);
    high = fmax(high, at);
  }
  *first = (int)fmax(floor(low), 0);
  *last = (int)fmin(ceil(high), size) - 1;
}

static void paint_row(placido_image *image, const polygon *shape, int y) {
  polygon below = cut(shape, false, y, 1);
  polygon slice = cut(&below, false, y + 1, -1);
  int first, last;
  if (slice.count < 3) {
    return;
  }
  reach(&slice, true, image->width_px, &first, &last);
  float *row = &image->data[(size_t)y * (size_t)image->width_px];
  for (int x = first; x <= last; x++) {
    polygon right = cut(&slice, true, x, 1);
    polygon piece = cut(&right, true, x + 1, -1);
    row[x] = fmaxf(row[x] - (float)area(&piece), 0);
  }
}

void placido_paint_polygon(placido_image *image, double arcmin_per_px,
                           const placido_corner *corners, int count) {
  polygon shape = {.count = count};
  for (int i = 0; i < count; i++) {
    shape.corners[i] = (placido_corner){corners[i].x / arcmin_per_px, corners[i].y / arcmin_per_px};
  }
  int first, last;
  reach(&shape, false, image->height_px, &first, &last);
  for (int y = first; y <= last; y++) {
    paint_row(image, &shape, y);
  }
}

void placido_paint_rectangle(placido_image *image, double arcmin_per_px, double left, double top,
                             double width, double height) {
  placido_corner corners[4] = {
    {left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}};
  placido_paint_polygon(image, arcmin_per_px, corners, 4);
}

static const struct {
  char character;
  const char *cells; /* rows of three */
} glyphs[] = {
  {'0', "#### ## ## ####"}, {'1', " # ##  #  # ###"}, {'2', "###  #####  ###"},
  {'4', "# ## ####  #  #"}, {'6', "####  #### ####"}, {'8', "#### ##### ####"},
  {'/', "  #  # # #  #  "},
};

static void paint_glyph(placido_image *image, double arcmin_per_px, double left, double top,
                        double cell, const char *cells) {
  for (int i = 0; i < 15; i++) {
    if (cells[i] == '#') {
      placido_paint_rectangle(image, arcmin_per_px, left + i % 3 * cell, top + i / 3 * cell, cell,
                              cell);
    }
  }
}

void placido_paint_text(placido_image *image, double arcmin_per_px, double left, double top,
                        double cell_arcmin, const char *text) {
  for (; *text != '\0'; text++, left += 4 * cell_arcmin) {
    for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++) {
      if (glyphs[i].character == *text) {
        paint_glyph(image, arcmin_per_px, left, top, cell_arcmin, glyphs[i].cells);
      }
    }
  }
}

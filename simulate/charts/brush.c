/* Coloured shapes over one another, by area coverage. */
#include "simulate/charts/brush.h"

#include "base/random.h"
#include "simulate/charts/sloan.h"

#include <string.h>

static placido_outline outline_at(const placido_brush *brush) {
  return placido_outline_new(0, 0, 1 / brush->arcmin_per_px, 0);
}

static void fill(const placido_brush *brush, const placido_outline *outline,
                 placido_colour colour) {
  const float planes[3] = {colour.red, colour.green, colour.blue};
  placido_outline_fill(brush->image, outline, planes);
}

void placido_brush_polygon(const placido_brush *brush, const placido_corner *corners, int count,
                           placido_colour colour) {
  placido_outline outline = outline_at(brush);
  placido_outline_polygon(&outline, corners, count);
  fill(brush, &outline, colour);
}

void placido_brush_rectangle(const placido_brush *brush, double left, double top, double width,
                             double height, placido_colour colour) {
  const placido_corner corners[4] = {
    {left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}};
  placido_brush_polygon(brush, corners, 4, colour);
}

void placido_brush_disc(const placido_brush *brush, double x, double y, double radius,
                        placido_colour colour) {
  placido_outline outline = outline_at(brush);
  placido_outline_move(&outline, x + radius, y);
  placido_outline_arc(&outline, x, y, radius, 0, 360);
  fill(brush, &outline, colour);
}

void placido_brush_write(const placido_brush *brush, double left, double top, double height,
                         const char *text, placido_colour colour) {
  const char *all = "CDHKNORSVZ";
  for (; *text != '\0'; text++, left += 1.5 * height) {
    const char *letter = strchr(all, *text);
    if (letter != NULL) {
      placido_outline outline = placido_outline_new((left + height / 2) / brush->arcmin_per_px,
                                                    (top + height / 2) / brush->arcmin_per_px,
                                                    height / 5 / brush->arcmin_per_px, 0);
      placido_sloan_outline(&outline, (int)(letter - all));
      fill(brush, &outline, colour);
    }
  }
}

placido_colour placido_colour_times(placido_colour colour, double factor) {
  float f = (float)factor;
  return (placido_colour){colour.red * f, colour.green * f, colour.blue * f};
}

double placido_brush_chance(unsigned seed, unsigned index) {
  return placido_random_uniform(seed, 0, index, 0, 1);
}

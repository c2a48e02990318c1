/* A street at night: lit windows, lamps, a car with its headlights on. White is a lit wall of about
 * 3 cd/m²; a low beam of 10,000 cd/m² is thousands of times brighter. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

static const placido_colour night = {0.002f, 0.003f, 0.008f}, wall = {0.020f, 0.018f, 0.020f},
                            road = {0.015f, 0.015f, 0.016f}, paint = {0.25f, 0.25f, 0.24f},
                            lit = {1.4f, 0.9f, 0.4f}, lamp = {900, 600, 250},
                            beam = {3300, 3200, 2900}, tail = {60, 2, 1},
                            body = {0.004f, 0.004f, 0.006f}, post = {0.006f, 0.006f, 0.006f};

/* Two rows of houses; one window in three is lit. */
static void build_houses(const placido_brush *brush) {
  for (int side = 0; side < 2; side++) {
    double left = side == 0 ? 0 : 240;
    placido_brush_rectangle(brush, left, 40, 124, 140, wall);
    for (unsigned i = 0; i < 24; i++) {
      if (placido_brush_chance(11 + (unsigned)side, i) < 0.34) {
        placido_brush_rectangle(brush, left + 10 + i % 6 * 19, 52 + i / 6 * 30, 9, 16,
                                placido_colour_times(lit, 0.3 + placido_brush_chance(13, i)));
      }
    }
  }
}

/* The middle line runs to the horizon. */
static void lay_road(const placido_brush *brush) {
  const placido_corner surface[] = {{172, 150}, {192, 150}, {400, 274}, {-40, 274}};
  placido_brush_polygon(brush, surface, 4, road);
  for (int i = 0; i < 5; i++) {
    double top = 156 + 5.0 * i * (i + 1), height = 3 + 3.0 * i, width = 0.6 + 0.7 * i;
    placido_brush_rectangle(brush, 182 - width / 2, top, width, height, paint);
  }
}

static void set_lamp(const placido_brush *brush, double x, double top, double bottom) {
  placido_brush_rectangle(brush, x - 0.8, top, 1.6, bottom - top, post);
  placido_brush_disc(brush, x, top, 2.5, lamp);
}

static void park_car(const placido_brush *brush, double left, double bottom, double width,
                     placido_colour light) {
  const double height = 0.75 * width, radius = 0.07 * width;
  const placido_corner shape[] = {{left, bottom},
                                  {left, bottom - 0.45 * height},
                                  {left + 0.2 * width, bottom - height},
                                  {left + 0.8 * width, bottom - height},
                                  {left + width, bottom - 0.45 * height},
                                  {left + width, bottom}};
  placido_brush_polygon(brush, shape, 6, body);
  placido_brush_disc(brush, left + 0.16 * width, bottom - 0.35 * height, radius, light);
  placido_brush_disc(brush, left + 0.84 * width, bottom - 0.35 * height, radius, light);
}

void placido_draw_street(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                         const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  (void)lines;
  placido_brush_rectangle(&brush, 0, 0, chart->width_arcmin + 4, chart->height_arcmin + 4, night);
  placido_brush_rectangle(&brush, 0, 180, chart->width_arcmin + 4, 100, wall);
  build_houses(&brush);
  lay_road(&brush);
  placido_brush_rectangle(&brush, 262, 96, 60, 14, placido_colour_times(lit, 0.6));
  placido_brush_write(&brush, 267, 99, 8, "ROCK", (placido_colour){0.02f, 0.01f, 0.01f});
  set_lamp(&brush, 128, 70, 200);
  set_lamp(&brush, 236, 70, 200);
  set_lamp(&brush, 160, 118, 160);
  park_car(&brush, 120, 215, 36, beam);
  park_car(&brush, 196, 190, 22, tail);
}

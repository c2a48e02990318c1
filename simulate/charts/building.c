/* A brick house by day: fine courses, window bars, a railing and a sign, 6 by 4.5 degrees. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

static const placido_colour sky = {0.42f, 0.58f, 0.86f}, mortar = {0.40f, 0.37f, 0.33f},
                            brick = {0.30f, 0.11f, 0.07f}, stone = {0.52f, 0.49f, 0.42f},
                            frame = {0.78f, 0.78f, 0.74f}, glass = {0.05f, 0.07f, 0.09f},
                            curtain = {0.48f, 0.44f, 0.36f}, door = {0.03f, 0.10f, 0.06f},
                            slate = {0.09f, 0.10f, 0.12f}, iron = {0.02f, 0.02f, 0.02f},
                            pavement = {0.27f, 0.26f, 0.25f}, leaves = {0.05f, 0.13f, 0.03f},
                            trunk = {0.07f, 0.05f, 0.03f};

static const double wall_left = 60, wall_top = 62, wall_width = 250, wall_bottom = 238;

/* Running bond: every course half a brick further. */
static void lay_bricks(const placido_brush *brush) {
  const double width = 10, height = 3.2, joint = 0.6;
  unsigned count = 0;
  placido_brush_rectangle(brush, wall_left, wall_top, wall_width, wall_bottom - wall_top, mortar);
  for (int course = 0; wall_top + course * (height + joint) + height <= wall_bottom; course++) {
    double top = wall_top + course * (height + joint);
    double left = wall_left - (course % 2 == 1 ? width / 2 : 0);
    for (; left < wall_left + wall_width; left += width + joint) {
      double from = left > wall_left ? left : wall_left, right = left + width;
      right = right < wall_left + wall_width ? right : wall_left + wall_width;
      placido_colour laid =
        placido_colour_times(brick, 0.75 + 0.5 * placido_brush_chance(1, count++));
      placido_brush_rectangle(brush, from, top, right - from, height, laid);
    }
  }
}

/* A frame around four panes; curtains in some. */
static void hang_window(const placido_brush *brush, double left, double top, bool curtained) {
  const double width = 30, height = 44, bar = 1.2, rim = 2.4;
  placido_brush_rectangle(brush, left - 3, top - 6, width + 6, 6, stone);
  placido_brush_rectangle(brush, left - 4, top + height, width + 8, 4, stone);
  placido_brush_rectangle(brush, left, top, width, height, frame);
  placido_brush_rectangle(brush, left + rim, top + rim, width - 2 * rim, height - 2 * rim, glass);
  if (curtained) {
    placido_brush_rectangle(brush, left + rim, top + rim, 7, height - 2 * rim, curtain);
    placido_brush_rectangle(brush, left + width - rim - 7, top + rim, 7, height - 2 * rim, curtain);
  }
  placido_brush_rectangle(brush, left + width / 2 - bar / 2, top, bar, height, frame);
  placido_brush_rectangle(brush, left, top + height * 0.42, width, bar, frame);
}

static void hang_windows(const placido_brush *brush) {
  for (int i = 0; i < 8; i++) {
    bool ground = i >= 4;
    if (i != 6) { /* there is the door */
      hang_window(brush, wall_left + 20 + i % 4 * 60, wall_top + (ground ? 112 : 24),
                  placido_brush_chance(2, (unsigned)i) > 0.5);
    }
  }
}

static void set_door(const placido_brush *brush) {
  const double left = wall_left + 136, top = wall_bottom - 72;
  placido_brush_rectangle(brush, left - 4, top - 5, 46, 77, stone);
  placido_brush_rectangle(brush, left, top, 38, 72, door);
  placido_brush_rectangle(brush, left + 4, top + 4, 30, 12, glass);
  placido_brush_disc(brush, left + 33, top + 40, 1.5, (placido_colour){0.6f, 0.45f, 0.1f});
}

static void set_sign(const placido_brush *brush) {
  const double left = wall_left + 66, top = wall_top + 78;
  placido_brush_rectangle(brush, left, top, 127, 18, (placido_colour){0.02f, 0.03f, 0.12f});
  placido_brush_write(brush, left + 6, top + 4, 10, "ZOO DOCK", frame);
}

static void set_roof(const placido_brush *brush) {
  const placido_corner corners[] = {{wall_left - 10, wall_top},
                                    {wall_left + 24, wall_top - 40},
                                    {wall_left + wall_width - 24, wall_top - 40},
                                    {wall_left + wall_width + 10, wall_top}};
  placido_brush_rectangle(brush, wall_left + 200, wall_top - 54, 18, 40, brick);
  placido_brush_polygon(brush, corners, 4, slate);
  placido_brush_rectangle(brush, wall_left - 6, wall_top, wall_width + 12, 5, stone);
}

/* Bars 1' wide and 3' apart: the first thing that blur takes. */
static void set_railing(const placido_brush *brush) {
  placido_brush_rectangle(brush, 0, 226, 56, 1.5, iron);
  for (int i = 0; i < 14; i++) {
    placido_brush_rectangle(brush, 2 + 4 * i, 222, 1, 24, iron);
  }
}

static void plant_tree(const placido_brush *brush) {
  placido_brush_rectangle(brush, 325, 170, 7, 76, trunk);
  for (unsigned i = 0; i < 90; i++) {
    double x = 300 + 48 * placido_brush_chance(3, i), y = 90 + 90 * placido_brush_chance(4, i);
    placido_brush_disc(brush, x, y, 4 + 6 * placido_brush_chance(5, i),
                       placido_colour_times(leaves, 0.5 + placido_brush_chance(6, i)));
  }
}

void placido_draw_building(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                           const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  (void)lines;
  placido_brush_rectangle(&brush, 0, 0, chart->width_arcmin + 4, chart->height_arcmin + 4, sky);
  placido_brush_rectangle(&brush, 0, wall_bottom, chart->width_arcmin + 4, 60, pavement);
  lay_bricks(&brush);
  set_roof(&brush);
  hang_windows(&brush);
  set_door(&brush);
  set_sign(&brush);
  set_railing(&brush);
  plant_tree(&brush);
}

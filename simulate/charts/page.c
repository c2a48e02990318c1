/* A page held at 33 cm in front of a window, 8 by 6 degrees: letters of 1 mm, the room's wall and
 * the window's bars at 3 m, and beyond them trees and houses too far to measure. The page leans
 * back by 45 degrees. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static const placido_colour paper = {0.80f, 0.78f, 0.72f}, ink = {0.025f, 0.025f, 0.03f},
                            rule = {0.50f, 0.06f, 0.05f}, wall = {0.33f, 0.26f, 0.19f},
                            bars = {0.62f, 0.60f, 0.55f}, shade = {0.40f, 0.38f, 0.34f},
                            meadow = {0.16f, 0.27f, 0.07f}, hill = {0.20f, 0.29f, 0.25f},
                            leaves = {0.06f, 0.15f, 0.03f}, trunk = {0.08f, 0.05f, 0.03f},
                            plaster = {0.72f, 0.62f, 0.46f}, brick = {0.38f, 0.14f, 0.09f},
                            tiles = {0.33f, 0.10f, 0.06f}, slate = {0.10f, 0.11f, 0.13f},
                            glass = {0.07f, 0.10f, 0.14f}, iron = {0.03f, 0.03f, 0.03f};

/* A part of the picture, minutes of arc. */
typedef struct area {
  double left, top, right, bottom;
} area;

static const area page = {96, 168, 388, 400}, opening = {44, 22, 436, 300};
static const double bar_arcmin = 9, horizon_arcmin = 176;
static const double page_D = 1 / 0.33, lean_D = 0.1, room_D = 1 / 3.0;

static bool holds(const area *part, double x, double y) {
  return x >= part->left && x < part->right && y >= part->top && y < part->bottom;
}

static void fill(const placido_brush *brush, const area *part, placido_colour colour) {
  placido_brush_rectangle(brush, part->left, part->top, part->right - part->left,
                          part->bottom - part->top, colour);
}

/* One upright and one cross bar of the window's frame. */
static void find_bars(area found[2]) {
  double middle = (opening.left + opening.right) / 2, half = bar_arcmin / 2;
  double cross = opening.top + 0.23 * (opening.bottom - opening.top);
  found[0] = (area){middle - half, opening.top, middle + half, opening.bottom};
  found[1] = (area){opening.left, cross - half, opening.right, cross + half};
}

double placido_page_vergence_D(double x_arcmin, double y_arcmin) {
  area between[2];
  find_bars(between);
  if (holds(&page, x_arcmin, y_arcmin)) {
    double middle = (page.top + 360) / 2, half = (360 - page.top) / 2;
    return page_D + lean_D * (y_arcmin - middle) / half;
  }
  bool outside = holds(&opening, x_arcmin, y_arcmin) && !holds(&between[0], x_arcmin, y_arcmin) &&
                 !holds(&between[1], x_arcmin, y_arcmin);
  return outside ? 0 : room_D;
}

/* Paler towards the horizon; clouds are flat below. */
static void spread_sky(const placido_brush *brush) {
  const double clouds[3][3] = {{88, 66, 1}, {190, 104, 0.7}, {352, 58, 1.1}}; /* x, y, size */
  for (int i = 0; i < 80; i++) {
    float down = (float)i / 80, top = (float)opening.top + (float)i * 2;
    placido_colour sky = {0.30f + 0.55f * down, 0.52f + 0.38f * down, 0.94f};
    placido_brush_rectangle(brush, 0, top, 484, 200, sky);
  }
  for (int k = 0; k < 3; k++) {
    for (unsigned i = 0; i < 7; i++) {
      double chance = placido_brush_chance(51 + (unsigned)k, i);
      double high = (3.5 - fabs(i - 3.0) + chance) * clouds[k][2];
      placido_brush_disc(brush, clouds[k][0] + (i - 3.0) * 7 * clouds[k][2],
                         clouds[k][1] - 1.3 * high, 2 * high + 1,
                         (placido_colour){0.96f, 0.96f, 0.97f});
    }
  }
}

static void raise_hills(const placido_brush *brush) {
  const placido_corner ridge[] = {{0, 180}, {0, 152}, {60, 140}, {130, 150}, {210, 134},
                                  {300, 150}, {370, 138}, {480, 156}, {480, 180}};
  placido_brush_polygon(brush, ridge, 9, hill);
  placido_brush_rectangle(brush, 0, horizon_arcmin - 8, 480, 200, meadow);
}

/* A fence of pales 1.2' wide, and furrows that come nearer. */
static void lay_field(const placido_brush *brush) {
  for (int i = 0; i < 8; i++) {
    double top = horizon_arcmin + 14 + 1.6 * i * (i + 3);
    placido_brush_rectangle(brush, 0, top, 484, 1.5 + 0.8 * i, placido_colour_times(meadow, 0.8));
  }
  placido_brush_rectangle(brush, 0, horizon_arcmin + 2, 484, 1, trunk);
  for (int i = 0; i < 120; i++) {
    placido_brush_rectangle(brush, 2 + 4.0 * i, horizon_arcmin - 1, 1.2, 9, trunk);
  }
}

/* Walls, a gabled roof with a chimney, and windows in rows. */
static void build_house(const placido_brush *brush, double left, double width, double height,
                        placido_colour walls, placido_colour roof) {
  const double top = horizon_arcmin - height, gable = 0.42 * width;
  const placido_corner slopes[] = {{left - 2, top}, {left + width / 2, top - gable},
                                   {left + width + 2, top}};
  placido_brush_rectangle(brush, left + 0.68 * width, top - gable, 0.1 * width, gable, brick);
  placido_brush_rectangle(brush, left, top, width, height, walls);
  placido_brush_polygon(brush, slopes, 3, roof);
  for (int i = 0; i < 6; i++) {
    double x = left + width * (0.12 + 0.29 * (i % 3)), y = top + height * (0.16 + 0.42 * (i / 3));
    placido_brush_rectangle(brush, x, y, 0.18 * width, 0.26 * height, bars);
    placido_brush_rectangle(brush, x + 0.8, y + 0.8, 0.18 * width - 1.6, 0.26 * height - 1.6,
                            glass);
    placido_brush_rectangle(brush, x + 0.09 * width - 0.4, y, 0.8, 0.26 * height, bars);
  }
}

/* A spire with a cross: bars of 1'. */
static void build_church(const placido_brush *brush, double left) {
  const placido_corner spire[] = {{left - 1, 128}, {left + 9, 104}, {left + 19, 128}};
  placido_brush_rectangle(brush, left, 128, 18, horizon_arcmin - 128, plaster);
  placido_brush_polygon(brush, spire, 3, slate);
  placido_brush_rectangle(brush, left + 8.5, 94, 1, 12, iron);
  placido_brush_rectangle(brush, left + 6, 97, 6, 1, iron);
  placido_brush_disc(brush, left + 9, 137, 4.5, bars);
  placido_brush_disc(brush, left + 9, 137, 3.5, glass);
}

static void plant_tree(const placido_brush *brush, double x, double height, unsigned seed) {
  placido_brush_rectangle(brush, x - 1.5, horizon_arcmin - 0.4 * height, 3, 0.4 * height + 4,
                          trunk);
  for (unsigned i = 0; i < 60; i++) {
    double turn = 2 * acos(-1) * placido_brush_chance(seed, i);
    double far = sqrt(placido_brush_chance(seed + 1, i)) * 0.3 * height;
    placido_brush_disc(brush, x + 0.8 * far * cos(turn),
                       horizon_arcmin - 0.64 * height + far * sin(turn),
                       1.5 + 0.06 * height * placido_brush_chance(seed + 2, i),
                       placido_colour_times(leaves, 0.6 + 1.3 * placido_brush_chance(seed + 3, i)));
  }
}

/* The wall around the opening, its frame and its bars. */
static void build_window(const placido_brush *brush) {
  const double rim = 7;
  const area walls[4] = {{0, 0, 484, opening.top}, {0, 0, opening.left, 364},
                         {opening.right, 0, 484, 364}, {0, opening.bottom, 484, 364}};
  const area frame[4] = {
    {opening.left - rim, opening.top - rim, opening.right + rim, opening.top},
    {opening.left - rim, opening.top, opening.left, opening.bottom},
    {opening.right, opening.top, opening.right + rim, opening.bottom},
    {opening.left - 2 * rim, opening.bottom, opening.right + 2 * rim, opening.bottom + rim}};
  area between[2];
  find_bars(between);
  for (int i = 0; i < 4; i++) {
    fill(brush, &walls[i], wall);
    for (double x = 8; x < 484; x += 24) { /* its paper has stripes */
      double left = fmax(x, walls[i].left), right = fmin(x + 10, walls[i].right);
      if (right > left) {
        fill(brush, &(area){left, walls[i].top, right, walls[i].bottom},
             placido_colour_times(wall, 0.86));
      }
    }
  }
  for (int i = 0; i < 4; i++) {
    fill(brush, &frame[i], bars);
  }
  for (int i = 0; i < 2; i++) {
    fill(brush, &between[i], bars);
    fill(brush, &(area){between[i].left, between[i].bottom - 1.5, between[i].right,
                        between[i].bottom}, shade);
  }
}

/* A headline, a red rule and lines of print; letters of 10' are 0.96 mm at 33 cm. */
static void print_page(const placido_brush *brush) {
  static const char *const rows[] = {
    "OCH DORN KRO ZOND", "SCHRON DO VOR ZONK", "KOCH VON NORD ROH", "ZO HORCHS DOCH KO",
    "VOR DRNO SCHON ZK", "NORK HOCH ROD SONC", "DON SORK ZOCH VORN"};
  fill(brush, &page, paper);
  placido_brush_write(brush, page.left + 16, page.top + 16, 15, "NORD ZOO OCH", ink);
  placido_brush_rectangle(brush, page.left + 16, page.top + 41, 260, 1.5, rule);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    placido_brush_write(brush, page.left + 16, page.top + 54 + 20 * (double)i, 10, rows[i], ink);
  }
}

void placido_draw_page(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                       const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  (void)chart;
  (void)lines;
  spread_sky(&brush);
  raise_hills(&brush);
  lay_field(&brush);
  build_church(&brush, 292);
  build_house(&brush, 66, 54, 40, plaster, tiles);
  build_house(&brush, 140, 46, 52, brick, slate);
  build_house(&brush, 340, 60, 38, plaster, slate);
  plant_tree(&brush, 128, 52, 61);
  plant_tree(&brush, 214, 84, 66);
  plant_tree(&brush, 268, 46, 71);
  plant_tree(&brush, 416, 70, 76);
  build_window(&brush);
  print_page(&brush);
}

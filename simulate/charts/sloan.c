/* The ten letters of Louise Sloan (Am J Ophthalmol 48 (1959) 807; NAS-NRC Committee on Vision,
 * Adv Ophthalmol 41 (1980) 103): 5 strokes high and wide, no serifs, curves of circles.
 *
 * A diagonal is one stroke wide across, like everything else. In N it runs from corner to corner,
 * which makes it 5/4 wide along the top; Z is N on its side. */
#include "simulate/charts/sloan.h"

#include <math.h>

/* From the square's top left corner, as the tables below count. */
static void add_polygon(placido_outline *outline, const placido_corner *corners, int count) {
  placido_outline_move(outline, corners[0].x - 2.5, corners[0].y - 2.5);
  for (int i = 1; i < count; i++) {
    placido_outline_line(outline, corners[i].x - 2.5, corners[i].y - 2.5);
  }
  placido_outline_close(outline);
}

void placido_ring_outline(placido_outline *outline, bool gap) {
  const double degrees = 180 / M_PI;
  double outer = gap ? asin(0.5 / 2.5) * degrees : 0, inner = gap ? asin(0.5 / 1.5) * degrees : 0;
  placido_outline_move(outline, 2.5 * cos(outer / degrees), gap ? -0.5 : 0);
  placido_outline_arc(outline, 0, 0, 2.5, outer, 360 - outer);
  if (!gap) {
    placido_outline_move(outline, 1.5, 0);
  }
  placido_outline_arc(outline, 0, 0, 1.5, 360 - inner, inner);
  placido_outline_close(outline);
}

static void draw_c(placido_outline *outline) {
  placido_ring_outline(outline, true);
}

static void draw_o(placido_outline *outline) {
  placido_ring_outline(outline, false);
}

/* A bar with a half ring: the outside, then the hole. */
static void draw_d(placido_outline *outline) {
  placido_outline_move(outline, -2.5, -2.5);
  placido_outline_arc(outline, 0, 0, 2.5, 90, -90);
  placido_outline_line(outline, -2.5, 2.5);
  placido_outline_close(outline);
  placido_outline_move(outline, -1.5, 1.5);
  placido_outline_arc(outline, 0, 0, 1.5, -90, 90);
  placido_outline_line(outline, -1.5, -1.5);
  placido_outline_close(outline);
}

static void draw_h(placido_outline *outline) {
  static const placido_corner corners[] = {{0, 0}, {1, 0}, {1, 2}, {4, 2}, {4, 0}, {5, 0},
                                           {5, 5}, {4, 5}, {4, 3}, {1, 3}, {1, 5}, {0, 5}};
  add_polygon(outline, corners, 12);
}

/* The arm runs at 45 degrees from the upper right into the stem, the leg leaves it at a right angle
 * and ends at the lower right. */
static void draw_k(placido_outline *outline) {
  const double width = M_SQRT2; /* of such a stroke along the level */
  const placido_corner corners[] = {
    {0, 0}, {1, 0},         {1, 4 - width},   {5 - width, 0},
    {5, 0}, {2.5, 2.5},     {5, 5},           {5 - width, 5},
    {2.5 - width / 2, 2.5 + width / 2}, {1, 4}, {1, 5}, {0, 5}};
  add_polygon(outline, corners, 12);
}

static void draw_n(placido_outline *outline) {
  static const placido_corner corners[] = {{0, 0}, {1.25, 0}, {4, 11 / 3.0}, {4, 0}, {5, 0},
                                           {5, 5}, {3.75, 5}, {1, 4 / 3.0},  {1, 5}, {0, 5}};
  add_polygon(outline, corners, 10);
}

/* The leg falls 4 for 3 to the right, from the end of the bowl's straight part to the corner. */
static void draw_r(placido_outline *outline) {
  placido_outline_move(outline, -2.5, -2.5);
  placido_outline_arc(outline, 1, -1, 1.5, 90, -90);
  placido_outline_line(outline, 2.5, 2.5);
  placido_outline_line(outline, 1.25, 2.5);
  placido_outline_line(outline, -0.25, 0.5);
  placido_outline_line(outline, -1.5, 0.5);
  placido_outline_line(outline, -1.5, 2.5);
  placido_outline_line(outline, -2.5, 2.5);
  placido_outline_close(outline);
  placido_outline_move(outline, -1.5, -0.5);
  placido_outline_arc(outline, 1, -1, 0.5, -90, 90);
  placido_outline_line(outline, -1.5, -1.5);
  placido_outline_close(outline);
}

/* Four turns of rings 3 wide; the ends are cut level. Its lower half is the upper one turned. */
static void draw_s(placido_outline *outline) {
  placido_outline_move(outline, 2.5, -1);
  placido_outline_arc(outline, 1, -1, 1.5, 0, 90);
  placido_outline_arc(outline, -1, -1, 1.5, 90, 270);
  placido_outline_arc(outline, 1, 1, 0.5, 90, -90);
  placido_outline_arc(outline, -1, 1, 0.5, -90, -180);
  placido_outline_line(outline, -2.5, 1);
  placido_outline_arc(outline, -1, 1, 1.5, 180, 270);
  placido_outline_arc(outline, 1, 1, 1.5, -90, 90);
  placido_outline_arc(outline, -1, -1, 0.5, 270, 90);
  placido_outline_arc(outline, 1, -1, 0.5, 90, 0);
  placido_outline_close(outline);
}

/* The strokes meet in a foot one stroke wide. */
static void draw_v(placido_outline *outline) {
  const double width = sqrt(29) / 5; /* of strokes that fall 5 for 2, along the level */
  const placido_corner corners[] = {{0, 0}, {width, 0}, {2.5, 2.5 * (2.5 - width)}, {5 - width, 0},
                                    {5, 0}, {3, 5},     {2, 5}};
  add_polygon(outline, corners, 7);
}

static void draw_z(placido_outline *outline) {
  static const placido_corner corners[] = {{0, 0}, {5, 0}, {5, 1.25}, {4 / 3.0, 4},  {5, 4},
                                           {5, 5}, {0, 5}, {0, 3.75}, {11 / 3.0, 1}, {0, 1}};
  add_polygon(outline, corners, 10);
}

void placido_sloan_outline(placido_outline *outline, int which) {
  static void (*const letters[PLACIDO_SLOAN_LETTERS])(placido_outline *) = {
    draw_c, draw_d, draw_h, draw_k, draw_n, draw_o, draw_r, draw_s, draw_v, draw_z};
  letters[which](outline);
}

/* Lines of equal light through a PSF, each bucket's middle a corner of the mesh: marching squares
 * (Lorensen and Cline, SIGGRAPH 1987, in the plane), ambiguous squares cut by their mean. */
#include "report/psf_view.h"

#include "report/palette.h"

#include <stdio.h>

enum { LEVELS = 5 };

static const double text_px = 18;

/* Of the peak. */
static const double levels[LEVELS] = {0.5, 0.2, 0.1, 0.01, 0.001};

/* A square of the mesh on the canvas. */
typedef struct cell {
  double x, y, side; /* lower left corner, px */
  double corner[4];  /* lower left, lower right, upper right, upper left */
} cell;

/* Where the level crosses the side from corner `a` to the next. */
static void cross(const cell *c, double level, int a, double *x, double *y) {
  static const double right[4] = {0, 1, 1, 0}, up[4] = {0, 0, 1, 1};
  int b = (a + 1) % 4;
  double t = (level - c->corner[a]) / (c->corner[b] - c->corner[a]);
  *x = c->x + c->side * (right[a] + t * (right[b] - right[a]));
  *y = c->y - c->side * (up[a] + t * (up[b] - up[a]));
}

static void draw_cell(const placido_canvas *canvas, const cell *c, double level) {
  int sides[4], count = 0;
  for (int a = 0; a < 4; a++) {
    if ((c->corner[a] >= level) != (c->corner[(a + 1) % 4] >= level)) {
      sides[count++] = a;
    }
  }
  double mean = 0.25 * (c->corner[0] + c->corner[1] + c->corner[2] + c->corner[3]);
  int first = count == 4 && (mean >= level) != (c->corner[0] >= level) ? 1 : 0;
  for (int k = 0; k + 1 < count; k += 2) { /* four crossings: about corners 1 and 3, or 2, 0 */
    double x, y;
    cross(c, level, sides[(first + k) % count], &x, &y);
    cairo_move_to(canvas->cr, x, y);
    cross(c, level, sides[(first + k + 1) % count], &x, &y);
    cairo_line_to(canvas->cr, x, y);
  }
}

static void draw_level(const placido_psf_view *view, const placido_canvas *canvas, double left,
                       double top, double side, double level) {
  double pitch = side / (2 * view->half + 1);
  for (int up = -view->half; up < view->half; up++) {
    for (int right = -view->half; right < view->half; right++) {
      const cell c = {.x = left + (right + view->half + 0.5) * pitch,
                      .y = top + side - (up + view->half + 0.5) * pitch,
                      .side = pitch,
                      .corner = {placido_psf_view_at(view, right, up),
                                 placido_psf_view_at(view, right + 1, up),
                                 placido_psf_view_at(view, right + 1, up + 1),
                                 placido_psf_view_at(view, right, up + 1)}};
      draw_cell(canvas, &c, level);
    }
  }
  cairo_stroke(canvas->cr);
}

static void set_line(const placido_canvas *canvas, int k) {
  placido_canvas_ink(canvas, placido_palette_sequential(1 - 0.62 * k / (LEVELS - 1)));
  cairo_set_line_width(canvas->cr, 3.4 - 0.6 * k);
}

static void draw_legend(const placido_canvas *canvas, double left, double top) {
  for (int k = 0; k < LEVELS; k++, top += 26) {
    set_line(canvas, k);
    placido_canvas_line(canvas, left, top, left + 40, top);
    cairo_set_source_rgb(canvas->cr, 0, 0, 0);
    placido_canvas_print(canvas, left + 48, top, text_px, PLACIDO_LEFT, "%g", levels[k]);
  }
}

void placido_psf_contour_draw(const placido_psf_view *view, const placido_canvas *canvas,
                              double left, double top, double side) {
  cairo_t *cr = canvas->cr;
  double bar_arcmin = placido_psf_view_tick(2 * view->half_arcmin, 5);
  char text[32];
  cairo_save(cr);
  cairo_rectangle(cr, left, top, side, side);
  cairo_clip(cr);
  for (int k = LEVELS - 1; k >= 0; k--) {
    set_line(canvas, k);
    draw_level(view, canvas, left, top, side, levels[k] * view->peak);
  }
  cairo_restore(cr);
  draw_legend(canvas, left + side + 20, top + 46);
  cairo_set_source_rgb(cr, 0, 0, 0);
  placido_canvas_text(canvas, left + side + 20, top + 14, text_px, PLACIDO_LEFT, false,
                      "of the peak");
  cairo_set_line_width(cr, 1.2);
  cairo_rectangle(cr, left, top, side, side);
  cairo_stroke(cr);
  snprintf(text, sizeof text, "%g arcmin", bar_arcmin);
  placido_canvas_scale_bar(canvas, left + side + 20, top + side - 14,
                           side * bar_arcmin / (2 * view->half_arcmin), text_px, text);
}

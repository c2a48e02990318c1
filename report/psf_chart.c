/* Curves in a frame. Colours are Okabe and Ito's (2008), which all common deficiencies of colour
 * vision tell apart; dashes do where a printer has no colour. */
#include "report/psf_chart.h"

#include "report/psf_view.h"

#include <math.h>

enum { TEXT = 18 };

static const double room_left = 64, room_below = 62, room_above = 34;

static const struct {
  placido_rgb ink;
  double dashes[4];
  int dash_count;
} styles[PLACIDO_CHART_CURVES_MAX] = {
  {{0, 0, 0}, {0}, 0},
  {{0, 0.447, 0.698}, {10, 4}, 2},
  {{0.835, 0.369, 0}, {3, 3}, 2},
  {{0, 0.62, 0.451}, {12, 4, 3, 4}, 4},
  {{0.8, 0.475, 0.655}, {18, 5}, 2},
};

/* The frame in the canvas. */
typedef struct frame {
  const placido_chart *chart;
  const placido_canvas *canvas;
  double left, right, top, bottom;
} frame;

static double to_x(const frame *f, double x) {
  return f->left + (x - f->chart->first) / (f->chart->last - f->chart->first) *
                     (f->right - f->left);
}

static double to_y(const frame *f, double y) {
  return f->bottom - y / f->chart->high * (f->bottom - f->top);
}

static const placido_rgb black = {0, 0, 0}, faint = {0.85, 0.85, 0.85};

static void draw_ticks(const frame *f) {
  const placido_chart *chart = f->chart;
  double step_x = placido_psf_view_tick(chart->last - chart->first, 6);
  double step_y = placido_psf_view_tick(chart->high, 5);
  cairo_set_line_width(f->canvas->cr, 1);
  for (double x = ceil(chart->first / step_x - 1e-9) * step_x; x <= chart->last + 1e-9 * step_x;
       x += step_x) {
    double value = fabs(x) < 1e-9 * step_x ? 0 : x;
    placido_canvas_ink(f->canvas, faint);
    placido_canvas_line(f->canvas, to_x(f, x), f->top, to_x(f, x), f->bottom);
    placido_canvas_ink(f->canvas, black);
    placido_canvas_print(f->canvas, to_x(f, x), f->bottom + 16, TEXT, PLACIDO_CENTRE, "%s%g",
                         value < 0 ? "−" : "", fabs(value));
  }
  for (double y = 0; y <= chart->high + 1e-9 * step_y; y += step_y) {
    placido_canvas_ink(f->canvas, faint);
    placido_canvas_line(f->canvas, f->left, to_y(f, y), f->right, to_y(f, y));
    placido_canvas_ink(f->canvas, black);
    placido_canvas_print(f->canvas, f->left - 8, to_y(f, y), TEXT, PLACIDO_RIGHT, "%g", y);
  }
}

static void set_style(const frame *f, int index) {
  placido_canvas_ink(f->canvas, styles[index].ink);
  cairo_set_line_width(f->canvas->cr, index == 0 ? 2.6 : 2);
  cairo_set_dash(f->canvas->cr, styles[index].dashes, styles[index].dash_count, 0);
}

static void draw_curve(const frame *f, int index) {
  const placido_chart_curve *curve = &f->chart->curves[index];
  cairo_t *cr = f->canvas->cr;
  bool drawing = false;
  cairo_save(cr);
  cairo_rectangle(cr, f->left, f->top - 2, f->right - f->left, f->bottom - f->top + 4);
  cairo_clip(cr);
  set_style(f, index);
  for (int k = 0; k < curve->count; k++) {
    bool known = isfinite(curve->y[k]);
    if (known && drawing) {
      cairo_line_to(cr, to_x(f, curve->x[k]), to_y(f, curve->y[k]));
    } else if (known) {
      cairo_move_to(cr, to_x(f, curve->x[k]), to_y(f, curve->y[k]));
    }
    drawing = known;
  }
  cairo_stroke(cr);
  cairo_restore(cr);
}

/* Names on white, at the right, one below the other. */
static void draw_legend(const frame *f) {
  double x = f->right - 172, y = f->top + 18;
  cairo_t *cr = f->canvas->cr;
  int named = 0;
  for (int i = 0; i < f->chart->count; i++) {
    named += f->chart->curves[i].name != NULL;
  }
  if (named < 2) {
    return;
  }
  cairo_set_source_rgba(cr, 1, 1, 1, 0.85);
  cairo_rectangle(cr, x - 8, f->top + 4, 176, 23 * named + 6);
  cairo_fill(cr);
  for (int i = 0; i < f->chart->count; i++, y += 23) {
    cairo_save(cr);
    set_style(f, i);
    placido_canvas_line(f->canvas, x, y, x + 44, y);
    cairo_restore(cr);
    placido_canvas_ink(f->canvas, black);
    placido_canvas_text(f->canvas, x + 52, y, TEXT, PLACIDO_LEFT, false,
                        f->chart->curves[i].name);
  }
}

void placido_chart_draw(const placido_chart *chart, const placido_canvas *canvas, double left,
                        double top, double width, double height) {
  frame f = {.chart = chart, .canvas = canvas, .left = left + room_left, .right = left + width - 12,
             .top = top + room_above, .bottom = top + height - room_below};
  placido_canvas_ink(canvas, black);
  placido_canvas_text(canvas, f.left, top + 14, TEXT, PLACIDO_LEFT, false, chart->title);
  draw_ticks(&f);
  for (int i = 0; i < chart->count; i++) {
    draw_curve(&f, i);
  }
  placido_canvas_ink(canvas, black);
  cairo_set_dash(canvas->cr, NULL, 0, 0);
  cairo_set_line_width(canvas->cr, 1.2);
  cairo_rectangle(canvas->cr, f.left, f.top, f.right - f.left, f.bottom - f.top);
  cairo_stroke(canvas->cr);
  draw_legend(&f);
  placido_canvas_text(canvas, 0.5 * (f.left + f.right), f.bottom + 42, TEXT, PLACIDO_CENTRE, false,
                      chart->x_name);
}

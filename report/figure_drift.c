/* How the daily checks on a ball went: power and shape over time, so that a slow drift is seen
 * before it reaches the limit. */
#include "report/report.h"

#include "report/canvas.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

enum { WIDTH = 1000, LEFT = 90, RIGHT = 970, TEXT = 16 };
#define DAY_S 86400.0
#define HEADROOM 1.25 /* of the axis over the limit or the farthest point */

static const double pi = 3.14159265358979323846;

/* Okabe and Ito (2008): blue, orange and bluish green, each with a mark of its own form. */
static const placido_rgb inks[3] = {{0, 0.447, 0.698}, {0.902, 0.624, 0}, {0, 0.62, 0.451}};
static const placido_rgb grey = {0.45, 0.45, 0.45}, black = {0, 0, 0}, red = {0.835, 0.369, 0};
static const char *const zones[3] = {"inner zone", "middle zone", "outer zone"};

/* A panel: its place on the canvas and what it shows. */
typedef struct panel {
  const placido_canvas *canvas;
  double top, bottom;   /* px */
  double first, last;   /* seconds, left and right */
  double low, high;     /* of the values */
} panel;

static double to_x(const panel *p, double t_s) {
  return LEFT + 20 + (t_s - p->first) / (p->last - p->first) * (RIGHT - LEFT - 40);
}

static double to_y(const panel *p, double value) {
  double share = (value - p->low) / (p->high - p->low);
  return p->bottom - fmin(fmax(share, 0), 1) * (p->bottom - p->top);
}

/* A filled circle, square or triangle; a failed check has a ring around it. */
static void draw_mark(const panel *p, double t_s, double value, int form, bool passed) {
  cairo_t *cr = p->canvas->cr;
  if (!isfinite(value)) {
    return;
  }
  double x = to_x(p, t_s), y = to_y(p, value), r = 4;
  placido_canvas_ink(p->canvas, inks[form]);
  placido_canvas_mark(p->canvas, x, y, r, form);
  if (!passed) {
    placido_canvas_ink(p->canvas, red);
    cairo_set_line_width(cr, 1.5);
    cairo_new_sub_path(cr);
    cairo_arc(cr, x, y, 2.2 * r, 0, 2 * pi);
    cairo_stroke(cr);
  }
}

/* The greatest of 1, 2 and 5 times a power of ten that divides `span` in at least four. */
static double choose_step(double span) {
  double step = pow(10, floor(log10(span / 4)));
  return step * 5 <= span / 4 ? 5 * step : step * 2 <= span / 4 ? 2 * step : step;
}

static void draw_frame(const panel *p, const char *title) {
  const placido_canvas *canvas = p->canvas;
  double step = choose_step(p->high - p->low);
  placido_canvas_ink(canvas, black);
  placido_canvas_text(canvas, LEFT, p->top - TEXT, TEXT, PLACIDO_LEFT, false, title);
  cairo_set_line_width(canvas->cr, 1);
  for (double v = ceil(p->low / step) * step; v <= p->high + 1e-9 * step; v += step) {
    int decimals = step < 0.1 ? 2 : step < 1 ? 1 : 0;
    placido_canvas_ink(canvas, (placido_rgb){0.88, 0.88, 0.88});
    placido_canvas_line(canvas, LEFT, to_y(p, v), RIGHT, to_y(p, v));
    placido_canvas_ink(canvas, black);
    placido_canvas_print(canvas, LEFT - 8, to_y(p, v), TEXT * 0.85, PLACIDO_RIGHT, "%.*f",
                         decimals, fabs(v) < 1e-9 ? 0.0 : v);
  }
  placido_canvas_ink(canvas, black);
  cairo_rectangle(canvas->cr, LEFT, p->top, RIGHT - LEFT, p->bottom - p->top);
  cairo_stroke(canvas->cr);
}

/* Dates below the panel: of whole days where there are days, else the time too. */
static void draw_dates(const panel *p) {
  double span = p->last - p->first;
  for (int i = 0; i <= 4; i++) {
    double t_s = p->first + span * i / 4;
    const time_t t = (time_t)t_s;
    struct tm utc;
    char text[32];
    if (gmtime_r(&t, &utc) &&
        strftime(text, sizeof text, span < 4 * DAY_S ? "%m-%d %H:%M" : "%Y-%m-%d", &utc)) {
      placido_canvas_ink(p->canvas, black);
      placido_canvas_line(p->canvas, to_x(p, t_s), p->bottom, to_x(p, t_s), p->bottom + 5);
      placido_canvas_text(p->canvas, to_x(p, t_s), p->bottom + 5 + TEXT, TEXT * 0.85,
                          PLACIDO_CENTRE, false, text);
    }
  }
}

/* A limit as steps through the checks: each had its own. */
static void draw_limit(const panel *p, const placido_drift_point *points, size_t count,
                       bool shape, double sign) {
  cairo_t *cr = p->canvas->cr;
  const double dashes[] = {8, 5};
  placido_canvas_ink(p->canvas, grey);
  cairo_set_line_width(cr, 2);
  cairo_set_dash(cr, dashes, 2, 0);
  double before = sign * (shape ? points[0].limit_um : points[0].limit_D);
  cairo_move_to(cr, LEFT, to_y(p, before));
  for (size_t i = 1; i < count; i++) {
    double limit = sign * (shape ? points[i].limit_um : points[i].limit_D);
    cairo_line_to(cr, to_x(p, points[i].t_s), to_y(p, before));
    cairo_line_to(cr, to_x(p, points[i].t_s), to_y(p, limit));
    before = limit;
  }
  cairo_line_to(cr, RIGHT, to_y(p, before));
  cairo_stroke(cr);
  cairo_set_dash(cr, NULL, 0, 0);
}

/* The value that a panel must reach: limits and points. */
static double reach_of(const placido_drift_point *points, size_t count, bool shape) {
  double reach = 0;
  for (size_t i = 0; i < count; i++) {
    const placido_drift_point *p = &points[i];
    reach = fmax(reach, shape ? p->limit_um : p->limit_D);
    for (int k = 0; k < 3 && !shape; k++) {
      reach = fmax(reach, fabs(p->power_D[k]));
    }
    reach = shape ? fmax(reach, p->shape_um) : reach;
  }
  return HEADROOM * (reach > 0 ? reach : 1);
}

static void draw_power(panel *p, const placido_drift_point *points, size_t count) {
  p->high = reach_of(points, count, false);
  p->low = -p->high;
  draw_frame(p, "Error of axial power (D)");
  draw_limit(p, points, count, false, 1);
  draw_limit(p, points, count, false, -1);
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++) {
      draw_mark(p, points[i].t_s, points[i].power_D[k], k, points[i].passed);
    }
  }
  panel legend = *p; /* marks at places of the canvas rather than of the axes */
  legend.low = 0;
  legend.high = 1;
  for (int k = 0; k < 3; k++) {
    double x = RIGHT - 360 + 120 * k;
    double t_s = p->first + (x - 12 - LEFT - 20) / (RIGHT - LEFT - 40) * (p->last - p->first);
    legend.top = p->top - TEXT - 1;
    legend.bottom = p->top - TEXT + 1;
    draw_mark(&legend, t_s, 0.5, k, true);
    placido_canvas_ink(p->canvas, black);
    placido_canvas_text(p->canvas, x, p->top - TEXT, TEXT * 0.85, PLACIDO_LEFT, false, zones[k]);
  }
}

static void draw_shape(panel *p, const placido_drift_point *points, size_t count) {
  p->low = 0;
  p->high = reach_of(points, count, true);
  draw_frame(p, "Deviation from the ball within 8 mm (µm rms)");
  draw_limit(p, points, count, true, 1);
  for (size_t i = 0; i < count; i++) {
    draw_mark(p, points[i].t_s, points[i].shape_um, 0, points[i].passed);
  }
  draw_dates(p);
  placido_canvas_ink(p->canvas, grey);
  placido_canvas_text(p->canvas, LEFT, p->bottom + 5 + 2.6 * TEXT, TEXT * 0.85, PLACIDO_LEFT,
                      false, "dashed: limits; a ring: a check that failed; times are UTC");
}

int placido_figure_drift(const placido_drift_point *points, size_t count, const char *path,
                         placido_error *err) {
  if (count == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "there is no check to draw");
  }
  placido_canvas canvas;
  int status = placido_canvas_new(&canvas, WIDTH, 640, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  panel p = {.canvas = &canvas, .first = points[0].t_s, .last = points[0].t_s};
  for (size_t i = 1; i < count; i++) {
    p.first = fmin(p.first, points[i].t_s);
    p.last = fmax(p.last, points[i].t_s);
  }
  if (p.last - p.first < 60) { /* a single check stands in the middle of a day */
    p.first -= DAY_S / 2;
    p.last += DAY_S / 2;
  }
  p.top = 50;
  p.bottom = 310;
  draw_power(&p, points, count);
  p.top = 370;
  p.bottom = 560;
  draw_shape(&p, points, count);
  status = placido_canvas_save(&canvas, path, err);
  placido_canvas_free(&canvas);
  return status;
}

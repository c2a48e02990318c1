/* The figure of error against time: every setting a point, the efficient ones joined by the stairs
 * below which nothing that was measured lies. */
#include "report/pareto.h"

#include "report/canvas.h"
#include "report/number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1000, LEFT = 110, RIGHT = 970, TOP = 70, BOTTOM = 590 };
enum { KEY = BOTTOM + 102, ROW = 19, NEAR = 14 }; /* what the numbers mean, a row each */

static const double text_px = 18, label_px = 13;
static const placido_rgb black = {0, 0, 0}, grey = {0.55, 0.55, 0.55}, pale = {0.9, 0.9, 0.9},
                         blue = {0, 0.27, 0.55}, orange = {0.8, 0.35, 0};

/* What the axes span, decades. */
typedef struct frame {
  const placido_canvas *canvas;
  double first, last, low, high;
} frame;

/* Times with their places, to be sorted. */
typedef struct ranked {
  double ms, error;
  size_t index;
} ranked;

static int compare(const void *a, const void *b) {
  const ranked *p = a, *q = b;
  if (p->ms != q->ms) {
    return p->ms < q->ms ? -1 : 1;
  }
  return (p->error > q->error) - (p->error < q->error);
}

static size_t count_of(const placido_pareto *pareto) {
  return pareto->count < PLACIDO_PARETO_POINTS_MAX ? pareto->count : PLACIDO_PARETO_POINTS_MAX;
}

size_t placido_pareto_front(size_t *front, const placido_pareto *pareto) {
  ranked all[PLACIDO_PARETO_POINTS_MAX];
  size_t count = count_of(pareto), found = 0;
  double least = INFINITY;
  for (size_t i = 0; i < count; i++) {
    all[i] = (ranked){pareto->points[i].ms, pareto->points[i].error, i};
  }
  qsort(all, count, sizeof *all, compare);
  for (size_t i = 0; i < count; i++) {
    if (all[i].error < least) {
      least = all[i].error;
      front[found++] = all[i].index;
    }
  }
  return found;
}

static double to_x(const frame *f, double ms) {
  return LEFT + (log10(ms) - f->first) / (f->last - f->first) * (RIGHT - LEFT);
}

static double to_y(const frame *f, double error) {
  double decade = error > 0 ? fmax(log10(error), f->low) : f->low;
  return BOTTOM - (decade - f->low) / (f->high - f->low) * (BOTTOM - TOP);
}

/* Room for a number, with a margin on both sides. */
static void widen(double *low, double *high, double value) {
  if (value > 0 && isfinite(value)) {
    *low = fmin(*low, log10(value) - 0.15);
    *high = fmax(*high, log10(value) + 0.15);
  }
}

static bool frame_find(frame *f, const placido_pareto *pareto) {
  f->first = f->low = INFINITY;
  f->last = f->high = -INFINITY;
  for (size_t i = 0; i < count_of(pareto); i++) {
    widen(&f->first, &f->last, pareto->points[i].ms);
    widen(&f->low, &f->high, pareto->points[i].error);
  }
  widen(&f->low, &f->high, pareto->floor);
  if (!isfinite(f->low)) { /* no error at all: a decade for the eye */
    f->low = -1;
    f->high = 0;
  }
  double lacks = 0.5 * (1 - (f->last - f->first)); /* never less than a decade of time */
  if (lacks > 0) {
    f->first -= lacks;
    f->last += lacks;
  }
  return isfinite(f->first);
}

/* One tick: a line of the grid, and its number where it is 1, 2 or 5 of a decade. */
static void draw_tick(const frame *f, bool is_time, double value, int digit) {
  const placido_canvas *canvas = f->canvas;
  double at = is_time ? to_x(f, value) : to_y(f, value);
  placido_canvas_ink(canvas, pale);
  cairo_set_line_width(canvas->cr, digit == 1 ? 1.6 : 0.8);
  if (is_time) {
    placido_canvas_line(canvas, at, TOP, at, BOTTOM);
  } else {
    placido_canvas_line(canvas, LEFT, at, RIGHT, at);
  }
  placido_canvas_ink(canvas, black);
  if (digit == 1 || digit == 2 || digit == 5) {
    if (is_time) {
      placido_canvas_print(canvas, at, BOTTOM + 16, 0.8 * text_px, PLACIDO_CENTRE, "%.4g", value);
    } else {
      placido_canvas_print(canvas, LEFT - 8, at, 0.8 * text_px, PLACIDO_RIGHT, "%.4g", value);
    }
  }
}

/* Over more than four decades only whole ones are numbered. */
static void draw_ticks(const frame *f, bool is_time, double from, double to) {
  for (int decade = (int)floor(from); decade <= (int)ceil(to); decade++) {
    for (int digit = 1; digit < 10; digit++) {
      double value = digit * pow(10, decade), place = log10(value);
      if (place >= from && place <= to && (digit == 1 || to - from <= 4)) {
        draw_tick(f, is_time, value, digit);
      }
    }
  }
}

static void draw_axes(const frame *f, const placido_pareto *pareto) {
  const placido_canvas *canvas = f->canvas;
  draw_ticks(f, true, f->first, f->last);
  draw_ticks(f, false, f->low, f->high);
  cairo_set_line_width(canvas->cr, 1.2);
  cairo_rectangle(canvas->cr, LEFT, TOP, RIGHT - LEFT, BOTTOM - TOP);
  cairo_stroke(canvas->cr);
  placido_canvas_text(canvas, LEFT, 24, 1.15 * text_px, PLACIDO_LEFT, false, pareto->title);
  placido_canvas_text(canvas, LEFT, 50, 0.85 * text_px, PLACIDO_LEFT, false, pareto->error_name);
  placido_canvas_text(canvas, 0.5 * (LEFT + RIGHT), BOTTOM + 44, text_px, PLACIDO_CENTRE, false,
                      "processor time, ms");
  placido_canvas_ink(canvas, blue);
  placido_canvas_mark(canvas, LEFT + 6, BOTTOM + 72, 6, 0);
  placido_canvas_ink(canvas, grey);
  placido_canvas_mark(canvas, LEFT + 166, BOTTOM + 72, 4, 1);
  placido_canvas_ink(canvas, black);
  placido_canvas_text(canvas, LEFT + 20, BOTTOM + 72, 0.8 * text_px, PLACIDO_LEFT, false,
                      "efficient settings");
  placido_canvas_text(canvas, LEFT + 180, BOTTOM + 72, 0.8 * text_px, PLACIDO_LEFT, false,
                      "others: slower and no better; each the worst of all eyes");
}

static void draw_floor(const frame *f, double floor) {
  const double dashes[] = {9, 6};
  cairo_t *cr = f->canvas->cr;
  if (!(floor > 0)) {
    return;
  }
  placido_canvas_ink(f->canvas, orange);
  cairo_set_line_width(cr, 2);
  cairo_set_dash(cr, dashes, 2, 0);
  placido_canvas_line(f->canvas, LEFT, to_y(f, floor), RIGHT, to_y(f, floor));
  cairo_set_dash(cr, NULL, 0, 0);
  placido_canvas_text(f->canvas, LEFT + 8, to_y(f, floor) - 11, label_px, PLACIDO_LEFT, true,
                      "what measuring leaves, whatever the settings");
}

static void draw_stairs(const frame *f, const placido_pareto *pareto, const size_t *front,
                        size_t count) {
  cairo_t *cr = f->canvas->cr;
  placido_canvas_ink(f->canvas, blue);
  cairo_set_line_width(cr, 2);
  for (size_t i = 0; i < count; i++) {
    const placido_pareto_point *p = &pareto->points[front[i]];
    if (i == 0) {
      cairo_move_to(cr, to_x(f, p->ms), TOP);
    } else {
      cairo_line_to(cr, to_x(f, p->ms), to_y(f, pareto->points[front[i - 1]].error));
    }
    cairo_line_to(cr, to_x(f, p->ms), to_y(f, p->error));
  }
  if (count > 0) {
    cairo_line_to(cr, RIGHT, to_y(f, pareto->points[front[count - 1]].error));
  }
  cairo_stroke(cr);
}

/* The efficient points' numbers beside them where there is room, and what they stand for below. */
static void draw_key(const frame *f, const placido_pareto *pareto, const size_t *front,
                     size_t count) {
  double last_x = -INFINITY, last_y = -INFINITY;
  char number[PLACIDO_NUMBER_SIZE];
  placido_canvas_ink(f->canvas, black);
  for (size_t i = 0; i < count; i++) {
    const placido_pareto_point *p = &pareto->points[front[i]];
    double x = to_x(f, p->ms), y = to_y(f, p->error), row = KEY + (double)i * ROW;
    if (hypot(x - last_x, y - last_y) > NEAR || i + 1 == count) {
      snprintf(number, sizeof number, "%zu", i + 1);
      placido_canvas_text(f->canvas, x + 9, y - 10, label_px, PLACIDO_LEFT, true, number);
      last_x = x;
      last_y = y;
    }
    placido_canvas_print(f->canvas, LEFT + 24, row, label_px, PLACIDO_RIGHT, "%zu", i + 1);
    placido_number_significant(number, sizeof number, p->ms, 2);
    placido_canvas_print(f->canvas, LEFT + 100, row, label_px, PLACIDO_RIGHT, "%s ms", number);
    placido_number_significant(number, sizeof number, p->error, 2);
    placido_canvas_print(f->canvas, LEFT + 190, row, label_px, PLACIDO_RIGHT, "%s", number);
    placido_canvas_text(f->canvas, LEFT + 210, row, label_px, PLACIDO_LEFT, false, p->setting);
  }
}

static void draw(const placido_canvas *canvas, const void *context) {
  const placido_pareto *pareto = context;
  size_t front[PLACIDO_PARETO_POINTS_MAX], count = placido_pareto_front(front, pareto);
  frame f = {.canvas = canvas};
  frame_find(&f, pareto);
  draw_axes(&f, pareto);
  draw_floor(&f, pareto->floor);
  placido_canvas_ink(canvas, grey);
  for (size_t i = 0; i < count_of(pareto); i++) {
    placido_canvas_mark(canvas, to_x(&f, pareto->points[i].ms), to_y(&f, pareto->points[i].error),
                        4, 1);
  }
  draw_stairs(&f, pareto, front, count);
  for (size_t i = 0; i < count; i++) {
    const placido_pareto_point *p = &pareto->points[front[i]];
    placido_canvas_mark(canvas, to_x(&f, p->ms), to_y(&f, p->error), 6, 0);
  }
  draw_key(&f, pareto, front, count);
}

int placido_figure_pareto(const placido_pareto *pareto, const char *path, placido_error *err) {
  frame f = {0};
  size_t front[PLACIDO_PARETO_POINTS_MAX];
  int height = KEY + ROW * (int)placido_pareto_front(front, pareto);
  if (pareto->count == 0 || !frame_find(&f, pareto)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: there is no setting to draw",
                             pareto->title);
  }
  size_t length = strlen(path);
  if (length > 4 && strcmp(path + length - 4, ".svg") == 0) {
    return placido_canvas_vector(WIDTH, height, draw, pareto, path, err);
  }
  placido_canvas canvas;
  int status = placido_canvas_new(&canvas, WIDTH, height, err);
  if (status == PLACIDO_OK) {
    draw(&canvas, pareto);
    status = placido_canvas_save(&canvas, path, err);
    placido_canvas_free(&canvas);
  }
  return status;
}

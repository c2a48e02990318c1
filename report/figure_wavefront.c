/* A wavefront as maps over the pupil, whole and without what a spectacle lens can correct, and its
 * Zernike terms as bars with their error bars. */
#include "report/report.h"

#include "base/memory.h"
#include "report/number.h"
#include "report/scale.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { WIDTH = 1360, HEIGHT = 520, DISC = 300, TOP = 118, BARS_LEFT = 830, BARS_RIGHT = 1335 };
enum { COARSE = 101, ORDER_SHOWN = 6, FIRST_TERM = 3 };

static const double pi = 3.14159265358979323846;
static const double text_px = 18, small_px = 15;
static const placido_rgb black = {0, 0, 0}, faint = {0.86, 0.86, 0.86}, blue = {0, 0.447, 0.698};

/* The wavefront of the terms from one order on, on a square grid over the pupil, rows upwards. */
typedef struct shape {
  double um[COARSE * COARSE];
} shape;

static void fill_row(shape *s, const placido_wavefront *w, int first, int row, double *terms) {
  double x[COARSE], y[COARSE];
  for (int i = 0; i < COARSE; i++) {
    x[i] = 2.0 * i / (COARSE - 1) - 1;
    y[i] = 2.0 * row / (COARSE - 1) - 1;
  }
  placido_zernike_terms(terms, w->order, x, y, COARSE);
  for (int i = 0; i < COARSE; i++) {
    double *um = &s->um[row * COARSE + i];
    *um = 0;
    for (int j = first; j < w->term_count; j++) {
      *um += w->coefficients_um[j] * terms[j * COARSE + i];
    }
  }
}

static int fill_shape(shape *s, const placido_wavefront *w, int first, placido_error *err) {
  double *terms = placido_memory_new((size_t)w->term_count * COARSE, sizeof *terms, err);
  if (terms == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int row = 0; row < COARSE; row++) {
    fill_row(s, w, first, row, terms);
  }
  placido_memory_free(terms);
  return PLACIDO_OK;
}

/* Bilinear; u and v from 0 to 1. */
static double shape_at(const shape *s, double u, double v) {
  double x = u * (COARSE - 1), y = v * (COARSE - 1);
  int i = (int)fmin(x, COARSE - 2), j = (int)fmin(y, COARSE - 2);
  double a = x - i, b = y - j;
  const double *low = &s->um[j * COARSE + i], *high = low + COARSE;
  return (1 - b) * ((1 - a) * low[0] + a * low[1]) + b * ((1 - a) * high[0] + a * high[1]);
}

/* Largest size of the shape within the disc. */
static double reach_of(const shape *s) {
  double reach = 0;
  for (int j = 0; j < COARSE; j++) {
    for (int i = 0; i < COARSE; i++) {
      double x = 2.0 * i / (COARSE - 1) - 1, y = 2.0 * j / (COARSE - 1) - 1;
      reach = x * x + y * y <= 1 ? fmax(reach, fabs(s->um[j * COARSE + i])) : reach;
    }
  }
  return reach;
}

/* As many steps of a round size on either side of zero as hold the reach. */
static placido_scale make_scale(double reach) {
  placido_scale half = placido_scale_from_zero(reach);
  int classes = 2 * half.classes + 1 < PLACIDO_CLASSES_MAX ? 2 * half.classes + 1
                                                          : PLACIDO_CLASSES_MAX;
  return (placido_scale){-0.5 * classes * half.step, half.step, classes, true};
}

static uint32_t pack(placido_rgb colour) {
  return 0xff000000u | (uint32_t)lround(255 * colour.r) << 16 |
         (uint32_t)lround(255 * colour.g) << 8 | (uint32_t)lround(255 * colour.b);
}

static int draw_disc(const placido_canvas *canvas, const shape *s, const placido_scale *scale,
                     double left, const char *title, placido_error *err) {
  cairo_surface_t *picture;
  int status = placido_canvas_picture(&picture, DISC, DISC, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  unsigned char *data = cairo_image_surface_get_data(picture);
  size_t stride = (size_t)cairo_image_surface_get_stride(picture);
  for (int j = 0; j < DISC; j++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)j * stride);
    for (int i = 0; i < DISC; i++) {
      double u = (i + 0.5) / DISC, v = 1 - (j + 0.5) / DISC;
      bool inside = hypot(2 * u - 1, 2 * v - 1) <= 1;
      row[i] = inside ? pack(placido_scale_colour(scale, placido_scale_class(scale,
                                                                            shape_at(s, u, v))))
                      : 0;
    }
  }
  cairo_surface_mark_dirty(picture);
  cairo_set_source_surface(canvas->cr, picture, left, TOP);
  cairo_paint(canvas->cr);
  cairo_surface_destroy(picture);
  placido_canvas_ink(canvas, black);
  cairo_set_line_width(canvas->cr, 1.5);
  cairo_arc(canvas->cr, left + DISC / 2.0, TOP + DISC / 2.0, DISC / 2.0, 0, 2 * pi);
  cairo_stroke(canvas->cr);
  placido_canvas_text(canvas, left + DISC / 2.0, TOP - 22, text_px, PLACIDO_CENTRE, false, title);
  return PLACIDO_OK;
}

/* The classes with their bounds, every other one numbered. */
static void draw_legend(const placido_canvas *canvas, const placido_scale *scale, double left) {
  double height = (double)DISC / scale->classes;
  for (int k = 0; k < scale->classes; k++) {
    double y = TOP + DISC - (k + 1) * height;
    placido_canvas_ink(canvas, placido_scale_colour(scale, k));
    cairo_rectangle(canvas->cr, left, y, 20, height);
    cairo_fill(canvas->cr);
    if ((k - scale->classes / 2) % 2 == 0) {
      char text[PLACIDO_NUMBER_SIZE];
      double middle = scale->first + (k + 0.5) * scale->step;
      placido_number_significant(text, sizeof text, middle, 2);
      placido_canvas_ink(canvas, black);
      placido_canvas_text(canvas, left + 26, y + height / 2, small_px, PLACIDO_LEFT, false, text);
    }
  }
  placido_canvas_ink(canvas, black);
  placido_canvas_text(canvas, left, TOP - 22, small_px, PLACIDO_LEFT, false, "µm");
}

/* The bars' place and scale. */
typedef struct chart {
  const placido_canvas *canvas;
  double top, bottom, reach;
  int first, last; /* terms */
} chart;

static double to_y(const chart *c, double um) {
  return 0.5 * (c->top + c->bottom) - 0.5 * um / c->reach * (c->bottom - c->top);
}

static double slot_of(const chart *c) {
  return (double)(BARS_RIGHT - BARS_LEFT) / (c->last - c->first + 1);
}

static void draw_bar(const chart *c, int j, double um, double sigma_um) {
  double slot = slot_of(c), x = BARS_LEFT + (j - c->first + 0.5) * slot;
  placido_canvas_ink(c->canvas, blue);
  cairo_rectangle(c->canvas->cr, x - 0.35 * slot, fmin(to_y(c, um), to_y(c, 0)), 0.7 * slot,
                  fabs(to_y(c, um) - to_y(c, 0)));
  cairo_fill(c->canvas->cr);
  placido_canvas_ink(c->canvas, black);
  if (isfinite(sigma_um) && sigma_um > 0) {
    double high = to_y(c, um + sigma_um), low = to_y(c, um - sigma_um);
    cairo_set_line_width(c->canvas->cr, 1.5);
    placido_canvas_line(c->canvas, x, high, x, low);
    placido_canvas_line(c->canvas, x - 4, high, x + 4, high);
    placido_canvas_line(c->canvas, x - 4, low, x + 4, low);
  }
  placido_canvas_print(c->canvas, x, c->bottom + 12, 12, PLACIDO_CENTRE, "%d", j);
}

static void draw_axis(const chart *c) {
  placido_scale ticks = placido_scale_from_zero(2.5 * c->reach);
  int steps = (int)(c->reach / ticks.step + 1e-9);
  cairo_set_line_width(c->canvas->cr, 1);
  for (int k = -steps; k <= steps; k++) {
    char text[PLACIDO_NUMBER_SIZE];
    double y = to_y(c, k * ticks.step);
    placido_canvas_ink(c->canvas, k == 0 ? black : faint);
    placido_canvas_line(c->canvas, BARS_LEFT, y, BARS_RIGHT, y);
    placido_canvas_ink(c->canvas, black);
    placido_number_write(text, sizeof text, k * ticks.step,
                         (int)fmax(ceil(-log10(ticks.step) - 1e-9), 0));
    placido_canvas_text(c->canvas, BARS_LEFT - 8, y, small_px, PLACIDO_RIGHT, false, text);
  }
  cairo_rectangle(c->canvas->cr, BARS_LEFT, c->top, BARS_RIGHT - BARS_LEFT, c->bottom - c->top);
  cairo_stroke(c->canvas->cr);
}

/* Lines between the orders, and their names. */
static void draw_orders(const chart *c, int order) {
  for (int n = 2; n <= order; n++) {
    double left = BARS_LEFT + (placido_zernike_count(n - 1) - c->first) * slot_of(c);
    double right = BARS_LEFT + (placido_zernike_count(n) - c->first) * slot_of(c);
    placido_canvas_ink(c->canvas, black);
    placido_canvas_print(c->canvas, (left + right) / 2, c->bottom + 32, small_px, PLACIDO_CENTRE,
                         n == 2 ? "order %d" : "%d", n);
    placido_canvas_line(c->canvas, left, c->bottom, left, c->bottom + 38);
  }
}

static void draw_chart(const placido_canvas *canvas, const placido_wavefront *w,
                       const double *sigma_um) {
  int order = w->order < ORDER_SHOWN ? w->order : ORDER_SHOWN;
  chart c = {canvas, TOP, TOP + DISC, 0, FIRST_TERM, placido_zernike_count(order) - 1};
  for (int j = c.first; j <= c.last; j++) {
    double sigma = sigma_um != NULL && isfinite(sigma_um[j]) ? sigma_um[j] : 0;
    c.reach = fmax(c.reach, fabs(w->coefficients_um[j]) + sigma);
  }
  c.reach = c.reach > 0 ? 1.1 * c.reach : 1;
  draw_axis(&c);
  for (int j = c.first; j <= c.last; j++) {
    draw_bar(&c, j, w->coefficients_um[j], sigma_um != NULL ? sigma_um[j] : (double)NAN);
  }
  draw_orders(&c, order);
  placido_canvas_text(canvas, BARS_LEFT, TOP - 22, text_px, PLACIDO_LEFT, false,
                      sigma_um != NULL ? "Zernike terms (OSA index), µm ± 1 σ"
                                       : "Zernike terms (OSA index), µm");
}

static void write_texts(const placido_canvas *canvas, const placido_wavefront *w) {
  double bar_px = DISC / w->eye.pupil_mm;
  placido_canvas_ink(canvas, black);
  placido_canvas_print(canvas, 30, 28, 24, PLACIDO_LEFT, "Corneal wavefront, pupil %g mm",
                       w->eye.pupil_mm);
  placido_canvas_print(canvas, 30, 60, text_px, PLACIDO_LEFT,
                       "Index %g   ·   reference sphere about the best focus, %.2f mm behind the "
                       "cornea   ·   positive where light is ahead",
                       w->eye.index, w->focus_mm[2]);
  cairo_set_line_width(canvas->cr, 2);
  placido_canvas_scale_bar(canvas, 40, HEIGHT - 46, bar_px, small_px, "1 mm");
  if (w->missing > 0.001) {
    placido_canvas_print(canvas, 30, HEIGHT - 18, small_px, PLACIDO_LEFT,
                         "%.1f %% of the pupil has no data: the surface's smooth continuation "
                         "stands in", 100 * w->missing);
  }
}

static int draw_shapes(const placido_canvas *canvas, const placido_wavefront *w,
                       placido_error *err) {
  shape *shapes = placido_memory_new(2, sizeof *shapes, err);
  if (shapes == NULL) {
    return PLACIDO_MEMORY;
  }
  int status = fill_shape(&shapes[0], w, FIRST_TERM, err);
  if (status == PLACIDO_OK) {
    status = fill_shape(&shapes[1], w, placido_zernike_count(2), err);
  }
  placido_scale scale = make_scale(fmax(reach_of(&shapes[0]), reach_of(&shapes[1])));
  if (status == PLACIDO_OK) {
    status = draw_disc(canvas, &shapes[0], &scale, 30, "Order 2 and above", err);
  }
  if (status == PLACIDO_OK) {
    status = draw_disc(canvas, &shapes[1], &scale, 50 + DISC, "Order 3 and above", err);
  }
  if (status == PLACIDO_OK) {
    draw_legend(canvas, &scale, 70 + 2 * DISC);
  }
  placido_memory_free(shapes);
  return status;
}

int placido_figure_wavefront(const placido_wavefront *wavefront, const double *sigma_um,
                             const char *path, placido_error *err) {
  placido_canvas canvas;
  int status = placido_canvas_new(&canvas, WIDTH, HEIGHT, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = draw_shapes(&canvas, wavefront, err);
  if (status == PLACIDO_OK) {
    draw_chart(&canvas, wavefront, sigma_um);
    write_texts(&canvas, wavefront);
    status = placido_canvas_save(&canvas, path, err);
  }
  placido_canvas_free(&canvas);
  return status;
}

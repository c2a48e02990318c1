/* The accuracy test: every object's differences by zone, mean and twice the standard deviation,
 * against the targets. */
#include "report/iso.h"

#include "report/canvas.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 1000, LEFT = 96, RIGHT = 970, TEXT = 16, SLOT = 26 };

#define MARK_PX 4.5

/* Okabe and Ito (2008): blue, orange and bluish green, each with a mark of its own form. */
static const placido_rgb inks[PLACIDO_ISO_ZONES] = {
    {0, 0.447, 0.698}, {0.902, 0.624, 0}, {0, 0.62, 0.451}};
static const placido_rgb black = {0, 0, 0}, grey = {0.45, 0.45, 0.45}, faint = {0.88, 0.88, 0.88};
static const char *const zone_names[PLACIDO_ISO_ZONES] = {"1 to 3 mm", "3 to 6 mm", "over 6 mm"};

/* A panel: its place on the canvas and the values it reaches, both ways from zero. */
typedef struct panel {
  const placido_canvas *canvas;
  double top, bottom, reach;
  size_t count;
  bool elevation;
} panel;

static double to_y(const panel *p, double value) {
  double share = fmin(fmax(value / p->reach, -1), 1);
  return 0.5 * (p->top + p->bottom) - 0.5 * share * (p->bottom - p->top);
}

static double to_x(const panel *p, size_t object) {
  return LEFT + ((double)object + 0.5) * (RIGHT - LEFT) / (double)p->count;
}

static double mean_of(const panel *p, const placido_iso_zone *zone) {
  return p->elevation ? zone->elevation_mean_um : zone->axial_mean_D;
}

static double spread_of(const panel *p, const placido_iso_zone *zone) {
  return p->elevation ? zone->elevation_2sd_um : zone->axial_2sd_D;
}

static void draw_zone(const panel *p, double x, const placido_iso_zone *zone, int form) {
  double mean = mean_of(p, zone), spread = spread_of(p, zone);
  if (!isfinite(mean)) {
    return;
  }
  placido_canvas_ink(p->canvas, inks[form]);
  cairo_set_line_width(p->canvas->cr, 2);
  double high = to_y(p, mean + spread), low = to_y(p, mean - spread);
  placido_canvas_line(p->canvas, x, high, x, low);
  placido_canvas_line(p->canvas, x - 5, high, x + 5, high);
  placido_canvas_line(p->canvas, x - 5, low, x + 5, low);
  placido_canvas_mark(p->canvas, x, to_y(p, mean), MARK_PX, form);
}

/* The greatest of 1, 2 and 5 times a power of ten that divides `reach` in at least two. */
static double choose_step(double reach) {
  double step = pow(10, floor(log10(reach / 2)));
  return step * 5 <= reach / 2 ? 5 * step : step * 2 <= reach / 2 ? 2 * step : step;
}

static void draw_frame(const panel *p, const char *title) {
  const placido_canvas *canvas = p->canvas;
  double step = choose_step(p->reach);
  int decimals = step < 1 ? (int)ceil(-log10(step) - 1e-9) : 0;
  placido_canvas_ink(canvas, black);
  placido_canvas_text(canvas, LEFT, p->top - TEXT, TEXT, PLACIDO_LEFT, false, title);
  cairo_set_line_width(canvas->cr, 1);
  int steps = (int)floor(p->reach / step + 1e-9);
  for (int k = -steps; k <= steps; k++) {
    placido_canvas_ink(canvas, k == 0 ? grey : faint);
    placido_canvas_line(canvas, LEFT, to_y(p, k * step), RIGHT, to_y(p, k * step));
    placido_canvas_ink(canvas, black);
    placido_canvas_print(canvas, LEFT - 8, to_y(p, k * step), TEXT * 0.85, PLACIDO_RIGHT,
                         "%s%.*f", k < 0 ? "−" : k > 0 ? "+" : "", decimals, fabs(k * step));
  }
  placido_canvas_ink(canvas, black);
  cairo_rectangle(canvas->cr, LEFT, p->top, RIGHT - LEFT, p->bottom - p->top);
  cairo_stroke(canvas->cr);
}

/* Dashed bounds of a target, drawn beside the objects' marks of that zone. */
static void draw_limits(const panel *p, size_t object, int zone, double limit) {
  const double dashes[] = {5, 4};
  double x = to_x(p, object) + (zone - 1) * SLOT;
  cairo_set_dash(p->canvas->cr, dashes, 2, 0);
  cairo_set_line_width(p->canvas->cr, 2);
  placido_canvas_ink(p->canvas, grey);
  for (int side = -1; side <= 1; side += 2) {
    double y = to_y(p, side * limit);
    placido_canvas_line(p->canvas, x - SLOT / 2.0, y, x + SLOT / 2.0, y);
  }
  cairo_set_dash(p->canvas->cr, NULL, 0, 0);
}

static double reach_of(const panel *p, const placido_iso_result *results) {
  double reach = 0;
  for (size_t i = 0; i < p->count; i++) {
    for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
      const placido_iso_zone *zone = &results[i].zones[k];
      double far = fabs(mean_of(p, zone)) + spread_of(p, zone);
      reach = isfinite(far) ? fmax(reach, far) : reach;
    }
  }
  return reach > 0 ? 1.15 * reach : 1;
}

static void draw_panel(panel *p, const placido_iso_result *results, const char *title) {
  p->reach = reach_of(p, results);
  draw_frame(p, title);
  for (size_t i = 0; i < p->count; i++) {
    for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
      if (results[i].failure[0] == '\0') {
        draw_zone(p, to_x(p, i) + (k - 1) * SLOT, &results[i].zones[k], k);
      }
    }
    for (size_t k = 0; k < 2 && k < results[i].check_count && !p->elevation; k++) {
      if (results[i].checks[k].limit < p->reach) {
        draw_limits(p, i, (int)k, results[i].checks[k].limit);
      }
    }
  }
}

/* An object's name, broken into two lines at its comma or first space. */
static void write_name(const panel *p, size_t object, const char *name) {
  char first[96];
  snprintf(first, sizeof first, "%s", name);
  char *end = first;
  while (*end != '\0' && *end != ' ' && *end != ',') {
    end++;
  }
  const char *second = *end == '\0' ? "" : end + 1;
  *end = '\0';
  placido_canvas_ink(p->canvas, black);
  placido_canvas_text(p->canvas, to_x(p, object), p->bottom + TEXT, TEXT * 0.8, PLACIDO_CENTRE,
                      false, first);
  placido_canvas_text(p->canvas, to_x(p, object), p->bottom + 2.1 * TEXT, TEXT * 0.8,
                      PLACIDO_CENTRE, false, second);
}

static void draw_legend(const placido_canvas *canvas) {
  for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
    double x = RIGHT - 350 + 125 * k;
    placido_canvas_ink(canvas, inks[k]);
    placido_canvas_mark(canvas, x - 12, 24, MARK_PX, k);
    placido_canvas_ink(canvas, black);
    placido_canvas_text(canvas, x, 24, TEXT * 0.85, PLACIDO_LEFT, false, zone_names[k]);
  }
}

int placido_figure_iso(const placido_iso_result *results, size_t count, const char *path,
                       placido_error *err) {
  if (count == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "there is no object to draw");
  }
  placido_canvas canvas;
  int status = placido_canvas_new(&canvas, WIDTH, 640, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  panel p = {.canvas = &canvas, .top = 50, .bottom = 290, .count = count};
  draw_legend(&canvas);
  draw_panel(&p, results, "Axial power, measured less known (D)");
  p.top = 340;
  p.bottom = 560;
  p.elevation = true;
  draw_panel(&p, results, "Elevation, measured less known (µm)");
  for (size_t i = 0; i < count; i++) {
    write_name(&p, i, results[i].object);
  }
  placido_canvas_ink(&canvas, grey);
  placido_canvas_text(&canvas, LEFT, 620, TEXT * 0.85, PLACIDO_LEFT, false,
                      "mark: mean; bar: twice the standard deviation either way, area weighted; "
                      "dashed: target, where it lies within the panel");
  status = placido_canvas_save(&canvas, path, err);
  placido_canvas_free(&canvas);
  return status;
}

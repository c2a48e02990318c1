/* The height field of a PSF in perspective: quads of a mesh, painted from the far side to the
 * near one. */
#include "report/psf_view.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>

enum { MESH_MAX = 91 }; /* corners a side; finer ones would only be lines */

static const double turn_rad = 0.42, lift_rad = 0.52; /* of the view: from lower left, above */
static const double distance = 7; /* of the viewer, in half sides of the floor */
static const double tall = 1.15;  /* of the peak, in half sides */
static const double text_px = 18;

/* A point: right and up in the visual field (-1 to 1) and height above the floor. */
typedef struct point {
  double right, up, height;
} point;

/* Where points come to lie on the canvas. */
typedef struct camera {
  double x0, y0, scale;
} camera;

typedef struct mesh {
  int half; /* corners run from -half to half */
  double pitch;
  double half_arcmin; /* from the centre to the outermost corners */
  double *heights;    /* shares of light, (2 half + 1) squared, up outer */
} mesh;

static void project(const camera *c, point p, double *x, double *y) {
  double across = p.right * cos(turn_rad) - p.up * sin(turn_rad);
  double away = p.right * sin(turn_rad) + p.up * cos(turn_rad);
  double depth = away * cos(lift_rad) - p.height * sin(lift_rad);
  double shrink = distance / (distance + depth);
  *x = c->x0 + c->scale * shrink * across;
  *y = c->y0 - c->scale * shrink * (p.height * cos(lift_rad) + away * sin(lift_rad));
}

/* The camera that fits the box into a rectangle. */
static camera fit_camera(double left, double top, double width, double height) {
  const camera unit = {0, 0, 1};
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY;
  for (int corner = 0; corner < 8; corner++) {
    point p = {corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? tall : 0};
    double x, y;
    project(&unit, p, &x, &y);
    x0 = fmin(x0, x);
    x1 = fmax(x1, x);
    y0 = fmin(y0, y);
    y1 = fmax(y1, y);
  }
  double scale = fmin(width / (x1 - x0), height / (y1 - y0));
  return (camera){left + 0.5 * width - 0.5 * scale * (x0 + x1),
                  top + 0.5 * height - 0.5 * scale * (y0 + y1), scale};
}

static double largest_in_block(const placido_psf_view *view, int right, int up, int block) {
  double largest = 0;
  for (int j = -(block / 2); j <= block / 2; j++) {
    for (int i = -(block / 2); i <= block / 2; i++) {
      largest = fmax(largest, placido_psf_view_at(view, right + i, up + j));
    }
  }
  return largest;
}

/* The view on at most MESH_MAX corners a side; a corner takes the largest bucket of its block,
 * so that the peak keeps its height. */
static int make_mesh(mesh *m, int *block, const placido_psf_view *view, placido_error *err) {
  *block = 1; /* odd, so that a block has a middle */
  while ((2 * view->half + 1) / *block > MESH_MAX) {
    *block += 2;
  }
  m->half = (view->half + *block / 2) / *block;
  m->pitch = 1.0 / m->half;
  m->half_arcmin = m->half * *block * view->psf->bucket_arcmin;
  int side = 2 * m->half + 1;
  m->heights = placido_memory_new((size_t)side * (size_t)side, sizeof *m->heights, err);
  if (m->heights == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int j = 0; j < side; j++) {
    for (int i = 0; i < side; i++) {
      m->heights[j * side + i] =
          largest_in_block(view, (i - m->half) * *block, (j - m->half) * *block, *block);
    }
  }
  return PLACIDO_OK;
}

static double share_at(const mesh *m, int i, int j) {
  return m->heights[(j + m->half) * (2 * m->half + 1) + i + m->half];
}

static void line(const placido_canvas *canvas, const camera *c, point from, point to) {
  double x0, y0, x1, y1;
  project(c, from, &x0, &y0);
  project(c, to, &x1, &y1);
  placido_canvas_line(canvas, x0, y0, x1, y1);
}

/* How bright a facet with these slopes is under a lamp above the viewer's left shoulder. */
static double shade(double slope_right, double slope_up) {
  const double lamp[3] = {-0.5, -0.35, 0.79};
  double length = sqrt(1 + slope_right * slope_right + slope_up * slope_up);
  double cosine = (-slope_right * lamp[0] - slope_up * lamp[1] + lamp[2]) / length;
  return 0.62 + 0.38 * fmax(cosine, 0) / lamp[2];
}

/* The lines of the mesh where no light is. */
static void draw_floor(const placido_canvas *canvas, const camera *c, const mesh *m) {
  for (int k = -m->half; k <= m->half; k++) {
    const point ends[] = {
        {k * m->pitch, -1, 0}, {k * m->pitch, 1, 0}, {-1, k * m->pitch, 0}, {1, k * m->pitch, 0}};
    for (int e = 0; e < 4; e++) {
      double x, y;
      project(c, ends[e], &x, &y);
      if (e % 2 == 0) {
        cairo_move_to(canvas->cr, x, y);
      } else {
        cairo_line_to(canvas->cr, x, y);
      }
    }
  }
  cairo_set_source_rgba(canvas->cr, 0.1, 0.1, 0.15, 0.5);
  cairo_stroke(canvas->cr);
}

static void draw_facet(const placido_psf_view *view, const placido_canvas *canvas, const camera *c,
                       const mesh *m, int i, int j) {
  static const int di[] = {0, 1, 1, 0}, dj[] = {0, 0, 1, 1};
  double h[4], mean = 0;
  for (int k = 0; k < 4; k++) {
    double share = share_at(m, i + di[k], j + dj[k]), x, y;
    h[k] = tall * share / view->peak;
    mean += 0.25 * share;
    project(c, (point){(i + di[k]) * m->pitch, (j + dj[k]) * m->pitch, h[k]}, &x, &y);
    cairo_line_to(canvas->cr, x, y);
  }
  cairo_close_path(canvas->cr);
  if (mean <= 0) { /* part of the floor, which hides nothing */
    cairo_new_path(canvas->cr);
    return;
  }
  double light = fmin(shade((h[1] + h[2] - h[0] - h[3]) / (2 * m->pitch),
                            (h[2] + h[3] - h[0] - h[1]) / (2 * m->pitch)),
                      1);
  placido_rgb ink = placido_psf_view_colour(view, mean);
  cairo_set_source_rgb(canvas->cr, light * ink.r, light * ink.g, light * ink.b);
  cairo_fill_preserve(canvas->cr);
  cairo_set_source_rgba(canvas->cr, 0.1, 0.1, 0.15, 0.35);
  cairo_stroke(canvas->cr);
}

static void draw_mesh(const placido_psf_view *view, const placido_canvas *canvas, const camera *c,
                      const mesh *m) {
  cairo_set_line_width(canvas->cr, 0.5);
  cairo_set_line_join(canvas->cr, CAIRO_LINE_JOIN_ROUND);
  draw_floor(canvas, c, m);
  for (int j = m->half - 1; j >= -m->half; j--) {
    for (int i = m->half - 1; i >= -m->half; i--) {
      draw_facet(view, canvas, c, m, i, j);
    }
  }
}

/* The two far walls with their lines of equal height, and the numbers at the left corner. */
static void draw_walls(const placido_psf_view *view, const placido_canvas *canvas,
                       const camera *c) {
  double tick = placido_psf_view_tick(view->peak, 5);
  cairo_set_line_width(canvas->cr, 1);
  for (int k = 0; k * tick <= view->peak * 1.0001; k++) {
    double h = tall * k * tick / view->peak, x, y;
    cairo_set_source_rgb(canvas->cr, 0.75, 0.75, 0.75);
    line(canvas, c, (point){-1, 1, h}, (point){1, 1, h});
    line(canvas, c, (point){1, 1, h}, (point){1, -1, h});
    if (k == 0) {
      continue;
    }
    project(c, (point){-1, 1, h}, &x, &y);
    cairo_set_source_rgb(canvas->cr, 0, 0, 0);
    placido_canvas_line(canvas, x - 6, y, x, y);
    placido_canvas_print(canvas, x - 10, y, text_px, PLACIDO_RIGHT, "%g %%", 100 * k * tick);
  }
  cairo_set_source_rgb(canvas->cr, 0.4, 0.4, 0.4);
  line(canvas, c, (point){-1, 1, 0}, (point){-1, 1, tall});
  line(canvas, c, (point){1, 1, 0}, (point){1, 1, tall});
  line(canvas, c, (point){1, -1, 0}, (point){1, -1, tall});
}

/* Ticks along one of the two near edges of the floor. */
static void draw_edge(const placido_canvas *canvas, const camera *c, double half_arcmin,
                      double tick_arcmin, bool along_right) {
  double x, y;
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  int ticks = (int)(half_arcmin / tick_arcmin + 1e-9);
  for (int k = -ticks; k <= ticks; k++) {
    double at = k * tick_arcmin / half_arcmin, out = -1.05, far = -1.13;
    point foot = along_right ? (point){at, -1, 0} : (point){-1, at, 0};
    point end = along_right ? (point){at, out, 0} : (point){out, at, 0};
    line(canvas, c, foot, end);
    project(c, along_right ? (point){at, far, 0} : (point){far, at, 0}, &x, &y);
    placido_canvas_print(canvas, x, y + 4, text_px, PLACIDO_CENTRE, "%s%g", k < 0 ? "−" : "",
                         fabs(k * tick_arcmin));
  }
  project(c, along_right ? (point){0.2, -1.42, 0} : (point){-1.24, -0.1, 0}, &x, &y);
  placido_canvas_text(canvas, x, y + 6, text_px, along_right ? PLACIDO_CENTRE : PLACIDO_RIGHT,
                      false, along_right ? "right, arcmin" : "up, arcmin");
}

int placido_psf_relief_draw(const placido_psf_view *view, const placido_canvas *canvas, double left,
                            double top, double width, double height, int *block,
                            placido_error *err) {
  mesh m = {0};
  int status = make_mesh(&m, block, view, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const double room_left = 84, room_below = 62;
  camera c = fit_camera(left + room_left, top, width - room_left, height - room_below);
  cairo_save(canvas->cr);
  draw_walls(view, canvas, &c);
  draw_mesh(view, canvas, &c, &m);
  cairo_set_line_width(canvas->cr, 1.2);
  draw_edge(canvas, &c, m.half_arcmin, view->tick_arcmin, true);
  draw_edge(canvas, &c, m.half_arcmin, view->tick_arcmin, false);
  cairo_restore(canvas->cr);
  placido_memory_free(m.heights);
  return PLACIDO_OK;
}

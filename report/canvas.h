/* A drawing surface that becomes a PNG file, and the few marks that all figures share. */
#ifndef PLACIDO_REPORT_CANVAS_H
#define PLACIDO_REPORT_CANVAS_H

#include <placido/status.h>

#include <cairo.h>
#include <stdbool.h>

/* Where a text stands relative to its point. */
enum placido_anchor { PLACIDO_LEFT, PLACIDO_CENTRE, PLACIDO_RIGHT };

/* sRGB, encoded, 0..1. */
typedef struct placido_rgb {
  double r, g, b;
} placido_rgb;

typedef struct placido_canvas {
  cairo_surface_t *surface;
  cairo_t *cr;
  int width_px, height_px;
} placido_canvas;

/* A white canvas with black ink. Free with placido_canvas_free. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_canvas_new(placido_canvas *canvas, int width_px, int height_px, placido_error *err);
void placido_canvas_free(placido_canvas *canvas);

/* White ground, black ink and the figures' font. */
void placido_canvas_clear(const placido_canvas *canvas);

/* Draws the figure `context` on a canvas of its size. */
typedef void placido_canvas_draw(const placido_canvas *canvas, const void *context);

/* What `draw` draws as an SVG file, by way of a temporary name. PLACIDO_OK, PLACIDO_MEMORY,
 * PLACIDO_SYSTEM (naming the path). */
int placido_canvas_vector(int width, int height, placido_canvas_draw *draw, const void *context,
                          const char *path, placido_error *err);

/* Writes the canvas as PNG by way of a temporary name. PLACIDO_OK, PLACIDO_MEMORY,
 * PLACIDO_SYSTEM (naming the path). */
int placido_canvas_save(const placido_canvas *canvas, const char *path, placido_error *err);

/* An ARGB32 picture for pixel work, all transparent. Destroy with cairo_surface_destroy. */
int placido_canvas_picture(cairo_surface_t **picture, int width_px, int height_px,
                           placido_error *err);

/* Paints such a picture, of `samples` pixels a side, over a square of the canvas, unsmoothed. */
void placido_canvas_paint(const placido_canvas *canvas, cairo_surface_t *picture, double left,
                          double top, double side, int samples);

void placido_canvas_ink(const placido_canvas *canvas, placido_rgb colour);
void placido_canvas_line(const placido_canvas *canvas, double x0, double y0, double x1, double y1);

/* Writes one line of text of this height whose vertical middle is at y; `halo` surrounds it with
 * white so that it can be read on any ground. */
void placido_canvas_text(const placido_canvas *canvas, double x, double y, double height_px,
                         enum placido_anchor anchor, bool halo, const char *text);

/* The same, formatted, without a halo. */
#if defined(__GNUC__)
__attribute__((format(printf, 6, 7)))
#endif
void placido_canvas_print(const placido_canvas *canvas, double x, double y, double height_px,
                          enum placido_anchor anchor, const char *format, ...);

/* A filled circle (form 0), square (1) or triangle of about `r_px` around (x, y). */
void placido_canvas_mark(const placido_canvas *canvas, double x, double y, double r_px, int form);

/* A horizontal bar with end marks and its length in words above, left end at (x, y). */
void placido_canvas_scale_bar(const placido_canvas *canvas, double x, double y, double length_px,
                              double text_px, const char *text);

#endif

/* A drawing surface that becomes a PNG file, and the few marks that all figures share. */
#include "report/canvas.h"

#include "base/cv/cv.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "report/reduce.h"

#include <png.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

static int check(cairo_status_t status, placido_error *err) {
  if (status == CAIRO_STATUS_SUCCESS) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_MEMORY, "drawing: %s", cairo_status_to_string(status));
}

int placido_canvas_new(placido_canvas *canvas, int width_px, int height_px, placido_error *err) {
  *canvas = (placido_canvas){.width_px = width_px, .height_px = height_px};
  canvas->surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px);
  canvas->cr = cairo_create(canvas->surface);
  int status = check(cairo_status(canvas->cr), err);
  if (status != PLACIDO_OK) {
    placido_canvas_free(canvas);
    return status;
  }
  placido_canvas_clear(canvas);
  return PLACIDO_OK;
}

void placido_canvas_clear(const placido_canvas *canvas) {
  cairo_set_source_rgb(canvas->cr, 1, 1, 1);
  cairo_paint(canvas->cr);
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  cairo_select_font_face(canvas->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
}

void placido_canvas_free(placido_canvas *canvas) {
  if (canvas == NULL) {
    return;
  }
  if (canvas->cr != NULL) {
    cairo_destroy(canvas->cr);
  }
  if (canvas->surface != NULL) {
    cairo_surface_destroy(canvas->surface);
  }
  *canvas = (placido_canvas){0};
}

/* Red, green, blue bytes of all pixels. */
static uint8_t *pack_pixels(const placido_canvas *canvas, placido_error *err) {
  size_t width = (size_t)canvas->width_px, height = (size_t)canvas->height_px;
  uint8_t *packed = placido_memory_new(3 * width, height, err);
  if (packed == NULL) {
    return NULL;
  }
  cairo_surface_flush(canvas->surface);
  const unsigned char *data = cairo_image_surface_get_data(canvas->surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(canvas->surface);
  uint8_t *out = packed;
  for (size_t y = 0; y < height; y++) {
    const uint32_t *row = (const uint32_t *)(const void *)(data + y * stride);
    for (size_t x = 0; x < width; x++) {
      *out++ = (uint8_t)(row[x] >> 16);
      *out++ = (uint8_t)(row[x] >> 8);
      *out++ = (uint8_t)row[x];
    }
  }
  return packed;
}

static int write_colours(const placido_canvas *canvas, const placido_file *file,
                         placido_error *err) {
  uint8_t *packed = pack_pixels(canvas, err);
  if (packed == NULL) {
    return PLACIDO_MEMORY;
  }
  int status = placido_cv_save_png(packed, canvas->width_px, canvas->height_px, 3, 8,
                                   3 * (size_t)canvas->width_px, file->temporary, err);
  placido_memory_free(packed);
  return status;
}

/* OpenCV writes no palettes. */
static int write_palette(const placido_canvas *canvas, const placido_reduced *reduced,
                         const placido_file *file, placido_error *err) {
  png_image image = {.version = PNG_IMAGE_VERSION,
                     .width = (png_uint_32)canvas->width_px,
                     .height = (png_uint_32)canvas->height_px,
                     .format = PNG_FORMAT_RGB_COLORMAP,
                     .colormap_entries = (png_uint_32)reduced->count};
  if (!png_image_write_to_stdio(&image, file->stream, 0, reduced->indices, canvas->width_px,
                                reduced->colours)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s",
                             placido_text_tail(file->path), image.message);
  }
  return PLACIDO_OK;
}

/* Most figures have few colours, and are a fifth as large with a palette. For the others OpenCV's
 * PNG settings take a fifth of the time of cairo's for pictures that are half as large again. */
int placido_canvas_save(const placido_canvas *canvas, const char *path, placido_error *err) {
  placido_reduced reduced = {0};
  placido_file file = {0};
  int status = check(cairo_status(canvas->cr), err);
  if (status == PLACIDO_OK) {
    status = placido_reduce(&reduced, canvas, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status == PLACIDO_OK) {
    status = reduced.count > 0 ? write_palette(canvas, &reduced, &file, err)
                               : write_colours(canvas, &file, err);
  }
  placido_reduced_free(&reduced);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}

int placido_canvas_picture(cairo_surface_t **picture, int width_px, int height_px,
                           placido_error *err) {
  *picture = NULL;
  cairo_surface_t *made = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width_px, height_px);
  int status = check(cairo_surface_status(made), err);
  if (status != PLACIDO_OK) {
    cairo_surface_destroy(made);
    return status;
  }
  *picture = made;
  return PLACIDO_OK;
}

void placido_canvas_paint(const placido_canvas *canvas, cairo_surface_t *picture, double left,
                          double top, double side, int samples) {
  cairo_t *cr = canvas->cr;
  cairo_surface_mark_dirty(picture);
  cairo_save(cr);
  cairo_translate(cr, left, top);
  cairo_scale(cr, side / samples, side / samples);
  cairo_set_source_surface(cr, picture, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_NEAREST);
  cairo_paint(cr);
  cairo_restore(cr);
}

void placido_canvas_ink(const placido_canvas *canvas, placido_rgb colour) {
  cairo_set_source_rgb(canvas->cr, colour.r, colour.g, colour.b);
}

void placido_canvas_line(const placido_canvas *canvas, double x0, double y0, double x1, double y1) {
  cairo_move_to(canvas->cr, x0, y0);
  cairo_line_to(canvas->cr, x1, y1);
  cairo_stroke(canvas->cr);
}

void placido_canvas_text(const placido_canvas *canvas, double x, double y, double height_px,
                         enum placido_anchor anchor, bool halo, const char *text) {
  cairo_t *cr = canvas->cr;
  cairo_set_font_size(cr, height_px);
  cairo_text_extents_t extents;
  cairo_text_extents(cr, text, &extents);
  /* 0.36 of the font's size is half the height of its figures, so that numbers sit in the middle */
  cairo_move_to(cr, x - 0.5 * anchor * extents.x_advance, y + 0.36 * height_px);
  if (halo) {
    cairo_save(cr);
    cairo_text_path(cr, text);
    cairo_set_source_rgba(cr, 1, 1, 1, 0.9);
    cairo_set_line_width(cr, 0.25 * height_px);
    cairo_set_line_join(cr, CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(cr);
    cairo_restore(cr);
    cairo_move_to(cr, x - 0.5 * anchor * extents.x_advance, y + 0.36 * height_px);
  }
  cairo_show_text(cr, text);
  cairo_new_path(cr);
}

void placido_canvas_print(const placido_canvas *canvas, double x, double y, double height_px,
                          enum placido_anchor anchor, const char *format, ...) {
  char text[256];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  placido_canvas_text(canvas, x, y, height_px, anchor, false, text);
}

void placido_canvas_mark(const placido_canvas *canvas, double x, double y, double r_px, int form) {
  cairo_t *cr = canvas->cr;
  const double r = r_px;
  if (form == 0) {
    cairo_arc(cr, x, y, r, 0, 2 * 3.14159265358979323846);
  } else if (form == 1) {
    cairo_rectangle(cr, x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
  } else {
    cairo_move_to(cr, x - 1.1 * r, y + 0.8 * r);
    cairo_line_to(cr, x + 1.1 * r, y + 0.8 * r);
    cairo_line_to(cr, x, y - 1.1 * r);
    cairo_close_path(cr);
  }
  cairo_fill(cr);
}

void placido_canvas_scale_bar(const placido_canvas *canvas, double x, double y, double length_px,
                              double text_px, const char *text) {
  double mark_px = 0.3 * text_px;
  placido_canvas_line(canvas, x, y, x + length_px, y);
  placido_canvas_line(canvas, x, y - mark_px, x, y + mark_px);
  placido_canvas_line(canvas, x + length_px, y - mark_px, x + length_px, y + mark_px);
  placido_canvas_text(canvas, x + length_px / 2, y - text_px, text_px, PLACIDO_CENTRE, false, text);
}

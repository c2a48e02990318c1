/* A drawing surface that becomes a PNG file, and the few marks that all figures share. */
#include "report/canvas.h"

#include "base/cv/cv.h"
#include "base/file.h"
#include "base/memory.h"

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
  cairo_set_source_rgb(canvas->cr, 1, 1, 1);
  cairo_paint(canvas->cr);
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  cairo_select_font_face(canvas->cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  return PLACIDO_OK;
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

static const uint32_t *row_of(const placido_canvas *canvas, int y) {
  const unsigned char *data = cairo_image_surface_get_data(canvas->surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(canvas->surface);
  return (const uint32_t *)(const void *)(data + (size_t)y * stride);
}

/* Whether red, green and blue are alike everywhere: such a picture is a third as large. */
static bool is_grey(const placido_canvas *canvas) {
  for (int y = 0; y < canvas->height_px; y++) {
    const uint32_t *row = row_of(canvas, y);
    for (int x = 0; x < canvas->width_px; x++) {
      if ((row[x] >> 8 & 0xffff) != (row[x] & 0xffff)) {
        return false;
      }
    }
  }
  return true;
}

/* The bytes of all pixels: red, green and blue of each, or one where there is one channel. */
static uint8_t *pack_pixels(const placido_canvas *canvas, int channels, placido_error *err) {
  size_t width = (size_t)canvas->width_px, height = (size_t)canvas->height_px;
  uint8_t *packed = placido_memory_new((size_t)channels * width, height, err);
  if (packed == NULL) {
    return NULL;
  }
  uint8_t *out = packed;
  for (int y = 0; y < canvas->height_px; y++) {
    const uint32_t *row = row_of(canvas, y);
    for (int x = 0; x < canvas->width_px; x++) {
      for (int shift = 8 * (channels - 1); shift >= 0; shift -= 8) {
        *out++ = (uint8_t)(row[x] >> shift);
      }
    }
  }
  return packed;
}

/* OpenCV's PNG settings take a fifth of the time of cairo's for pictures that are half as large
 * again. */
int placido_canvas_save(const placido_canvas *canvas, const char *path, placido_error *err) {
  int status = check(cairo_status(canvas->cr), err);
  if (status != PLACIDO_OK) {
    return status;
  }
  cairo_surface_flush(canvas->surface);
  int channels = is_grey(canvas) ? 1 : 3;
  uint8_t *packed = pack_pixels(canvas, channels, err);
  if (packed == NULL) {
    return PLACIDO_MEMORY;
  }
  placido_file file = {0};
  status = placido_file_create(&file, path, err);
  if (status == PLACIDO_OK) {
    status = placido_cv_save_png(packed, canvas->width_px, canvas->height_px, channels, 8,
                                 (size_t)channels * (size_t)canvas->width_px, file.temporary, err);
  }
  placido_memory_free(packed);
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

void placido_canvas_scale_bar(const placido_canvas *canvas, double x, double y, double length_px,
                              double text_px, const char *text) {
  double mark_px = 0.3 * text_px;
  placido_canvas_line(canvas, x, y, x + length_px, y);
  placido_canvas_line(canvas, x, y - mark_px, x, y + mark_px);
  placido_canvas_line(canvas, x + length_px, y - mark_px, x + length_px, y + mark_px);
  placido_canvas_text(canvas, x + length_px / 2, y - text_px, text_px, PLACIDO_CENTRE, false, text);
}

/* The same drawing as SVG, for papers. */
#include "report/canvas.h"

#include "base/file.h"
#include "base/text.h"

#include <cairo-svg.h>
#include <stdio.h>

static cairo_status_t write_some(void *closure, const unsigned char *data, unsigned int length) {
  FILE *stream = closure;
  return fwrite(data, 1, length, stream) == length ? CAIRO_STATUS_SUCCESS
                                                   : CAIRO_STATUS_WRITE_ERROR;
}

int placido_canvas_vector(int width, int height, placido_canvas_draw *draw, const void *context,
                          const char *path, placido_error *err) {
  placido_file file = {0};
  int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_canvas canvas = {.width_px = width, .height_px = height};
  canvas.surface = cairo_svg_surface_create_for_stream(write_some, file.stream, width, height);
  canvas.cr = cairo_create(canvas.surface);
  placido_canvas_clear(&canvas);
  draw(&canvas, context);
  cairo_surface_finish(canvas.surface);
  cairo_status_t drawn = cairo_status(canvas.cr), written = cairo_surface_status(canvas.surface);
  placido_canvas_free(&canvas);
  if (drawn != CAIRO_STATUS_SUCCESS || written != CAIRO_STATUS_SUCCESS) {
    placido_file_discard(&file);
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(path),
                             cairo_status_to_string(drawn != CAIRO_STATUS_SUCCESS ? drawn
                                                                                  : written));
  }
  return placido_file_commit(&file, err);
}

/* The plan of a PSF, bucket by bucket, on a logarithmic scale that shows faint ghosts, too. */
#include "report/psf_view.h"

#include "report/palette.h"

#include <math.h>
#include <stdint.h>

static const double text_px = 18;

static uint32_t to_pixel(placido_rgb c) {
  return 0xff000000u | (uint32_t)lround(255 * c.r) << 16 | (uint32_t)lround(255 * c.g) << 8 |
         (uint32_t)lround(255 * c.b);
}

static int draw_buckets(const placido_psf_view *view, const placido_canvas *canvas, double left,
                        double top, double side, placido_error *err) {
  int count = 2 * view->half + 1;
  cairo_surface_t *picture;
  int status = placido_canvas_picture(&picture, count, count, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  unsigned char *data = cairo_image_surface_get_data(picture);
  int stride = cairo_image_surface_get_stride(picture);
  for (int j = 0; j < count; j++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)j * (size_t)stride);
    for (int i = 0; i < count; i++) {
      double value = placido_psf_view_at(view, i - view->half, view->half - j);
      row[i] = to_pixel(placido_psf_view_colour(view, value));
    }
  }
  placido_canvas_paint(canvas, picture, left, top, side, count);
  cairo_surface_destroy(picture);
  return PLACIDO_OK;
}

static void draw_axes(const placido_psf_view *view, const placido_canvas *canvas, double left,
                      double top, double side) {
  double middle_x = left + 0.5 * side, middle_y = top + 0.5 * side, bottom = top + side;
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  cairo_set_line_width(canvas->cr, 1.2);
  cairo_rectangle(canvas->cr, left, top, side, side);
  cairo_stroke(canvas->cr);
  int ticks = (int)(view->half_arcmin / view->tick_arcmin);
  for (int k = -ticks; k <= ticks; k++) {
    double offset = 0.5 * side * k * view->tick_arcmin / view->half_arcmin;
    double value = fabs(k * view->tick_arcmin);
    const char *sign = k < 0 ? "−" : "";
    placido_canvas_line(canvas, middle_x + offset, bottom, middle_x + offset, bottom + 6);
    placido_canvas_line(canvas, left - 6, middle_y - offset, left, middle_y - offset);
    placido_canvas_print(canvas, middle_x + offset, bottom + 19, text_px, PLACIDO_CENTRE, "%s%g",
                         sign, value);
    placido_canvas_print(canvas, left - 11, middle_y - offset, text_px, PLACIDO_RIGHT, "%s%g", sign,
                         value);
  }
  placido_canvas_text(canvas, middle_x, bottom + 43, text_px, PLACIDO_CENTRE, false,
                      "←  left     arcmin     right  →");
  cairo_save(canvas->cr);
  cairo_translate(canvas->cr, left - 58, middle_y);
  cairo_rotate(canvas->cr, -acos(0));
  placido_canvas_text(canvas, 0, 0, text_px, PLACIDO_CENTRE, false, "←  down     arcmin     up  →");
  cairo_restore(canvas->cr);
}

static void draw_bar(const placido_canvas *canvas, double left, double top, double height) {
  const double width = 24;
  cairo_pattern_t *ramp = cairo_pattern_create_linear(0, top, 0, top + height);
  for (int k = 0; k <= 32; k++) {
    placido_rgb c = placido_palette_sequential(1 - k / 32.0);
    cairo_pattern_add_color_stop_rgb(ramp, k / 32.0, c.r, c.g, c.b);
  }
  cairo_set_source(canvas->cr, ramp);
  cairo_rectangle(canvas->cr, left, top, width, height);
  cairo_fill_preserve(canvas->cr);
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  cairo_set_line_width(canvas->cr, 1);
  cairo_stroke(canvas->cr);
  cairo_pattern_destroy(ramp);
  for (int k = 0; k <= PLACIDO_PSF_DECADES; k++) {
    double y = top + height * k / PLACIDO_PSF_DECADES;
    placido_canvas_line(canvas, left + width, y, left + width + 6, y);
    placido_canvas_print(canvas, left + width + 10, y, text_px, PLACIDO_LEFT, "%g", pow(10, -k));
  }
  double y = top + height + 22;
  cairo_rectangle(canvas->cr, left, y, width, 20);
  cairo_stroke(canvas->cr);
  placido_canvas_text(canvas, left + width + 10, y + 10, text_px, PLACIDO_LEFT, false, "none");
}

int placido_psf_plan_draw(const placido_psf_view *view, const placido_canvas *canvas, double left,
                          double top, double side, placido_error *err) {
  int status = draw_buckets(view, canvas, left, top, side, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  draw_axes(view, canvas, left, top, side);
  draw_bar(canvas, left + side + 24, top, side - 42);
  return PLACIDO_OK;
}

/* Camera frames as pictures: cut out, brought to 8 bits and made smaller by the mean over areas. */
#include "report/report.h"

#include "report/frame_picture.h"

#include <math.h>
#include <string.h>

/* A pixel's channels scaled to 0..1. */
static placido_rgb read_pixel(const placido_frame *frame, int x, int y) {
  const uint8_t *at = frame->data + (size_t)y * frame->stride_bytes +
                      (size_t)x * placido_format_bytes(frame->format);
  if (frame->format == PLACIDO_RGB8) {
    return (placido_rgb){at[0] / 255.0, at[1] / 255.0, at[2] / 255.0};
  }
  double grey = at[0] / 255.0;
  if (frame->format == PLACIDO_MONO16) {
    uint16_t sample;
    memcpy(&sample, at, sizeof sample);
    int bits = frame->bits > 0 && frame->bits < 16 ? frame->bits : 16;
    grey = fmin(sample / (double)((1u << bits) - 1), 1);
  }
  return (placido_rgb){grey, grey, grey};
}

/* The length that pixel `index` shares with [from, to). */
static double overlap(int index, double from, double to) {
  double first = index > from ? index : from, last = index + 1 < to ? index + 1 : to;
  return last - first;
}

static placido_rgb mean_over(const placido_frame *frame, double x0, double y0, double x1,
                             double y1) {
  double r = 0, g = 0, b = 0, area = (x1 - x0) * (y1 - y0);
  for (int y = (int)y0; y < y1 && y < frame->height_px; y++) {
    for (int x = (int)x0; x < x1 && x < frame->width_px; x++) {
      double weight = overlap(x, x0, x1) * overlap(y, y0, y1);
      placido_rgb pixel = read_pixel(frame, x, y);
      r += weight * pixel.r;
      g += weight * pixel.g;
      b += weight * pixel.b;
    }
  }
  return (placido_rgb){r / area, g / area, b / area};
}

static uint32_t to_pixel(placido_rgb colour, bool grey) {
  if (grey) { /* luma of ITU-R BT.601: the samples are encoded, not linear */
    double luma = 0.299 * colour.r + 0.587 * colour.g + 0.114 * colour.b;
    colour = (placido_rgb){luma, luma, luma};
  }
  uint32_t r = (uint32_t)(255 * colour.r + 0.5), g = (uint32_t)(255 * colour.g + 0.5);
  uint32_t b = (uint32_t)(255 * colour.b + 0.5);
  return 0xff000000u | r << 16 | g << 8 | b;
}

int placido_frame_picture(cairo_surface_t **picture, const placido_frame *frame,
                          const placido_crop *crop, int width_px, int height_px, bool grey,
                          placido_error *err) {
  int status = placido_canvas_picture(picture, width_px, height_px, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  unsigned char *data = cairo_image_surface_get_data(*picture);
  int stride = cairo_image_surface_get_stride(*picture);
  double dx = (double)crop->width / width_px, dy = (double)crop->height / height_px;
  bool same_size = crop->width == width_px && crop->height == height_px;
  for (int y = 0; y < height_px; y++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * (size_t)stride);
    double y0 = crop->top + y * dy;
    for (int x = 0; x < width_px; x++) {
      double x0 = crop->left + x * dx;
      row[x] = to_pixel(same_size ? read_pixel(frame, crop->left + x, crop->top + y)
                                  : mean_over(frame, x0, y0, x0 + dx, y0 + dy),
                        grey);
    }
  }
  cairo_surface_mark_dirty(*picture);
  return PLACIDO_OK;
}

int placido_frame_check(const placido_frame *frame, placido_error *err) {
  if (frame->data == NULL || frame->width_px < 1 || frame->height_px < 1) {
    return placido_error_set(err, PLACIDO_INPUT, "figure of a frame: the frame is empty");
  }
  return PLACIDO_OK;
}

int placido_figure_frame(const placido_frame *frame, int width_px, const char *path,
                         placido_error *err) {
  int status = placido_frame_check(frame, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (width_px < 1) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "figure of a frame: width %d px, expected 1 or more", width_px);
  }
  placido_crop whole = {0, 0, frame->width_px, frame->height_px};
  double scale = fmin(1, (double)width_px / frame->width_px);
  int width = (int)fmax(lround(frame->width_px * scale), 1);
  int height = (int)fmax(lround(frame->height_px * scale), 1);
  placido_canvas canvas;
  cairo_surface_t *picture = NULL;
  status = placido_canvas_new(&canvas, width, height, err);
  if (status == PLACIDO_OK) {
    status = placido_frame_picture(&picture, frame, &whole, width, height, false, err);
  }
  if (status == PLACIDO_OK) {
    cairo_set_source_surface(canvas.cr, picture, 0, 0);
    cairo_paint(canvas.cr);
    status = placido_canvas_save(&canvas, path, err);
  }
  if (picture != NULL) {
    cairo_surface_destroy(picture);
  }
  placido_canvas_free(&canvas);
  return status;
}

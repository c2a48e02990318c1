/* The frame with every edge point found on it, so that a person can see at a glance whether the
 * mires were numbered rightly. */
#include "report/report.h"

#include "base/memory.h"
#include "report/frame_picture.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

/* Frames up to this size are shown whole, larger ones as what is around the mires. */
enum { WIDTH_MAX = 1400 };

static const double pi = 3.14159265358979323846;

/* Okabe and Ito's blue and orange (2008), lightened for use on black and white; a red-violet
 * apart from both. */
static const placido_rgb edge_ink[2] = {{0.20, 0.66, 1.0}, {1.0, 0.62, 0.0}};
static const placido_rgb unused_ink = {1.0, 0.15, 0.62};

/* An overlay on its way to paper. */
typedef struct overlay {
  const placido_mires *mires;
  placido_canvas canvas;
  placido_crop crop;
  double scale;            /* canvas px per frame px */
  int width_px, height_px; /* of the picture; the legend stands below */
  double text_px;
} overlay;

static double to_x(const overlay *o, double u_px) { return (u_px + 0.5 - o->crop.left) * o->scale; }

static double to_y(const overlay *o, double v_px) { return (v_px + 0.5 - o->crop.top) * o->scale; }

/* One axis of the crop: the points' extent and a margin, within the frame. */
static void cut(int *start, int *length, double low, double high, int limit_px) {
  double margin = 0.15 * (high - low) + 10;
  *start = (int)fmin(fmax(floor(low - margin), 0), limit_px - 1);
  *length = (int)fmin(fmax(ceil(high + margin), *start + 1), limit_px) - *start;
}

static placido_crop choose_crop(const placido_frame *frame, const placido_mires *mires) {
  placido_crop crop = {0, 0, frame->width_px, frame->height_px};
  if ((crop.width <= WIDTH_MAX && crop.height <= WIDTH_MAX) || mires->count == 0) {
    return crop;
  }
  double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
  for (size_t k = 0; k < mires->count; k++) {
    const placido_mire_point *p = &mires->points[k];
    left = fmin(left, p->u_px);
    right = fmax(right, p->u_px);
    top = fmin(top, p->v_px);
    bottom = fmax(bottom, p->v_px);
  }
  cut(&crop.left, &crop.width, left, right, frame->width_px);
  cut(&crop.top, &crop.height, top, bottom, frame->height_px);
  return crop;
}

/* At most WIDTH_MAX on the longer side; whole frames are never enlarged, small cut-outs up to
 * fourfold. */
static double choose_scale(const placido_frame *frame, const placido_crop *crop) {
  int longer = crop->width > crop->height ? crop->width : crop->height;
  double fits = (double)WIDTH_MAX / longer;
  bool whole = crop->width == frame->width_px && crop->height == frame->height_px;
  return fits < 1 ? fits : whole ? 1 : fmin(floor(fits), 4);
}

/* Thirty-two levels of grey tell as much under the points, in a file of a third of the size: what
 * compresses badly is the sensor's noise. */
static void coarsen(cairo_surface_t *picture, int width, int height) {
  unsigned char *data = cairo_image_surface_get_data(picture);
  size_t stride = (size_t)cairo_image_surface_get_stride(picture);
  for (int y = 0; y < height; y++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * stride);
    for (int x = 0; x < width; x++) {
      row[x] = 0xff000000u | (row[x] & 0xf8f8f8u) | (row[x] >> 5 & 0x070707u);
    }
  }
  cairo_surface_mark_dirty(picture);
}

static int draw_frame(const overlay *o, const placido_frame *frame, placido_error *err) {
  cairo_surface_t *picture;
  bool larger = o->scale > 1;
  int width = larger ? o->crop.width : o->width_px, height = larger ? o->crop.height : o->height_px;
  int status = placido_frame_picture(&picture, frame, &o->crop, width, height, true, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  coarsen(picture, width, height);
  cairo_t *cr = o->canvas.cr;
  cairo_save(cr);
  cairo_scale(cr, (double)o->width_px / width, (double)o->height_px / height);
  cairo_set_source_surface(cr, picture, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cr), CAIRO_FILTER_BILINEAR);
  cairo_pattern_set_extend(cairo_get_source(cr), CAIRO_EXTEND_PAD);
  cairo_rectangle(cr, 0, 0, width, height);
  cairo_fill(cr);
  cairo_restore(cr);
  cairo_surface_destroy(picture);
  return PLACIDO_OK;
}

static void draw_dot(const placido_canvas *canvas, double x, double y, double radius,
                     placido_rgb ink) {
  placido_canvas_ink(canvas, ink);
  cairo_arc(canvas->cr, x, y, radius, 0, 2 * pi);
  cairo_fill(canvas->cr);
}

static uint32_t blend(uint32_t under, placido_rgb over, double share) {
  double r = (under >> 16 & 255) + share * (255 * over.r - (under >> 16 & 255));
  double g = (under >> 8 & 255) + share * (255 * over.g - (under >> 8 & 255));
  double b = (under & 255) + share * (255 * over.b - (under & 255));
  return (uint32_t)(r + 0.5) << 16 | (uint32_t)(g + 0.5) << 8 | (uint32_t)(b + 0.5);
}

/* A dot put straight into the pixels: there are many thousands, and a path for each takes longer
 * than all else. The surface must have been flushed. */
static void stamp_dot(const overlay *o, double x, double y, double radius, placido_rgb ink) {
  unsigned char *data = cairo_image_surface_get_data(o->canvas.surface);
  int stride = cairo_image_surface_get_stride(o->canvas.surface);
  int left = (int)fmax(floor(x - radius - 1), 0), top = (int)fmax(floor(y - radius - 1), 0);
  for (int j = top; j < o->height_px && j <= y + radius + 1; j++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)j * (size_t)stride);
    for (int i = left; i < o->width_px && i <= x + radius + 1; i++) {
      double right = i + 0.5 - x, down = j + 0.5 - y;
      double covered = radius + 0.5 - sqrt(right * right + down * down);
      if (covered > 0) {
        row[i] = blend(row[i], ink, covered < 1 ? covered : 1);
      }
    }
  }
}

static void draw_cross(const placido_canvas *canvas, double x, double y, double half,
                       placido_rgb ink) {
  placido_canvas_ink(canvas, ink);
  cairo_set_line_width(canvas->cr, 0.45 * half);
  placido_canvas_line(canvas, x - half, y - half, x + half, y + half);
  placido_canvas_line(canvas, x - half, y + half, x + half, y - half);
}

static double dot_radius(const overlay *o) { return 0.085 * o->text_px; }

static void draw_points(const overlay *o) {
  const placido_mires *mires = o->mires;
  cairo_surface_flush(o->canvas.surface);
  for (size_t k = 0; k < mires->count; k++) {
    const placido_mire_point *p = &mires->points[k];
    if (p->used) {
      stamp_dot(o, to_x(o, p->u_px), to_y(o, p->v_px), dot_radius(o), edge_ink[p->edge & 1]);
    }
  }
  cairo_surface_mark_dirty(o->canvas.surface);
  for (size_t k = 0; k < mires->count; k++) {
    const placido_mire_point *p = &mires->points[k];
    if (!p->used) {
      draw_cross(&o->canvas, to_x(o, p->u_px), to_y(o, p->v_px), 2 * dot_radius(o), unused_ink);
    }
  }
}

static int meridian_of(const placido_mires *mires, const placido_mire_point *p) {
  long index = lround(p->meridian_deg / 360 * mires->meridian_count);
  return (int)(((index % mires->meridian_count) + mires->meridian_count) % mires->meridian_count);
}

/* The meridian on which most edges were found. */
static int find_full_meridian(int *meridian, const placido_mires *mires, placido_error *err) {
  *meridian = 0;
  int *found = placido_memory_new((size_t)mires->meridian_count, sizeof *found, err);
  if (found == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t k = 0; k < mires->count; k++) {
    found[meridian_of(mires, &mires->points[k])]++;
  }
  for (int m = 1; m < mires->meridian_count; m++) {
    if (found[m] > found[*meridian]) {
      *meridian = m;
    }
  }
  placido_memory_free(found);
  return PLACIDO_OK;
}

/* The edges' numbers beside their points, as many as can be read. */
static int number_edges(const overlay *o, placido_error *err) {
  const placido_mires *mires = o->mires;
  if (mires->count == 0 || mires->meridian_count < 1) {
    return PLACIDO_OK;
  }
  int meridian;
  int status = find_full_meridian(&meridian, mires, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double angle = 2 * pi * meridian / mires->meridian_count;
  double beside_x = 0.9 * o->text_px * sin(angle), beside_y = 0.9 * o->text_px * cos(angle);
  double room = (0.85 + 0.5 * fabs(cos(angle))) * o->text_px, last_x = -1e9, last_y = -1e9;
  for (size_t k = 0; k < mires->count; k++) {
    const placido_mire_point *p = &mires->points[k];
    double x = to_x(o, p->u_px), y = to_y(o, p->v_px);
    if (meridian_of(mires, p) != meridian || hypot(x - last_x, y - last_y) < room) {
      continue;
    }
    char text[16];
    snprintf(text, sizeof text, "%d", p->edge);
    cairo_set_source_rgb(o->canvas.cr, 0, 0, 0);
    placido_canvas_text(&o->canvas, x + beside_x, y + beside_y, 0.8 * o->text_px, PLACIDO_CENTRE,
                        true, text);
    last_x = x;
    last_y = y;
  }
  return PLACIDO_OK;
}

static void draw_centre(const overlay *o) {
  double x = to_x(o, o->mires->centre_u_px), y = to_y(o, o->mires->centre_v_px);
  double half = 0.6 * o->text_px;
  cairo_t *cr = o->canvas.cr;
  for (int pass = 0; pass < 2; pass++) {
    cairo_set_source_rgb(cr, pass, pass, pass);
    cairo_set_line_width(cr, (pass ? 0.08 : 0.2) * o->text_px);
    placido_canvas_line(&o->canvas, x - half, y, x + half, y);
    placido_canvas_line(&o->canvas, x, y - half, x, y + half);
  }
}

static size_t count_used(const placido_mires *mires) {
  size_t used = 0;
  for (size_t k = 0; k < mires->count; k++) {
    used += mires->points[k].used;
  }
  return used;
}

/* A bar of 1 mm, or of the decade that fills between a twentieth and a half of the width. */
static void draw_bar(const overlay *o, double mm_per_px) {
  double px_per_mm = o->scale / mm_per_px, length_mm = 1;
  if (!isfinite(px_per_mm) || px_per_mm <= 0) {
    return;
  }
  while (length_mm < 1e3 && length_mm * px_per_mm < 0.05 * o->width_px) {
    length_mm *= 10;
  }
  while (length_mm > 1e-3 && length_mm * px_per_mm > 0.5 * o->width_px) {
    length_mm /= 10;
  }
  char text[48];
  snprintf(text, sizeof text, "%g mm on the cornea", length_mm);
  double room = fmax(length_mm * px_per_mm, 10.5 * o->text_px);
  cairo_set_source_rgb(o->canvas.cr, 0, 0, 0);
  cairo_set_line_width(o->canvas.cr, 0.14 * o->text_px);
  placido_canvas_scale_bar(
      &o->canvas, o->width_px - 0.5 * (room + length_mm * px_per_mm) - o->text_px,
      o->height_px + 2.6 * o->text_px, length_mm * px_per_mm, o->text_px, text);
}

static void draw_legend(const overlay *o, double mm_per_px) {
  const placido_mires *mires = o->mires;
  const placido_canvas *canvas = &o->canvas;
  size_t used = count_used(mires);
  double t = o->text_px, first = o->height_px + 1.1 * t, second = first + 1.6 * t;
  draw_dot(canvas, t, first, 0.3 * t, edge_ink[0]);
  draw_dot(canvas, 8.5 * t, first, 0.3 * t, edge_ink[1]);
  draw_cross(canvas, 16 * t, first, 0.3 * t, unused_ink);
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  placido_canvas_text(canvas, 1.7 * t, first, t, PLACIDO_LEFT, false, "even edges");
  placido_canvas_text(canvas, 9.2 * t, first, t, PLACIDO_LEFT, false, "odd edges");
  placido_canvas_text(canvas, 16.7 * t, first, t, PLACIDO_LEFT, false, "not used");
  placido_canvas_print(canvas, 0.7 * t, second, t, PLACIDO_LEFT,
                       "%zu used, %zu not used; %d edges, %.0f %% found", used, mires->count - used,
                       mires->edge_count, 100 * mires->coverage);
  draw_bar(o, mm_per_px);
}

static int draw(const overlay *o, const placido_frame *frame, double mm_per_px,
                placido_error *err) {
  int status = draw_frame(o, frame, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  draw_points(o);
  draw_centre(o);
  status = number_edges(o, err);
  draw_legend(o, mm_per_px);
  return status;
}

int placido_figure_mires(const placido_frame *frame, const placido_mires *mires, double mm_per_px,
                         const char *path, placido_error *err) {
  int status = placido_frame_check(frame, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  overlay o = {.mires = mires, .crop = choose_crop(frame, mires)};
  o.scale = choose_scale(frame, &o.crop);
  o.width_px = (int)fmax(lround(o.crop.width * o.scale), 1);
  o.height_px = (int)fmax(lround(o.crop.height * o.scale), 1);
  o.text_px = fmax(o.width_px / 58.0, 8);
  status = placido_canvas_new(&o.canvas, o.width_px, o.height_px + (int)ceil(3.8 * o.text_px), err);
  if (status == PLACIDO_OK) {
    status = draw(&o, frame, mm_per_px, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_canvas_save(&o.canvas, path, err);
  }
  placido_canvas_free(&o.canvas);
  return status;
}

/* The small figures of a study's page: a cornea's axial power, and a point spread function. */
#include "report/study.h"

#include "report/canvas.h"
#include "report/field.h"
#include "report/palette.h"
#include "report/psf_view.h"
#include "report/scale.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>

enum { MAP_WIDTH = 480, MAP_HEIGHT = 400, DISC = 360, DISC_LEFT = 10, DISC_TOP = 20 };
enum { PSF_WIDTH = 480, PSF_HEIGHT = 800, RELIEF_HEIGHT = 350, PLAN = 400, PLAN_TOP = 365 };

static const double text_px = 20;
static const double pi = 3.14159265358979323846;

static uint32_t to_pixel(placido_rgb c) {
  return 0xff000000u | (uint32_t)lround(255 * c.r) << 16 | (uint32_t)lround(255 * c.g) << 8 |
         (uint32_t)lround(255 * c.b);
}

static uint32_t *row_of(cairo_surface_t *picture, int row) {
  unsigned char *data = cairo_image_surface_get_data(picture);
  return (uint32_t *)(void *)(data +
                              (size_t)row * (size_t)cairo_image_surface_get_stride(picture));
}

static int draw_disc(const placido_canvas *canvas, const placido_map_field *field,
                     const placido_scale *scale, placido_error *err) {
  cairo_surface_t *picture;
  int status = placido_canvas_picture(&picture, field->size, field->size, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int j = 0; j < field->size; j++) {
    uint32_t *row = row_of(picture, j);
    for (int i = 0; i < field->size; i++) {
      double value = field->values[(size_t)j * (size_t)field->size + (size_t)i];
      row[i] = isfinite(value)
                   ? to_pixel(placido_scale_colour(scale, placido_scale_class(scale, value)))
                   : 0;
    }
  }
  placido_canvas_paint(canvas, picture, DISC_LEFT, DISC_TOP, DISC, field->size);
  cairo_surface_destroy(picture);
  return PLACIDO_OK;
}

static void draw_pupils(const placido_canvas *canvas, const placido_maps *maps,
                        const double *pupils_mm, size_t count) {
  const double dashes[] = {6, 5};
  double px_per_mm = 0.5 * DISC / (maps->half * maps->step_mm);
  cairo_set_dash(canvas->cr, dashes, 2, 0);
  cairo_set_line_width(canvas->cr, 1.5);
  for (size_t k = 0; k < count; k++) {
    cairo_arc(canvas->cr, DISC_LEFT + 0.5 * DISC, DISC_TOP + 0.5 * DISC,
              0.5 * pupils_mm[k] * px_per_mm, 0, 2 * pi);
    cairo_set_source_rgb(canvas->cr, 0, 0, 0);
    cairo_stroke(canvas->cr);
  }
  cairo_set_dash(canvas->cr, NULL, 0, 0);
  cairo_set_line_width(canvas->cr, 2.5);
  placido_canvas_scale_bar(canvas, 4, MAP_HEIGHT - 8, 2 * px_per_mm, text_px, "2 mm");
}

static void draw_legend(const placido_canvas *canvas, const placido_scale *scale) {
  const double left = DISC_LEFT + DISC + 18, width = 24, top = 44;
  double height = (MAP_HEIGHT - top - 16) / scale->classes;
  for (int k = 0; k < scale->classes; k++) {
    double y = top + (scale->classes - 1 - k) * height;
    placido_canvas_ink(canvas, placido_scale_colour(scale, k));
    cairo_rectangle(canvas->cr, left, y, width, height);
    cairo_fill(canvas->cr);
    cairo_set_source_rgb(canvas->cr, 0, 0, 0);
    if (k > 0 && k % 4 == 0) {
      char text[32];
      placido_scale_write(text, sizeof text, scale, k);
      placido_canvas_text(canvas, left + width + 6, y + height, text_px, PLACIDO_LEFT, false, text);
    }
  }
  placido_canvas_text(canvas, left, top - 22, text_px, PLACIDO_LEFT, false, "D");
}

int placido_figure_study_map(const placido_maps *maps, const double *pupils_mm, size_t pupil_count,
                             const char *path, placido_error *err) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  int axial = placido_maps_find(isfinite(maps->vertex_mm[0]) ? "axial_vertex" : "axial");
  placido_scale scale = placido_scale_for(&kinds[axial], PLACIDO_SCALE_ABSOLUTE, 0, 0);
  placido_map_field field;
  placido_canvas canvas;
  int status = placido_map_field_new(&field, maps, maps->values[axial], DISC, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_canvas_new(&canvas, MAP_WIDTH, MAP_HEIGHT, err);
  if (status == PLACIDO_OK) {
    status = draw_disc(&canvas, &field, &scale, err);
  }
  if (status == PLACIDO_OK) {
    draw_pupils(&canvas, maps, pupils_mm, pupil_count);
    draw_legend(&canvas, &scale);
    status = placido_canvas_save(&canvas, path, err);
  }
  placido_map_field_free(&field);
  placido_canvas_free(&canvas);
  return status;
}

static int draw_plan(const placido_psf_view *view, const placido_canvas *canvas,
                     placido_error *err) {
  const double left = 0.5 * (PSF_WIDTH - PLAN);
  int side = 2 * view->half + 1;
  cairo_surface_t *picture;
  int status = placido_canvas_picture(&picture, side, side, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int j = 0; j < side; j++) {
    uint32_t *row = row_of(picture, j);
    for (int i = 0; i < side; i++) {
      double value = placido_psf_view_at(view, i - view->half, view->half - j);
      row[i] = to_pixel(placido_psf_view_colour(view, value));
    }
  }
  placido_canvas_paint(canvas, picture, left, PLAN_TOP, PLAN, side);
  cairo_surface_destroy(picture);
  cairo_set_source_rgb(canvas->cr, 0, 0, 0);
  cairo_set_line_width(canvas->cr, 1.5);
  cairo_rectangle(canvas->cr, left, PLAN_TOP, PLAN, PLAN);
  cairo_stroke(canvas->cr);
  char text[32];
  double length = placido_psf_view_tick(2 * view->half_arcmin, 4);
  snprintf(text, sizeof text, "%g′", length);
  cairo_set_line_width(canvas->cr, 2.5);
  placido_canvas_scale_bar(canvas, left + 12, PLAN_TOP + PLAN - 14,
                           0.5 * PLAN * length / view->half_arcmin, text_px, text);
  return PLACIDO_OK;
}

int placido_figure_study_psf(const placido_psf *psf, const char *path, placido_error *err) {
  placido_psf_view view;
  placido_canvas canvas;
  int block = 1, status = placido_psf_view_find(&view, psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_canvas_new(&canvas, PSF_WIDTH, PSF_HEIGHT, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_psf_relief_draw(&view, &canvas, 0, 8, PSF_WIDTH, RELIEF_HEIGHT, &block, err);
  if (status == PLACIDO_OK) {
    status = draw_plan(&view, &canvas, err);
  }
  if (status == PLACIDO_OK) {
    placido_canvas_print(&canvas, 0.5 * PSF_WIDTH, PSF_HEIGHT - 16, text_px, PLACIDO_CENTRE,
                         "peak %.3g %% of the light", 100 * view.peak);
    status = placido_canvas_save(&canvas, path, err);
  }
  placido_canvas_free(&canvas);
  return status;
}

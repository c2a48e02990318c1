/* The figure of an image's quality: contours, contrast, encircled energy, and through focus. */
#include "report/report.h"

#include "base/memory.h"
#include "report/psf_chart.h"
#include "report/psf_view.h"

#include <math.h>

enum { WIDTH = 1360, HEIGHT = 1060, FREQUENCIES = 61, RADII = 81 };
enum { HALF = WIDTH / 2, PANEL_TOP = 60, PANEL = 490 };

static const double text_px = 18;

/* Numbers that curves are drawn from. */
typedef struct columns {
  double frequency_cpd[FREQUENCIES], radius_arcmin[RADII], share[RADII];
} columns;

static void draw_mtf(const placido_canvas *canvas, const placido_mtf *mtf, columns *c) {
  static const char *const names[PLACIDO_MTF_MERIDIANS] = {"along 0°", "along 45°", "along 90°",
                                                           "along 135°"};
  for (int k = 0; k < mtf->count; k++) {
    c->frequency_cpd[k] = k * mtf->step_cpd;
  }
  placido_chart chart = {.title = "Contrast left of a grating (modulation transfer)",
                         .x_name = "cycles per degree",
                         .last = (mtf->count - 1) * mtf->step_cpd,
                         .high = 1,
                         .count = 1 + PLACIDO_MTF_MERIDIANS};
  chart.curves[0] =
      (placido_chart_curve){"all directions", mtf->count, c->frequency_cpd, mtf->radial};
  for (int i = 0; i < PLACIDO_MTF_MERIDIANS; i++) {
    chart.curves[i + 1] =
        (placido_chart_curve){names[i], mtf->count, c->frequency_cpd, mtf->meridian[i]};
  }
  placido_chart_draw(&chart, canvas, HALF, PANEL_TOP, HALF - 20, PANEL);
}

static void draw_encircled(const placido_canvas *canvas, const placido_psf *psf, columns *c) {
  placido_moments m = placido_psf_moments(psf);
  double last = fmax(1.1 * placido_encircled_radius(psf, 0.95), 2 * psf->bucket_arcmin);
  for (int k = 0; k < RADII; k++) {
    c->radius_arcmin[k] = last * k / (RADII - 1);
    c->share[k] = placido_encircled_share(psf, m.x, m.y, c->radius_arcmin[k]);
  }
  placido_chart chart = {.title = "Share of the light within a circle about its centroid",
                         .x_name = "radius, arcmin",
                         .last = last,
                         .high = 1,
                         .count = 1};
  chart.curves[0] = (placido_chart_curve){NULL, RADII, c->radius_arcmin, c->share};
  placido_chart_draw(&chart, canvas, 20, PANEL_TOP + PANEL, HALF - 40, PANEL);
}

static void draw_focus(const placido_canvas *canvas, const placido_focus_curve *curve) {
  placido_chart chart = {.title = "Through focus, relative to a perfect eye",
                         .x_name = "lens added, D",
                         .first = curve->lens_D[0],
                         .last = curve->lens_D[curve->count - 1],
                         .high = 0.05,
                         .count = 3};
  const double *const rows[3] = {curve->mtf_area, curve->visual_strehl, curve->peak};
  static const char *const names[3] = {"MTF area", "visual Strehl", "peak"};
  for (int i = 0; i < 3; i++) {
    for (int k = 0; k < curve->count; k++) {
      chart.high = fmax(chart.high, rows[i][k]);
    }
    chart.curves[i] = (placido_chart_curve){names[i], curve->count, curve->lens_D, rows[i]};
  }
  double step = placido_psf_view_tick(chart.high, 5);
  chart.high = step * ceil(chart.high / step - 1e-9);
  placido_chart_draw(&chart, canvas, HALF, PANEL_TOP + PANEL, HALF - 20, PANEL);
}

/* What stands where there is no curve through focus. */
static void write_figures(const placido_canvas *canvas, const placido_psf *psf) {
  placido_moments m = placido_psf_moments(psf);
  const struct { const char *name; double value; const char *unit; } rows[] = {
      {"fullest bucket, of what landed", 100 * psf->strehl_g, " %"},
      {"half of the light within", placido_encircled_radius(psf, 0.5), "′"},
      {"four fifths within", placido_encircled_radius(psf, 0.8), "′"},
      {"root mean square radius", m.rms, "′"},
      {"centroid, to the right", m.x, "′"},
      {"centroid, upwards", m.y, "′"},
      {"landed within the PSF", 100 * m.sum, " %"}};
  double y = PANEL_TOP + PANEL + 60;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++, y += 34) {
    placido_canvas_text(canvas, HALF + 64, y, text_px, PLACIDO_LEFT, false, rows[i].name);
    placido_canvas_print(canvas, HALF + 470, y, text_px, PLACIDO_RIGHT, "%s%.3g%s",
                         rows[i].value < 0 ? "−" : "", fabs(rows[i].value), rows[i].unit);
  }
}

static void write_title(const placido_canvas *canvas, const placido_psf *psf) {
  if (psf->wavelength_nm > 0) {
    placido_canvas_print(canvas, 30, 28, 24, PLACIDO_LEFT,
                         "Image quality, pupil %.3g mm, diffraction at %g nm", psf->pupil_mm,
                         psf->wavelength_nm);
  } else {
    placido_canvas_print(canvas, 30, 28, 24, PLACIDO_LEFT, "Image quality, pupil %.3g mm, rays",
                         psf->pupil_mm);
  }
}

static int draw(const placido_canvas *canvas, const placido_psf *psf,
                const placido_focus_curve *curve, placido_error *err) {
  placido_psf_view view;
  placido_mtf mtf = {0};
  columns *c = placido_memory_new(1, sizeof *c, err);
  double step_cpd = fmin(1, 30 / psf->bucket_arcmin / (FREQUENCIES - 1));
  int status = c == NULL ? PLACIDO_MEMORY : placido_psf_view_find(&view, psf, err);
  if (status == PLACIDO_OK) {
    status = placido_mtf_new(&mtf, psf, FREQUENCIES, step_cpd, err);
  }
  if (status == PLACIDO_OK) {
    write_title(canvas, psf);
    placido_canvas_text(canvas, 84, PANEL_TOP + 14, text_px, PLACIDO_LEFT, false,
                        "Contours, as the patient sees it");
    placido_psf_contour_draw(&view, canvas, 84, PANEL_TOP + 34, 394);
    draw_mtf(canvas, &mtf, c);
    draw_encircled(canvas, psf, c);
    if (curve != NULL) {
      draw_focus(canvas, curve);
    } else {
      write_figures(canvas, psf);
    }
  }
  placido_mtf_free(&mtf);
  placido_memory_free(c);
  return status;
}

int placido_figure_quality(const placido_psf *psf, const placido_focus_curve *curve,
                           const char *path, placido_error *err) {
  placido_canvas canvas;
  int status = placido_canvas_new(&canvas, WIDTH, HEIGHT, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = draw(&canvas, psf, curve, err);
  if (status == PLACIDO_OK) {
    status = placido_canvas_save(&canvas, path, err);
  }
  placido_canvas_free(&canvas);
  return status;
}

/* The figure of a PSF: its height field, its plan and its figures on one sheet. */
#include "report/report.h"

#include "report/correction.h"
#include "report/number.h"
#include "report/psf_view.h"

enum { WIDTH = 1360, HEIGHT = 680, PLAN = 460, PLAN_LEFT = 764 };

static const double text_px = 19;

static void write_figures(const placido_canvas *canvas, const placido_psf *psf) {
  char correction[PLACIDO_CORRECTION_SIZE], landed[PLACIDO_NUMBER_SIZE];
  placido_number_write(landed, sizeof landed,
                       100 * (double)psf->rays_landed / (double)psf->rays_entered, 2);
  placido_correction_write(correction, &psf->correction);
  if (psf->wavelength_nm > 0) {
    placido_canvas_print(canvas, 30, HEIGHT - 54, text_px, PLACIDO_LEFT,
                         "pupil %.3g mm   ·   diffraction at %g nm   ·   fullest bucket %.3g %%   ·   "
                         "%.2f %% landed",
                         psf->pupil_mm, psf->wavelength_nm, 100 * psf->strehl_g,
                         100 * (1 - psf->outside));
  } else {
    placido_canvas_print(canvas, 30, HEIGHT - 54, text_px, PLACIDO_LEFT,
                         "pupil %.3g mm   ·   geometric Strehl ratio %.3g   ·   "
                         "landed %s %% of %ld rays",
                         psf->pupil_mm, psf->strehl_g, landed, psf->rays_entered);
  }
  placido_canvas_print(canvas, 30, HEIGHT - 24, text_px, PLACIDO_LEFT,
                       "correction %s   ·   retina at %.2f mm   ·   index %g", correction,
                       psf->retina_mm, psf->index);
}

static void write_titles(const placido_canvas *canvas, const placido_psf_view *view, int block) {
  const placido_psf *psf = view->psf;
  placido_canvas_print(canvas, 30, 26, 24, PLACIDO_LEFT, "Point spread function, pupil %.3g mm",
                       psf->pupil_mm);
  placido_canvas_print(canvas, 30, 60, text_px, PLACIDO_LEFT,
                       "Height: share of light per bucket of %g′ × %g′", psf->bucket_arcmin,
                       psf->bucket_arcmin);
  if (block > 1) {
    placido_canvas_print(canvas, 30, 84, text_px, PLACIDO_LEFT,
                         "(the mesh shows the largest of each %d × %d buckets)", block, block);
  }
  placido_canvas_text(canvas, PLAN_LEFT, 26, text_px, PLACIDO_LEFT, false,
                      "As the patient sees it");
  placido_canvas_print(canvas, PLAN_LEFT, 54, text_px, PLACIDO_LEFT,
                       "Colour: light relative to the peak (%.3g %%), logarithmic",
                       100 * view->peak);
}

int placido_figure_psf(const placido_psf *psf, const char *path, placido_error *err) {
  placido_psf_view view;
  int status = placido_psf_view_find(&view, psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_canvas canvas;
  status = placido_canvas_new(&canvas, WIDTH, HEIGHT, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int block = 1;
  status = placido_psf_relief_draw(&view, &canvas, 10, 100, 660, 490, &block, err);
  if (status == PLACIDO_OK) {
    status = placido_psf_plan_draw(&view, &canvas, PLAN_LEFT, 78, PLAN, err);
  }
  if (status == PLACIDO_OK) {
    write_titles(&canvas, &view, block);
    write_figures(&canvas, psf);
    status = placido_canvas_save(&canvas, path, err);
  }
  placido_canvas_free(&canvas);
  return status;
}

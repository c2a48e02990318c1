/* Pupils of a field, and the spread that they make by rays or by waves. */
#include "simulate/plan/bank.h"

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/plan/nodes.h"
#include "simulate/psf/diffraction_psf.h"
#include "simulate/psf/slopes.h"
#include "simulate/spectrum/spectrum.h"
#include "simulate/trace.h"

#include <math.h>

/* The field is dimmed by the square root of 10^(-rho r²): Stiles and Crawford's is of light. */
static void dim(double *amplitude, const placido_pupil *pupil, const placido_view *view) {
  const double factor = -0.5 * log(10) * view->apodisation_per_mm2;
  const double middle = 0.5 * (pupil->n - 1);
  for (int row = 0; row < pupil->n; row++) {
    for (int column = 0; column < pupil->n; column++) {
      double x = (column - middle) * pupil->spacing_mm + view->eye.pupil_x_mm;
      double y = (row - middle) * pupil->spacing_mm + view->eye.pupil_y_mm;
      double dx = x - view->apodisation_x_mm, dy = y - view->apodisation_y_mm;
      amplitude[(size_t)row * (size_t)pupil->n + (size_t)column] *=
        exp(factor * (dx * dx + dy * dy));
    }
  }
}

static int apodise(placido_pupil *pupil, const placido_view *view, placido_error *err) {
  size_t area = (size_t)pupil->n * (size_t)pupil->n;
  double *amplitude = (double *)pupil->amplitude; /* the pupil owns it */
  if (view->apodisation_per_mm2 == 0) {
    return PLACIDO_OK;
  }
  if (amplitude == NULL) {
    amplitude = placido_memory_new(area, sizeof *amplitude, err);
    if (amplitude == NULL) {
      return PLACIDO_MEMORY;
    }
    for (size_t i = 0; i < area; i++) {
      amplitude[i] = 1;
    }
    pupil->amplitude = amplitude;
  }
  dim(amplitude, pupil, view);
  return PLACIDO_OK;
}

static int make_pupil(placido_bank *bank, const placido_view *view, int node, int threads,
                      placido_error *err) {
  placido_pupil *pupil = &bank->pupils[node];
  placido_node_field_deg(bank->field_deg[node], view->canvas.width_px, view->canvas.height_px,
                         view->bleed_px, view->settings->bucket_arcmin, view->nodes, node);
  int status = placido_ocular_pupil(pupil, view->surface, &view->eye, &view->ocular,
                                    bank->field_deg[node], bank->offset_arcmin, 0,
                                    view->settings->pupil_samples, threads, err);
  return status == PLACIDO_OK ? apodise(pupil, view, err) : status;
}

/* All nodes; of those that fail the first one's message counts. */
static int make_pupils(placido_bank *bank, const placido_view *view, placido_error *err) {
  const int outer = bank->count < view->threads ? bank->count : view->threads;
  const int inner = outer > 1 ? 1 : view->threads;
  int failed = bank->count, status = PLACIDO_OK;
#pragma omp parallel for num_threads(outer) schedule(dynamic, 1) if (outer > 1)
  for (int node = 0; node < bank->count; node++) {
    placido_error note;
    int mine = make_pupil(bank, view, node, inner, &note);
    if (mine != PLACIDO_OK) {
#pragma omp critical(placido_bank_note)
      if (node < failed) {
        failed = node;
        status = placido_error_set(err, mine, "%s", note.text);
      }
    }
  }
  return status;
}

/* The mean slope of a pupil's wavefront, weighted by its light: where its image has its centroid. */
static void find_tilt(double tilt[2], const placido_pupil *pupil) {
  const size_t n = (size_t)pupil->n;
  double sum[3] = {0};
  for (int row = 1; row + 1 < pupil->n; row++) {
    for (int column = 1; column + 1 < pupil->n; column++) {
      size_t at = (size_t)row * n + (size_t)column;
      double x = pupil->opd_um[at + 1] - pupil->opd_um[at - 1];
      double y = pupil->opd_um[at + n] - pupil->opd_um[at - n];
      double light = pupil->amplitude != NULL ? pupil->amplitude[at] * pupil->amplitude[at] : 1;
      if (placido_pupil_lit(pupil, column, row) && isfinite(x + y + light)) {
        sum[0] += light;
        sum[1] += light * x;
        sum[2] += light * y;
      }
    }
  }
  for (int i = 0; i < 2; i++) {
    tilt[i] = sum[0] > 0 ? sum[1 + i] / sum[0] / (2 * pupil->spacing_mm) : 0;
  }
}

/* Off the axis the mean of the light is seen where it is on the axis, beside the place that it
 * comes from: the picture is not distorted. Whoever has the eye is used to that. */
static void straighten(placido_bank *bank) {
  double middle[2], tilt[2];
  find_tilt(middle, &bank->pupils[bank->count / 2]);
  for (int node = 0; node < bank->count; node++) {
    placido_pupil *pupil = &bank->pupils[node];
    double *opd_um = (double *)pupil->opd_um; /* the pupil owns it */
    const double half = 0.5 * (pupil->n - 1);
    find_tilt(tilt, pupil);
    for (int row = 0; row < pupil->n && node != bank->count / 2; row++) {
      for (int column = 0; column < pupil->n; column++) {
        *opd_um++ -= pupil->spacing_mm * ((tilt[0] - middle[0]) * (column - half) +
                                          (tilt[1] - middle[1]) * (row - half));
      }
    }
  }
}

int placido_bank_new(placido_bank *bank, const placido_view *view, placido_error *err) {
  const size_t count = (size_t)view->nodes * (size_t)view->nodes;
  *bank = (placido_bank){.count = (int)count};
  bank->pupils = placido_memory_new(count, sizeof *bank->pupils, err);
  bank->field_deg = placido_memory_new(count, sizeof *bank->field_deg, err);
  int status = bank->pupils != NULL && bank->field_deg != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  if (status == PLACIDO_OK) {
    status = placido_ocular_fixation(bank->offset_arcmin, view->surface, &view->eye, &view->ocular,
                                     err);
  }
  if (status == PLACIDO_OK) {
    status = make_pupils(bank, view, err);
  }
  if (status != PLACIDO_OK) {
    placido_bank_free(bank);
    return status;
  }
  straighten(bank);
  return PLACIDO_OK;
}

void placido_bank_free(placido_bank *bank) {
  if (bank != NULL) {
    for (int i = 0; i < bank->count && bank->pupils != NULL; i++) {
      placido_pupil_free(&bank->pupils[i]);
    }
    placido_memory_free(bank->pupils);
    placido_memory_free(bank->field_deg);
    *bank = (placido_bank){0};
  }
}

/* The light's waves as they arrive at a node from what has defocus_D. */
static void find_waves(placido_wave *waves, const placido_light *light, const placido_view *view,
                       const double field_deg[2], double defocus_D) {
  const double axis_mm[2] = {0, 0};
  double shift_mm[2] = {0, 0};
  if (view->shifts) {
    placido_transverse_shift(shift_mm, axis_mm, field_deg);
    shift_mm[0] += view->shift_mm[0];
    shift_mm[1] += view->shift_mm[1];
  }
  for (int i = 0; i < light->count; i++) {
    waves[i] = light->waves[i];
    waves[i].x_arcmin += PLACIDO_ARCMIN_PER_D_MM * shift_mm[0] * waves[i].defocus_D;
    waves[i].y_arcmin += PLACIDO_ARCMIN_PER_D_MM * shift_mm[1] * waves[i].defocus_D;
    waves[i].defocus_D += defocus_D;
  }
}

/* Where the buckets are on the retina: known of the cornea alone, whose nodal point is. */
static void place(placido_psf *psf, const placido_bank *bank, const placido_view *view) {
  placido_apex apex;
  placido_entry chief;
  double x_mm, y_mm;
  psf->bucket_um = psf->centre_x_um = psf->centre_y_um = NAN;
  if (!view->ocular.whole &&
      placido_apex_find(&apex, view->surface, &view->eye, NULL) == PLACIDO_OK &&
      placido_entry_at(&chief, view->surface, &apex, view->eye.pupil_x_mm, view->eye.pupil_y_mm) &&
      placido_entry_trace(&chief, &view->eye, view->eye.retina_mm, &x_mm, &y_mm)) {
    double arcmin_um = 1e3 * PLACIDO_ARCMIN_RAD *
                       placido_apex_nodal_mm(&apex, view->eye.index, view->eye.retina_mm);
    psf->bucket_um = arcmin_um * psf->bucket_arcmin;
    psf->centre_x_um = 1e3 * x_mm + arcmin_um * bank->offset_arcmin[0];
    psf->centre_y_um = 1e3 * y_mm + arcmin_um * bank->offset_arcmin[1];
  }
}

void placido_bank_describe(placido_psf *psf, const placido_bank *bank, const placido_view *view,
                           int node, int light) {
  const placido_light *waves = &view->lights[light];
  psf->pupil_mm = view->eye.pupil_mm;
  psf->index = view->eye.index;
  psf->retina_mm = view->eye.retina_mm;
  psf->correction = view->eye.correction;
  psf->wavelength_nm = view->waves && waves->count == 1 ? waves->waves[0].wavelength_nm : 0;
  placido_psf_count_samples(psf, &bank->pupils[node]);
  placido_psf_summarise(psf);
  place(psf, bank, view);
}

int placido_bank_psf(placido_psf *psf, const placido_bank *bank, const placido_view *view,
                     int node, int light, double defocus_D, int threads, placido_error *err) {
  const placido_pupil *pupil = &bank->pupils[node];
  const size_t count = (size_t)view->lights[light].count;
  const placido_window window = {.buckets = view->settings->buckets,
                                 .bucket_arcmin = view->settings->bucket_arcmin,
                                 .threads = threads};
  placido_wave waves[PLACIDO_WAVES_MAX];
  size_t area = (size_t)window.buckets * (size_t)window.buckets;
  *psf = (placido_psf){.n = window.buckets, .bucket_arcmin = window.bucket_arcmin};
  psf->values = placido_memory_new(area, sizeof *psf->values, err);
  if (psf->values == NULL) {
    return PLACIDO_MEMORY;
  }
  find_waves(waves, &view->lights[light], view, bank->field_deg[node], defocus_D);
  placido_diffraction_use use = {.share = 0};
  int status = view->waves
                 ? placido_diffraction(psf->values, &use, pupil, waves, count, &window, err)
                 : placido_slopes(psf->values, &use.share, pupil, waves, count, &window, err);
  if (status == PLACIDO_OK && !(use.share > 0)) {
    status = placido_error_set(err, PLACIDO_QUALITY, "no light lands within the PSF's %.0f'",
                               window.buckets * window.bucket_arcmin);
  }
  if (status != PLACIDO_OK) {
    placido_psf_free(psf);
    return status;
  }
  for (size_t i = 0; i < area; i++) {
    psf->values[i] *= view->core / use.share;
  }
  return PLACIDO_OK;
}

/* The figures worth a look when an examination is done. */
#include "acquire/cli/record.h"

#include "acquire/cli/figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LENS_SIZE 64

static void print_frames(const struct examination *examination) {
  const struct combination *combination = &examination->combination;
  size_t used = 0;
  for (size_t i = 0; i < combination->count; i++) {
    used += combination->movements[i].weight > 0;
  }
  if (used > 1) {
    say(examination->settings, "%zu frames combined, of which frame %ld is the best", used,
        examination->choice.index);
  }
}

static void print_fit(const struct examination *examination) {
  const placido_fit_summary fit = placido_fit_summary_get(examination->fit);
  say(examination->settings,
      "frame %ld of %ld: %zu edge points, %.1f %% found, residual %.3f px rms",
      examination->choice.index, examination->choice.frames, fit.points_used,
      100.0 * examination->mires.coverage, fit.rms_px);
}

static void print_heights(const struct examination *examination) {
  const placido_heights_summary *fitted = &examination->heights;
  say(examination->settings,
      "%zu points, %zu missing: residual %.3f um rms, at most %.2f um, knots every %g mm",
      fitted->count, examination->elevation.missing, fitted->rms_um, fabs(fitted->worst_um),
      fitted->knot_mm);
}

static void print_index(const struct settings *settings, const placido_index_value *index) {
  if (isfinite(index->sigma)) {
    say(settings, "%-26s %9.3f ± %.3f %s", index->name, index->value, index->sigma, index->unit);
  } else if (isfinite(index->value)) {
    say(settings, "%-26s %9.3f %s", index->name, index->value, index->unit);
  }
}

/* "-2.50 -0.75 × 90°"; clinics write an axis of 0 as 180. */
static void write_lens(char text[LENS_SIZE], const struct prescription *lens) {
  const double axis = lens->axis_deg < 0.5 ? 180.0 : lens->axis_deg;
  if (isfinite(lens->axis_deg)) {
    snprintf(text, LENS_SIZE, "%+.2f %+.2f × %.0f°", lens->sphere_D, lens->cylinder_D, axis);
  } else {
    snprintf(text, LENS_SIZE, "%+.2f", lens->sphere_D);
  }
}

static void print_view(const struct settings *settings, const struct view *view) {
  char cornea[LENS_SIZE], spectacles[LENS_SIZE];
  const placido_psf *psf = &view->psf;
  const struct prescription near = prescription_cornea(&psf->correction);
  const struct prescription far = prescription_spectacles(settings, &psf->correction);
  write_lens(cornea, &near);
  write_lens(spectacles, &far);
  const bool same = strcmp(cornea, spectacles) == 0 || isnan(far.sphere_D);
  char sigma[32] = "";
  if (isfinite(view->strehl_g_sigma)) {
    snprintf(sigma, sizeof sigma, " ± %.4f", view->strehl_g_sigma);
  }
  say(settings, "pupil %.3g mm: lens %s%s%s%s, retina at %.3f mm, %s %.4f%s",
      psf->pupil_mm, cornea, same ? "" : " (", same ? "" : spectacles,
      same ? "" : " as spectacles)", psf->retina_mm,
      psf->wavelength_nm > 0 ? "fullest bucket" : "Strehl (geometric)", psf->strehl_g, sigma);
}

static void print_acuity(const struct settings *settings, const struct acuity_view *view) {
  char text[256];
  for (size_t i = 0; i < view->count; i++) {
    placido_acuity_write(text, sizeof text, &view->items[i]);
    say(settings, "  %-12s %s", view->items[i].test->name, text);
  }
  if (view->count > 0 && view->ghosts.count > 0) {
    placido_ghosts_write(text, sizeof text, &view->ghosts);
    say(settings, "  %s", text);
  }
}

void summary_print(const struct examination *examination) {
  const struct settings *settings = examination->settings;
  if (examination->elevation.count > 0) {
    print_heights(examination);
  } else if (examination->fit) {
    print_frames(examination);
    print_fit(examination);
  }
  for (size_t i = 0; i < examination->index_count; i++) {
    print_index(settings, &examination->indices[i]);
  }
  wavefronts_print(&examination->wavefronts, settings);
  for (size_t i = 0; i < examination->views.count; i++) {
    print_view(settings, &examination->views.items[i]);
    print_acuity(settings, &examination->views.items[i].acuity);
  }
  promise_print(examination);
  const bool page = figures_available() && examination->views.count > 0;
  say(settings, "%s/%s", settings->output, page ? "report.html" : examination->recipe->marker);
}

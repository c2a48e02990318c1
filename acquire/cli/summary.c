/* The figures worth a look when an examination is done. */
#include "acquire/cli/record.h"

#include "acquire/cli/figures.h"

#include <math.h>

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

static void print_view(const struct settings *settings, const struct view *view) {
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(&view->psf.correction, &sphere_D, &cylinder_D, &axis_deg);
  if (isfinite(axis_deg)) {
    say(settings,
        "pupil %g mm: lens %+.2f %+.2f × %.0f°, retina at %.3f mm, Strehl (geometric) %.4f",
        view->psf.pupil_mm, sphere_D, cylinder_D, axis_deg, view->psf.retina_mm,
        view->psf.strehl_g);
  } else {
    say(settings, "pupil %g mm: lens %+.2f, retina at %.3f mm, Strehl (geometric) %.4f",
        view->psf.pupil_mm, sphere_D, view->psf.retina_mm, view->psf.strehl_g);
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
  }
  const bool page = figures_available() && examination->views.count > 0;
  say(settings, "%s/%s", settings->output, page ? "report.html" : examination->recipe->marker);
}

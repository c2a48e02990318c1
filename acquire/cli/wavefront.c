/* Wavefronts with their error bars: what every variant of the fit does to each term. */
#include "acquire/cli/wavefront.h"

#include "acquire/cli/command.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void fill_figures(double *values, const placido_wavefront *front,
                         const double *coefficients_um) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count && i < WAVEFRONT_FIGURES_MAX; i++) {
    values[i] = figures[i].at(front, coefficients_um);
  }
}

static int find_view(struct wavefront_view *view, const placido_surface *surface, double pupil_mm,
                     const struct settings *settings, placido_notes *notes, placido_error *err) {
  const double index = settings->wavefront_index > 0 ? settings->wavefront_index : settings->index;
  const placido_eye eye = {.pupil_mm = pupil_mm,
                           .pupil_x_mm = settings->wavefront_centre_mm.values[0],
                           .pupil_y_mm = settings->wavefront_centre_mm.values[1],
                           .index = index};
  const placido_wavefront_options options = {.order = settings->wavefront_order};
  const int status = placido_wavefront_new(&view->front, surface, &eye, &options, notes, err);
  if (status == PLACIDO_OK) {
    fill_figures(view->figures, &view->front, view->front.coefficients_um);
  }
  return status;
}

/* What one variant of the fit does to one wavefront. */
struct change {
  double terms_um[PLACIDO_WAVEFRONT_TERMS], figures[WAVEFRONT_FIGURES_MAX];
};

static int find_change(struct change *change, const struct wavefront_view *view,
                       const placido_surface *variant, placido_error *err) {
  const int status = placido_wavefront_again(change->terms_um, &view->front, variant, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  fill_figures(change->figures, &view->front, change->terms_um);
  for (size_t i = 0; i < count && i < WAVEFRONT_FIGURES_MAX; i++) {
    change->figures[i] =
        placido_wavefront_difference(&figures[i], change->figures[i], view->figures[i]);
  }
  for (int j = 0; j < view->front.term_count; j++) {
    change->terms_um[j] -= view->front.coefficients_um[j];
  }
  return PLACIDO_OK;
}

/* Variant number `variant` through every pupil: row `variant` of `changes`. */
static int find_changes(struct change *changes, const struct wavefronts *wavefronts,
                        const placido_fit *fit, int variant, placido_error *err) {
  placido_surface *surface;
  int status = placido_fit_variant(&surface, fit, variant, err);
  for (size_t i = 0; i < wavefronts->count && status == PLACIDO_OK; i++) {
    status = find_change(&changes[(size_t)variant * wavefronts->count + i], &wavefronts->items[i],
                         surface, err);
  }
  placido_surface_free(surface);
  return status;
}

static void add_square(struct spread *spread, double change, enum placido_sigma_source source) {
  spread->by[source] += change * change;
}

static void take_root(struct spread *spread, bool geometry_known) {
  spread->sigma = 0;
  for (int k = 0; k < PLACIDO_SIGMA_SOURCES; k++) {
    spread->sigma += spread->by[k];
    spread->by[k] = sqrt(spread->by[k]);
  }
  spread->sigma = sqrt(spread->sigma);
  if (!geometry_known) {
    spread->by[PLACIDO_SIGMA_GEOMETRY] = NAN;
  }
}

/* The squares of the changes, in the order of the variants, so that threads change nothing. */
static void gather(struct wavefronts *wavefronts, const struct change *changes,
                   const placido_fit *fit) {
  const int variants = placido_fit_variant_count(fit);
  bool geometry_known = false;
  for (size_t i = 0; i < wavefronts->count; i++) {
    struct wavefront_view *view = &wavefronts->items[i];
    for (int k = 0; k < variants; k++) {
      const struct change *change = &changes[(size_t)k * wavefronts->count + i];
      const enum placido_sigma_source source = placido_fit_variant_source(fit, k);
      geometry_known = geometry_known || source == PLACIDO_SIGMA_GEOMETRY;
      for (int j = 0; j < PLACIDO_WAVEFRONT_TERMS; j++) {
        add_square(&view->terms[j], change->terms_um[j], source);
      }
      for (int j = 0; j < WAVEFRONT_FIGURES_MAX; j++) {
        add_square(&view->figure_spreads[j], change->figures[j], source);
      }
    }
    for (int j = 0; j < PLACIDO_WAVEFRONT_TERMS; j++) {
      take_root(&view->terms[j], geometry_known);
    }
    for (int j = 0; j < WAVEFRONT_FIGURES_MAX; j++) {
      take_root(&view->figure_spreads[j], geometry_known);
    }
  }
}

static int find_spreads(struct wavefronts *wavefronts, const placido_fit *fit,
                        placido_error *err) {
  const int variants = placido_fit_variant_count(fit);
  struct change *changes =
      placido_memory_new((size_t)variants * wavefronts->count, sizeof *changes, err);
  if (!changes) {
    return PLACIDO_MEMORY;
  }
  int status = PLACIDO_OK, failed = variants;
#pragma omp parallel for schedule(dynamic)
  for (int k = 0; k < variants; k++) {
    placido_error reason = {0};
    const int ended = find_changes(changes, wavefronts, fit, k, &reason);
#pragma omp critical(placido_cli_wavefronts)
    if (ended != PLACIDO_OK && k < failed) {
      failed = k;
      status = placido_error_set(err, ended, "%s", reason.text);
    }
  }
  if (status == PLACIDO_OK) {
    gather(wavefronts, changes, fit);
  }
  placido_memory_free(changes);
  return status;
}

static void clear_spreads(struct wavefronts *wavefronts) {
  const struct spread unknown = {NAN, {NAN, NAN, NAN}};
  for (size_t i = 0; i < wavefronts->count; i++) {
    for (int j = 0; j < PLACIDO_WAVEFRONT_TERMS; j++) {
      wavefronts->items[i].terms[j] = unknown;
    }
    for (int j = 0; j < WAVEFRONT_FIGURES_MAX; j++) {
      wavefronts->items[i].figure_spreads[j] = unknown;
    }
  }
}

int wavefronts_find(struct wavefronts *wavefronts, const placido_surface *surface,
                    const placido_fit *fit, const struct settings *settings, placido_notes *notes,
                    placido_error *err) {
  *wavefronts = (struct wavefronts){0};
  const struct number_list *pupils = &settings->wavefront_mm;
  int status = PLACIDO_OK;
  for (size_t i = 0; i < pupils->count && status == PLACIDO_OK; i++) {
    placido_error reason = {0};
    status = find_view(&wavefronts->items[wavefronts->count], surface, pupils->values[i], settings,
                       notes, &reason);
    if (status == PLACIDO_QUALITY) {
      placido_notes_add(notes, "wavefront left out: %s", reason.text);
      status = PLACIDO_OK;
    } else if (status != PLACIDO_OK) {
      placido_error_set(err, status, "%s", reason.text);
    } else {
      wavefronts->count++;
    }
  }
  if (status == PLACIDO_OK && fit && wavefronts->count > 0) {
    status = find_spreads(wavefronts, fit, err);
  } else {
    clear_spreads(wavefronts);
  }
  return status;
}

void wavefronts_free(struct wavefronts *wavefronts) {
  for (size_t i = 0; i < wavefronts->count; i++) {
    placido_wavefront_free(&wavefronts->items[i].front);
  }
  wavefronts->count = 0;
}

static void print_figure(char *text, size_t size, const struct wavefront_view *view,
                         const char *name) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count && i < WAVEFRONT_FIGURES_MAX; i++) {
    const double sigma = view->figure_spreads[i].sigma;
    if (strcmp(figures[i].name, name) != 0) {
      continue;
    }
    if (isfinite(sigma)) {
      snprintf(text, size, "%.3f ± %.3f", view->figures[i], sigma);
    } else {
      snprintf(text, size, "%.3f", view->figures[i]);
    }
  }
}

void wavefronts_print(const struct wavefronts *wavefronts, const struct settings *settings) {
  for (size_t i = 0; i < wavefronts->count; i++) {
    const struct wavefront_view *view = &wavefronts->items[i];
    char spherical[64] = "", coma[64] = "", higher[64] = "";
    print_figure(spherical, sizeof spherical, view, "spherical_um");
    print_figure(coma, sizeof coma, view, "coma_um");
    print_figure(higher, sizeof higher, view, "rms_hoa_um");
    say(settings, "wavefront %g mm: spherical %s, coma %s, higher orders %s µm rms",
        view->front.eye.pupil_mm, spherical, coma, higher);
  }
}

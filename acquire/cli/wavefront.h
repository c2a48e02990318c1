/* The corneal wavefront of an examination: a pupil each, with error bars from the fit. */
#ifndef PLACIDO_CLI_WAVEFRONT_H
#define PLACIDO_CLI_WAVEFRONT_H

#include "acquire/cli/settings.h"

#include <placido/reconstruct.h>
#include <placido/wavefront.h>

#define WAVEFRONT_FIGURES_MAX 32

/* One standard deviation of a quantity, and each source's share: the squares add up. */
struct spread {
  double sigma, by[PLACIDO_SIGMA_SOURCES];
};

/* The wavefront of one pupil. Spreads are NaN where nothing is known. */
struct wavefront_view {
  placido_wavefront front;
  struct spread terms[PLACIDO_WAVEFRONT_TERMS];
  double figures[WAVEFRONT_FIGURES_MAX]; /* as placido_wavefront_figures orders them */
  struct spread figure_spreads[WAVEFRONT_FIGURES_MAX];
};

struct wavefronts {
  size_t count;
  struct wavefront_view items[LIST_MAX];
};

/* The wavefronts of a surface through the pupils that the settings ask for; one that the surface
 * does not fill is left out with a note. `fit` (may be NULL) gives the error bars. Free with
 * wavefronts_free. */
int wavefronts_find(struct wavefronts *wavefronts, const placido_surface *surface,
                    const placido_fit *fit, const struct settings *settings, placido_notes *notes,
                    placido_error *err);
void wavefronts_free(struct wavefronts *wavefronts);

/* Writes wavefront.json (`placido-wavefront/1`, docs/formats.md). */
int wavefronts_save(const struct wavefronts *wavefronts, const char *path, placido_error *err);

/* A few lines on stdout. */
void wavefronts_print(const struct wavefronts *wavefronts, const struct settings *settings);

#endif

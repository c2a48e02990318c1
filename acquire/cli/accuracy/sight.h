/* What is seen through a cornea by a pupil of 4 mm: point spread function, chart and acuity, about
 * the middle of the light, so that two corneas' compare. */
#ifndef PLACIDO_CLI_ACCURACY_SIGHT_H
#define PLACIDO_CLI_ACCURACY_SIGHT_H

#include "acquire/cli/accuracy/knob_values.h"
#include "acquire/cli/accuracy/table.h"
#include "simulate/eye.h"

#include <placido/simulate.h>

#define ACCURACY_PUPIL_MM 4.0

/* A chart and who looks at it; borrowed by every sight. */
struct accuracy_chart {
  placido_scene scene;
  placido_observer *observer; /* of enough trials to tell corneas apart: the same for all */
};

struct accuracy_sight {
  const placido_surface *surface; /* borrowed */
  placido_eye eye;                /* everything decided */
  placido_apex apex;
  double fixation_mm[2];
  placido_psf psf;
  placido_image image; /* of the chart */
  double logmar;       /* where none is found: the bound */
};

int accuracy_chart_new(struct accuracy_chart *chart, bool quick, placido_error *err);
void accuracy_chart_free(struct accuracy_chart *chart);

/* Rays as the knobs of the trace and of buckets say; the chart is spread with those of the
 * convolution where buckets are as the chart's. Free with accuracy_sight_free. Errors as
 * placido_psf_new. */
int accuracy_sight_new(struct accuracy_sight *sight, const placido_surface *surface,
                       const struct accuracy_chart *chart, const struct accuracy_knobs *knobs,
                       placido_error *err);
void accuracy_sight_free(struct accuracy_sight *sight);

/* The rays of this sight's eye as `knobs` say, in place of its own; `psf` is the caller's. */
int accuracy_sight_trace(placido_psf *psf, const struct accuracy_sight *sight,
                         const struct accuracy_knobs *knobs, placido_error *err);

/* The chart through a PSF; `seen` is the caller's. */
int accuracy_chart_see(placido_image *seen, const struct accuracy_chart *chart,
                       const placido_psf *psf, const struct accuracy_knobs *knobs,
                       placido_error *err);

/* The acuity of a PSF, or the bound that it is beyond. */
int accuracy_chart_read(double *logmar, const placido_observer *observer, const placido_psf *psf,
                        placido_error *err);

/* All errors of an accuracy table: what differs between two corneas and what is seen through
 * them. */
int accuracy_sights_differ(double error[ACCURACY_ERRORS], const struct accuracy_sight *one,
                           const struct accuracy_sight *other, placido_error *err);

#endif

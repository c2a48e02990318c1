/* What tests know of an eye beforehand: truths beside the samples, exact edge points from the
 * phantom, and how far a fit is off. */
#ifndef PLACIDO_TESTS_TRUTH_H
#define PLACIDO_TESTS_TRUTH_H

#include <placido/instrument.h>
#include <placido/mires.h>
#include <placido/reconstruct.h>
#include <placido/surface.h>

/* The surface of tests/data/samples/NAME.truth.json and the z of the cornea on the axis. Fails the
 * test where it cannot be read. */
placido_surface *truth_load(const char *name, double *axis_z_mm);

/* The instrument beside it. */
placido_instrument truth_instrument(const char *name);

/* Edge points where the phantom's exact forward trace puts them, plus Gaussian noise of sigma_px
 * (repeatable: keyed by edge and meridian). Points for which `hidden` (may be NULL) is true are
 * left out. Free with placido_mires_free. */
placido_mires truth_points(const placido_surface *surface, const placido_instrument *instrument,
                           int meridians, double sigma_px,
                           bool (*hidden)(int edge, double meridian_deg));

/* The points once more: a fit writes into its own. Free with placido_mires_free. */
placido_mires truth_copy(const placido_mires *mires);

/* Errors of a fit within a diameter, on a 0.1 mm grid of covered points: rms of elevation with the
 * median within 3 mm removed (micrometres), rms of axial power for r > 0.25 mm (337.5 D), share
 * covered, rms of elevation error over claimed sigma. */
typedef struct truth_error {
  double elevation_um, axial_D, covered, over_sigma;
} truth_error;

truth_error truth_compare(const placido_fit *fit, const placido_surface *truth, double from_mm,
                          double to_mm);

#endif

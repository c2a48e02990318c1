/* The knobs that accuracy is bought with, as values. */
#ifndef PLACIDO_CLI_ACCURACY_KNOB_VALUES_H
#define PLACIDO_CLI_ACCURACY_KNOB_VALUES_H

#include <placido/status.h>

/* 0 asks for the library's default. */
struct accuracy_knobs {
  /* mires */
  int meridians;
  double filter_px;
  /* fit */
  double knot_mm;
  int degree;
  double tolerance;
  /* trace */
  int samples;
  int pattern, light; /* enum placido_pattern_kind, placido_light_kind */
  /* psf */
  double bucket_arcmin;
  int buckets, wavelengths;
  /* convolution */
  int doubles; /* 0 or 1 */
  double memory_MB;
  int size_px;
  /* acuity */
  int trials;
};

/* Sets what `setting` names (setting_text.h) and leaves the others. Returns PLACIDO_OK or
 * PLACIDO_INPUT, which names the pair that is not understood. */
int accuracy_knobs_read(struct accuracy_knobs *knobs, const char *setting, placido_error *err);

#endif

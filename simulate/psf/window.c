/* Windows and waves as they are given: defaults filled in, ranges checked. */
#include "simulate/psf/diffraction.h"

static int default_to(int value, int otherwise) { return value == 0 ? otherwise : value; }

static int check_number(double value, double min, double max, const char *name,
                        placido_error *err) {
  if (value >= min && value <= max) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT, "%s is %g, expected %g to %g", name, value, min,
                           max);
}

int placido_window_settle(placido_window *settled, const placido_window *window,
                          placido_error *err) {
  *settled = *window;
  settled->buckets = default_to(settled->buckets, 257);
  settled->threads = default_to(settled->threads, 1);
  settled->bucket_arcmin = settled->bucket_arcmin == 0 ? 0.5 : settled->bucket_arcmin;
  if (settled->buckets % 2 == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%d buckets a side, expected an odd number",
                             settled->buckets);
  }
  int status = check_number(settled->buckets, 3, 4095, "buckets a side", err);
  if (status == PLACIDO_OK) {
    status = check_number(settled->bucket_arcmin, 1e-4, 600, "the bucket (arcmin)", err);
  }
  if (status == PLACIDO_OK) {
    status = check_number(settled->samples, 0, PLACIDO_DIFFRACTION_SAMPLES_MAX,
                          "samples across the pupil", err);
  }
  return status != PLACIDO_OK ? status : check_number(settled->threads, 1, 256, "threads", err);
}

int placido_waves_check(const placido_wave *waves, size_t count, placido_error *err) {
  if (count == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "no wavelength was given");
  }
  for (size_t i = 0; i < count; i++) {
    const struct { double value, min, max; const char *name; } ranges[] = {
      {waves[i].wavelength_nm, 100, 10000, "the wavelength (nm)"},
      {waves[i].weight, 0, 1e9, "a wavelength's weight"},
      {waves[i].defocus_D, -1000, 1000, "a wavelength's defocus (D)"},
      {waves[i].x_arcmin, -6000, 6000, "a wavelength's x (arcmin)"},
      {waves[i].y_arcmin, -6000, 6000, "a wavelength's y (arcmin)"},
    };
    for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++) {
      int status =
        check_number(ranges[k].value, ranges[k].min, ranges[k].max, ranges[k].name, err);
      if (status != PLACIDO_OK) {
        return status;
      }
    }
  }
  return PLACIDO_OK;
}

/* What lights are made of.
 *
 * Display: three primaries as sums of Gaussians, like those of a tube's blue and green phosphors
 * and a backlight's red with a filter that leaks violet, fitted so that their chromaticities are
 * those of IEC 61966-2-1 (sRGB); white has them in that standard's shares of luminance.
 *
 * Pictures in colour of things that reflect light: each plane has the light times a band of
 * reflectance. The three bands sum to 1 at every wavelength, so that grey reflects the light as it
 * is, and are parted where in daylight each has its primary's share of sRGB's luminance; their
 * chromaticities are then within 0.02 of the primaries', too.
 *
 * Daylight D65 and incandescent light (illuminant A): CIE 15, tables and equation. */
#include "simulate/spectrum/spectrum.h"

#include <math.h>

enum { DAYLIGHT_FIRST_NM = 380, DAYLIGHT_STEP_NM = 10, DAYLIGHT_COUNT = 41 };

static const double daylight_power[DAYLIGHT_COUNT] = {
  49.9755, 54.6482, 82.7549, 91.4860, 93.4318, 86.6823, 104.865, 117.008, 117.812,
  114.861, 115.923, 108.811, 109.354, 107.802, 104.790, 107.689, 104.405, 104.046,
  100.000, 96.3342, 95.7880, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992,
  80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.3490, 61.6040, 69.8856,
  75.0870, 63.5927, 46.4182, 66.8054, 63.3828};

/* Of red, green and blue, by the integrals of their lobes over V: what makes white. */
static const double primary_share[3] = {0.2126, 0.7152, 0.0722};
static const double primary_light[3] = {14.9926, 62.2728, 5.9520};

static double gaussian(double peak_nm, double full_width_nm, double wavelength_nm) {
  double from_peak = (wavelength_nm - peak_nm) / full_width_nm;
  return exp2(-4 * from_peak * from_peak);
}

static void display_power(double primaries[3], double wavelength_nm) {
  double green = gaussian(539.1, 78.3, wavelength_nm);
  primaries[0] = gaussian(613, 30, wavelength_nm) + 0.0228 * gaussian(440, 40, wavelength_nm);
  primaries[1] = green;
  primaries[2] = gaussian(450.8, 60, wavelength_nm) + 0.0263 * green;
}

static double daylight(double wavelength_nm) {
  double place = (wavelength_nm - DAYLIGHT_FIRST_NM) / DAYLIGHT_STEP_NM;
  place = fmin(fmax(place, 0), DAYLIGHT_COUNT - 1);
  int below = (int)fmin(floor(place), DAYLIGHT_COUNT - 2);
  double beyond = place - below;
  return (1 - beyond) * daylight_power[below] + beyond * daylight_power[below + 1];
}

/* Planck's law, relative to 560 nm, with the constants that define illuminant A. */
static double incandescent(double wavelength_nm) {
  const double second_constant_nm = 1.435e7 / 2848;
  double ratio = 560 / wavelength_nm;
  return ratio * ratio * ratio * ratio * ratio * expm1(second_constant_nm / 560) /
         expm1(second_constant_nm / wavelength_nm);
}

static double whole_light(enum placido_spectrum spectrum, double wavelength_nm) {
  switch (spectrum) {
  case PLACIDO_SPECTRUM_DAYLIGHT:
    return daylight(wavelength_nm);
  case PLACIDO_SPECTRUM_INCANDESCENT:
    return incandescent(wavelength_nm);
  default:
    return 1;
  }
}

/* Red, green and blue shares of the light that is reflected. */
static void reflect(double bands[3], double wavelength_nm) {
  const double blue_edge_nm = 492.5, red_edge_nm = 592.7, softness_nm = 10;
  double beyond_blue = 1 / (1 + exp((blue_edge_nm - wavelength_nm) / softness_nm));
  double red = 1 / (1 + exp((red_edge_nm - wavelength_nm) / softness_nm));
  bands[0] = red;
  bands[1] = beyond_blue - red;
  bands[2] = 1 - beyond_blue;
}

void placido_spectrum_power(double *power, int planes, enum placido_spectrum spectrum,
                            double wavelength_nm) {
  double bands[3];
  if (spectrum == PLACIDO_SPECTRUM_DISPLAY_SRGB) {
    display_power(bands, wavelength_nm);
    power[0] = 0;
    for (int k = 0; k < 3 && planes == 1; k++) {
      power[0] += bands[k] * primary_share[k] / primary_light[k];
    }
  } else {
    power[0] = whole_light(spectrum, wavelength_nm);
    reflect(bands, wavelength_nm);
    for (int k = 0; k < 3 && planes > 1; k++) {
      bands[k] *= whole_light(spectrum, wavelength_nm);
    }
  }
  for (int k = 0; k < 3 && planes > 1; k++) {
    power[k] = bands[k];
  }
}

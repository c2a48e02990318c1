/* A light in a few wavelengths: the density of its luminance over the scale of focus, cut into
 * cells, each of which becomes one wave with the cell's share and means. */
#include "simulate/spectrum/spectrum.h"

#include <math.h>

enum { FIRST_NM = 390, LAST_NM = 730, SAMPLES = LAST_NM - FIRST_NM + 1 };

/* Sums up to each nanometre. */
typedef struct sums {
  double density[SAMPLES + 1]; /* its square root over the scale of focus: where cells are cut */
  double light[SAMPLES + 1], wavelength[SAMPLES + 1], defocus[SAMPLES + 1];
} sums;

/* One nanometre more. */
static void add(sums *s, int i, double light, double wavelength_nm, double defocus_D,
                double step_D) {
  s->density[i + 1] = s->density[i] + sqrt(light * step_D);
  s->light[i + 1] = s->light[i] + light;
  s->wavelength[i + 1] = s->wavelength[i] + light * wavelength_nm;
  s->defocus[i + 1] = s->defocus[i] + light * defocus_D;
}

static void sum_up(sums *s, int count, enum placido_spectrum spectrum, double focus_nm) {
  for (int k = 0; k < count; k++) {
    s[k].density[0] = s[k].light[0] = s[k].wavelength[0] = s[k].defocus[0] = 0;
  }
  double below_D = placido_chromatic_defocus(FIRST_NM - 0.5, focus_nm);
  for (int i = 0; i < SAMPLES; i++) {
    double wavelength_nm = FIRST_NM + i, power[PLACIDO_VIEW_LIGHTS];
    double above_D = placido_chromatic_defocus(wavelength_nm + 0.5, focus_nm);
    double defocus_D = placido_chromatic_defocus(wavelength_nm, focus_nm);
    double efficiency = placido_luminous_efficiency(wavelength_nm);
    placido_spectrum_power(power, count, spectrum, wavelength_nm);
    for (int k = 0; k < count; k++) {
      add(&s[k], i, power[k] * efficiency, wavelength_nm, defocus_D, below_D - above_D);
    }
    below_D = above_D;
  }
}

/* A sum up to a place between nanometres. */
static double up_to(const double *sum, double place) {
  int below = (int)fmin(floor(place), SAMPLES - 1);
  return sum[below] + (place - below) * (sum[below + 1] - sum[below]);
}

/* Where the density reaches `level`, from `place` onwards. */
static double reach(const double *density, double level, double place) {
  int at = (int)floor(place);
  while (at < SAMPLES - 1 && density[at + 1] < level) {
    at++;
  }
  double step = density[at + 1] - density[at];
  return at + (step > 0 ? fmin(fmax((level - density[at]) / step, 0), 1) : 0);
}

static void cut(placido_light *light, const sums *s, int wavelengths) {
  double from = 0;
  light->count = wavelengths;
  for (int i = 0; i < wavelengths; i++) {
    double level = s->density[SAMPLES] * (i + 1) / wavelengths;
    double to = i + 1 < wavelengths ? reach(s->density, level, from) : SAMPLES;
    double share = up_to(s->light, to) - up_to(s->light, from);
    light->waves[i] = (placido_wave){
      .wavelength_nm = (up_to(s->wavelength, to) - up_to(s->wavelength, from)) / share,
      .weight = share / s->light[SAMPLES],
      .defocus_D = (up_to(s->defocus, to) - up_to(s->defocus, from)) / share};
    from = to;
  }
}

bool placido_spectrum_is_line(const placido_conditions *conditions) {
  return conditions->spectrum == PLACIDO_SPECTRUM_LINE;
}

double placido_spectrum_focus_nm(const placido_conditions *conditions) {
  return placido_spectrum_is_line(conditions) ? conditions->wavelength_nm : PLACIDO_FOCUS_NM;
}

int placido_spectrum_lights(placido_light lights[PLACIDO_VIEW_LIGHTS],
                            const placido_conditions *conditions, int planes, int wavelengths,
                            double focus_nm) {
  sums s[PLACIDO_VIEW_LIGHTS];
  if (placido_spectrum_is_line(conditions)) {
    double wavelength_nm = conditions->wavelength_nm;
    lights[0] = (placido_light){.count = 1};
    lights[0].waves[0] = (placido_wave){
      .wavelength_nm = wavelength_nm,
      .weight = 1,
      .defocus_D = placido_chromatic_defocus(wavelength_nm, focus_nm)};
    return 1;
  }
  int count = planes >= 3 ? 3 : 1;
  sum_up(s, count, conditions->spectrum, focus_nm);
  for (int k = 0; k < count; k++) {
    cut(&lights[k], &s[k], wavelengths);
  }
  return count;
}

/* Colour classes with the fixed steps of ISO 19980 annex B: 0.5, 1.0 or 1.5 D for curvature, 2,
 * 5, 10 or 20 micrometres for elevation. Fixed steps about a fixed centre make two eyes' maps
 * comparable. */
#include "report/scale.h"

#include "report/number.h"
#include "report/palette.h"

#include <math.h>
#include <string.h>

/* The middle of the clinical absolute scales; the mean of human corneas is near it. */
static const double centre_D = 43.5;
static const double keratometric = 337.5;

#define STEPS_MAX 6

/* One family of fixed steps. */
typedef struct family {
  double steps[STEPS_MAX];
  int count, classes;
  double centre; /* a class bound where `classes` is even, the middle of a class where it is odd */
} family;

static bool is_micrometre(const char *unit) {
  return strcmp(unit, "um") == 0 || strcmp(unit, "µm") == 0 || strcmp(unit, "μm") == 0;
}

static family find_family(const placido_map_kind *kind) {
  if (strcmp(kind->unit, "D") == 0) {
    return (family){{0.5, 1.0, 1.5}, 3, 20, centre_D};
  }
  if (is_micrometre(kind->unit)) {
    return (family){{2, 5, 10, 20}, 4, 21, 0};
  }
  double curvature = centre_D / keratometric, step = kind->step;
  return (family){{step, 2 * step, 5 * step, 10 * step}, 4, 20, curvature * curvature};
}

static placido_scale make_scale(const family *f, double step) {
  double middle = f->classes % 2 == 0 ? round(f->centre / step) * step : f->centre;
  return (placido_scale){middle - 0.5 * f->classes * step, step, f->classes, true};
}

/* The smallest of the family's steps that holds both. */
static placido_scale choose(const family *f, double low, double high) {
  placido_scale scale = make_scale(f, f->steps[0]);
  for (int i = 1; i < f->count; i++) {
    if (low >= scale.first && high <= scale.first + scale.classes * scale.step) {
      break;
    }
    scale = make_scale(f, f->steps[i]);
  }
  return scale;
}

placido_scale placido_scale_of_kind(const placido_map_kind *kind, double low, double high) {
  family f = find_family(kind);
  return choose(&f, low, high);
}

placido_scale placido_scale_for(const placido_map_kind *kind, enum placido_scale_mode mode,
                                double low, double high) {
  bool absolute = mode == PLACIDO_SCALE_ABSOLUTE;
  family f = find_family(kind);
  if (strcmp(kind->unit, "mm") == 0) {
    return absolute ? (placido_scale){0, kind->step, 10, false} : placido_scale_from_zero(high);
  }
  if (mode == PLACIDO_SCALE_ADAPTIVE && !is_micrometre(kind->unit) && isfinite(low + high)) {
    f.centre = (low + high) / 2;
  }
  return absolute ? make_scale(&f, kind->step) : choose(&f, low, high);
}

placido_scale placido_scale_of_difference(const char *unit, double low, double high) {
  static const family powers = {{0.1, 0.25, 0.5, 1.0, 1.5}, 5, 21, 0};
  static const family heights = {{0.5, 1, 2, 5, 10, 20}, 6, 21, 0};
  return choose(is_micrometre(unit) ? &heights : &powers, low, high);
}

placido_scale placido_scale_from_zero(double high) {
  static const double multiples[] = {1, 2, 5, 10};
  double wanted = high > 0 ? high / 10 : 0.1;
  double decade = pow(10, floor(log10(wanted)));
  int i = 0;
  while (i < 3 && multiples[i] * decade < wanted * (1 - 1e-9)) {
    i++;
  }
  double step = multiples[i] * decade;
  int classes = (int)fmin(fmax(ceil(high / step - 1e-9), 2), 10);
  return (placido_scale){0, step, classes, false};
}

int placido_scale_step(const placido_scale *scale, double value) {
  double steps = floor((value - scale->first) / scale->step);
  int beyond = scale->classes / 2;
  if (steps < -beyond) {
    return -beyond;
  }
  return steps > scale->classes + beyond ? scale->classes + beyond : (int)steps;
}

int placido_scale_class(const placido_scale *scale, double value) {
  int step = placido_scale_step(scale, value);
  if (step < 0) {
    return 0;
  }
  return step < scale->classes ? step : scale->classes - 1;
}

static bool has_decimals(double value, int decimals) {
  double scaled = value * pow(10, decimals);
  return fabs(scaled - round(scaled)) < 1e-6;
}

void placido_scale_write(char *text, size_t size, const placido_scale *scale, int step) {
  int decimals = 0;
  while (decimals < 8 &&
         !(has_decimals(scale->first, decimals) && has_decimals(scale->step, decimals))) {
    decimals++;
  }
  placido_number_write(text, size, scale->first + step * scale->step, decimals);
}

placido_rgb placido_scale_colour(const placido_scale *scale, int class_index) {
  if (!scale->diverging) {
    return placido_palette_sequential((double)class_index / (scale->classes - 1));
  }
  int half = scale->classes / 2, offset = class_index - half;
  if (scale->classes % 2 == 0 && offset >= 0) {
    offset++; /* an even scale has no neutral class: its middle is a bound */
  }
  return placido_palette_diverging((double)offset / half);
}

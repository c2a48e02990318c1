/* The layout of Bailey and Lovie (Am J Optom Physiol Opt 53 (1976) 740) as in the ETDRS charts
 * (Ferris et al., Am J Ophthalmol 94 (1982) 91): five letters a line, a letter's width between
 * letters, the next line's height between lines. */
#include "simulate/charts/logmar.h"

#include "simulate/charts/paint.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STEPS 14 /* of the ETDRS charts, 1.0 to -0.3; orders repeat beyond */

static const double step_logmar = 0.1, first_logmar = 1.0, last_logmar = -0.3;
static const double margin_arcmin = 14, label_cell_arcmin = 1.5, label_width_arcmin = 42;

/* Letters of ETDRS chart 1. */
static const char *const letter_orders[STEPS] = {
  "NCKZO", "RHSDK", "DOVHR", "CZRHS", "ONHRC", "DKSNV", "ZSOKN",
  "CKDNR", "SRZKD", "HZOVC", "NVDOK", "VHCNO", "SVHCZ", "OZDVK"};

/* Directions in eighths of a turn: each equally often, none twice in a row, also where only the
 * upright and level ones are used (halved). */
static const char *const turn_orders[STEPS] = {
  "36150", "24612", "73057", "56021", "46035", "74312", "71425",
  "74130", "20647", "56314", "62507", "37506", "31465", "74203"};

placido_chart_lines placido_logmar_usual(void) {
  return (placido_chart_lines){first_logmar, last_logmar, 8};
}

int placido_logmar_check(const placido_chart_lines *lines, placido_error *err) {
  const double low = -1, high = 2;
  if (!(lines->first_logmar >= lines->last_logmar) || !(lines->last_logmar >= low) ||
      !(lines->first_logmar <= high)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "lines from %g to %g logMAR: expected from %g down to %g",
                             lines->first_logmar, lines->last_logmar, high, low);
  }
  if (lines->directions != 4 && lines->directions != 8) {
    return placido_error_set(err, PLACIDO_INPUT, "%d directions of rings, expected 4 or 8",
                             lines->directions);
  }
  return PLACIDO_OK;
}

int placido_logmar_count(const placido_chart_lines *lines) {
  const double rounding = 1e-6;
  return 1 + (int)floor((lines->first_logmar - lines->last_logmar) / step_logmar + rounding);
}

static double height_of(const placido_chart_lines *lines, int index) {
  return 5 * pow(10, lines->first_logmar - index * step_logmar);
}

static int letter_of(enum placido_optotype optotype, int directions, int order, int place) {
  if (optotype == PLACIDO_OPTOTYPE_SLOAN) {
    const char *all = "CDHKNORSVZ";
    return (int)(strchr(all, letter_orders[order][place]) - all);
  }
  int eighths = turn_orders[order][place] - '0';
  if (optotype == PLACIDO_OPTOTYPE_E) {
    return eighths / 2;
  }
  return directions == 4 ? eighths / 2 * 2 : eighths;
}

placido_logmar_line placido_logmar_place(const placido_chart_lines *lines,
                                         enum placido_optotype optotype, int index) {
  double widest = (2 * PLACIDO_LOGMAR_LETTERS - 1) * height_of(lines, 0);
  placido_logmar_line line = {.logmar = lines->first_logmar - index * step_logmar,
                              .height_arcmin = height_of(lines, index),
                              .top_arcmin = margin_arcmin};
  for (int i = 1; i <= index; i++) {
    line.top_arcmin += height_of(lines, i - 1) + height_of(lines, i);
  }
  line.pitch_arcmin = 2 * line.height_arcmin;
  line.left_arcmin = margin_arcmin + label_width_arcmin + widest / 2 -
                     (PLACIDO_LOGMAR_LETTERS - 0.5) * line.height_arcmin;
  int order = (int)lround((first_logmar - line.logmar) / step_logmar) % STEPS;
  for (int i = 0; i < PLACIDO_LOGMAR_LETTERS; i++) {
    line.letters[i] = letter_of(optotype, lines->directions, order < 0 ? order + STEPS : order, i);
  }
  return line;
}

void placido_logmar_measure(const placido_chart_lines *lines, double *width_arcmin,
                            double *height_arcmin) {
  placido_logmar_line last =
    placido_logmar_place(lines, PLACIDO_OPTOTYPE_SLOAN, placido_logmar_count(lines) - 1);
  *width_arcmin = (2 * PLACIDO_LOGMAR_LETTERS - 1) * height_of(lines, 0) +
                  2 * (margin_arcmin + label_width_arcmin);
  *height_arcmin = last.top_arcmin + last.height_arcmin + margin_arcmin;
}

/* The denominator as charts print it: tenths of a log unit have preferred numbers (R10, ISO 3). */
static void write_fraction(char *text, size_t size, double logmar) {
  static const double preferred[10] = {1, 1.25, 1.6, 2, 2.5, 3.2, 4, 5, 6.3, 8};
  double steps = 3 + logmar / step_logmar, nearest = round(steps); /* 20 is three steps above 10 */
  double denominator = 20 * pow(10, logmar);
  if (fabs(steps - nearest) < 1e-6) {
    double decades = floor(nearest / 10);
    denominator = preferred[(int)(nearest - 10 * decades)] * pow(10, 1 + decades);
  }
  snprintf(text, size, "20/%.3g", denominator);
}

/* Beside a line and as high as its letters, but no higher than need be. */
static void draw_labels(placido_image *image, double arcmin_per_px, double width_arcmin,
                        const placido_logmar_line *line) {
  double cell = fmin(label_cell_arcmin, line->height_arcmin / 5);
  double top = line->top_arcmin + line->height_arcmin / 2 - 2.5 * cell;
  char text[32];
  write_fraction(text, sizeof text, line->logmar);
  placido_paint_text(image, arcmin_per_px, margin_arcmin, top, cell, text);
  double shown = round(line->logmar * 100) / 100;
  snprintf(text, sizeof text, shown * 10 == round(shown * 10) ? "%.1f" : "%.2f",
           shown == 0 ? 0 : shown);
  double written = (4 * (double)strlen(text) - 1) * cell;
  placido_paint_text(image, arcmin_per_px, width_arcmin - margin_arcmin - written, top, cell, text);
}

void placido_logmar_draw(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                         const placido_chart_lines *lines) {
  double width, height;
  placido_logmar_measure(lines, &width, &height);
  for (int i = 0; i < placido_logmar_count(lines); i++) {
    placido_logmar_line line = placido_logmar_place(lines, chart->optotype, i);
    double half = line.height_arcmin / 2;
    for (int k = 0; k < PLACIDO_LOGMAR_LETTERS; k++) {
      placido_optotype_draw(image, chart->optotype, line.letters[k], line.height_arcmin,
                            line.left_arcmin + half + k * line.pitch_arcmin,
                            line.top_arcmin + half, arcmin_per_px);
    }
    draw_labels(image, arcmin_per_px, width, &line);
  }
}

/* Colour classes: which value gets which colour, with ISO 19980's fixed steps. */
#ifndef PLACIDO_REPORT_SCALE_H
#define PLACIDO_REPORT_SCALE_H

#include "report/canvas.h"
#include "report/report.h"

#define PLACIDO_CLASSES_MAX 21

/* Class k holds first + k step up to (not including) first + (k + 1) step; the first and the
 * last class take everything beyond, too. */
typedef struct placido_scale {
  double first, step;
  int classes;
  bool diverging; /* else from light to dark */
} placido_scale;

/* The scale of a kind of map whose values run from low to high: the smallest of its family's
 * fixed steps whose window holds both, else the largest. Families by unit: dioptres about 43.5 D
 * with 0.5, 1.0 and 1.5 D, 20 classes; micrometres about 0 with 2, 5, 10 and 20 um, 21 classes
 * (zero stands in the middle of one); any other about the curvature of 43.5 D with 1, 2, 5 and
 * 10 times kind->step. */
placido_scale placido_scale_of_kind(const placido_map_kind *kind, double low, double high);

/* The same in another way: PLACIDO_SCALE_ABSOLUTE is one and the same scale for every eye, with
 * kind->step; PLACIDO_SCALE_ADAPTIVE puts dioptres (and other curvatures) about the middle of low
 * and high, rounded to the step. Distances (mm) begin at 0 and have light to dark colours. */
placido_scale placido_scale_for(const placido_map_kind *kind, enum placido_scale_mode mode,
                                double low, double high);

/* For a difference of values in `unit` (D or micrometres): about 0, the smallest of 0.1, 0.25, 0.5,
 * 1 and 1.5 D or of 0.5, 1, 2, 5, 10 and 20 um whose window holds both, else the largest. */
placido_scale placido_scale_of_difference(const char *unit, double low, double high);

/* For a quantity from 0 to `high`: at most ten classes with a step of 1, 2 or 5 times a power of
 * ten. */
placido_scale placido_scale_from_zero(double high);

/* The class of a finite value, 0 to classes - 1. */
int placido_scale_class(const placido_scale *scale, double value);

/* The number of the step that a value lies in, counted as classes are, but up to half a scale
 * beyond either end: contours go on inside the open-ended classes, though not without end. */
int placido_scale_step(const placido_scale *scale, double value);

/* Writes the lower bound of a class or step, with as many decimals as all bounds of the scale
 * need. */
void placido_scale_write(char *text, size_t size, const placido_scale *scale, int step);

placido_rgb placido_scale_colour(const placido_scale *scale, int class_index);

#endif

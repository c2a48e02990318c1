/* Generated charts and pictures: drawn in minutes of arc, at any scale, by area coverage. */
#ifndef PLACIDO_SIMULATE_CHART_H
#define PLACIDO_SIMULATE_CHART_H

#include "simulate/charts/optotype.h"

#include <placido/image.h>
#include <placido/scene.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct placido_chart placido_chart;

/* One chart: the size of the picture and what is drawn in it. */
struct placido_chart {
  const char *name, *help;
  double width_arcmin, height_arcmin; /* 0: what its lines need */
  int planes;                         /* 1, or 3 in colour */
  enum placido_optotype optotype;          /* of a chart in lines */
  void (*draw)(placido_image *image, double arcmin_per_px, const placido_chart *chart,
               const placido_chart_lines *lines);
  double luminance_cd_m2;             /* of white; 0: not known */
  double distance_m;                  /* where the eye looks; 0: far */
  enum placido_spectrum spectrum;
  double (*vergence_D)(double x_arcmin, double y_arcmin); /* of what is seen there, 1 / distance in
                                         m; NULL: all at distance_m */
};

/* The charts that this build draws, `*count` rows. */
const placido_chart *placido_chart_table(size_t *count);

/* The chart called `name`, NULL where there is none. */
const placido_chart *placido_chart_find(const char *name);

/* Draws a chart, white 1 and black 0 (in colour: linear light). `lines` may be NULL: the chart's
 * own. Free with placido_image_free. Returns PLACIDO_OK, PLACIDO_INPUT (arcmin_per_px not within
 * 0.05 to 4; lines out of range, or for a chart that has its own; a picture too large),
 * PLACIDO_MEMORY. */
int placido_chart_new(placido_image *image, const placido_chart *chart,
                      const placido_chart_lines *lines, double arcmin_per_px, placido_error *err);

/* A line of tumbling E's, all of one size. */
typedef struct placido_e_line {
  int denominator;                    /* of the Snellen fraction 20/... */
  double height_arcmin;               /* 5' at 20/20 */
  double left_arcmin, top_arcmin;     /* of the first E; x to the right, y downwards */
  double pitch_arcmin;                /* from one E to the next */
  char directions[5];                 /* where the arms point: r, u, l, d */
} placido_e_line;

/* The lines of the tumbling-E chart, largest first, `*count` of them. */
const placido_e_line *placido_e_lines(size_t *count);

void placido_draw_tumbling_e(placido_image *image, double arcmin_per_px,
                             const placido_chart *chart, const placido_chart_lines *lines);
void placido_draw_fan(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                      const placido_chart_lines *lines);

/* Radial lines 15 degrees apart and 1' wide around (x, y), from 5' to radius_arcmin. */
void placido_draw_spokes(placido_image *image, double arcmin_per_px, double x_arcmin,
                         double y_arcmin, double radius_arcmin);

#endif

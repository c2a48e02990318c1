/* Generated pictures in colour: scenes to be looked at, drawn by this project. */
#ifndef PLACIDO_SIMULATE_PICTURES_H
#define PLACIDO_SIMULATE_PICTURES_H

#include "simulate/charts/chart.h"

void placido_draw_building(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                           const placido_chart_lines *lines);
void placido_draw_colours(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                          const placido_chart_lines *lines);
void placido_draw_street(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                         const placido_chart_lines *lines);
void placido_draw_stars(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                        const placido_chart_lines *lines);
void placido_draw_monitor(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                          const placido_chart_lines *lines);
void placido_draw_page(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                       const placido_chart_lines *lines);

/* What stands where in that one: 1 / distance in m. */
double placido_page_vergence_D(double x_arcmin, double y_arcmin);

#endif

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

#endif

/* Black shapes on a white picture, exact to the area that they cover of each pixel. */
#ifndef PLACIDO_SIMULATE_PAINT_H
#define PLACIDO_SIMULATE_PAINT_H

#include "simulate/charts/outline.h"

#include <placido/image.h>

/* Takes from every pixel the share that a polygon of `count` corners (3 to PLACIDO_EDGES_MAX, in
 * minutes of arc) covers. Shapes that do not overlap add up exactly. */
void placido_paint_polygon(placido_image *image, double arcmin_per_px,
                           const placido_corner *corners, int count);

void placido_paint_rectangle(placido_image *image, double arcmin_per_px, double left, double top,
                             double width, double height);

/* Writes digits, '/', '.' and '-' in cells of `cell_arcmin`, 3 wide and 5 high, from (left, top)
 * on. */
void placido_paint_text(placido_image *image, double arcmin_per_px, double left, double top,
                        double cell_arcmin, const char *text);

#endif

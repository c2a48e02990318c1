/* Coloured shapes for generated pictures. Colours are linear light relative to white. */
#ifndef PLACIDO_SIMULATE_BRUSH_H
#define PLACIDO_SIMULATE_BRUSH_H

#include "simulate/charts/outline.h"

#include <placido/image.h>

/* Where and how large it draws; the picture is the caller's, with 3 planes. */
typedef struct placido_brush {
  placido_image *image;
  double arcmin_per_px;
} placido_brush;

typedef struct placido_colour {
  float red, green, blue;
} placido_colour;

/* Lengths in minutes of arc from the picture's top left corner, y downwards. What is drawn later
 * covers what was there. */
void placido_brush_rectangle(const placido_brush *brush, double left, double top, double width,
                             double height, placido_colour colour);
void placido_brush_polygon(const placido_brush *brush, const placido_corner *corners, int count,
                           placido_colour colour);
void placido_brush_disc(const placido_brush *brush, double x, double y, double radius,
                        placido_colour colour);

/* Writes Sloan letters (others are left blank), `height` high, half of it between them. */
void placido_brush_write(const placido_brush *brush, double left, double top, double height,
                         const char *text, placido_colour colour);

/* `colour` times `factor`. */
placido_colour placido_colour_times(placido_colour colour, double factor);

/* A number from 0 to 1 that depends on nothing but `seed` and `index`: for walls that look laid by
 * hand, the same in every run. */
double placido_brush_chance(unsigned seed, unsigned index);

#endif

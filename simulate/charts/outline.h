/* Shapes bounded by straight lines and arcs of circles, and the area of every pixel that they
 * cover: exact to rounding, at any scale and position. */
#ifndef PLACIDO_SIMULATE_OUTLINE_H
#define PLACIDO_SIMULATE_OUTLINE_H

#include <placido/image.h>

#define PLACIDO_EDGES_MAX 64

/* A point; x to the right, y downwards. */
typedef struct placido_corner {
  double x, y;
} placido_corner;

/* A straight line, or an arc within one quarter of its circle: x and y run one way. Pixels. */
typedef struct placido_edge {
  placido_corner from, to;
  placido_corner centre;
  double radius;      /* 0: straight */
  int side_x, side_y; /* of the centre: -1 or 1 */
} placido_edge;

/* Closed lines. What they wind around once is inside; a hole runs the other way around. */
typedef struct placido_outline {
  placido_corner origin; /* where (0, 0) of the shape's own units lies, pixels */
  double px_per_unit;
  int eighths;           /* of a full turn, counterclockwise as seen */
  placido_corner start, at;
  int count;
  placido_edge edges[PLACIDO_EDGES_MAX];
} placido_outline;

/* An empty shape whose units are placed, scaled and turned as said. */
placido_outline placido_outline_new(double x_px, double y_px, double px_per_unit, int eighths);

/* Begins a closed line at (x, y), in the shape's units. */
void placido_outline_move(placido_outline *outline, double x, double y);
void placido_outline_line(placido_outline *outline, double x, double y);

/* A straight line to the arc's beginning, unless it is there, then the arc around (x, y). Angles
 * count from +x, counterclockwise as seen; to_deg below from_deg runs clockwise. */
void placido_outline_arc(placido_outline *outline, double x, double y, double radius,
                         double from_deg, double to_deg);

/* Back to where the closed line began. */
void placido_outline_close(placido_outline *outline);

/* A closed line through `count` corners. */
void placido_outline_polygon(placido_outline *outline, const placido_corner *corners, int count);

/* Takes from every pixel of the colour planes the share that the shape covers, down to 0: black on
 * white. Shapes that do not overlap add up exactly. */
void placido_outline_blacken(placido_image *image, const placido_outline *outline);

/* Lays a colour over the picture, one value a plane: pixel + share * (colour - pixel). */
void placido_outline_fill(placido_image *image, const placido_outline *outline,
                          const float *colour);

#endif

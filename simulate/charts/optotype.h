/* Single optotypes: tumbling E, Landolt C, Sloan letters, drawn by exact area coverage. */
#ifndef PLACIDO_SIMULATE_OPTOTYPE_H
#define PLACIDO_SIMULATE_OPTOTYPE_H

#include <placido/image.h>

enum placido_optotype {
  PLACIDO_OPTOTYPE_E,       /* 4: arms to the right, up, left, down */
  PLACIDO_OPTOTYPE_LANDOLT, /* 8: gap to the right, up right, up, ... in steps of 45 degrees; the
                               even ones are the four-choice test */
  PLACIDO_OPTOTYPE_SLOAN,   /* 10: C D H K N O R S V Z */
};

/* How many of a kind there are. */
int placido_optotype_count(enum placido_optotype kind);

/* The name of one: "right" ..., "C" ... A constant. */
const char *placido_optotype_name(enum placido_optotype kind, int which);

/* Takes one optotype from every colour plane of a picture (which is white, 1, where black letters
 * on white are wanted): pixel - covered area, not below 0. `which` counts from 0 and is taken
 * modulo the kind's count. size_arcmin is its height and width, five strokes: 5' at 20/20.
 * (x_arcmin, y_arcmin) is the middle of its square, from the picture's top left corner, y
 * downwards; what falls outside of the picture is cut off. Exact to float rounding; allocates
 * nothing. */
void placido_optotype_draw(placido_image *image, enum placido_optotype kind, int which,
                           double size_arcmin, double x_arcmin, double y_arcmin,
                           double arcmin_per_px);

#endif

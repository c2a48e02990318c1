/* A small picture of rings whose contrast a test knows. */
#ifndef PLACIDO_TESTS_ACQUIRE_RINGS_H
#define PLACIDO_TESTS_ACQUIRE_RINGS_H

#include <placido/frame.h>

/* Draws square rings on a square frame of 8 bits: slopes along x or y, which is radial enough
 * for a score. */
void rings_draw(placido_frame *frame, int contrast);

#endif

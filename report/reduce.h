/* A picture in few colours: a palette and an index a pixel, for files of a fifth of the size. */
#ifndef PLACIDO_REPORT_REDUCE_H
#define PLACIDO_REPORT_REDUCE_H

#include "report/canvas.h"

#include <stdint.h>

#define PLACIDO_COLOURS_MAX 256

/* The canvas in at most 256 colours. */
typedef struct placido_reduced {
  int count;                                /* 0: it has too many to look the same */
  uint8_t colours[PLACIDO_COLOURS_MAX][3];  /* red, green, blue */
  uint8_t *indices;                         /* width * height, rows downwards */
} placido_reduced;

/* Exact where the canvas has no more than 256 colours. Where it has more, rare ones (of smoothed
 * edges, mostly) become their nearest neighbours; where that would change the picture by more than
 * 2 of 255 a channel in the root mean square, count is 0. Free with placido_reduced_free. PLACIDO_OK,
 * PLACIDO_MEMORY. */
int placido_reduce(placido_reduced *reduced, const placido_canvas *canvas, placido_error *err);
void placido_reduced_free(placido_reduced *reduced);

#endif

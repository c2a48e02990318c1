/* Planes spread by a grid of nodes, each of which has its own spread: convolved piece by piece
 * between the nodes. */
#ifndef PLACIDO_SIMULATE_MOSAIC_H
#define PLACIDO_SIMULATE_MOSAIC_H

#include "simulate/plan/view.h"

#include <placido/convolution.h>

/* A plane of the canvas, and the transfer of its light at every node, row by row. `target` is apart
 * from every source; light is added to it where there are several nodes, and takes its place where
 * there is one. */
typedef struct placido_sheet {
  const float *source;
  float *target;
  placido_transfer *const *transfers;
} placido_sheet;

/* Pieces of a canvas for spreads up to one reach. */
typedef struct placido_mosaic {
  placido_convolver *convolver; /* of a piece; of the whole canvas where there is one node */
  int reach;
  int width_px, height_px;      /* of the canvas */
  int piece_width_px, piece_height_px; /* a piece and as far as it is spread */
  int nodes, threads;
  float *across, *down;         /* where columns and rows stand among the nodes */
} placido_mosaic;

/* For the view's canvas and nodes. Free with placido_mosaic_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_mosaic_new(placido_mosaic *mosaic, const placido_view *view, int reach,
                       placido_error *err);
void placido_mosaic_free(placido_mosaic *mosaic);

/* Every sheet spread: each node spreads its share of each sample. The same bits for any number of
 * threads. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_mosaic_run(const placido_mosaic *mosaic, const placido_sheet *sheets, int count,
                       placido_error *err);

#endif

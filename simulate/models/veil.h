/* The veil that scattered light lays over a picture: smooth, so that coarse cells carry it. */
#ifndef PLACIDO_SIMULATE_VEIL_H
#define PLACIDO_SIMULATE_VEIL_H

#include "simulate/models/glare.h"

#include <placido/image.h>
#include <placido/status.h>

enum { PLACIDO_VEIL_PLANES = 4 };

/* How large a cell is, where the picture is not wider than so many cells. */
#define PLACIDO_VEIL_CELL_ARCMIN 2.0
#define PLACIDO_VEIL_CELLS_MAX 512

/* Scattered light at the corners of cells: what is in excess of an even veil of the mean light. */
typedef struct placido_veil {
  double share;                     /* of the light that is scattered */
  double mean[PLACIDO_VEIL_PLANES]; /* light of the picture */
  int cell_px, columns, rows;       /* corners */
  int margin_px;                    /* the first corner stands there, from the left and the top */
  int planes;
  float *excess;                    /* planes * rows * columns */
} placido_veil;

/* Of a picture's light, all planes alike, alpha too. On every side margin_px are not looked at.
 * Around the picture it goes on with its mean light, so that an even picture stays even, exactly.
 * What comes of a source: the sum of its light times the glare function, wherever it stands in a
 * cell (hat functions keep its centre). Free with placido_veil_free. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_veil_new(placido_veil *veil, const placido_image *light, int margin_px,
                     double arcmin_per_px, const placido_glare *glare, int threads,
                     placido_error *err);
void placido_veil_free(placido_veil *veil);

/* Takes the scattered share from every sample of `picture`, which has the size of the one that the
 * veil is of, and lays the veil over it. */
void placido_veil_lay(placido_image *picture, const placido_veil *veil, int threads);

#endif

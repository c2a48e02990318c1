/* The mires' edges found in one frame: where they are, which they are, how sure that is. */
#ifndef PLACIDO_MIRES_H
#define PLACIDO_MIRES_H

#include <placido/frame.h>
#include <placido/instrument.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct placido_mire_point {
  int edge;            /* index into the instrument's edges, 0 the innermost */
  double meridian_deg; /* about the mires' centre, 0..360, from +x (right) towards +y (up) */
  double u_px, v_px;   /* sub-pixel position in the image */
  double sigma_px;     /* standard deviation across the edge */
  bool used;           /* taken by the surface fit */
  double residual_px;  /* distance from the fitted surface's edge; NaN before the fit */
  bool folded;         /* where the cornea seems to mirror the mires twice: trust no place there */
} placido_mire_point;

typedef struct placido_mires {
  double centre_u_px, centre_v_px; /* the mires' centre: the reflection of the vertex */
  int edge_count, meridian_count;
  size_t count;
  placido_mire_point *points; /* ordered by edge, then meridian */
  size_t doubtful_count;
  placido_mire_point *doubtful; /* seen and numbered, but not to be fitted to (`used` is false): a
                                   lash, a reflection or saturation may pull them. Same order */
  double coverage;            /* share of edge_count × meridian_count that was found, doubtful
                                      or not */
  double stray;    /* share of the meridians on which strong edges among the numbered ones have no
                      number: lashes, or a cornea that folds the mires */
  double folded;   /* share of the meridians on which the mires show a fold */
  double contrast;            /* mean edge height over the image's full range */
} placido_mires;

/* Knobs of the detection; zero means the default in brackets. */
typedef struct placido_mires_options {
  int meridians;        /* [360] */
  double filter_px;     /* standard deviation of the smoothing along the mires in which edges are
                           found and measured, 0.6 to 4 [1] */
  int edges_min;        /* fewest edges that must be seen on a fifth of the meridians [5] */
  int threads;          /* [1]; the result does not depend on it */
} placido_mires_options;

/* Finds, measures and numbers the mires of a frame. An edge that cannot be numbered is left out.
 * Free with placido_mires_free. Returns PLACIDO_OK, PLACIDO_INPUT (frame of another size than
 * the instrument's), PLACIDO_QUALITY (no mires, or too few edges), PLACIDO_MEMORY. */
int placido_mires_find(placido_mires *mires, const placido_frame *frame,
                       const placido_instrument *instrument,
                       const placido_mires_options *options, placido_notes *notes,
                       placido_error *err);

void placido_mires_free(placido_mires *mires);

/* Writes mires.csv (docs/formats.md) by way of a temporary name. */
int placido_mires_save(const placido_mires *mires, const char *path, placido_error *err);

#endif

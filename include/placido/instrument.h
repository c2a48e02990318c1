/* The topographer's geometry: where its camera stands and where its mires' edges are.
 * File format `placido-instrument/1` (docs/formats.md). */
#ifndef PLACIDO_INSTRUMENT_H
#define PLACIDO_INSTRUMENT_H

#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>

#define PLACIDO_EDGES_MAX 256

enum placido_camera_model {
  PLACIDO_PINHOLE,    /* normalised ((x-px)/(pz-z), -(y-py)/(pz-z)) */
  PLACIDO_TELECENTRIC /* normalised (x-px, -(y-py)) in mm, no division */
};

/* A circle about the z axis at which the mires change between bright and dark. */
typedef struct placido_edge {
  double radius_mm, z_mm;
} placido_edge;

/* A value: copy it freely, nothing to free. */
typedef struct placido_instrument {
  char name[128];
  enum placido_camera_model model;
  int width_px, height_px;
  double focal_px[2];      /* pinhole: focal length; telecentric: pixels per mm; along u and v */
  double principal_px[2];  /* (u, v); (0, 0) is the centre of the top-left pixel */
  double distortion[5];    /* k1 k2 p1 p2 k3 of OpenCV's model, on normalised coordinates */
  double position_mm[3];   /* the entrance pupil; the camera looks along -z */
  bool first_band_bright;  /* brightness of the band between edge 0 and edge 1 */
  int edge_count;          /* at least 1 */
  placido_edge edges[PLACIDO_EDGES_MAX]; /* from the innermost in the image outwards */
  bool calibrated;         /* false: nominal geometry, which every report must show. A file
                              that does not say is believed calibrated only if it has "sigma" */
} placido_instrument;

/* Reads an instrument file. Unknown keys give one warning line in `notes` (may be NULL).
 * Refuses, naming file, line and field: unknown format or version, missing fields, wrong types,
 * sizes, radii or focal lengths that are not positive and finite, more than PLACIDO_EDGES_MAX
 * edges. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_instrument_load(placido_instrument *instrument, const char *path,
                            placido_notes *notes, placido_error *err);

/* Writes an instrument file, by way of a temporary name. */
int placido_instrument_save(const placido_instrument *instrument, const char *path,
                            placido_error *err);

#endif

/* The numbered crossings by edge and meridian. */
#ifndef PLACIDO_MIRES_TRACKS_H
#define PLACIDO_MIRES_TRACKS_H

#include "reconstruct/mires/edges.h"

#define PLACIDO_TRACKS_NONE ((size_t)-1)

/* Which crossing an edge has on a meridian: row by row, an edge a row. */
typedef struct placido_tracks {
  int edges, meridians;
  size_t *at; /* index into the crossings' list, or PLACIDO_TRACKS_NONE */
} placido_tracks;

/* As many edges as have numbers. Free with placido_tracks_free. */
int placido_tracks_new(placido_tracks *tracks, const placido_crossings *crossings,
                       placido_error *err);
void placido_tracks_free(placido_tracks *tracks);

/* The crossing of an edge on a meridian, which is counted on round the circle, once either way. */
static inline size_t placido_tracks_at(const placido_tracks *tracks, int edge, int meridian) {
  int m = meridian < 0                    ? meridian + tracks->meridians
          : meridian >= tracks->meridians ? meridian - tracks->meridians
                                          : meridian;
  return tracks->at[(size_t)edge * (size_t)tracks->meridians + (size_t)m];
}

#endif

/* A table of all edges on all meridians. */
#include "reconstruct/mires/tracks.h"

#include "base/memory.h"

int placido_tracks_new(placido_tracks *tracks, const placido_crossings *crossings,
                       placido_error *err) {
  *tracks = (placido_tracks){.meridians = crossings->meridians};
  for (size_t i = 0; i < crossings->count; i++) {
    int edge = crossings->list[i].edge;
    tracks->edges = edge >= tracks->edges ? edge + 1 : tracks->edges;
  }
  size_t cells = (size_t)tracks->edges * (size_t)tracks->meridians;
  tracks->at = placido_memory_new(cells, sizeof *tracks->at, err);
  if (!tracks->at) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < cells; i++) {
    tracks->at[i] = PLACIDO_TRACKS_NONE;
  }
  for (size_t i = 0; i < crossings->count; i++) {
    const placido_crossing *c = &crossings->list[i];
    if (c->edge >= 0) {
      tracks->at[(size_t)c->edge * (size_t)tracks->meridians + (size_t)c->meridian] = i;
    }
  }
  return PLACIDO_OK;
}

void placido_tracks_free(placido_tracks *tracks) {
  placido_memory_free(tracks->at);
  *tracks = (placido_tracks){0};
}

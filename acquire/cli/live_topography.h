/* Topography beside the live view: the newest frame's mires and surface, measured in threads of
 * their own while the person looks. */
#ifndef PLACIDO_CLI_LIVE_TOPOGRAPHY_H
#define PLACIDO_CLI_LIVE_TOPOGRAPHY_H

#include <placido/frame.h>
#include <placido/instrument.h>
#include <stdbool.h>

#define LIVE_MAP_SIDE 45 /* points across the map, the axis in the middle */
#define LIVE_MAP_STEP_MM 0.2

/* What was measured last. */
struct live_cornea {
  long count;       /* of frames measured so far, with this one; 0: none yet */
  long corneas;     /* of these, so many gave a surface */
  uint64_t seq;     /* the frame's own number */
  char reason[512]; /* why it gave no surface; empty where it did, and NaN below where it did not */
  double flat_D, flat_axis_deg, steep_D, steep_axis_deg, cylinder_D; /* SimK, docs/indices.md */
  double measure_ms; /* from the frame to the figures */
  float axial_D[LIVE_MAP_SIDE * LIVE_MAP_SIDE]; /* by rows upwards; NaN: not seen */
};

struct live_topography;

/* Starts the threads. The instrument is borrowed. Close with live_topography_close. Returns
 * PLACIDO_OK, PLACIDO_MEMORY, PLACIDO_SYSTEM. */
int live_topography_open(struct live_topography **topography, const placido_instrument *instrument,
                         double axis_z_mm, placido_error *err);
void live_topography_close(struct live_topography *topography);

/* Hands over a copy of a frame; one that waits to be measured gives way to it. */
int live_topography_give(struct live_topography *topography, const placido_frame *frame,
                         placido_error *err);

/* Waits until the frame that was given last is being measured, or has been. */
void live_topography_wait_taken(struct live_topography *topography);
void live_topography_wait_measured(struct live_topography *topography);

void live_topography_latest(struct live_topography *topography, struct live_cornea *cornea);

#endif

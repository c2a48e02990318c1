/* Spread layers laid behind each other, from near to far. */
#ifndef PLACIDO_SIMULATE_OVERLAY_H
#define PLACIDO_SIMULATE_OVERLAY_H

#include <placido/image.h>
#include <placido/status.h>

/* What nearer layers leave open of every pixel, for each light. */
typedef struct placido_overlay {
  placido_image open;
  float core;
} placido_overlay;

/* Of the size of `canvas`, everything open. `core` is what a spread's values sum to: a cover that
 * is whole is spread to that. Free with placido_overlay_free. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_overlay_new(placido_overlay *overlay, const placido_image *canvas, int lights,
                        double core, placido_error *err);
void placido_overlay_free(placido_overlay *overlay);

/* Adds to `seen` the light of the next farther layer (spread, weighted by cover) as far as its own
 * spread cover finds room: a plane for each light, or no data: all that is left is its. Covers of
 * layers add up until a pixel is full, as parts of a surface that runs through several layers do: a
 * ray meets one or the other. (Were they laid over each other like panes of glass, each by what the
 * others let through, a slanted wall would be transparent.) */
void placido_overlay_add(placido_overlay *overlay, placido_image *seen, const placido_image *light,
                         const placido_image *covers);

#endif

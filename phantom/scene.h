/* What is in the picture besides the mires: eye, nose, lid and lashes, in grey levels of 8 bits. */
#ifndef PLACIDO_PHANTOM_SCENE_H
#define PLACIDO_PHANTOM_SCENE_H

#include <placido/image.h>
#include <placido/instrument.h>
#include <stdbool.h>
#include <stdint.h>

/* What stands around the reflection. */
typedef struct placido_phantom_scene {
  const placido_instrument *instrument;
  double vertex_mm[3]; /* where the cornea's vertex is, in the instrument's coordinates */
  bool nose;
  double lid_mm; /* height of the upper lid's margin above the axis; INFINITY: out of sight */
  int lashes;
  uint64_t seed;
} placido_phantom_scene;

/* Turns `picture`, which holds the lit share of every pixel, into grey levels. */
int placido_phantom_scene_paint(placido_image *picture, const placido_phantom_scene *scene,
                                int threads, placido_error *err);

/* Draws lashes that hang from the picture's upper border. */
void placido_phantom_lashes_draw(placido_image *picture, int count, uint64_t seed);

#endif

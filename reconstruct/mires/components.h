/* Chains that hang together, numbered relative to each other. */
#ifndef PLACIDO_MIRES_COMPONENTS_H
#define PLACIDO_MIRES_COMPONENTS_H

#include "reconstruct/mires/link.h"

#include <placido/instrument.h>

/* Relative numbers lie within ± this. */
#define PLACIDO_RELATIVE_MAX 512

typedef struct placido_component {
  int low, high; /* relative numbers present */
  int length;    /* meridians of all its chains */
} placido_component;

typedef struct placido_components {
  int count;
  placido_component *list;
  int *member;   /* component of a chain, -1: none */
  int *relative; /* its relative number there, growing outwards */
} placido_components;

/* Of two chains that follow each other outwards and turn opposite ways the outer one is one more;
 * what hangs together by such votes is a component. Steps too wide for a cornea that shows the
 * mires `scale` times as large as expected_px do not vote. Free with placido_components_free. */
int placido_components_find(placido_components *components, const placido_chains *chains,
                            const placido_crossings *crossings,
                            const placido_instrument *instrument, const double *expected_px,
                            double scale, placido_error *err);
void placido_components_free(placido_components *components);

#endif

/* Candidates joined into chains that run from meridian to meridian. */
#ifndef PLACIDO_MIRES_LINK_H
#define PLACIDO_MIRES_LINK_H

#include "reconstruct/mires/edges.h"

typedef struct placido_chain {
  int length;       /* meridians that it runs over */
  bool rising;      /* turns bright outwards */
  double radius_px; /* mean */
  int edge;         /* set by numbering; -1: unknown */
} placido_chain;

typedef struct placido_chains {
  int count;
  placido_chain *list;
} placido_chains;

/* Sets `chain` of every crossing that lies in a chain of at least `length_min` meridians. Free
 * with placido_chains_free. */
int placido_chains_link(placido_chains *chains, placido_crossings *crossings, int length_min,
                        placido_error *err);
void placido_chains_free(placido_chains *chains);

#endif

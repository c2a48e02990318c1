/* Doubtful edges sorted out by how they look beside their neighbours. */
#ifndef PLACIDO_MIRES_GATE_H
#define PLACIDO_MIRES_GATE_H

#include "reconstruct/mires/edges.h"

/* Takes the number from measured crossings whose height or blur differs from what is usual around
 * them (the border of a lash or a shadow looks so), from their neighbours along the edge, and from
 * those beside which no other edge is seen. */
int placido_crossings_gate(placido_crossings *crossings, int edge_count, placido_error *err);

#endif

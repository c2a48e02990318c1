/* Doubtful edges sorted out by how they look beside their neighbours. */
#ifndef PLACIDO_MIRES_GATE_H
#define PLACIDO_MIRES_GATE_H

#include "reconstruct/mires/edges.h"

/* Marks those numbered crossings as doubtful that have no sigma_px (they could not be measured),
 * whose height or blur differs from what is usual around them (the border of a lash or a shadow
 * looks so), and their neighbours along the edge. Takes the number from those that are far too
 * faint, and from those beside which no other edge is seen. */
int placido_crossings_gate(placido_crossings *crossings, int edge_count, placido_error *err);

#endif

/* What every call from outside begins with. */
#ifndef PLACIDO_DRIVERS_GENICAM_FEATURE_H
#define PLACIDO_DRIVERS_GENICAM_FEATURE_H

#include "drivers/genicam/nodes.h"

/* What a node of that kind is to the user. */
enum placido_feature_kind placido_genicam_feature_kind(enum kind kind);

/* Finds the node of a name; PLACIDO_INPUT where there is none that holds a value. */
int placido_genicam_feature(const placido_genicam *features, const char *name, uint32_t *node,
                            placido_error *err);

/* Gives a call its measure of work, and returns that of the call around it (one within a
 * callback), which end gives back. */
unsigned placido_genicam_begin(placido_genicam *features);
void placido_genicam_end(placido_genicam *features, unsigned outer);

#endif

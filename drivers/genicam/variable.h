/* The names that a node's formulas may use. */
#ifndef PLACIDO_DRIVERS_GENICAM_VARIABLE_H
#define PLACIDO_DRIVERS_GENICAM_VARIABLE_H

#include "drivers/genicam/nodes.h"

/* The property that defines a name, with what it is (TAG_VARIABLE, TAG_CONSTANT, TAG_EXPRESSION);
 * of X.Min also the one that defines X. 0 where there is none. */
uint32_t placido_genicam_definition(const placido_genicam *features, uint32_t node,
                                    const char *name, enum tag *tag);

/* The value of a constant, or of a variable's node: what the name says behind the point, one of
 * Value, Min, Max, Inc, Entry.NAME. */
int placido_genicam_variable(placido_genicam *features, uint32_t node, uint32_t property,
                             const char *name, struct number *value, placido_error *err);

#endif

/* The value of a node: read and written through whatever stands behind it. */
#ifndef PLACIDO_DRIVERS_GENICAM_VALUE_H
#define PLACIDO_DRIVERS_GENICAM_VALUE_H

#include "drivers/genicam/nodes.h"

/* Reading does not ask for access; writing checks the limits of every node on the way. */
int placido_genicam_node_get(placido_genicam *features, uint32_t node, struct number *value,
                             placido_error *err);
int placido_genicam_node_set(placido_genicam *features, uint32_t node,
                             const struct number *value, placido_error *err);

/* What a converter makes of a value of what stands behind it. */
int placido_genicam_from_raw(placido_genicam *features, uint32_t node, const struct number *raw,
                             struct number *value, placido_error *err);

/* What a property says: its number, or the value of the node that it names. */
int placido_genicam_property_get(placido_genicam *features, uint32_t node, uint32_t property,
                                 struct number *value, placido_error *err);

/* The same as a whole number of the property with that tag; `fallback` where there is none. */
int placido_genicam_setting(placido_genicam *features, uint32_t node, enum tag tag,
                            int64_t fallback, int64_t *value, placido_error *err);

/* Which property of a node holds its value now: the index may choose. 0: none. */
int placido_genicam_source(placido_genicam *features, uint32_t node, uint32_t *property,
                           placido_error *err);
/* The node that it names; NODE_NONE where the value stands in the description itself. */
int placido_genicam_target(placido_genicam *features, uint32_t node, uint32_t *target,
                           placido_error *err);

/* The value of an enumeration's entry. PLACIDO_INPUT where there is none of that name. */
int placido_genicam_entry_value(placido_genicam *features, uint32_t node, const char *name,
                                struct number *value, placido_error *err);

/* Limits of a number; those that nobody knows are the widest. */
struct limits {
  struct number min, max, step;
};
int placido_genicam_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                           placido_error *err);
/* Refuses what lies outside. A real number just beyond a limit, as by a formula's rounding, is
 * moved onto it. */
int placido_genicam_limits_check(placido_genicam *features, uint32_t node, struct number *value,
                                 placido_error *err);

enum access { ACCESS_NONE = 0, ACCESS_READ = 1, ACCESS_WRITE = 2, ACCESS_BOTH = 3 };
/* Whether a node can be read and written now: a sum of `enum access`. */
int placido_genicam_access(placido_genicam *features, uint32_t node, unsigned *access,
                           placido_error *err);

#endif

/* Registers: where they lie, and numbers and texts made of their bytes. */
#ifndef PLACIDO_DRIVERS_GENICAM_REGISTERS_H
#define PLACIDO_DRIVERS_GENICAM_REGISTERS_H

#include "drivers/genicam/nodes.h"

/* Of IntReg, MaskedIntReg and StructEntry. Setting refuses what the bits cannot hold. */
int placido_genicam_integer_get(placido_genicam *features, uint32_t node, struct number *value,
                                placido_error *err);
int placido_genicam_integer_set(placido_genicam *features, uint32_t node,
                                const struct number *value, placido_error *err);
/* The least and the greatest that the bits can hold, and an int64. */
int placido_genicam_integer_range(placido_genicam *features, uint32_t node, int64_t *min,
                                  int64_t *max, placido_error *err);

/* Of FloatReg. */
int placido_genicam_float_get(placido_genicam *features, uint32_t node, struct number *value,
                              placido_error *err);
int placido_genicam_float_set(placido_genicam *features, uint32_t node,
                              const struct number *value, placido_error *err);

/* Of StringReg: one clean line, cut where it does not fit; written with zeros behind it. */
int placido_genicam_string_get(placido_genicam *features, uint32_t node, char *text, size_t size,
                               placido_error *err);
int placido_genicam_string_set(placido_genicam *features, uint32_t node, const char *text,
                               placido_error *err);

#endif

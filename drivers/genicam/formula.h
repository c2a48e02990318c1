/* Formulas of a description's knives and converters. */
#ifndef PLACIDO_DRIVERS_GENICAM_FORMULA_H
#define PLACIDO_DRIVERS_GENICAM_FORMULA_H

#include "drivers/genicam/nodes.h"

/* Evaluates `text` with the variables, constants and expressions of `node`: in integers that wrap
 * around, or in doubles. `input` (may be NULL) is what "TO" or "FROM", its `input_name`, stands
 * for. A division of integers by zero, a shift out of range, or no number (NaN) is
 * PLACIDO_INPUT. */
int placido_genicam_formula(placido_genicam *features, uint32_t node, const char *text,
                            bool is_whole, const char *input_name, const struct number *input,
                            struct number *value, placido_error *err);

#endif

/* From what the variants change to an index's error bar. */
#ifndef PLACIDO_INDICES_ERRORS_H
#define PLACIDO_INDICES_ERRORS_H

#include <placido/index.h>

/* Fills sigma and budget of a value from what the fit's variants gave, changed[variant * stride].
 * Nothing happens to a value that is NaN. Differences wrap by `period` (0: they do not); sigma ends
 * at range/sqrt(12), even odds all over the range (0: there is none). */
void placido_index_fill_sigma(placido_index_value *value, const placido_fit *fit,
                              const double *changed, size_t stride, double period, double range);

#endif

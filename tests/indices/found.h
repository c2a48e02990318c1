/* Indices of a surface by name, for tests. */
#ifndef PLACIDO_TESTS_INDICES_FOUND_H
#define PLACIDO_TESTS_INDICES_FOUND_H

#include <placido/index.h>

typedef struct found_indices {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
} found_indices;

/* Each fails the test where there is nothing to be found. */
found_indices found_of(const placido_surface *surface, const placido_fit *fit);
const placido_index_value *found_index(const found_indices *found, const char *name);
double found_value(const found_indices *found, const char *name);

/* Why there is no value; fails the test where there is one. */
const char *found_reason(const found_indices *found, const char *name);

#endif

/* An index by its name, in tests that know which they want. */
#ifndef PLACIDO_TESTS_NAMED_INDEX_H
#define PLACIDO_TESTS_NAMED_INDEX_H

#include "tests/support/near.h"

#include <placido/index.h>
#include <string.h>

/* Fails the test where it is not among them. */
static inline const placido_index_value *named_index(const placido_index_value *values,
                                                     size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return &values[i];
    }
  }
  fail_msg("no index %s", name);
  return NULL;
}

#endif

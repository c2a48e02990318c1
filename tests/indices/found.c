#include "tests/indices/found.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

found_indices found_of(const placido_surface *surface, const placido_fit *fit) {
  found_indices found;
  assert_int_equal(placido_indices_find(found.values, &found.count, surface, fit, NULL),
                   PLACIDO_OK);
  return found;
}

const placido_index_value *found_index(const found_indices *found, const char *name) {
  for (size_t i = 0; i < found->count; i++) {
    if (strcmp(found->values[i].name, name) == 0) {
      return &found->values[i];
    }
  }
  fail_msg("no index %s", name);
  return NULL;
}

double found_value(const found_indices *found, const char *name) {
  return found_index(found, name)->value;
}

const char *found_reason(const found_indices *found, const char *name) {
  const placido_index_value *value = found_index(found, name);
  assert_true(isnan(value->value));
  assert_non_null(value->reason);
  return value->reason;
}

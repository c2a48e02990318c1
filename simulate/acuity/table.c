/* The acuity tests.
 *
 * Criteria of E and Landolt C lie midway between chance and certainty; that of the Sloan letters is
 * Watson and Ahumada's (2008). */
#include "simulate/acuity/table.h"

#include <string.h>

static const placido_acuity_test tests[] = {
  {"e", "tumbling E", 4, 0.625},
  {"c", "Landolt C in four directions", 4, 0.625},
  {"c8", "Landolt C in eight directions", 8, 0.5625},
  {"sloan", "Sloan letters", 10, 0.55},
};

/* In the same order. */
static const placido_acuity_letters letters[] = {
  {PLACIDO_OPTOTYPE_E, 1},
  {PLACIDO_OPTOTYPE_LANDOLT, 2},
  {PLACIDO_OPTOTYPE_LANDOLT, 1},
  {PLACIDO_OPTOTYPE_SLOAN, 1},
};

const placido_acuity_test *placido_acuity_tests(size_t *count) {
  *count = sizeof tests / sizeof *tests;
  return tests;
}

const placido_acuity_test *placido_acuity_test_find(const char *name) {
  for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
    if (strcmp(tests[i].name, name) == 0) {
      return &tests[i];
    }
  }
  return NULL;
}

placido_acuity_letters placido_acuity_letters_of(const placido_acuity_test *test) {
  return letters[test - tests];
}

/* Which optotypes an acuity test shows. */
#ifndef PLACIDO_SIMULATE_ACUITY_TABLE_H
#define PLACIDO_SIMULATE_ACUITY_TABLE_H

#include "simulate/charts/optotype.h"

#include <placido/acuity.h>

/* The optotypes of a test: every `every`-th of a kind. */
typedef struct placido_acuity_letters {
  enum placido_optotype kind;
  int every;
} placido_acuity_letters;

placido_acuity_letters placido_acuity_letters_of(const placido_acuity_test *test);

#endif

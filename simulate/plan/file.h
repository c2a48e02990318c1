/* A plan as JSON. */
#ifndef PLACIDO_SIMULATE_PLAN_FILE_H
#define PLACIDO_SIMULATE_PLAN_FILE_H

#include <jansson.h>
#include <placido/plan.h>

/* `placido-plan/1` (docs/formats.md), a new reference; NULL: out of memory. */
json_t *placido_plan_json(const placido_plan *plan);

#endif

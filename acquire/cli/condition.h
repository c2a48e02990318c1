/* How strongly an examination's results answer to errors of what goes in: the condition numbers of
 * exam.json. */
#ifndef PLACIDO_CLI_CONDITION_H
#define PLACIDO_CLI_CONDITION_H

#include "acquire/cli/views.h"
#include "acquire/cli/wavefront.h"

#include <jansson.h>
#include <stddef.h>

/* Three of the shape, seven of a wavefront, Strehl ratio and acuities of a view. */
#define CONDITIONS_MAX (3 + 7 * LIST_MAX + VIEWS_MAX * (1 + ACUITY_TESTS_MAX))
#define CONDITION_ZONE_MM 6

/* One result. NaN: not known. */
struct condition {
  char name[32];
  const char *unit;
  double pupil_mm; /* NaN: it is of no pupil */
  double value, sigma;
  double by_edges, by_geometry; /* standard deviation that each leaves, by its own size */
  double per_mm;                /* derivative by the distance */
};

/* Count 0: nothing was measured. */
struct conditions {
  double edge_sigma_px, edge_scale_px;         /* of a point; of all about the mires' centre */
  double distance_sigma_mm, distance_scale_mm; /* NaN: no instrument saw the cornea */
  double matrix;                               /* of the fit's normal equations */
  size_t count;
  struct condition items[CONDITIONS_MAX];
};

struct examination;

/* Exam.json's `condition`; NULL when memory is out. */
json_t *conditions_json(const struct conditions *conditions);

/* The same for people, in a sentence or two; empty where nothing is known. */
void conditions_tell(char *text, size_t size, const struct conditions *conditions);

#endif

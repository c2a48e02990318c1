/* Which distances a scene in depth is cut into. */
#ifndef PLACIDO_SIMULATE_LEVELS_H
#define PLACIDO_SIMULATE_LEVELS_H

#include <stdbool.h>
#include <stddef.h>

enum { PLACIDO_LEVELS_MAX = 128 };

/* Vergences from far to near. */
typedef struct placido_levels {
  int count;
  double vergence_D[PLACIDO_LEVELS_MAX];
  bool joined[PLACIDO_LEVELS_MAX]; /* with the next nearer one: things stand in between */
  double step_D;                   /* between joined ones, at most */
} placido_levels;

/* Levels for `count` vergences (none negative). Where things stand at all distances levels are
 * uniform in dioptres, `step_D` apart (Barsky, "Vision-realistic rendering" (2004)), one of them at
 * focus_D, where the blur changes fastest; what stands apart by more than that gets levels of its
 * own, one where it is flat. More than `most` (1 to PLACIDO_LEVELS_MAX) levels widen the step; one
 * or two of them have no regard to the focus. */
void placido_levels_choose(placido_levels *levels, const float *depth_D, size_t count,
                           double focus_D, double step_D, int most);

/* The farther of the two levels between which a vergence lies, and by which share it belongs to the
 * nearer one: 0 to below 1, linear in between, so that nothing jumps along a slanted plane. */
int placido_levels_find(const placido_levels *levels, double vergence_D, float *nearer);

#endif

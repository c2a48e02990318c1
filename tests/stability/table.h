/* The table of a family of hard cases: each has a bound that is derived, not fitted. */
#ifndef PLACIDO_TESTS_STABILITY_TABLE_H
#define PLACIDO_TESTS_STABILITY_TABLE_H

#include <stddef.h>

/* NaN: does not apply, prints as "-". */
struct stability_row {
  const char *name;      /* of the case; copied */
  double condition;      /* number of the problem: what relative, or per-sigma, change comes out per
                            such change in */
  double perturbation;   /* put in, and its unit */
  const char *in_unit;
  double change;         /* that came out, and its unit */
  const char *out_unit;
  double bound;          /* of the change: derived; the comment beside the case says how */
  double extended;       /* error against extended precision, ulp */
  const char *refused;   /* not NULL: the case must refuse, and this is what it said; copied */
};

/* Adds a row; the verdict is "within" or "BEYOND" (change <= bound; NaN is beyond), or "refuses". */
void stability_add(const struct stability_row *row);

/* Prints every row added so far under a title and forgets them; 0 where every verdict is good.
 * With PLACIDO_STABILITY_TABLE set in the environment it is appended to that file as well. */
int stability_print(const char *title);

#endif

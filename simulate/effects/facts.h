/* What of a scene decides which effects are seen in it: measured once. */
#ifndef PLACIDO_SIMULATE_FACTS_H
#define PLACIDO_SIMULATE_FACTS_H

#include <placido/scene.h>
#include <placido/status.h>
#include <stdbool.h>

enum { PLACIDO_FACTS_SIDE = 24 }; /* cells of the coarse picture on its longer side */

/* Light relative to white; above white as it is. Of scenes with a bleed that is part of it. */
typedef struct placido_facts {
  int planes;                 /* of colour: 1 or 3 */
  double darkest[3], brightest[3]; /* of each plane */
  double step[3];             /* largest difference between neighbouring samples */
  double colour;              /* largest difference between a sample's planes: 0 is grey */
  double width_deg, height_deg; /* of what is seen */
  double nearest_D, farthest_D; /* vergence of what is looked at: 1 / distance in m; 0: far */
  double focus_D;             /* vergence at which the eye is asked to look */
  int columns, rows;          /* a coarse picture of the mean luminance of its cells */
  double cell_arcmin;
  float luminance[PLACIDO_FACTS_SIDE * PLACIDO_FACTS_SIDE]; /* row by row */
  float light[3][PLACIDO_FACTS_SIDE * PLACIDO_FACTS_SIDE];  /* the same of each plane */
  float most[PLACIDO_FACTS_SIDE * PLACIDO_FACTS_SIDE];      /* brightest sample in each cell */
  float least[PLACIDO_FACTS_SIDE * PLACIDO_FACTS_SIDE];     /* darkest */
} placido_facts;

/* One pass over the picture; the depth map (where there is one) gives the vergences. Returns
 * PLACIDO_OK, PLACIDO_INPUT (a picture without samples), or what reading a depth map returns. */
int placido_facts_find(placido_facts *facts, const placido_scene *scene, placido_error *err);

#endif

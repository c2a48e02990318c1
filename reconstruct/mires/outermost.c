/* The outermost edge that is seen, counted over the meridians. */
#include "reconstruct/mires/outermost.h"

#include <math.h>
#include <placido/instrument.h>

#define ALL_ROUND 0.75 /* share of the meridians that end alike */
#define SOME 0.05      /* share on which the last edge is enough: it was hidden elsewhere */
#define MIRES_MOST 3   /* missing; more are no slip but another instrument */
#define CORNEA 1.2     /* of the ordinary reach: so far every cornea goes */
#define QUIET 0.5      /* of the outermost edge's strength */

/* Where a meridian's numbers end. */
typedef struct ending {
  const placido_crossing *last, *before; /* the outermost, and the next of its polarity */
} ending;

static ending ending_of(const placido_crossings *all, int meridian) {
  ending e = {NULL, NULL};
  for (size_t i = all->first[meridian]; i < all->first[meridian + 1]; i++) {
    const placido_crossing *c = &all->list[i];
    if (c->edge >= 0) {
      e.last = c;
    }
  }
  for (size_t i = all->first[meridian]; i < all->first[meridian + 1] && e.last; i++) {
    if (all->list[i].edge == e.last->edge - 2) {
      e.before = &all->list[i];
    }
  }
  return e;
}

/* Whether another mire would lie within the image, and none does. */
static bool is_quiet_beyond(const placido_crossings *all, const ending *e,
                            const double centre_px[2], int width_px, int height_px,
                            double reach_px) {
  double period = e->last->radius_px - e->before->radius_px;
  double limit = e->last->radius_px + 1.2 * period;
  if (limit > CORNEA * reach_px) {
    return false;
  }
  double angle = 2 * M_PI * e->last->meridian / all->meridians;
  double u = centre_px[0] + limit * cos(angle), v = centre_px[1] - limit * sin(angle);
  if (!(u > 0 && v > 0 && u < width_px - 1 && v < height_px - 1)) {
    return false;
  }
  for (const placido_crossing *c = e->last + 1;
       c < all->list + all->first[e->last->meridian + 1] && c->radius_px < limit; c++) {
    if (fabs(c->slope) > QUIET * fabs(e->last->slope)) {
      return false;
    }
  }
  return true;
}

int placido_crossings_outermost(const placido_crossings *crossings, int edge_count,
                                const double centre_px[2], int width_px, int height_px,
                                double reach_px, placido_error *err) {
  int endings[PLACIDO_EDGES_MAX] = {0}, quiet[PLACIDO_EDGES_MAX] = {0}, common = 0;
  for (int m = 0; m < crossings->meridians; m++) {
    ending e = ending_of(crossings, m);
    if (!e.last) {
      continue;
    }
    int k = e.last->edge;
    endings[k]++;
    quiet[k] +=
        e.before && is_quiet_beyond(crossings, &e, centre_px, width_px, height_px, reach_px);
    common = endings[k] > endings[common] ? k : common;
  }
  int missing = edge_count - 1 - common;
  if (missing > 0 && missing % 2 == 0 && missing <= 2 * MIRES_MOST &&
      quiet[common] >= ALL_ROUND * crossings->meridians &&
      endings[edge_count - 1] < SOME * crossings->meridians) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires end all round with edge %d of %d: the last %d are missing, "
                             "or the innermost ones were not seen and every number is wrong",
                             common + 1, edge_count, missing);
  }
  return PLACIDO_OK;
}

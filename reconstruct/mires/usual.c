/* Running means along every edge, by way of sums that are carried round the circle. */
#include "reconstruct/mires/usual.h"

#include <math.h>

#define REACH_DEG 8.0 /* to either side */

/* Sums of what was fitted. */
typedef struct sums {
  double count, offset, height, width, squares, freedom;
} sums;

static void add(sums *s, const placido_fitted *f, double sign) {
  if (f->good && f->freedom > 0) {
    s->count += sign;
    s->offset += sign * (double)f->offset;
    s->height += sign * fabs((double)f->height);
    s->width += sign * (double)f->width;
    s->squares += sign * (double)f->squares;
    s->freedom += sign * (double)f->freedom;
  }
}

static placido_usual mean(const sums *s) {
  if (s->count < 0.5) {
    return (placido_usual){NAN, NAN, NAN, NAN};
  }
  return (placido_usual){.offset = (float)(s->offset / s->count),
                         .height = (float)(s->height / s->count),
                         .width = (float)(s->width / s->count),
                         .variance = (float)(s->squares / fmax(s->freedom, 0.5))};
}

/* Adds the fit of an edge on a meridian, or takes it away again. */
static void pass(sums *s, const placido_tracks *tracks, int edge, int meridian,
                 const placido_fitted *fitted, double sign) {
  size_t at = placido_tracks_at(tracks, edge, meridian);
  if (at != PLACIDO_TRACKS_NONE) {
    add(s, &fitted[at], sign);
  }
}

static void run_along(placido_usual *usual, const placido_tracks *tracks, int edge, int reach,
                      const placido_fitted *fitted) {
  sums s = {0};
  for (int m = -reach; m < reach; m++) {
    pass(&s, tracks, edge, m, fitted, 1);
  }
  for (int m = 0; m < tracks->meridians; m++) {
    pass(&s, tracks, edge, m + reach, fitted, 1);
    size_t middle = placido_tracks_at(tracks, edge, m);
    if (middle != PLACIDO_TRACKS_NONE) {
      usual[middle] = mean(&s);
    }
    pass(&s, tracks, edge, m - reach, fitted, -1);
  }
}

void placido_usual_find(placido_usual *usual, const placido_crossings *crossings,
                        const placido_tracks *tracks, const placido_fitted *fitted) {
  int reach = (int)fmax(1, round(REACH_DEG * tracks->meridians / 360));
  for (size_t i = 0; i < crossings->count; i++) {
    sums own = {0};
    add(&own, &fitted[i], 1);
    usual[i] = mean(&own);
  }
  for (int k = 0; k < tracks->edges; k++) {
    run_along(usual, tracks, k, reach, fitted);
  }
}

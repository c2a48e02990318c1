/* The median of squared fourth differences over their expectation, in blocks. */
#include "reconstruct/mires/scale.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define BLOCK_DEG 10.0
#define BLOCK_EDGES 12
#define FEW 25
#define APART_PX 8.0  /* pixels of places so far apart along an edge are not the same */
#define OUTLIER 30.0 /* times the square of what the median says */
#define MEDIAN 0.4549 /* of the chi-squared distribution of one degree of freedom */
#define LEAST 0.9     /* scale: fits do not know better than the noise lets them */
#define MOST 10.0

/* The squared fourth difference of the radius about a crossing over its expectation; NaN at gaps.
 */
static double wavering(const placido_tracks *tracks, const placido_crossings *all, int edge,
                       int meridian) {
  static const double binomial[5] = {1, -4, 6, -4, 1};
  size_t middle = placido_tracks_at(tracks, edge, meridian);
  if (middle == PLACIDO_TRACKS_NONE) {
    return NAN;
  }
  double arc = all->list[middle].radius_px * 2 * M_PI / tracks->meridians;
  int stride = (int)ceil(APART_PX / arc);
  double difference = 0, variance = 0;
  if (stride > tracks->meridians / 16) {
    return NAN;
  }
  for (int k = 0; k < 5; k++) {
    size_t at = placido_tracks_at(tracks, edge, meridian + (k - 2) * stride);
    if (at == PLACIDO_TRACKS_NONE) {
      return NAN;
    }
    const placido_crossing *c = &all->list[at];
    difference += binomial[k] * c->radius_px;
    variance += binomial[k] * binomial[k] * c->sigma_px * c->sigma_px;
  }
  return difference * difference / variance;
}

/* Root of the mean of what is no outlier, judged by the median. */
static double scale_of(double *values, size_t count) {
  double limit = OUTLIER * placido_quantile(values, count, 0.5) / MEDIAN, sum = 0;
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    if (values[i] <= limit) {
      sum += values[i];
      kept++;
    }
  }
  return kept ? fmax(LEAST, fmin(MOST, sqrt(sum / (double)kept))) : MOST;
}

/* Edges and meridians, from the first to before the end. */
typedef struct block {
  int edge, edge_end, meridian, meridian_end;
} block;

/* Everything at hand. */
typedef struct work {
  const placido_tracks *tracks;
  double *wavering; /* as the tracks: an edge a row */
  double *values;   /* room for all of it */
} work;

static double *wavering_at(const work *w, int edge, int meridian) {
  int m = meridian < 0 ? meridian + w->tracks->meridians : meridian;
  return &w->wavering[(size_t)edge * (size_t)w->tracks->meridians + (size_t)m];
}

/* The scale of a block; `usual` where it has too few places. */
static double scale_in(const work *w, const block *b, double usual) {
  size_t count = 0;
  for (int k = b->edge; k < b->edge_end; k++) {
    for (int m = b->meridian; m < b->meridian_end; m++) {
      double value = *wavering_at(w, k, m);
      if (!isnan(value)) {
        w->values[count++] = value;
      }
    }
  }
  return count < FEW ? usual : scale_of(w->values, count);
}

static void apply(placido_crossings *crossings, const work *w, const block *b, double scale) {
  for (int k = b->edge; k < b->edge_end; k++) {
    for (int m = b->meridian; m < b->meridian_end; m++) {
      size_t at = placido_tracks_at(w->tracks, k, m);
      if (at != PLACIDO_TRACKS_NONE) {
        placido_crossing *c = &crossings->list[at];
        c->sigma_px = hypot(c->sigma_px * scale, c->light_px);
      }
    }
  }
}

static void scale_blocks(placido_crossings *crossings, const work *w) {
  int edges = w->tracks->edges, meridians = w->tracks->meridians;
  int sectors = (int)(360 / BLOCK_DEG), rings = (edges + BLOCK_EDGES / 2) / BLOCK_EDGES;
  rings = rings < 1 ? 1 : rings;
  for (int k = 0; k < edges; k++) {
    for (int m = 0; m < meridians; m++) {
      *wavering_at(w, k, m) = wavering(w->tracks, crossings, k, m);
    }
  }
  block all = {0, edges, 0, meridians};
  double usual = scale_in(w, &all, 1);
  for (int ring = 0; ring < rings; ring++) {
    for (int sector = 0; sector < sectors; sector++) {
      /* the image's axes, where sampling is seen most, are in the middle of their sectors */
      block b = {.edge = ring * edges / rings,
                 .edge_end = (ring + 1) * edges / rings,
                 .meridian = (int)floor((sector - 0.5) * meridians / sectors),
                 .meridian_end = (int)floor((sector + 0.5) * meridians / sectors)};
      apply(crossings, w, &b, scale_in(w, &b, usual));
    }
  }
}

int placido_crossings_scale(placido_crossings *crossings, const placido_tracks *tracks,
                            placido_error *err) {
  size_t cells = (size_t)tracks->edges * (size_t)tracks->meridians;
  work w = {.tracks = tracks};
  w.wavering = placido_memory_new(cells, sizeof *w.wavering, err);
  w.values = placido_memory_new(cells, sizeof *w.values, err);
  int status = w.wavering && w.values ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    scale_blocks(crossings, &w);
  }
  placido_memory_free(w.wavering);
  placido_memory_free(w.values);
  return status;
}

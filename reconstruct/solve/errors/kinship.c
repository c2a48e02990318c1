/* The variogram along the edges (Matheron, Economic Geology 58:1246, 1963), from mean absolute
 * differences, and the correlation across them. */
#include "reconstruct/solve/errors/kinship.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define KIN_PX 6.0         /* points of an edge farther apart share no pixels */
#define STRANGER_PX 18.0   /* up to here they are compared with */
#define STRANGERS 12       /* so many distances beyond */
#define TELLING_PX 2.0     /* meridians closer than this show what they share */
#define USUAL_PX 3.3       /* along edges of a blurred picture that was resampled once */
#define MOST_PX 6.5        /* no blur that mires can be told in reaches farther */
#define TURNS 72           /* arcs of an edge */
#define FOLLOWED_KNOTS 5.0 /* radius where two arcs are as long as a spline's least wave */
#define ACROSS 2           /* neighbours on either side that a mire's edges may share pixels with */
#define ACROSS_LEAST 0.25
#define ACROSS_MOST 4.0
#define CLIP 4.0 /* of a difference, in usual ones; of an arc's, in standard deviations */

/* The absolute differences `lag` meridians apart; the room is for all meridians. Returns how many.
 */
static size_t differences(double *out, const double *line, int meridians, int lag) {
  size_t n = 0;
  for (int m = 0; m < meridians; m++) {
    double d = line[m + lag < meridians ? m + lag : m + lag - meridians] - line[m];
    if (!isnan(d)) {
      out[n++] = fabs(d);
    }
  }
  return n;
}

/* The mean difference from `first` to `last` meridians apart; beyond `most` it is no noise. NaN
 * where there are too few. */
static double mean_difference(double *work, const double *line, int meridians, int first, int last,
                              double most) {
  double sum = 0;
  size_t count = 0;
  for (int lag = first; lag <= last; lag += 1 + (last - first) / STRANGERS) {
    size_t n = differences(work, line, meridians, lag);
    for (size_t i = 0; i < n; i++) {
      sum += fmin(work[i], most);
    }
    count += n;
  }
  return count > (size_t)meridians / 4 ? sum / (double)count : (double)NAN;
}

/* 1 + 2 Σ correlation of an edge's points over the distances at which they may share pixels; what
 * is alike farther on, too, is no noise. NaN where too little is there. */
static double repeats_of(double *work, const double *line, int meridians, double step_px) {
  int near = (int)ceil(KIN_PX / step_px), far = (int)ceil(STRANGER_PX / step_px);
  size_t n = differences(work, line, meridians, far);
  double factor = 1, most = CLIP * placido_quantile(work, n, 0.5);
  double apart = mean_difference(work, line, meridians, near + 1, far, most);
  for (int lag = 1; lag <= near && apart > 0; lag++) {
    double unlike = mean_difference(work, line, meridians, lag, lag, most) / apart;
    factor += 2 * (1 - unlike * unlike);
  }
  return apart > 0 ? factor : (double)NAN;
}

double placido_kinship_length(const double *residual_px, const double *step_px, int edges,
                              int meridians, double *work) {
  double sum = 0, weight = 0;
  for (int k = 0; k < edges; k++) {
    if (!(step_px[k] > 0) || step_px[k] > TELLING_PX || 4 * STRANGER_PX > meridians * step_px[k]) {
      continue;
    }
    double repeats =
        repeats_of(work, residual_px + (size_t)k * (size_t)meridians, meridians, step_px[k]);
    if (!isnan(repeats)) {
      sum += repeats * fabs(repeats) - 1;
      weight += 1 / (step_px[k] * step_px[k]);
    }
  }
  double length_px = weight > 0 ? sqrt(fmax(0, sum / weight)) : USUAL_PX;
  return length_px < MOST_PX ? length_px : 0;
}

/* Points that stand for one another come to length/step each, and soon to one where they do not. */
double placido_kinship_factor(double length_px, double step_px) {
  double repeats = length_px / step_px, square = repeats * repeats;
  return pow(1 + square * square, 0.125);
}

/* An arc's points: Σ w, Σ w · residual in sigmas; then its difference from the next one. */
typedef struct arc {
  double weight, pull, difference;
} arc;

static void fill(arc *arcs, const placido_refinement *r, const placido_mires *mires,
                 const double *residual_px) {
  double reach = FOLLOWED_KNOTS * r->shape.grid->knot_mm;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (s->used && !isnan(s->residual_px) &&
        s->hit.x * s->hit.x + s->hit.y * s->hit.y < reach * reach) {
      const placido_mire_point *point = &mires->points[s->point];
      double weight = placido_sample_weight(s, r->sigma_px);
      arc *a = &arcs[point->edge * TURNS + (int)(point->meridian_deg * TURNS / 360) % TURNS];
      a->weight += weight;
      a->pull += weight * residual_px[i] / r->sigma_px;
    }
  }
}

/* The differences, in the standard deviations of independent points. */
static void find_differences(arc *arcs, int edges) {
  for (int i = 0; i < edges * TURNS; i++) {
    const arc *a = &arcs[i], *b = &arcs[i % TURNS == TURNS - 1 ? i + 1 - TURNS : i + 1];
    bool both = a->weight > 0 && b->weight > 0;
    double d =
        both ? (a->pull / a->weight - b->pull / b->weight) / sqrt(1 / a->weight + 1 / b->weight)
             : (double)NAN;
    arcs[i].difference = both ? fmax(-CLIP, fmin(CLIP, d)) : d;
  }
}

/* The mean product of differences `lag` edges apart. */
static double product_at(const arc *arcs, int edges, int lag) {
  double sum = 0;
  size_t n = 0;
  for (int i = 0; i < (edges - lag) * TURNS; i++) {
    double product = arcs[i].difference * arcs[i + lag * TURNS].difference;
    if (!isnan(product)) {
      sum += product;
      n++;
    }
  }
  return n ? sum / (double)n : 0;
}

int placido_kinship_find(placido_kinship *kinship, const placido_refinement *r,
                         const placido_mires *mires, const double *residual_px,
                         placido_error *err) {
  *kinship = (placido_kinship){1, 1};
  arc *arcs = placido_memory_new((size_t)mires->edge_count * TURNS, sizeof *arcs, err);
  if (!arcs) {
    return PLACIDO_MEMORY;
  }
  fill(arcs, r, mires, residual_px);
  find_differences(arcs, mires->edge_count);
  double own = product_at(arcs, mires->edge_count, 0), across = 1;
  for (int lag = 1; lag <= ACROSS && own > 0; lag++) {
    across += 2 * product_at(arcs, mires->edge_count, lag) / own;
  }
  kinship->arcs = own > 0 ? own : 1;
  kinship->across = fmax(ACROSS_LEAST, fmin(ACROSS_MOST, across));
  placido_memory_free(arcs);
  return PLACIDO_OK;
}

/* Medians over the frames tell which of them to believe, weighted means what they say together. */
#include "reconstruct/solve/agreement.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

/* A frame is set aside where it is so many times the usual off the others, and by more than a good
 * frame may. Of good frames none is more than 1.3 times the usual; one that is blurred by a jerk
 * gives a wrong surface at 1.8 times. */
#define APART 1.6
#define APART_LEAST_PX 0.05
/* Blocks of neighbouring edges, about as wide as the surface's knots: noise averages out over them,
 * and what makes a wrong surface does not. */
#define BLOCK_DEG 15
#define BLOCK_EDGES 6
#define SPREAD_LEAST_PX 0.01 /* better than this no two frames agree but by chance */
#define STRAY 3.5            /* spreads of its frame at which a single point is not believed */

int placido_agreement_new(placido_agreement *agreement, size_t count, int edge_count,
                          int meridian_count, placido_error *err) {
  const size_t places = (size_t)edge_count * (size_t)meridian_count;
  *agreement = (placido_agreement){
      .count = count, .edge_count = edge_count, .meridian_count = meridian_count, .places = places};
  agreement->middle_px = placido_memory_new(places, sizeof *agreement->middle_px, err);
  agreement->work = placido_memory_new(places, sizeof *agreement->work, err);
  bool enough = agreement->middle_px && agreement->work;
  for (size_t i = 0; i < count && enough; i++) {
    placido_testimony *frame = &agreement->frames[i];
    frame->used = true;
    frame->residual_px = placido_memory_new(places, sizeof *frame->residual_px, err);
    enough = frame->residual_px != NULL;
    for (size_t place = 0; place < places && enough; place++) {
      frame->residual_px[place] = NAN;
    }
  }
  return enough ? PLACIDO_OK : PLACIDO_MEMORY;
}

void placido_agreement_free(placido_agreement *agreement) {
  for (size_t i = 0; i < agreement->count; i++) {
    placido_memory_free(agreement->frames[i].residual_px);
  }
  placido_memory_free(agreement->middle_px);
  placido_memory_free(agreement->work);
}

/* What the frames of use say of one place, and which they are; returns how many. */
static size_t gather(const placido_agreement *agreement, size_t place, double *values,
                     size_t *frames) {
  size_t n = 0;
  for (size_t i = 0; i < agreement->count; i++) {
    const placido_testimony *frame = &agreement->frames[i];
    if (frame->used && !isnan(frame->residual_px[place])) {
      frames[n] = i;
      values[n++] = frame->residual_px[place];
    }
  }
  return n;
}

static double median(const double *values, size_t count) {
  double sorted[PLACIDO_COMBINE_MAX];
  memcpy(sorted, values, count * sizeof *sorted);
  double middle = placido_quantile(sorted, count, 0.5);
  if (count > 0 && count % 2 == 0) {
    double next = INFINITY;
    for (size_t i = count / 2; i < count; i++) {
      next = fmin(next, sorted[i]);
    }
    middle = (middle + next) / 2;
  }
  return middle;
}

static size_t used_count(const placido_agreement *agreement) {
  size_t used = 0;
  for (size_t i = 0; i < agreement->count; i++) {
    used += agreement->frames[i].used;
  }
  return used;
}

/* Medians by place, where at least half of the frames of use have it. */
static void find_middle(placido_agreement *agreement) {
  const size_t used = used_count(agreement);
  for (size_t place = 0; place < agreement->places; place++) {
    double values[PLACIDO_COMBINE_MAX];
    size_t frames[PLACIDO_COMBINE_MAX], n = gather(agreement, place, values, frames);
    agreement->middle_px[place] = n > 0 && 2 * n >= used ? median(values, n) : NAN;
  }
}

static double off_middle(const placido_agreement *agreement, const placido_testimony *frame,
                         size_t place) {
  return frame->residual_px[place] - agreement->middle_px[place];
}

/* Robust spread about 0; reorders the values. NaN where there are none. */
static double spread_of(double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    values[i] = fabs(values[i]);
  }
  return 1.4826 * placido_quantile(values, count, 0.5);
}

/* The mean distance from the middle over a block that begins at `edge` and `meridian`; NaN where
 * less than half of it is seen. */
static double block_mean(const placido_agreement *agreement, const placido_testimony *frame,
                         int edge, int meridian, int width) {
  double sum = 0;
  int n = 0;
  for (int k = edge; k < edge + BLOCK_EDGES; k++) {
    for (int m = meridian; m < meridian + width; m++) {
      const size_t place = (size_t)k * (size_t)agreement->meridian_count + (size_t)m;
      const double off = off_middle(agreement, frame, place);
      n += !isnan(off);
      sum += isnan(off) ? 0 : off;
    }
  }
  return 2 * n > BLOCK_EDGES * width ? sum / n : NAN;
}

static double bias_of(placido_agreement *agreement, const placido_testimony *frame) {
  const int width = (agreement->meridian_count * BLOCK_DEG + 359) / 360;
  size_t blocks = 0;
  for (int k = 0; k + BLOCK_EDGES <= agreement->edge_count; k += BLOCK_EDGES) {
    for (int m = 0; m + width <= agreement->meridian_count; m += width) {
      const double mean = block_mean(agreement, frame, k, m, width);
      if (!isnan(mean)) {
        agreement->work[blocks++] = mean;
      }
    }
  }
  return spread_of(agreement->work, blocks) * sqrt(width * BLOCK_EDGES);
}

/* Robust spreads of a frame about the middle: of points, and of blocks. */
static void find_spread(placido_agreement *agreement, placido_testimony *frame) {
  size_t points = 0;
  for (size_t place = 0; place < agreement->places; place++) {
    const double off = off_middle(agreement, frame, place);
    if (!isnan(off)) {
      agreement->work[points++] = off;
    }
  }
  /* fmax takes the number where the other is none */
  frame->spread_px = fmax(spread_of(agreement->work, points), SPREAD_LEAST_PX);
  frame->bias_px = fmax(bias_of(agreement, frame), frame->spread_px);
}

static double usual_bias(const placido_agreement *agreement) {
  double biases[PLACIDO_COMBINE_MAX];
  size_t n = 0;
  for (size_t i = 0; i < agreement->count; i++) {
    if (agreement->frames[i].used) {
      biases[n++] = agreement->frames[i].bias_px;
    }
  }
  return median(biases, n);
}

/* Takes the frame that agrees least with the others out of use, where that is far worse than the
 * usual. */
static bool set_one_aside(placido_agreement *agreement) {
  placido_testimony *worst = NULL;
  find_middle(agreement);
  for (size_t i = 0; i < agreement->count; i++) {
    placido_testimony *frame = &agreement->frames[i];
    find_spread(agreement, frame);
    if (frame->used && (!worst || frame->bias_px > worst->bias_px)) {
      worst = frame;
    }
  }
  if (!worst || worst->bias_px < fmax(APART * usual_bias(agreement), APART_LEAST_PX)) {
    return false;
  }
  worst->used = false;
  return true;
}

/* A worse frame than usual has a lesser share; better ones than usual are so by chance. */
static void set_weights(placido_agreement *agreement) {
  const double usual_px = usual_bias(agreement);
  double sum = 0;
  for (size_t i = 0; i < agreement->count; i++) {
    placido_testimony *frame = &agreement->frames[i];
    frame->weight = frame->used ? pow(fmax(frame->bias_px, usual_px), -2) : 0;
    sum += frame->weight;
  }
  for (size_t i = 0; i < agreement->count && sum > 0; i++) {
    agreement->frames[i].weight /= sum;
  }
}

void placido_agreement_find(placido_agreement *agreement) {
  bool is_settled = false;
  while (!is_settled) {
    is_settled = !set_one_aside(agreement);
  }
  set_weights(agreement);
}

bool placido_agreement_mean(const placido_agreement *agreement, size_t place, double *mean_px,
                            double *sigma_px) {
  double values[PLACIDO_COMBINE_MAX], sum = 0, weights = 0, squares = 0, variance = 0;
  size_t frames[PLACIDO_COMBINE_MAX], n = gather(agreement, place, values, frames), kept = 0;
  for (size_t i = 0; i < n; i++) {
    const placido_testimony *frame = &agreement->frames[frames[i]];
    const double off = values[i] - agreement->middle_px[place];
    if (fabs(off) < STRAY * frame->spread_px) {
      weights += frame->weight;
      sum += frame->weight * off;
      squares += off * off / (frame->spread_px * frame->spread_px);
      variance += pow(frame->weight * frame->spread_px, 2);
      kept++;
    }
  }
  if (kept == 0 || 2 * kept < used_count(agreement)) {
    return false;
  }
  *mean_px = agreement->middle_px[place] + sum / weights;
  const double scatter = kept > 1 ? squares / (double)(kept - 1) : 1;
  *sigma_px = sqrt(variance * fmax(scatter, 1)) / weights;
  return true;
}

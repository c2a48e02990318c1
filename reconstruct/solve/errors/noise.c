/* Differences and autocorrelation of the residuals along the mires. */
#include "reconstruct/solve/errors/noise.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/errors/kinship.h"

#include <math.h>

#define LAG_MAX 30
#define BLOCK_EDGES 4     /* share one figure, from as many differences again on either side */
#define BLOCK_MERIDIANS 1 /* on either side */
#define NOISE_LEAST 0.5
#define NOISE_MOST 8.0
#define DIFFERENCES_MIN 8 /* fewer tell nothing */

/* Whether sample j lies `lag` meridians after sample i on the same edge, both of use. */
static bool neighbours(const placido_sample *samples, size_t i, size_t j, int lag,
                       const placido_mires *mires) {
  const placido_sample *a = &samples[i], *b = &samples[j];
  if (a->edge != b->edge || !a->used || !b->used || isnan(a->residual_px) ||
      isnan(b->residual_px)) {
    return false;
  }
  double step = (mires->points[b->point].meridian_deg - mires->points[a->point].meridian_deg) *
                mires->meridian_count / 360;
  return lrint(step) == lag;
}

double placido_noise_rough(const placido_sample *samples, size_t count, const placido_mires *mires,
                           int stride, double *work) {
  size_t n = 0;
  for (size_t i = 0; i + 1 < count; i++) {
    if (neighbours(samples, i, i + 1, stride, mires)) {
      work[n++] = fabs(samples[i + 1].residual_px - samples[i].residual_px);
    }
  }
  return 1.4826 * placido_quantile(work, n, 0.5) / M_SQRT2;
}

double placido_noise_inflation(const placido_sample *samples, const double *residual_px,
                               size_t count, const placido_mires *mires) {
  double variance = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used && !isnan(samples[i].residual_px)) {
      variance += residual_px[i] * residual_px[i];
      used++;
    }
  }
  double factor = 1;
  for (int lag = 1; lag <= LAG_MAX && variance > 0; lag++) {
    double sum = 0;
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++) {
      for (size_t j = i + 1; j <= i + (size_t)lag && j < count; j++) {
        if (neighbours(samples, i, j, lag, mires)) {
          sum += residual_px[i] * residual_px[j];
          pairs++;
          break;
        }
      }
    }
    double correlation = pairs ? sum / (double)pairs / (variance / (double)used) : 0;
    if (correlation < 0.03) {
      break; /* what follows is noise of the estimate itself */
    }
    factor += 2 * correlation;
  }
  return factor;
}

/* The residuals by edge and meridian; NaN where there is none. */
typedef struct table {
  int edges, meridians;
  double *residual_px, *noise; /* edges × meridians; blocks of edges × meridians */
} table;

static int meridian_of(const placido_mires *mires, const placido_sample *sample) {
  double turn = mires->points[sample->point].meridian_deg / 360;
  return (int)(lrint(turn * mires->meridian_count) % mires->meridian_count);
}

static void fill(table *t, const placido_sample *samples, size_t count,
                 const placido_mires *mires) {
  for (int i = 0; i < t->edges * t->meridians; i++) {
    t->residual_px[i] = NAN;
  }
  for (size_t i = 0; i < count; i++) {
    const placido_sample *s = &samples[i];
    if (s->used) {
      int edge = mires->points[s->point].edge;
      t->residual_px[edge * t->meridians + meridian_of(mires, s)] = s->residual_px * s->noise;
    }
  }
}

/* The median distance in the image between meridians, edge by edge; 0 where there is none. */
static void find_steps(double *step_px, const placido_sample *samples, size_t count,
                       const placido_mires *mires, double *work) {
  for (int k = 0; k < mires->edge_count; k++) {
    step_px[k] = 0;
  }
  for (size_t i = 0; i < count;) {
    int edge = mires->points[samples[i].point].edge;
    size_t n = 0;
    for (; i < count && mires->points[samples[i].point].edge == edge; i++) {
      const placido_mire_point *p = &mires->points[samples[i].point];
      double du = p->u_px - mires->centre_u_px, dv = p->v_px - mires->centre_v_px;
      work[n++] = sqrt(du * du + dv * dv);
    }
    step_px[edge] = 2 * M_PI * placido_quantile(work, n, 0.5) / mires->meridian_count;
  }
}

/* The robust standard deviation about one block; NaN where too little is there. */
static double noise_about(const table *t, int block, int meridian) {
  double differences[3 * BLOCK_EDGES * (2 * BLOCK_MERIDIANS + 1)];
  size_t n = 0;
  int first = (block - 1) * BLOCK_EDGES, last = first + 3 * BLOCK_EDGES;
  first = first > 0 ? first : 0;
  last = last < t->edges - 1 ? last : t->edges - 1;
  for (int m = meridian - BLOCK_MERIDIANS; m <= meridian + BLOCK_MERIDIANS; m++) {
    const double *column = t->residual_px + (m + t->meridians) % t->meridians;
    for (int k = first; k < last; k++) {
      double d = column[(k + 1) * t->meridians] - column[k * t->meridians];
      if (!isnan(d)) {
        differences[n++] = fabs(d);
      }
    }
  }
  return n >= DIFFERENCES_MIN ? 1.4826 * placido_quantile(differences, n, 0.5) / M_SQRT2
                              : (double)NAN;
}

static double median_noise(const placido_sample *samples, size_t count, double *work) {
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used) {
      work[n++] = samples[i].noise;
    }
  }
  return placido_quantile(work, n, 0.5);
}

/* Hands the table's figures out to the samples, relative to the usual one, and larger where
 * meridians stand for less than a point each. */
static void hand_out(placido_sample *samples, size_t count, const placido_mires *mires,
                     const table *t, const double *step_px, double kin_px, double *work) {
  size_t n = 0;
  for (int i = 0; i < (t->edges + BLOCK_EDGES - 1) / BLOCK_EDGES * t->meridians; i++) {
    if (!isnan(t->noise[i])) {
      work[n++] = t->noise[i];
    }
  }
  double usual = placido_quantile(work, n, 0.5);
  if (!(usual > 0)) {
    return;
  }
  for (size_t i = 0; i < count; i++) {
    int block = mires->points[samples[i].point].edge / BLOCK_EDGES;
    double noise = t->noise[block * t->meridians + meridian_of(mires, &samples[i])] / usual;
    samples[i].noise = isnan(noise) ? 1 : fmax(NOISE_LEAST, fmin(NOISE_MOST, noise));
  }
  double shared[PLACIDO_EDGES_MAX];
  for (int k = 0; k < mires->edge_count; k++) {
    shared[k] = step_px[k] > 0 ? placido_kinship_factor(kin_px, step_px[k]) : 1;
  }
  for (size_t i = 0; i < count; i++) {
    samples[i].shared = shared[mires->points[samples[i].point].edge];
    samples[i].noise *= samples[i].shared;
  }
  double middle = median_noise(samples, count, work);
  for (size_t i = 0; i < count; i++) {
    samples[i].noise /= middle;
  }
}

int placido_noise_find(placido_sample *samples, double *kin_px, size_t count,
                       const placido_mires *mires, placido_error *err) {
  double step_px[PLACIDO_EDGES_MAX];
  *kin_px = 0;
  table t = {.edges = mires->edge_count, .meridians = mires->meridian_count};
  size_t places = (size_t)t.edges * (size_t)t.meridians;
  t.residual_px = placido_memory_new(places, sizeof *t.residual_px, err);
  t.noise = placido_memory_new(places, sizeof *t.noise, err);
  double *work = placido_memory_new(places > count ? places : count, sizeof *work, err);
  int status = t.residual_px && t.noise && work ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    fill(&t, samples, count, mires);
    for (int i = 0; i < (t.edges + BLOCK_EDGES - 1) / BLOCK_EDGES * t.meridians; i++) {
      t.noise[i] = noise_about(&t, i / t.meridians, i % t.meridians);
    }
    find_steps(step_px, samples, count, mires, work);
    *kin_px = placido_kinship_length(t.residual_px, step_px, t.edges, t.meridians, work);
    hand_out(samples, count, mires, &t, step_px, *kin_px, work);
  }
  placido_memory_free(t.residual_px);
  placido_memory_free(t.noise);
  placido_memory_free(work);
  return status;
}

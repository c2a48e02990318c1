/* Candidates for edges: extrema of the Gaussian derivative of each profile, held against the
 * strength that is usual around them. */
#include "reconstruct/mires/edges.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define KERNEL_MAX 16   /* half length in samples */
#define SIGMA_SHARE 0.12 /* of the distance between edges: standard deviation of the derivative */
#define SIGMA_LEAST_PX 0.7
#define SIGMA_MOST_PX 4.0
#define SECTORS 24      /* blocks of the reference map around the circle */
#define RING_EDGES 6    /* edges that a block spans */
#define SHARE 0.3       /* a candidate has at least this share of its block's usual strength */
#define USUAL_SHARE 0.25 /* of the edges to expect: as many are stronger than what is usual */
#define BIN_SHIFT 17    /* bits of a float that a histogram does not tell apart */
#define BINS (1u << (31 - BIN_SHIFT))
#define FLOOR_SHARE 0.2 /* of the usual strength of all: the least that a block's may be */

/* An extremum. */
typedef struct candidate {
  float radius_px, slope, width_px;
} candidate;

/* The extrema of all meridians, `room` places for each. */
typedef struct candidates {
  int meridians;
  size_t room;
  size_t *found; /* a meridian */
  candidate *list;
} candidates;

/* Gaussian derivative of a profile; 0 where the kernel reaches beyond it. */
static void derivative(float *out, const float *profile, const placido_meridian *along,
                       double sigma_px) {
  double sigma = sigma_px / along->step_px, sum = 0;
  int reach = (int)fmin(KERNEL_MAX, ceil(3 * sigma)), inner = along->count - 2 * reach;
  memset(out, 0, (size_t)along->count * sizeof *out);
  if (inner <= 0) {
    return;
  }
  for (int k = 1; k <= reach; k++) {
    sum += 2 * k * along->step_px * k * exp(-0.5 * k * k / (sigma * sigma));
  }
  for (int k = 1; k <= reach; k++) {
    float weight = (float)(k * exp(-0.5 * k * k / (sigma * sigma)) / sum);
    const float *after = profile + reach + k, *before = profile + reach - k;
    float *here = out + reach;
    for (int i = 0; i < inner; i++) {
      here[i] += weight * (after[i] - before[i]);
    }
  }
}

/* Lists the extrema of a derivative: maxima above 0, minima below. The bend of their tops tells
 * how wide the edge is. */
static size_t extrema(candidate *out, const float *d, const placido_meridian *along,
                      double sigma_px) {
  size_t found = 0;
  float step = (float)along->step_px, start = (float)along->start_px;
  for (int i = 1; i < along->count - 1; i++) {
    float before = d[i - 1], here = d[i], after = d[i + 1];
    bool top = here > 0 && here > before && here >= after;
    bool bottom = here < 0 && here < before && here <= after;
    if (!top && !bottom) {
      continue;
    }
    float bend = before - 2 * here + after, shift = 0.5F * (before - after) / bend;
    float variance = -here * step * step / bend - (float)(sigma_px * sigma_px);
    float radius = start + ((float)i + shift) * step;
    if (radius > 0) {
      out[found++] = (candidate){radius, here, variance > 0.25F ? sqrtf(variance) : 0.5F};
    }
  }
  return found;
}

static int candidates_new(candidates *out, const placido_polar *polar, double sigma_px,
                          int threads, placido_error *err) {
  size_t meridians = (size_t)polar->meridians, samples = (size_t)polar->samples;
  *out = (candidates){.meridians = polar->meridians, .room = samples}; /* noise may turn at each */
  float *slopes = placido_memory_new(meridians * samples, sizeof *slopes, err);
  out->found = placido_memory_new(meridians, sizeof *out->found, err);
  out->list = placido_memory_new(meridians * out->room, sizeof *out->list, err);
  int status = slopes && out->found && out->list ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
#pragma omp parallel for num_threads(threads)
    for (int m = 0; m < polar->meridians; m++) {
      size_t row = (size_t)m * samples;
      derivative(slopes + row, polar->data + row, &polar->along[m], sigma_px);
      out->found[m] = extrema(out->list + (size_t)m * out->room, slopes + row, &polar->along[m],
                              sigma_px);
    }
  }
  placido_memory_free(slopes);
  return status;
}

static void candidates_free(candidates *all) {
  placido_memory_free(all->found);
  placido_memory_free(all->list);
}

/* The strength that a quarter as many of `count` values reach as there are edges to expect: were
 * all edges seen, the strongest quarter of them would; flat eyes show fewer, lashes and lids hide
 * some. Noise makes far more extrema than mires do, so it is the rank from the top that counts. */
static double usual_strength(double *values, size_t count, double edges) {
  double share = count ? 1 - USUAL_SHARE * edges / (double)count : 0;
  return placido_quantile(values, count, fmax(share, 0));
}

/* The bin of a strength: its exponent and the first bits of its mantissa, so that bins are 1.6 %
 * wide or less. */
static size_t bin_of(float strength) {
  uint32_t bits;
  memcpy(&bits, &strength, sizeof bits);
  return bits >> BIN_SHIFT;
}

/* The least usual strength of a block: a share of what is usual where mires are to be expected,
 * which a histogram tells. */
static int floor_of(double *strength, const candidates *all, double spacing_px, double reach_px,
                    placido_error *err) {
  size_t *bins = placido_memory_new(BINS, sizeof *bins, err);
  if (!bins) {
    return PLACIDO_MEMORY;
  }
  for (int m = 0; m < all->meridians; m++) {
    const candidate *list = all->list + (size_t)m * all->room;
    for (size_t i = 0; i < all->found[m] && (double)list[i].radius_px < reach_px; i++) {
      bins[bin_of(fabsf(list[i].slope))]++;
    }
  }
  double wanted = USUAL_SHARE * all->meridians * reach_px / spacing_px, seen = 0;
  size_t bin = BINS - 1;
  while (bin > 0 && seen + (double)bins[bin] < wanted) {
    seen += (double)bins[bin--];
  }
  uint32_t bits = (uint32_t)bin << BIN_SHIFT;
  float usual;
  memcpy(&usual, &bits, sizeof usual);
  *strength = FLOOR_SHARE * (double)usual;
  placido_memory_free(bins);
  return PLACIDO_OK;
}

/* Makes crossings of the candidates that no block could refuse. */
static int crossings_new(placido_crossings *out, const candidates *all, double least,
                         placido_error *err) {
  size_t count = 0;
  for (int pass = 0; pass < 2; pass++) {
    out->count = 0;
    for (int m = 0; m < all->meridians; m++) {
      const candidate *list = all->list + (size_t)m * all->room;
      for (size_t i = 0; i < all->found[m]; i++) {
        if (fabs((double)list[i].slope) < least) {
          continue;
        }
        if (pass == 1) {
          out->list[out->count] = (placido_crossing){.meridian = m,
                                                     .radius_px = (double)list[i].radius_px,
                                                     .slope = (double)list[i].slope,
                                                     .chain = -1,
                                                     .edge = -1,
                                                     .width_px = (double)list[i].width_px};
        }
        out->count++;
      }
    }
    if (pass == 0) {
      count = out->count;
      out->list = placido_memory_new(count, sizeof *out->list, err);
      out->first = placido_memory_new((size_t)all->meridians + 1, sizeof *out->first, err);
      if (!out->list || !out->first) {
        return PLACIDO_MEMORY;
      }
    }
  }
  return PLACIDO_OK;
}

/* The usual strength per block of (sector, ring). */
typedef struct reference {
  double ring_px;
  int rings;
  double *strength; /* SECTORS * rings */
} reference;

static size_t block_of(const reference *ref, const placido_crossing *c, int meridians) {
  int sector = c->meridian * SECTORS / meridians;
  int ring = (int)(c->radius_px / ref->ring_px);
  return (size_t)sector * (size_t)ref->rings + (size_t)(ring < ref->rings ? ring : ref->rings - 1);
}

static int reference_new(reference *ref, const placido_crossings *all, double spacing_px,
                         double floor_strength, double far_px, placido_error *err) {
  ref->ring_px = RING_EDGES * spacing_px;
  ref->rings = (int)(far_px / ref->ring_px) + 1;
  size_t blocks = (size_t)SECTORS * (size_t)ref->rings;
  double *values = placido_memory_new(all->count, sizeof *values, err);
  size_t *starts = placido_memory_new(blocks + 1, sizeof *starts, err);
  ref->strength = placido_memory_new(blocks, sizeof *ref->strength, err);
  int status = values && starts && ref->strength ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < all->count; i++) {
      starts[block_of(ref, &all->list[i], all->meridians) + 1]++;
    }
    for (size_t b = 0; b < blocks; b++) {
      starts[b + 1] += starts[b];
    }
    for (size_t i = 0; i < all->count; i++) {
      size_t b = block_of(ref, &all->list[i], all->meridians);
      values[starts[b]++] = fabs(all->list[i].slope);
    }
    for (size_t b = 0, start = 0; b < blocks; start = starts[b++]) {
      double usual = usual_strength(values + start, starts[b] - start,
                                    (double)all->meridians / SECTORS * RING_EDGES);
      ref->strength[b] = usual > floor_strength ? usual : floor_strength;
    }
  }
  placido_memory_free(values);
  placido_memory_free(starts);
  return status;
}

/* Keeps what stands out, in order, and notes where each meridian's share begins. */
static void keep_strong(placido_crossings *all, const reference *ref) {
  size_t kept = 0;
  int meridian = 0;
  for (size_t i = 0; i < all->count; i++) {
    placido_crossing c = all->list[i];
    if (fabs(c.slope) >= SHARE * ref->strength[block_of(ref, &c, all->meridians)]) {
      while (meridian <= c.meridian) {
        all->first[meridian++] = kept;
      }
      all->list[kept++] = c;
    }
  }
  while (meridian <= all->meridians) {
    all->first[meridian++] = kept;
  }
  all->count = kept;
}

int placido_crossings_find(placido_crossings *out, const placido_polar *polar, double spacing_px,
                           double reach_px, int threads, placido_error *err) {
  double sigma_px = fmax(SIGMA_LEAST_PX, fmin(SIGMA_MOST_PX, SIGMA_SHARE * spacing_px));
  double least = 0;
  candidates all = {0};
  reference ref = {0};
  *out = (placido_crossings){.meridians = polar->meridians};
  int status = candidates_new(&all, polar, sigma_px, threads, err);
  if (!status) {
    status = floor_of(&least, &all, spacing_px, reach_px, err);
  }
  if (!status) {
    status = crossings_new(out, &all, SHARE * least, err);
  }
  if (!status) {
    status = reference_new(&ref, out, spacing_px, least, (double)polar->samples, err);
  }
  if (!status) {
    keep_strong(out, &ref);
  }
  candidates_free(&all);
  placido_memory_free(ref.strength);
  if (status) {
    placido_crossings_free(out);
  }
  return status;
}

void placido_crossings_free(placido_crossings *crossings) {
  placido_memory_free(crossings->first);
  placido_memory_free(crossings->list);
  *crossings = (placido_crossings){0};
}

/* Candidates for edges: extrema of the Gaussian derivative of each profile, held against the
 * strength that is usual around them. */
#include "reconstruct/mires/edges.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

#define KERNEL 6        /* half length in samples: 3 standard deviations */
#define SIGMA_SAMPLES 2 /* 1 px */
#define SECTORS 24      /* blocks of the reference map around the circle */
#define RING_EDGES 6      /* edges that a block spans */
#define SHARE 0.3       /* a candidate has at least this share of its block's usual strength */

static void derivative(const float *profile, int count, float *out) {
  float kernel[KERNEL + 1], sum = 0;
  for (int i = 0; i <= KERNEL; i++) {
    kernel[i] = (float)i * expf(-(float)(i * i) / (2.0f * SIGMA_SAMPLES * SIGMA_SAMPLES));
    sum += 2 * (float)i * kernel[i] * (float)PLACIDO_POLAR_STEP_PX;
  }
  for (int i = 0; i < count; i++) {
    out[i] = 0;
    if (i < KERNEL || i >= count - KERNEL) {
      continue;
    }
    float d = 0;
    for (int k = 1; k <= KERNEL; k++) {
      d += kernel[k] * (profile[i + k] - profile[i - k]);
    }
    out[i] = isnan(d) ? 0 : d / sum;
  }
}

/* Appends the extrema of |derivative| of one profile; returns how many. */
static size_t extrema(const float *d, int count, int meridian, placido_crossing *out) {
  size_t found = 0;
  for (int i = 1; i < count - 1; i++) {
    float here = fabsf(d[i]), before = fabsf(d[i - 1]), after = fabsf(d[i + 1]);
    if (here <= 0 || here < before || here <= after) {
      continue;
    }
    double bend = (double)before - 2.0 * here + after;
    double shift = bend < 0 ? 0.5 * ((double)before - after) / bend : 0;
    out[found++] = (placido_crossing){.meridian = meridian,
                                      .radius_px = (i + shift) * PLACIDO_POLAR_STEP_PX,
                                      .slope = d[i],
                                      .chain = -1,
                                      .edge = -1};
  }
  return found;
}

/* The usual strength per block of (sector, ring): were all its edges seen, the strongest
 * quarter of them would reach it; flat eyes show fewer, lashes and lids hide some. Noise makes far
 * more extrema than mires do, so it is the rank from the top that counts. Not less than a fifth of
 * what is usual where mires are to be expected. */
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

/* The strength that a quarter as many of `count` values reach as there are edges to expect. */
static double usual_strength(double *values, size_t count, double edges) {
  double share = count ? 1 - 0.25 * edges / (double)count : 0;
  return placido_quantile(values, count, fmax(share, 0));
}

static int reference_new(reference *ref, const placido_crossings *all, double spacing_px,
                         double reach_px, double far_px, placido_error *err) {
  ref->ring_px = RING_EDGES * spacing_px;
  ref->rings = (int)(far_px / ref->ring_px) + 1;
  size_t blocks = (size_t)SECTORS * (size_t)ref->rings;
  double *values = placido_memory_new(all->count, sizeof *values, err);
  size_t *starts = placido_memory_new(blocks + 1, sizeof *starts, err);
  ref->strength = placido_memory_new(blocks, sizeof *ref->strength, err);
  int status = values && starts && ref->strength ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    size_t near = 0;
    for (size_t i = 0; i < all->count; i++) {
      starts[block_of(ref, &all->list[i], all->meridians) + 1]++;
      if (all->list[i].radius_px < reach_px) {
        values[near++] = fabs(all->list[i].slope);
      }
    }
    double meridians = all->meridians;
    double floor_strength = 0.2 * usual_strength(values, near, meridians * reach_px / spacing_px);
    for (size_t b = 0; b < blocks; b++) {
      starts[b + 1] += starts[b];
    }
    for (size_t i = 0; i < all->count; i++) {
      size_t b = block_of(ref, &all->list[i], all->meridians);
      values[starts[b]++] = fabs(all->list[i].slope);
    }
    for (size_t b = 0, start = 0; b < blocks; start = starts[b++]) {
      double usual = usual_strength(values + start, starts[b] - start,
                                    meridians / SECTORS * RING_EDGES);
      ref->strength[b] = usual > floor_strength ? usual : floor_strength;
    }
  }
  placido_memory_free(values);
  placido_memory_free(starts);
  return status;
}

/* Keeps what stands out, in order, and notes where each meridian's share begins. */
static int select_strong(placido_crossings *all, double spacing_px, double reach_px,
                         double far_px, placido_error *err) {
  reference ref = {0};
  int status = reference_new(&ref, all, spacing_px, reach_px, far_px, err);
  if (!status) {
    size_t kept = 0;
    int meridian = 0;
    for (size_t i = 0; i < all->count; i++) {
      placido_crossing c = all->list[i];
      if (fabs(c.slope) >= SHARE * ref.strength[block_of(&ref, &c, all->meridians)]) {
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
  placido_memory_free(ref.strength);
  return status;
}

int placido_crossings_find(placido_crossings *out, const placido_polar *polar, double spacing_px,
                           double reach_px, int threads, placido_error *err) {
  size_t meridians = (size_t)polar->meridians, samples = (size_t)polar->samples;
  size_t room = samples / 2 + 1;
  *out = (placido_crossings){.meridians = polar->meridians};
  float *slopes = placido_memory_new(meridians * samples, sizeof *slopes, err);
  size_t *found = placido_memory_new(meridians, sizeof *found, err);
  out->first = placido_memory_new(meridians + 1, sizeof *out->first, err);
  out->list = placido_memory_new(meridians * room, sizeof *out->list, err);
  int status = slopes && found && out->first && out->list ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
#pragma omp parallel for num_threads(threads)
    for (int m = 0; m < polar->meridians; m++) {
      size_t row = (size_t)m * samples;
      derivative(polar->data + row, polar->samples, slopes + row);
      found[m] = extrema(slopes + row, polar->samples, m, out->list + (size_t)m * room);
    }
    for (size_t m = 0; m < meridians; m++) {
      memmove(out->list + out->count, out->list + m * room, found[m] * sizeof *out->list);
      out->count += found[m];
    }
    status = select_strong(out, spacing_px, reach_px,
                           (double)samples * PLACIDO_POLAR_STEP_PX, err);
  }
  placido_memory_free(slopes);
  placido_memory_free(found);
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

/* Each meridian is stretched so that its edges lie where the pattern has them: what differs from
 * the sharp pattern then is blur, and no astigmatism, cone or ripple. */
#include "acquire/guide/blur.h"

#include <math.h>


#define PER_SECTOR (PLACIDO_GUIDE_MERIDIANS / PLACIDO_GUIDE_SECTORS)
#define EDGES_NEEDED 5 /* of the pattern's, on a meridian */
#define MERIDIANS_NEEDED (PER_SECTOR / 2)
#define SAMPLES_MAX 4096
/* The pixel's own width, and bilinear interpolation. */
#define PIXEL_VARIANCE (1.0 / 12 + 1.0 / 6)

/* Where a meridian's edges are, and where the pattern has them. */
struct warp {
  int count;
  double seen_px[PLACIDO_GUIDE_PATTERN_EDGES], pattern_px[PLACIDO_GUIDE_PATTERN_EDGES];
};

static struct warp warp_of(const placido_guide_walk *walk, int m) {
  struct warp warp = {.count = 0};
  const float *row = walk->radius_px + (size_t)m * (size_t)walk->edge_count;
  for (int k = 0; k < PLACIDO_GUIDE_PATTERN_EDGES && k < walk->edge_count; k++) {
    if (!isnan(row[k]) && k < walk->numbered[m]) {
      warp.seen_px[warp.count] = (double)row[k];
      warp.pattern_px[warp.count++] = walk->expected_px[k];
    }
  }
  return warp;
}

static double stretch_of(const struct warp *warp) {
  const int last = warp->count - 1;
  return (warp->seen_px[last] - warp->seen_px[0]) /
         (warp->pattern_px[last] - warp->pattern_px[0]);
}

/* The pattern's radius of a radius in the picture; `*piece` is where the last one was. */
static double to_pattern(const struct warp *warp, double radius_px, int *piece) {
  while (*piece < warp->count - 2 && radius_px > warp->seen_px[*piece + 1]) {
    (*piece)++;
  }
  const double *seen = &warp->seen_px[*piece], *pattern = &warp->pattern_px[*piece];
  return pattern[0] +
         (radius_px - seen[0]) * (pattern[1] - pattern[0]) / (seen[1] - seen[0]);
}

/* Samples of a sector. */
struct heap {
  int count;
  placido_guide_sample samples[SAMPLES_MAX];
};

static void add_meridian(struct heap *heap, const struct warp *warp,
                         const placido_guide_pattern *pattern, const placido_guide_polar *polar,
                         int m) {
  const float *row = polar->data + (size_t)m * (size_t)polar->samples;
  const double low = pattern->low_px / pattern->step_px, high = pattern->high_px / pattern->step_px;
  int piece = 0;
  for (int i = 0; i < polar->samples && heap->count < SAMPLES_MAX; i++) {
    const double place = to_pattern(warp, i * polar->step_px, &piece) / pattern->step_px;
    if (place > high) {
      break;
    }
    if (place >= low && row[i] >= 0) {
      heap->samples[heap->count++] = (placido_guide_sample){(float)place, row[i]};
    }
  }
}

/* Variance of the blur along a sector's direction, px²; NaN where too little is seen. */
static double sector_variance(const placido_guide_polar *polar,
                              const placido_guide_pattern *pattern,
                              const placido_guide_walk *walk, int sector) {
  struct heap heap = {.count = 0};
  int meridians = 0;
  double stretch = 0;
  for (int j = 0; j < PER_SECTOR; j++) {
    const int m = (sector * PER_SECTOR + j - PER_SECTOR / 2 + PLACIDO_GUIDE_MERIDIANS) %
                  PLACIDO_GUIDE_MERIDIANS;
    const struct warp warp = warp_of(walk, m);
    if (warp.count >= EDGES_NEEDED) {
      add_meridian(&heap, &warp, pattern, polar, m);
      stretch += stretch_of(&warp);
      meridians++;
    }
  }
  if (meridians < MERIDIANS_NEEDED) {
    return NAN;
  }
  const double blur =
      stretch / meridians * placido_guide_pattern_blur(pattern, heap.samples, heap.count);
  return blur * blur - PIXEL_VARIANCE;
}

/* A straight motion of length L adds L²/12 cos²(θ - direction) to the variance along θ. */
void placido_guide_blur(double *blur_px, double *motion_px, const placido_guide_polar *polar,
                        const placido_guide_pattern *pattern, const placido_guide_walk *walk) {
  double variances[PLACIDO_GUIDE_SECTORS], wave[3];
  *blur_px = *motion_px = NAN;
  for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
    variances[s] = sector_variance(polar, pattern, walk, s);
  }
  if (placido_guide_wave_fit(wave, 2, variances)) {
    const double swing = hypot(wave[1], wave[2]);
    *blur_px = sqrt(fmax(0, wave[0] - swing));
    *motion_px = sqrt(24 * swing);
  }
}

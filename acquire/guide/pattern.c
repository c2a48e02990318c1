/* The mires' pattern as a table over radius and blur, and the correlation of a profile with it. */
#include "acquire/guide/pattern.h"

#include <math.h>

#define BLUR_FIRST 0.035 /* of a gap */
#define BLUR_RATIO 1.24
#define SAMPLES_MIN 12.0F
#define SHARE_MIN 0.6F /* of a profile's samples that must be in the picture */

static double blurred_step(double x, double blur) {
  return 0.5 * erfc(-x / (sqrt(2.0) * blur));
}

void placido_guide_pattern_make(placido_guide_pattern *pattern, const double *edges_px, int count,
                                bool first_bright) {
  const int last =
      count < PLACIDO_GUIDE_PATTERN_EDGES ? count - 1 : PLACIDO_GUIDE_PATTERN_EDGES - 1;
  pattern->inner_px = edges_px[0];
  pattern->gap_px = (edges_px[last] - edges_px[0]) / last;
  pattern->low_px = 0.4 * edges_px[0]; /* a lamp to be looked at may stand in the middle */
  pattern->high_px = edges_px[last] + 0.5 * pattern->gap_px;
  pattern->middle_px = edges_px[last < 2 ? last : 2];
  pattern->step_px = fmax(pattern->gap_px / 16,
                          1.05 * pattern->high_px / PLACIDO_GUIDE_PATTERN_SAMPLES);
  pattern->count = (int)(1.02 * pattern->high_px / pattern->step_px) + 2;
  for (int b = 0; b < PLACIDO_GUIDE_BLURS; b++) {
    pattern->blur_px[b] = BLUR_FIRST * pattern->gap_px * pow(BLUR_RATIO, b);
    for (int i = 0; i < pattern->count; i++) {
      double light = first_bright ? 0 : 1;
      for (int k = 0; k < count; k++) {
        const double sign = (k % 2 == 0) == first_bright ? 1 : -1;
        light += sign * blurred_step(i * pattern->step_px - edges_px[k], pattern->blur_px[b]);
      }
      pattern->light[b][i] = (float)light;
    }
  }
}

/* Sums for the correlation of light (t) and grey level (p). */
struct sums {
  float n, t, p, tt, pp, tp;
};

/* One place of the profile, in steps of the pattern; beyond the pattern it does not count. */
static void add(struct sums *sums, const placido_guide_pattern *pattern, const float *light,
                float place, float grey) {
  const int index = (int)place;
  if (place < 0 || index > pattern->count - 2) {
    return;
  }
  const float t = light[index] + (place - (float)index) * (light[index + 1] - light[index]);
  sums->n += 1;
  sums->t += t;
  sums->p += grey;
  sums->tt += t * t;
  sums->pp += grey * grey;
  sums->tp += t * grey;
}

static placido_guide_match match_of(const struct sums *s) {
  const double vt = (double)(s->n * s->tt - s->t * s->t), vp = (double)(s->n * s->pp - s->p * s->p);
  const double covariance = (double)(s->n * s->tp - s->t * s->p);
  return s->n < SAMPLES_MIN || vt <= 0 || vp <= 1e-9
             ? (placido_guide_match){-1, 0}
             : (placido_guide_match){covariance / sqrt(vt * vp), covariance / vt};
}

placido_guide_match placido_guide_compare(const placido_guide_profile *profile,
                                          const placido_guide_pattern *pattern,
                                          const placido_guide_trial *trial) {
  const double low_px = trial->scale * pattern->low_px + trial->shift_px;
  const double high_px = trial->scale * pattern->high_px + trial->shift_px;
  const double to_place = 1 / (trial->scale * pattern->step_px);
  const int first = (int)fmax(0, ceil(low_px / profile->step_px));
  int last = (int)(high_px / profile->step_px);
  last = last < profile->count - 1 ? last : profile->count - 1;
  struct sums sums = {0};
  for (int i = first; i <= last; i++) {
    if (profile->grey[i] >= 0) {
      add(&sums, pattern, pattern->light[trial->blur],
          (float)((i * profile->step_px - trial->shift_px) * to_place), profile->grey[i]);
    }
  }
  return sums.n < SHARE_MIN * (float)(last - first) ? (placido_guide_match){-1, 0}
                                                   : match_of(&sums);
}

static double likeness_at(const placido_guide_pattern *pattern,
                          const placido_guide_sample *samples, int count, int blur) {
  struct sums sums = {0};
  for (int i = 0; i < count; i++) {
    add(&sums, pattern, pattern->light[blur], samples[i].place, samples[i].grey);
  }
  return match_of(&sums).likeness;
}

/* The likeness has one maximum over the rows: first every third of them, then those beside the
 * best, whose neighbours a parabola needs as well. */
double placido_guide_pattern_blur(const placido_guide_pattern *pattern,
                                  const placido_guide_sample *samples, int count) {
  double likeness[PLACIDO_GUIDE_BLURS];
  int best = 0;
  for (int b = 0; b < PLACIDO_GUIDE_BLURS; b++) {
    likeness[b] = b % 3 == 0 ? likeness_at(pattern, samples, count, b) : -2;
    best = likeness[b] > likeness[best] ? b : best;
  }
  const int middle = best;
  for (int b = middle - 3; b <= middle + 3; b++) {
    if (b >= 0 && b < PLACIDO_GUIDE_BLURS && b % 3 != 0) {
      likeness[b] = likeness_at(pattern, samples, count, b);
      best = likeness[b] > likeness[best] ? b : best;
    }
  }
  double row = best;
  if (best > 0 && best < PLACIDO_GUIDE_BLURS - 1) {
    const double *at = &likeness[best];
    const double bend = at[-1] - 2 * at[0] + at[1];
    row += bend < 0 ? 0.5 * (at[-1] - at[1]) / bend : 0;
  }
  return likeness[best] > 0 ? pattern->blur_px[0] * pow(BLUR_RATIO, row) : (double)NAN;
}

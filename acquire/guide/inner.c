/* Matched filter: correlation of each sector's mean profile with the mires' pattern, over scale,
 * shift and blur. Neither brightness nor contrast matters to a correlation. Beyond the width where
 * an edge's slope still tells its blur, the mires' height against the wide dark disc's does, so
 * that one fit serves all blurs. */
#include "acquire/guide/inner.h"

#include <math.h>
#include <string.h>

#define PER_SECTOR (PLACIDO_GUIDE_MERIDIANS / PLACIDO_GUIDE_SECTORS)
#define SCALE_LOW 0.6 /* of a cornea of 7.8 mm: radii of 4.7 to 11 mm */
#define SCALE_HIGH 1.4
#define SCALE_STEP 0.018
#define START_SHARP 6       /* of the pattern's row of blurs: an eighth of a gap */
#define START_BLURRED 13    /* more than half a gap */
#define LIKENESS_GOOD 0.55  /* of a sector; skin reaches it in some, and the walk tells it apart */
#define SECTORS_MIN 8
#define ROUNDS 3            /* of centring */

static void average_sector(placido_guide_profile *profile, const placido_guide_polar *polar,
                           int sector, int count) {
  profile->count = count;
  profile->step_px = polar->step_px;
  memset(profile->grey, 0, sizeof profile->grey);
  for (int j = 0; j < PER_SECTOR; j++) {
    const int m = (sector * PER_SECTOR + j - PER_SECTOR / 2 + PLACIDO_GUIDE_MERIDIANS) %
                  PLACIDO_GUIDE_MERIDIANS;
    const float *row = polar->data + (size_t)m * (size_t)polar->samples;
    for (int i = 0; i < count; i++) {
      profile->grey[i] += row[i] < 0 ? -1e3F : row[i] / PER_SECTOR;
    }
  }
}

/* Scale and blur at which all sectors together look most like the pattern. */
static placido_guide_trial search_scale(const placido_guide_profile *profiles,
                                        const placido_guide_pattern *pattern) {
  static const int blurs[] = {START_SHARP, START_BLURRED};
  placido_guide_trial best = {1, 0, START_SHARP};
  double most = -INFINITY;
  for (int b = 0; b < 2; b++) {
    for (double scale = SCALE_LOW; scale <= SCALE_HIGH; scale += SCALE_STEP) {
      const placido_guide_trial trial = {scale, 0, blurs[b]};
      double sum = 0;
      for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
        sum += fmax(0, placido_guide_compare(&profiles[s], pattern, &trial).likeness);
      }
      if (sum > most) {
        most = sum;
        best = trial;
      }
    }
  }
  return best;
}

/* Moves one number of a trial to where the likeness is greatest within ± reach, first among a few
 * places, then by the parabola through the best three. */
static void improve(placido_guide_trial *trial, double *number, double reach, int half,
                    const placido_guide_profile *profile, const placido_guide_pattern *pattern) {
  const double start = *number, step = reach / half;
  double likeness[17];
  int best = 0;
  for (int i = -half; i <= half; i++) {
    *number = start + i * step;
    likeness[i + half] = placido_guide_compare(profile, pattern, trial).likeness;
    best = likeness[i + half] > likeness[best + half] ? i : best;
  }
  double fraction = 0;
  if (best > -half && best < half) {
    const double *at = &likeness[best + half];
    const double bend = at[-1] - 2 * at[0] + at[1];
    fraction = bend < 0 ? 0.5 * (at[-1] - at[1]) / bend : 0;
  }
  *number = start + (best + fraction) * step;
}

static placido_guide_sector fit_sector(const placido_guide_profile *profile,
                                       const placido_guide_pattern *pattern,
                                       const placido_guide_trial *start) {
  placido_guide_trial trial = *start;
  const double scale = start->scale, gap_px = scale * pattern->gap_px;
  improve(&trial, &trial.shift_px, 0.9 * gap_px, 6, profile, pattern);
  improve(&trial, &trial.scale, 0.08 * scale, 5, profile, pattern);
  improve(&trial, &trial.shift_px, 0.3 * gap_px, 4, profile, pattern);
  const placido_guide_match match = placido_guide_compare(profile, pattern, &trial);
  return (placido_guide_sector){.scale = trial.scale,
                                .shift_px = trial.shift_px,
                                .likeness = match.likeness,
                                .contrast = match.contrast};
}

static bool is_good(const placido_guide_sector *sector) {
  return sector->likeness > LIKENESS_GOOD;
}

static double radius_in(const placido_guide_sector *sector, double pattern_px) {
  return sector->scale * pattern_px + sector->shift_px;
}

/* Moves the centre to the middle of the mires; false where they do not surround it. */
static bool recentre(placido_guide_inner *inner, const placido_guide_pattern *pattern) {
  double radii[PLACIDO_GUIDE_SECTORS], wave[3];
  for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
    const placido_guide_sector *sector = &inner->sectors[s];
    radii[s] = is_good(sector) ? radius_in(sector, pattern->middle_px) : (double)NAN;
  }
  if (!placido_guide_wave_fit(wave, 1, radii)) {
    return false;
  }
  inner->scale = wave[0] / pattern->middle_px;
  inner->centre_px[0] += wave[1];
  inner->centre_px[1] -= wave[2];
  return true;
}

static void summarise(placido_guide_inner *inner) {
  inner->good = 0;
  inner->contrast = inner->likeness = 0;
  for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
    if (is_good(&inner->sectors[s])) {
      inner->good++;
      inner->contrast += inner->sectors[s].contrast;
      inner->likeness += inner->sectors[s].likeness;
    }
  }
  if (inner->good > 0) {
    inner->contrast /= inner->good;
    inner->likeness /= inner->good;
  }
}

void placido_guide_inner_find(placido_guide_inner *inner, const placido_guide_pattern *pattern,
                              placido_guide_polar *polar, const placido_guide_view *view) {
  placido_guide_profile profiles[PLACIDO_GUIDE_SECTORS];
  placido_guide_trial start = {1, 0, START_SHARP};
  int count = (int)(SCALE_HIGH * pattern->high_px / polar->step_px) + 1;
  count = count < polar->samples ? count : polar->samples;
  count = count < PLACIDO_GUIDE_PROFILE_MAX ? count : PLACIDO_GUIDE_PROFILE_MAX;
  *inner = (placido_guide_inner){.centre_px = {polar->centre_px[0], polar->centre_px[1]}};
  for (int round = 0; round < ROUNDS; round++) {
    polar->centre_px[0] = inner->centre_px[0];
    polar->centre_px[1] = inner->centre_px[1];
    placido_guide_polar_fill(polar, view, count);
    for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
      average_sector(&profiles[s], polar, s, count);
    }
    if (round == 0) {
      start = search_scale(profiles, pattern);
    }
    for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
      inner->sectors[s] = fit_sector(&profiles[s], pattern, &start);
    }
    summarise(inner);
    if (inner->good < SECTORS_MIN || (round < ROUNDS - 1 && !recentre(inner, pattern))) {
      return;
    }
    start.scale = inner->scale;
  }
  inner->found = true;
}

double placido_guide_inner_radius(const placido_guide_inner *inner, int meridian,
                                  double pattern_px) {
  const double place = (double)meridian / PER_SECTOR;
  const int before = (int)place, after = (before + 1) % PLACIDO_GUIDE_SECTORS;
  const placido_guide_sector *a = &inner->sectors[before], *b = &inner->sectors[after];
  const double ra = is_good(a) ? radius_in(a, pattern_px) : inner->scale * pattern_px;
  const double rb = is_good(b) ? radius_in(b, pattern_px) : inner->scale * pattern_px;
  return ra + (place - before) * (rb - ra);
}

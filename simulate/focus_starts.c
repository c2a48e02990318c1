/* Many starts, so that the search does not end on the nearest hill.
 *
 * The wavefront of a part of the pupil has its refraction in closed form, the least squares of its
 * slopes, and the peak comes from the part that one focus suits best: with a cone seldom the middle.
 * So parts of all sizes and places start, each with a profile as wide as its own blur, which shrinks
 * by octaves; one that arrives where another has been is given up. Where the best focus gathers
 * little of the light, others as good are many and narrow: the search then leaps from the best ones
 * by distances of all scales until that has long gained nothing (basin hopping: Wales and Doye, J.
 * Phys. Chem. A 101 (1997) 5111). Leaps are drawn by number, so that a search repeats itself. */
#include "simulate/focus_starts.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

enum {
  UNKNOWNS = PLACIDO_PENCIL_UNKNOWNS,
  KEPT = PLACIDO_FOCUS_KEPT,
  LATTICE = 3, /* rows and columns of parts on either side of the pupil's centre */
  CENTRED = 7, /* parts about the centre */
  PARTS_MAX = CENTRED + 2 * (2 * LATTICE + 1) * (2 * LATTICE + 1),
  OCTAVES = 8, /* of width, 87' down */
  STEPS = 2,   /* an octave */
  LAST_STEPS = 12,
  LEAP_SCALES = 5, /* octaves of a leap's length */
  LEAPS_MAX = 600
};

static const double width_arcmin = PLACIDO_FOCUS_WIDTH_ARCMIN;
static const double apart_D = 0.03;      /* below it two trials are one */
static const double clear_share = 0.5;   /* a focus of so much of the light has no rival */
static const double patience = 15;       /* leaps without gain, over the share of the light */
static const double hopeless = 0.6, promising = 0.9; /* of the best one's light */

/* Where trials have been at each width. */
typedef struct trails {
  int count[OCTAVES];
  placido_aim aims[OCTAVES][PARTS_MAX];
} trails;

/* Whether a trial has been within a quarter of the width's blur of this one; remembers it if not. */
static bool been_here(trails *past, const placido_climb *climb, const placido_trial *trial,
                      int octave) {
  double quarter_arcmin = ldexp(width_arcmin, octave) / 4;
  double across = quarter_arcmin * placido_climb_arcmin(climb, &trial->aim);
  double along_D = placido_climb_dioptres(climb, quarter_arcmin);
  for (int i = 0; i < past->count[octave]; i++) {
    const placido_aim *other = &past->aims[octave][i];
    if (placido_aim_distance_D(&trial->aim, other) < along_D &&
        hypot(trial->aim.x - other->x, trial->aim.y - other->y) < across) {
      return true;
    }
  }
  past->aims[octave][past->count[octave]++] = trial->aim;
  return false;
}

/* From the part's focus up to the best for all light near it; false where that fails or another
 * trial has been there. */
static bool start_from(placido_climb *climb, trails *past, const placido_patch *part,
                       placido_trial *trial) {
  double rms;
  if (!placido_climb_part(climb, part, trial, &rms)) {
    return false;
  }
  double widths = 2 * rms / placido_climb_arcmin(climb, &trial->aim) / width_arcmin;
  int octave = widths > 1 ? (int)fmin(ceil(log2(widths)), OCTAVES - 1) : 0;
  for (; octave >= 0; octave--) {
    if (!placido_climb_run(climb, trial, ldexp(width_arcmin, octave), STEPS) ||
        been_here(past, climb, trial, octave)) {
      return false;
    }
  }
  return placido_climb_run(climb, trial, width_arcmin, LAST_STEPS);
}

/* Discs and rings about the centre, then discs of two sizes on a triangular lattice. */
static int pupil_parts(const placido_eye *eye, placido_patch parts[PARTS_MAX]) {
  const double radius = eye->pupil_mm / 2, spacing = 0.35 * radius;
  static const double rings[CENTRED][2] = {{0, 1.01}, {0, 0.25}, {0, 0.5}, {0, 0.75},
                                           {0.4, 1},  {0.6, 1},  {0.8, 1}};
  int count = 0;
  for (; count < CENTRED; count++) {
    parts[count] = (placido_patch){0, 0, rings[count][0] * radius, rings[count][1] * radius};
  }
  for (int j = -LATTICE; j <= LATTICE; j++) {
    for (int i = -LATTICE; i <= LATTICE; i++) {
      double x = spacing * (i + (j % 2 != 0 ? 0.5 : 0)), y = spacing * sqrt(0.75) * j;
      double off = hypot(x, y) / radius;
      if (off > 0 && off < 0.9) {
        parts[count++] = (placido_patch){x, y, 0, radius / 4};
      }
      if (off > 0 && off <= 1.01) {
        parts[count++] = (placido_patch){x, y, 0, radius / 2};
      }
    }
  }
  return count;
}

/* Takes a trial among the best, which are in descending order; of two that are one, the better.
 * Returns how many there are. */
static int keep(placido_trial kept[KEPT], int count, const placido_trial *trial) {
  int same = 0;
  while (same < count && placido_aim_distance_D(&kept[same].aim, &trial->aim) >= apart_D) {
    same++;
  }
  if (same < count && kept[same].gathered >= trial->gathered) {
    return count;
  }
  int at = same < count ? same : count < KEPT ? count++ : KEPT - 1;
  if (at == KEPT - 1 && same == KEPT && kept[at].gathered >= trial->gathered) {
    return count;
  }
  for (; at > 0 && trial->gathered > kept[at - 1].gathered; at--) {
    kept[at] = kept[at - 1];
  }
  kept[at] = *trial;
  return count;
}

/* A place at a random distance from the trial's, of a scale that is random, too. */
static bool leap(const placido_climb *climb, placido_trial *trial, uint64_t number) {
  double scale_D = placido_climb_dioptres(climb, width_arcmin) *
                   exp2(placido_random_uniform(1, number, 0, 0, LEAP_SCALES));
  placido_aim change = {.x = 0};
  for (int k = 0; k < UNKNOWNS; k++) {
    change.power_D[k] = climb->open[k] ? scale_D * placido_random_normal(2, number, (uint64_t)k) : 0;
  }
  return placido_climb_advance(climb, &trial->aim, &change, 1);
}

/* Up from where a leap has led; false where that is not worth it. */
static bool climb_from_leap(placido_climb *climb, placido_trial *trial, double best) {
  return placido_climb_run(climb, trial, 2 * width_arcmin, 1) &&
         placido_climb_run(climb, trial, width_arcmin, 1) && trial->gathered > hopeless * best &&
         placido_climb_run(climb, trial, width_arcmin, 3) && trial->gathered > promising * best &&
         placido_climb_run(climb, trial, width_arcmin, LAST_STEPS);
}

static int leap_about(placido_climb *climb, placido_trial kept[KEPT], int count) {
  double rays = (double)climb->pencil.count;
  for (int number = 0, last_gain = 0; number < LEAPS_MAX && count > 0; number++) {
    double best = kept[0].gathered;
    if (best > clear_share * rays || number - last_gain > patience * rays / best) {
      break;
    }
    placido_trial trial = kept[number % count];
    if (leap(climb, &trial, (uint64_t)number) && climb_from_leap(climb, &trial, best)) {
      count = keep(kept, count, &trial);
      last_gain = trial.gathered > 1.001 * best ? number : last_gain;
    }
  }
  return count;
}

int placido_focus_starts(placido_climb *climb, const placido_aim *refraction,
                         placido_trial kept[KEPT]) {
  placido_patch parts[PARTS_MAX];
  trails past;
  memset(past.count, 0, sizeof past.count);
  int part_count = pupil_parts(&climb->eye, parts), count = 0;
  for (int i = 0; i < part_count; i++) {
    placido_trial trial = {.aim = *refraction};
    if (start_from(climb, &past, &parts[i], &trial)) {
      count = keep(kept, count, &trial);
    }
  }
  return leap_about(climb, kept, count);
}

/* Search of the best focus in power-vector form: vergence behind the cornea, J0, J45.
 *
 * What people choose as best focus is a peak, not the least spread: at 8 mm the two are over a
 * dioptre apart. So as much light as possible shall lie close together, each ray counting by
 * Moffat's profile (1 + d²/w²)^-2 of its distance d from the peak. The rays of a part of the pupil
 * are brought together by least squares. With the profile's derivative (1 + d²/w²)^-3 as weights of
 * the next fit the light gathered grows from step to step (majorise and minimise: Hunter and Lange,
 * American Statistician 58 (2004) 30), faster where a step is lengthened as long as that gains; w
 * shrinks from the part's own blur to the bucket. The peak comes from the part that one focus suits
 * best, with a cone seldom the middle: so parts of all sizes and places start, and along the axis,
 * where the caustic makes one local best after the other, the best of them are tried again. */
#include "simulate/focus.h"

#include "base/memory.h"
#include "simulate/light.h"
#include "simulate/pencil.h"

#include <math.h>

enum {
  LATTICE = 3,     /* rows and columns of parts on either side of the pupil's centre */
  CENTRED = 7,     /* parts about the centre */
  PARTS_MAX = CENTRED + 2 * (2 * LATTICE + 1) * (2 * LATTICE + 1),
  KEPT = 4,        /* trials that are tried again */
  SHIFTS = 10,     /* to either side */
  TRIALS_MAX = PARTS_MAX, /* a part each, later the kept ones with their neighbours */
  STEPS = 2,       /* for each width */
  LAST_STEPS = 24,
  STRETCH_MAX = 16 /* times a step */
};

_Static_assert(KEPT * (2 * SHIFTS + 1) <= TRIALS_MAX, "neighbours find room among the trials");

static const double wide_arcmin = 0.8;
static const double narrow_arcmin = 0.4;
static const double trifle_D = 0.002;
static const double vergence_min_D = 5, vergence_max_D = 300; /* retina 270 to 4.5 mm away */
static const double cross_max_D = 20;

typedef struct trial {
  placido_aim aim;
  double gathered;
} trial;

typedef struct search {
  const placido_focus *focus;
  placido_pencil pencil;
  placido_eye eye;
  bool retina_open, cylinder_open;
} search;

double placido_focus_arcmin_mm(const placido_focus *focus, const placido_eye *eye) {
  const placido_optics *optics = focus->optics;
  double bucket_um = placido_apex_bucket_um(focus->apex, optics, eye->index, eye->retina_mm);
  return bucket_um / optics->bucket_arcmin / 1000;
}

static placido_eye decided_eye(const search *s, const placido_aim *aim) {
  placido_eye eye = s->eye;
  if (s->retina_open) {
    eye.retina_mm = 1000 * eye.index / aim->vergence_D;
  }
  if (s->cylinder_open) {
    eye.correction.j0_D = aim->j0_D;
    eye.correction.j45_D = aim->j45_D;
  }
  return eye;
}

/* A minute of the visual field as slope behind the cornea. */
static double arcmin_slope(const search *s, const placido_aim *aim) {
  placido_eye eye = decided_eye(s, aim);
  return placido_focus_arcmin_mm(s->focus, &eye) / eye.retina_mm;
}

/* The defocus that widens the spot by the narrow width. */
static double step_D(const search *s) {
  return 2 * 1000 * narrow_arcmin * PLACIDO_ARCMIN_RAD / s->eye.pupil_mm;
}

static bool in_range(double vergence_D) {
  return vergence_D >= vergence_min_D && vergence_D <= vergence_max_D;
}

/* aim + times × change; false where that leaves the range. */
static bool advance(placido_aim *aim, const placido_aim *change, double times) {
  aim->vergence_D += times * change->vergence_D;
  aim->j0_D += times * change->j0_D;
  aim->j45_D += times * change->j45_D;
  aim->x += times * change->x;
  aim->y += times * change->y;
  return in_range(aim->vergence_D) && hypot(aim->j0_D, aim->j45_D) <= cross_max_D;
}

static void gather(search *s, trial *t, double width_arcmin) {
  placido_pencil_aim(&s->pencil, &t->aim);
  t->gathered = placido_pencil_gather(&s->pencil, width_arcmin * arcmin_slope(s, &t->aim));
}

static bool step_uphill(search *s, trial *t, double width_arcmin) {
  placido_aim change;
  double rms;
  gather(s, t, width_arcmin);
  if (!placido_pencil_fit(&s->pencil, s->retina_open, s->cylinder_open, &change, &rms)) {
    return false;
  }
  trial start = *t;
  for (int times = 1; times <= STRETCH_MAX; times *= 2) {
    trial next = start;
    if (!advance(&next.aim, &change, times)) {
      return times > 1;
    }
    gather(s, &next, width_arcmin);
    if (times > 1 && !(next.gathered > t->gathered)) {
      break;
    }
    *t = next;
  }
  return true;
}

static bool climb(search *s, trial *t, double width_arcmin, int steps) {
  for (int i = 0; i < steps; i++) {
    if (!step_uphill(s, t, width_arcmin)) {
      return false;
    }
  }
  return true;
}

static bool climb_to_narrow(search *s, trial *t) {
  return climb(s, t, wide_arcmin, STEPS) && climb(s, t, narrow_arcmin, STEPS);
}

/* Power of the pupil's middle; NaN where there is none. */
static double middle_power(search *s, const placido_patch *middle) {
  placido_aim afocal = {.j0_D = s->pencil.j0_D, .j45_D = s->pencil.j45_D}, change;
  double rms;
  placido_pencil_aim(&s->pencil, &afocal);
  placido_pencil_select(&s->pencil, middle);
  return placido_pencil_fit(&s->pencil, true, true, &change, &rms) ? change.vergence_D : NAN;
}

/* A part of the pupil brought to its own focus, then all the light that this focus gathers. */
static bool start_from(search *s, const placido_patch *part, trial *t) {
  placido_aim change;
  double rms = 0;
  placido_pencil_select(&s->pencil, part);
  for (int i = 0; i < 2; i++) { /* the second for the retina's new scale */
    placido_pencil_aim(&s->pencil, &t->aim);
    if (!placido_pencil_fit(&s->pencil, s->retina_open, s->cylinder_open, &change, &rms) ||
        !advance(&t->aim, &change, 1)) {
      return false;
    }
  }
  double width_arcmin = 2 * rms / arcmin_slope(s, &t->aim);
  for (; width_arcmin > wide_arcmin; width_arcmin /= 2) {
    if (!climb(s, t, width_arcmin, STEPS)) {
      return false;
    }
  }
  return climb_to_narrow(s, t);
}

/* Discs and rings about the centre, then discs of two sizes on a triangular lattice. */
static int pupil_parts(const placido_eye *eye, placido_patch parts[PARTS_MAX]) {
  const double radius = eye->pupil_mm / 2, spacing = 0.35 * radius;
  const double rings[CENTRED][2] = {{0, 0.25}, {0, 0.5}, {0, 0.75}, {0, 1},
                                    {0.4, 1},  {0.6, 1}, {0.8, 1}};
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

static bool close_to_any(const trial *t, const trial *kept, int count, double distance_D) {
  for (int i = 0; i < count; i++) {
    if (fabs(t->aim.vergence_D - kept[i].aim.vergence_D) < distance_D &&
        fabs(t->aim.j0_D - kept[i].aim.j0_D) < distance_D &&
        fabs(t->aim.j45_D - kept[i].aim.j45_D) < distance_D) {
      return true;
    }
  }
  return false;
}

/* Copies the brightest trials, each at least `distance_D` from the others, to `kept`; returns how
 * many. */
static int keep_best(const trial *trials, int count, trial *kept, int kept_max,
                     double distance_D) {
  int found = 0;
  while (found < kept_max) {
    const trial *best = NULL;
    for (int i = 0; i < count; i++) {
      bool brighter = best == NULL || trials[i].gathered > best->gathered;
      if (brighter && !close_to_any(&trials[i], kept, found, distance_D)) {
        best = &trials[i];
      }
    }
    if (best == NULL) {
      break;
    }
    kept[found++] = *best;
  }
  return found;
}

/* Climbs again from the best trials' neighbours, whole numbers of `direction` × step_D away; what
 * is found replaces `trials`. Returns how many there are. */
static int try_neighbours(search *s, trial trials[TRIALS_MAX], int count,
                          const placido_aim *direction) {
  trial kept[KEPT];
  int kept_count = keep_best(trials, count, kept, KEPT, step_D(s) / 2);
  count = 0;
  for (int i = 0; i < kept_count; i++) {
    trials[count++] = kept[i];
    for (int k = -SHIFTS; k <= SHIFTS; k++) {
      trials[count] = kept[i];
      count += k != 0 && advance(&trials[count].aim, direction, k * step_D(s)) &&
               climb_to_narrow(s, &trials[count]);
    }
  }
  return count;
}

/* Traces many rays through the trial's own lens and settles there. */
static bool settle(search *s, trial *t) {
  placido_eye eye = decided_eye(s, &t->aim);
  placido_pencil_trace(&s->pencil, s->focus->dense, &eye);
  return climb(s, t, narrow_arcmin, LAST_STEPS);
}

/* Every trial that the parts lead to; `count` of them, none where the middle has no power. */
static int find_trials(search *s, trial trials[TRIALS_MAX], double *power_D) {
  placido_patch parts[PARTS_MAX];
  const placido_correction *worn = &s->eye.correction;
  int part_count = pupil_parts(&s->eye, parts), count = 0;
  *power_D = middle_power(s, &parts[0]);
  double vergence_D = s->retina_open ? *power_D : 1000 * s->eye.index / s->eye.retina_mm;
  for (int i = 0; i < part_count && in_range(*power_D); i++) {
    trials[count].aim = (placido_aim){vergence_D, worn->j0_D, worn->j45_D, 0, 0};
    count += start_from(s, &parts[i], &trials[count]);
  }
  static const placido_aim directions[2][2] = {
    {{.j0_D = 1}, {.j45_D = 1}},         /* where the retina is given */
    {{.vergence_D = 3}, {.vergence_D = 1}}, /* coarse, then fine */
  };
  for (int i = 0; i < 2; i++) {
    count = try_neighbours(s, trials, count, &directions[s->retina_open][i]);
  }
  return count;
}

/* A cylinder below the search's own resolution is none. */
static void drop_trifle(placido_correction *correction) {
  if (hypot(correction->j0_D, correction->j45_D) < trifle_D) {
    correction->j0_D = correction->j45_D = 0;
  }
}

static int decide(search *s, placido_eye *eye, placido_error *err) {
  trial trials[TRIALS_MAX], last[2];
  double power_D;
  placido_pencil_trace(&s->pencil, s->focus->sparse, eye);
  int count = find_trials(s, trials, &power_D), settled = 0;
  count = keep_best(trials, count, last, 2, step_D(s) / 2);
  for (int i = 0; i < count; i++) {
    last[settled] = last[i];
    settled += settle(s, &last[settled]);
  }
  if (keep_best(last, settled, trials, 1, 0) == 0) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no focus: the cornea's power in the middle of the pupil is %.1f D, "
                             "expected %g to %g D",
                             power_D, vergence_min_D, vergence_max_D);
  }
  *eye = decided_eye(s, &trials[0].aim);
  if (s->cylinder_open) {
    drop_trifle(&eye->correction);
  }
  return PLACIDO_OK;
}

int placido_focus_search(const placido_focus *focus, placido_eye *eye, placido_error *err) {
  search s = {.focus = focus,
              .eye = *eye,
              .retina_open = eye->retina_mm == 0,
              .cylinder_open = eye->correct};
  if (!s.retina_open && !s.cylinder_open) {
    return PLACIDO_OK;
  }
  int status = placido_pencil_new(&s.pencil, focus->sparse->count + focus->dense->count, err);
  if (status == PLACIDO_OK) {
    status = decide(&s, eye, err);
  }
  placido_pencil_free(&s.pencil);
  return status;
}

int placido_focus_peak(const placido_focus *focus, const placido_eye *eye, double peak_mm[2],
                       placido_error *err) {
  const double width_arcmin = 1; /* the detail of 20/20 */
  const placido_rays *rays = focus->dense;
  size_t landed = 0, count = rays->count;
  double *x = placido_memory_new(count, 2 * sizeof *x, err);
  if (x == NULL) {
    return PLACIDO_MEMORY;
  }
  double *y = x + count;
  for (size_t i = 0; i < count; i++) {
    landed +=
      placido_entry_trace(&rays->entries[i], eye, eye->retina_mm, &x[landed], &y[landed]);
  }
  placido_light_peak(x, y, landed, width_arcmin * placido_focus_arcmin_mm(focus, eye), peak_mm);
  placido_memory_free(x);
  return PLACIDO_OK;
}

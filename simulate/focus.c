/* Search of the best focus in power-vector form: vergence behind the cornea, J0, J45.
 *
 * What people choose as best focus is a peak, not the least spread: at 8 mm the two are over a
 * dioptre apart. So the search makes as much light as possible lie close together (light.c). It
 * starts from the analytic answer for parts of the pupil (the slopes of the rays there are linear
 * in position, and the linear terms are the powers), because the peak comes from the part that one
 * focus suits best, and with a cone that need not be the middle. The best starts are refined by a
 * downhill simplex, first with a wide neighbourhood, then with a narrow one. Where the retina alone
 * is open, one unknown is few enough to step through. */
#include "simulate/focus.h"

#include "base/memory.h"
#include "simulate/light.h"
#include "simulate/minimise.h"

#include <math.h>

enum {
  RING = 6,          /* patches of a size around the pupil's centre */
  STEPS = 120,       /* vergences tried where that is the only unknown */
  STARTS_MAX = 128,
  KEPT = 4,          /* starts that are refined */
  WIDE_CALLS = 60,   /* evaluations of each, wide neighbourhood */
  NARROW_CALLS = 90, /* and narrow */
};

static const double wide_arcmin = 1;
static const double narrow_arcmin = 0.4;
static const double tolerance_D = 0.002;
static const double vergence_min_D = 5, vergence_max_D = 300; /* retina 270 to 4.5 mm away */
static const double cross_max_D = 30;

/* A trial: vergence of the light that meets on the retina, and the cross-cylinder. */
typedef struct trial {
  double vergence_D, j0_D, j45_D;
  double cost; /* less light gathered */
} trial;

typedef struct search {
  placido_focus *focus;
  placido_eye eye;       /* of the trial */
  bool retina_open, cylinder_open;
  double width_arcmin;
} search;

int placido_focus_new(placido_focus *focus, const placido_rays *rays, const placido_apex *apex,
                      const placido_optics *optics, placido_error *err) {
  *focus = (placido_focus){.rays = rays, .apex = apex, .optics = optics};
  focus->x_mm = placido_memory_new(rays->count, 2 * sizeof *focus->x_mm, err);
  if (focus->x_mm == NULL) {
    return PLACIDO_MEMORY;
  }
  focus->y_mm = focus->x_mm + rays->count;
  return PLACIDO_OK;
}

void placido_focus_free(placido_focus *focus) {
  if (focus != NULL) {
    placido_memory_free(focus->x_mm);
    *focus = (placido_focus){0};
  }
}

static size_t land(placido_focus *focus, const placido_eye *eye) {
  size_t landed = 0;
  for (size_t i = 0; i < focus->rays->count; i++) {
    landed += placido_entry_trace(&focus->rays->entries[i], eye, eye->retina_mm,
                                  &focus->x_mm[landed], &focus->y_mm[landed]);
  }
  return landed;
}

/* Millimetres on the eye's retina of a minute as the buckets count it. */
static double arcmin_mm(const placido_focus *focus, const placido_eye *eye) {
  const placido_optics *optics = focus->optics;
  double bucket_um = placido_apex_bucket_um(focus->apex, optics, eye->index, eye->retina_mm);
  return bucket_um / optics->bucket_arcmin / 1000;
}

static double cost_of(search *s) {
  double peak[2];
  size_t landed = land(s->focus, &s->eye);
  return -placido_light_gathered(s->focus->x_mm, s->focus->y_mm, landed,
                                 s->width_arcmin * arcmin_mm(s->focus, &s->eye), 1, peak);
}

/* The objective in whichever unknowns are open, in the order vergence, J0, J45. */
static double cost_at(void *user, const double *at) {
  search *s = user;
  double vergence_D = s->retina_open ? *at++ : vergence_min_D;
  if (!(vergence_D >= vergence_min_D && vergence_D <= vergence_max_D)) {
    return 0;
  }
  if (s->retina_open) {
    s->eye.retina_mm = 1000 * s->eye.index / vergence_D;
  }
  if (s->cylinder_open) {
    if (!(hypot(at[0], at[1]) <= cross_max_D)) {
      return 0;
    }
    s->eye.correction.j0_D = at[0];
    s->eye.correction.j45_D = at[1];
  }
  return cost_of(s);
}

static int pack(const search *s, const trial *t, double at[PLACIDO_MINIMISE_MAX]) {
  int count = 0;
  if (s->retina_open) {
    at[count++] = t->vergence_D;
  }
  if (s->cylinder_open) {
    at[count++] = t->j0_D;
    at[count++] = t->j45_D;
  }
  return count;
}

static void unpack(const search *s, const double *at, trial *t) {
  if (s->retina_open) {
    t->vergence_D = *at++;
  }
  if (s->cylinder_open) {
    t->j0_D = at[0];
    t->j45_D = at[1];
  }
}

static void evaluate(search *s, trial *t) {
  double at[PLACIDO_MINIMISE_MAX];
  pack(s, t, at);
  t->cost = cost_at(s, at);
}

/* The defocus that widens the spot by the neighbourhood. */
static double step_D(const search *s) {
  return fmin(1000 * s->width_arcmin * PLACIDO_ARCMIN_RAD / s->eye.pupil_mm * 2, 1);
}

static void refine(search *s, trial *t, int calls) {
  double at[PLACIDO_MINIMISE_MAX];
  int count = pack(s, t, at);
  t->cost = placido_minimise(cost_at, s, at, count, step_D(s), tolerance_D, calls);
  unpack(s, at, t);
}

/* A disc within the pupil. */
typedef struct patch {
  double x_mm, y_mm, radius_mm;
} patch;

/* Sums for a straight-line fit of the ray slopes over a patch. */
typedef struct slope_sums {
  double n, x, y, xx, xy, yy, u, v, ux, uy, vx, vy;
} slope_sums;

static void add_slope(slope_sums *s, double x, double y, double u, double v) {
  s->n += 1;
  s->x += x;
  s->y += y;
  s->xx += x * x;
  s->xy += x * y;
  s->yy += y * y;
  s->u += u;
  s->v += v;
  s->ux += u * x;
  s->uy += u * y;
  s->vx += v * x;
  s->vy += v * y;
}

/* Ray slopes over the patch, each brought to the apex's plane for light meeting at retina_mm:
 * where hit = r + L q, q's gradient must be -1/L for the patch to be in focus. */
static slope_sums patch_slopes(const search *s, const patch *p, double retina_mm) {
  slope_sums sums = {0};
  const placido_rays *rays = s->focus->rays;
  for (size_t i = 0; i < rays->count; i++) {
    const placido_entry *entry = &rays->entries[i];
    double x = entry->x_mm - p->x_mm, y = entry->y_mm - p->y_mm, hx, hy;
    bool inside = x * x + y * y <= p->radius_mm * p->radius_mm;
    if (inside && placido_entry_trace(entry, &s->eye, retina_mm, &hx, &hy)) {
      add_slope(&sums, x, y, (hx - entry->x_mm) / retina_mm, (hy - entry->y_mm) / retina_mm);
    }
  }
  return sums;
}

/* Vergence and correcting cross-cylinder of a patch, on top of what the trial eye wears. */
static bool patch_powers(const search *s, const patch *p, double retina_mm, trial *t) {
  slope_sums m = patch_slopes(s, p, retina_mm);
  double xx = m.xx - m.x * m.x / m.n, xy = m.xy - m.x * m.y / m.n, yy = m.yy - m.y * m.y / m.n;
  double ux = m.ux - m.u * m.x / m.n, uy = m.uy - m.u * m.y / m.n;
  double vx = m.vx - m.v * m.x / m.n, vy = m.vy - m.v * m.y / m.n;
  double determinant = xx * yy - xy * xy;
  if (!(m.n >= 6 && determinant > 0)) {
    return false;
  }
  double u_x = (ux * yy - uy * xy) / determinant, u_y = (uy * xx - ux * xy) / determinant;
  double v_x = (vx * yy - vy * xy) / determinant, v_y = (vy * xx - vx * xy) / determinant;
  double dioptres = 1000 * s->eye.index;
  *t = (trial){.vergence_D = -dioptres * (u_x + v_y) / 2,
               .j0_D = dioptres * (u_x - v_y) / 2,
               .j45_D = dioptres * (u_y + v_x) / 2};
  return true;
}

enum { PATCHES = 4 + 2 * RING };

/* Discs about the pupil's centre, then rings of half and quarter-size ones around it. */
static void pupil_patches(const placido_eye *eye, patch patches[PATCHES]) {
  const double turn = 2 * acos(-1);
  double radius = eye->pupil_mm / 2;
  for (int i = 0; i < 4; i++) {
    patches[i] = (patch){eye->pupil_x_mm, eye->pupil_y_mm, radius * (i + 1) / 4};
  }
  for (int i = 0; i < RING; i++) {
    double x = eye->pupil_x_mm + radius / 2 * cos(turn * i / RING);
    double y = eye->pupil_y_mm + radius / 2 * sin(turn * i / RING);
    patches[4 + i] = (patch){x, y, radius / 2};
    patches[4 + RING + i] = (patch){x, y, radius / 4};
  }
}

static void add_start(search *s, trial *starts, int *count, trial t) {
  evaluate(s, &t);
  if (*count < STARTS_MAX && t.cost < 0) {
    starts[(*count)++] = t;
  }
}

/* Powers of every patch as they are without search: `count` of them, those without a focus left
 * out. Returns the middle patch's vergence, NaN where there is none. */
static double find_powers(search *s, trial powers[PATCHES], int *count) {
  patch patches[PATCHES];
  trial middle;
  *count = 0;
  pupil_patches(&s->eye, patches);
  if (!patch_powers(s, &patches[0], 1e9, &middle)) {
    return NAN;
  }
  if (!(middle.vergence_D >= vergence_min_D && middle.vergence_D <= vergence_max_D)) {
    return middle.vergence_D;
  }
  double retina_mm = s->eye.retina_mm;
  if (s->retina_open) {
    retina_mm = 1000 * s->eye.index / middle.vergence_D;
  }
  for (int i = 0; i < PATCHES; i++) {
    *count += patch_powers(s, &patches[i], retina_mm, &powers[*count]);
  }
  return middle.vergence_D;
}

/* With the cylinder open: each patch's own, and none, because light from several patches may meet
 * better so. */
static int start_with_cylinder(search *s, const trial *powers, int count, trial *starts) {
  placido_correction worn = s->eye.correction;
  int found = 0;
  for (int i = 0; i < count; i++) {
    trial t = powers[i];
    add_start(s, starts, &found, (trial){.vergence_D = t.vergence_D});
    t.j0_D += worn.j0_D;
    t.j45_D += worn.j45_D;
    add_start(s, starts, &found, t);
  }
  return found;
}

/* With the retina alone open: evenly spaced from the weakest line focus to the strongest. */
static int start_along_axis(search *s, const trial *powers, int count, trial *starts) {
  double low = vergence_max_D, high = vergence_min_D;
  int found = 0;
  for (int i = 0; i < count; i++) {
    double line_D = hypot(powers[i].j0_D, powers[i].j45_D);
    low = fmin(low, powers[i].vergence_D - line_D);
    high = fmax(high, powers[i].vergence_D + line_D);
  }
  for (int i = 0; i < STEPS; i++) {
    add_start(s, starts, &found, (trial){.vergence_D = low + (high - low) * i / (STEPS - 1)});
  }
  return found;
}

static bool close_to_any(const trial *t, const trial *kept, int count, double distance_D) {
  for (int i = 0; i < count; i++) {
    if (fabs(t->vergence_D - kept[i].vergence_D) < distance_D &&
        fabs(t->j0_D - kept[i].j0_D) < distance_D &&
        fabs(t->j45_D - kept[i].j45_D) < distance_D) {
      return true;
    }
  }
  return false;
}

/* Copies the cheapest trials, each at least `distance_D` from the others, to `kept`; returns how
 * many. */
static int keep_best(const trial *trials, int count, trial *kept, int kept_max,
                     double distance_D) {
  int found = 0;
  while (found < kept_max) {
    const trial *best = NULL;
    for (int i = 0; i < count; i++) {
      bool cheaper = best == NULL || trials[i].cost < best->cost;
      if (cheaper && !close_to_any(&trials[i], kept, found, distance_D)) {
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

/* A cylinder below the search's own resolution is none. */
static void drop_trifle(placido_correction *correction) {
  if (hypot(correction->j0_D, correction->j45_D) < tolerance_D) {
    correction->j0_D = correction->j45_D = 0;
  }
}

int placido_focus_search(placido_focus *focus, placido_eye *eye, placido_error *err) {
  search s = {.focus = focus,
              .eye = *eye,
              .retina_open = eye->retina_mm == 0,
              .cylinder_open = eye->correct,
              .width_arcmin = eye->correct ? wide_arcmin : narrow_arcmin};
  if (!s.retina_open && !s.cylinder_open) {
    return PLACIDO_OK;
  }
  trial powers[PATCHES], starts[STARTS_MAX], kept[KEPT];
  int count;
  double middle_D = find_powers(&s, powers, &count);
  if (count > 0) {
    count = s.cylinder_open ? start_with_cylinder(&s, powers, count, starts)
                            : start_along_axis(&s, powers, count, starts);
    count = keep_best(starts, count, kept, KEPT, step_D(&s) / 2);
  }
  if (count == 0) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no focus: the cornea's power in the middle of the pupil is %.1f D, "
                             "expected %g to %g D",
                             middle_D, vergence_min_D, vergence_max_D);
  }
  for (int i = 0; i < count && s.cylinder_open; i++) {
    refine(&s, &kept[i], WIDE_CALLS);
  }
  s.width_arcmin = narrow_arcmin;
  for (int i = 0; i < count; i++) {
    refine(&s, &kept[i], NARROW_CALLS);
  }
  keep_best(kept, count, starts, 1, 0);
  evaluate(&s, &starts[0]);
  if (s.cylinder_open) {
    drop_trifle(&s.eye.correction);
  }
  *eye = s.eye;
  return PLACIDO_OK;
}

void placido_focus_peak(placido_focus *focus, const placido_eye *eye, double *x_mm, double *y_mm) {
  const double width_arcmin = 1; /* the detail of 20/20 */
  double peak[2];
  size_t landed = land(focus, eye);
  placido_light_gathered(focus->x_mm, focus->y_mm, landed, width_arcmin * arcmin_mm(focus, eye), 12,
                         peak);
  *x_mm = peak[0];
  *y_mm = peak[1];
}

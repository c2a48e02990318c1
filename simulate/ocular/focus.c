/* The focus of the whole eye: where its retina stands and which cross-cylinder it wears.
 *
 * It sets out from the retina that gives light near the axis the error that it had with the cornea
 * alone, and climbs from there by the steps of the cornea's own search (focus_climb.c), rays traced
 * anew until the climb leads nowhere. A stronger lens and a farther retina are the same to first
 * order: the sphere is sought as the one and applied as the other. */
#include "simulate/ocular/ocular.h"

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/light.h"
#include "simulate/ocular/landing.h"
#include "simulate/ocular/sight.h"
#include "simulate/pencil.h"
#include "simulate/trace.h"

#include <math.h>

enum { UNKNOWNS = PLACIDO_PENCIL_UNKNOWNS, TRACES_MAX = 5, STEPS_MAX = 40, STRETCH_MAX = 16 };

static const double retina_min_mm = 5, retina_max_mm = 200;
static const double probe_D = 0.25;  /* of a lens, to see how slopes follow it */
static const double still_D = 1e-4, traced_D = 0.01;
static const double usual_nm = 555;
static const double axis[2] = {0, 0};

/* The vergence right behind the cornea's front that is in focus: what refracts there more than with
 * the index of the cornea alone is added, what near light lacks is not there. */
static double needed_D(const placido_apex *apex, const placido_eye *eye,
                       const placido_ocular *ocular, const placido_navarro *behind) {
  double more = placido_navarro_cornea(behind) - eye->index;
  return 1000 * (eye->index / eye->retina_mm + more / apex->radius_mm) - ocular->accommodation_D;
}

static int place_retina(double *retina_mm, double vergence_D, const placido_navarro *behind,
                        placido_error *err) {
  *retina_mm = placido_navarro_focus_mm(behind, vergence_D);
  if (*retina_mm >= retina_min_mm && *retina_mm <= retina_max_mm) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the whole eye has no retina: its focus is %g mm behind the cornea, "
                           "expected %g to %g", *retina_mm, retina_min_mm, retina_max_mm);
}

int placido_ocular_retina(double *retina_mm, const placido_surface *surface,
                          const placido_eye *eye, const placido_ocular *ocular,
                          placido_error *err) {
  placido_apex apex;
  *retina_mm = eye->retina_mm;
  int status = ocular->whole ? placido_apex_find(&apex, surface, eye, err) : PLACIDO_OK;
  if (status != PLACIDO_OK || !ocular->whole) {
    return status;
  }
  placido_navarro behind = placido_navarro_at(ocular->accommodation_D, usual_nm);
  return place_retina(retina_mm, needed_D(&apex, eye, ocular, &behind), &behind, err);
}

/* A search while it is under way. */
typedef struct search {
  const placido_surface *surface;
  const placido_ocular *ocular;
  placido_navarro behind;
  placido_eye eye;
  double vergence_D;      /* for which the retina stands where it does */
  bool open[UNKNOWNS];
  placido_rays rays;
  placido_pencil pencil;  /* in arcmin */
  double peak[2];         /* where light is densest with the cornea alone */
  float *alone[2];        /* where rays go with it, x and y */
  float *room;            /* angles with the whole eye: four times two columns */
} search;

/* Angles of all rays with a lens that is stronger by what `probe` says. */
static void probe(float *x, float *y, const search *s, const placido_sight *sight, int unknown) {
  placido_sight probed = *sight;
  double more = probe_D / 1000;
  probed.incidence.xx += unknown == 0 || unknown == 1 ? more : 0;
  probed.incidence.yy += unknown == 0 ? more : unknown == 1 ? -more : 0;
  probed.incidence.xy += unknown == 2 ? more : 0;
  placido_landing_angles(x, y, &probed, s->rays.entries, s->rays.count);
}

/* Fills the pencil with the rays that arrive; `start` is where those go that the patient looks
 * with. */
static int trace(search *s, double start[2], placido_error *err) {
  placido_sight sight;
  int status = placido_sight_new(&sight, s->surface, &s->eye, s->ocular, axis, axis, usual_nm, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t rays = s->rays.count;
  float *x[1 + UNKNOWNS], *y[1 + UNKNOWNS];
  for (int k = 0; k <= UNKNOWNS; k++) {
    x[k] = s->room + 2 * (size_t)k * rays;
    y[k] = x[k] + rays;
    probe(x[k], y[k], s, &sight, k - 1);
  }
  placido_landing_middle(start, x[0], y[0], s->alone[0], s->alone[1], rays, s->peak);
  placido_pencil *p = &s->pencil;
  p->count = 0;
  for (size_t i = 0; i < rays; i++) {
    size_t at = p->count;
    float sum = 0;
    p->slope_x[at] = x[0][i];
    p->slope_y[at] = y[0][i];
    for (int k = 0; k < UNKNOWNS; k++) {
      p->change_x[k][at] = (x[1 + k][i] - x[0][i]) / (float)probe_D;
      p->change_y[k][at] = (y[1 + k][i] - y[0][i]) / (float)probe_D;
      sum += p->change_x[k][at] + p->change_y[k][at];
    }
    p->count += isfinite(sum);
  }
  placido_pencil_close(p);
  return PLACIDO_OK;
}

static placido_aim advance(const placido_aim *aim, const placido_aim *change, double times) {
  placido_aim next = {.x = aim->x + times * change->x, .y = aim->y + times * change->y};
  for (int k = 0; k < UNKNOWNS; k++) {
    next.power_D[k] = aim->power_D[k] + times * change->power_D[k];
  }
  return next;
}

static double size_D(const placido_aim *aim) {
  return fmax(fabs(aim->power_D[0]), hypot(aim->power_D[1], aim->power_D[2]));
}

/* One step, doubled as long as that gathers more light. False where none is determined. */
static bool step(search *s, placido_aim *aim, double width) {
  placido_aim change, start = *aim;
  double rms, most = placido_pencil_gather(&s->pencil, aim, width);
  if (!placido_pencil_fit(&s->pencil, s->open, &change, &rms)) {
    return false;
  }
  for (int times = 1; times <= STRETCH_MAX; times *= 2) {
    placido_aim next = advance(&start, &change, times);
    double gathered = placido_pencil_gather(&s->pencil, &next, width);
    if (times > 1 && !(gathered > most)) {
      break;
    }
    *aim = next;
    most = gathered;
  }
  return true;
}

/* The best lens, first by a wider profile. False where light does not determine it. */
static bool climb(search *s, placido_aim *aim) {
  for (int wide = 2; wide >= 1; wide--) {
    for (int i = 0; i < STEPS_MAX; i++) {
      placido_aim before = *aim;
      if (!step(s, aim, wide * PLACIDO_FOCUS_WIDTH_ARCMIN)) {
        return false;
      }
      placido_aim moved = advance(aim, &before, -1);
      if (size_D(&moved) < still_D) {
        break;
      }
    }
  }
  return true;
}

static int refuse(const search *s, placido_error *err) {
  return placido_error_set(err, PLACIDO_QUALITY,
                           "no focus: the whole eye's light within its pupil of %g mm does not "
                           "determine one", s->eye.pupil_mm);
}

/* Climbs and traces in turn; `gaze` is where the light is densest in the end. */
static int seek(search *s, double gaze[2], placido_error *err) {
  for (int i = 0; i < TRACES_MAX; i++) {
    int status = trace(s, gaze, err);
    if (status != PLACIDO_OK || !s->open[0]) {
      return status;
    }
    placido_aim aim = {.x = gaze[0], .y = gaze[1]};
    if (!climb(s, &aim)) {
      return refuse(s, err);
    }
    gaze[0] = aim.x;
    gaze[1] = aim.y;
    s->vergence_D -= aim.power_D[0];
    s->eye.correction.j0_D += aim.power_D[1];
    s->eye.correction.j45_D += aim.power_D[2];
    status = place_retina(&s->eye.retina_mm, s->vergence_D, &s->behind, err);
    if (status != PLACIDO_OK || size_D(&aim) < traced_D) {
      return status;
    }
  }
  return PLACIDO_OK;
}

/* Where the rays go with the cornea alone, and where they are densest. */
static int look_alone(search *s, const placido_eye *eye, placido_error *err) {
  const placido_ocular alone = {0};
  placido_sight sight;
  size_t rays = s->rays.count;
  int status = placido_sight_new(&sight, s->surface, eye, &alone, axis, axis, 0, err);
  if (status == PLACIDO_OK) {
    placido_landing_angles(s->room, s->room + rays, &sight, s->rays.entries, rays);
    size_t landed = placido_landing_close_up(s->room, s->room + rays, rays);
    placido_light_peak(s->room, s->room + rays, landed, PLACIDO_FOCUS_WIDTH_ARCMIN, s->peak);
    placido_landing_angles(s->alone[0], s->alone[1], &sight, s->rays.entries, rays);
  }
  return status;
}

static int search_focus(search *s, const placido_apex *apex, const placido_eye *eye,
                        double gaze[2], placido_error *err) {
  int status = placido_rays_new(&s->rays, s->surface, apex, &s->eye, PLACIDO_FOCUS_SETTLE_SAMPLES,
                                err);
  size_t rays = s->rays.count;
  if (status == PLACIDO_OK) {
    status = placido_pencil_new(&s->pencil, rays + 1, err);
  }
  if (status == PLACIDO_OK) {
    s->room = placido_memory_new(rays + 1, 2 * (2 + UNKNOWNS) * sizeof *s->room, err);
    status = s->room == NULL ? PLACIDO_MEMORY : PLACIDO_OK;
  }
  if (status == PLACIDO_OK) {
    s->alone[0] = s->room + 2 * (1 + UNKNOWNS) * rays;
    s->alone[1] = s->alone[0] + rays;
    status = look_alone(s, eye, err);
  }
  if (status == PLACIDO_OK) {
    status = seek(s, gaze, err);
  }
  placido_memory_free(s->room);
  placido_pencil_free(&s->pencil);
  placido_rays_free(&s->rays);
  return status;
}

int placido_ocular_focus(placido_eye *found, placido_ocular *ocular,
                         const placido_surface *surface, const placido_eye *eye,
                         enum placido_correct open, placido_error *err) {
  search s = {.surface = surface, .ocular = ocular};
  placido_eye alone;
  placido_apex apex;
  double gaze[2] = {0, 0};
  int status = placido_eye_settle(&alone, eye, err);
  *found = s.eye = alone;
  if (status != PLACIDO_OK || !ocular->whole) {
    return status;
  }
  status = placido_apex_find(&apex, surface, &alone, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  s.open[0] = open != PLACIDO_CORRECT_NONE;
  s.open[1] = s.open[2] = open == PLACIDO_CORRECT_FULL;
  s.behind = placido_navarro_at(ocular->accommodation_D, usual_nm);
  s.vergence_D = needed_D(&apex, &alone, ocular, &s.behind);
  status = place_retina(&s.eye.retina_mm, s.vergence_D, &s.behind, err);
  if (status == PLACIDO_OK) {
    status = search_focus(&s, &apex, &alone, gaze, err);
  }
  if (status == PLACIDO_OK) {
    *found = s.eye;
    ocular->gazes = true;
    ocular->gaze_arcmin[0] = gaze[0];
    ocular->gaze_arcmin[1] = gaze[1];
  }
  return status;
}

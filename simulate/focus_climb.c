/* The steps of the search: each gathers more light than the one before it.
 *
 * A step is the least-squares fit of the rays' slopes, weighted with the derivative of the profile
 * by which light counts: the profile lies above the parabola that touches it where the ray is, so
 * that what brings the parabolas' sum down brings the light up (majorise and minimise: Hunter and
 * Lange, American Statistician 58 (2004) 30). A step is doubled as long as that gains. */
#include "simulate/focus_climb.h"

#include <math.h>

enum {
  UNKNOWNS = PLACIDO_PENCIL_UNKNOWNS,
  RAYS_MIN = 8, /* of a part, below which chance decides */
  SETTLE_STEPS = 40,
  RETRACES = 4,
  STRETCH_MAX = 16 /* times a step */
};

static const double still_D = 1e-4;
static const double retrace_D = 0.1; /* of lens: beyond it slopes are not linear to 0.001' */
static const double vergence_min_D = PLACIDO_FOCUS_VERGENCE_MIN_D;
static const double vergence_max_D = PLACIDO_FOCUS_VERGENCE_MAX_D;
static const double usual_power_D = 43; /* where the first fit sets out; it is linear in it */

placido_eye placido_climb_lens(const placido_climb *climb, const placido_aim *aim) {
  placido_eye eye = climb->eye;
  eye.correction.m_D = climb->retina_open ? eye.correction.m_D : aim->power_D[0];
  eye.correction.j0_D = aim->power_D[1];
  eye.correction.j45_D = aim->power_D[2];
  return eye;
}

placido_eye placido_climb_eye(const placido_climb *climb, const placido_aim *aim) {
  placido_eye eye = placido_climb_lens(climb, aim);
  eye.retina_mm = climb->retina_open ? 1000 * eye.index / aim->power_D[0] : eye.retina_mm;
  return eye;
}

double placido_climb_arcmin(const placido_climb *climb, const placido_aim *aim) {
  placido_eye eye = placido_climb_eye(climb, aim);
  return placido_focus_arcmin_mm(climb->focus, &eye) / eye.retina_mm;
}

double placido_climb_dioptres(const placido_climb *climb, double arcmin) {
  return 2 * 1000 * arcmin * PLACIDO_ARCMIN_RAD / climb->eye.pupil_mm;
}

double placido_aim_distance_D(const placido_aim *a, const placido_aim *b) {
  double most = 0;
  for (int k = 0; k < UNKNOWNS; k++) {
    most = fmax(most, fabs(a->power_D[k] - b->power_D[k]));
  }
  return most;
}

double placido_climb_lens_distance_D(const placido_climb *climb, const placido_aim *a,
                                     const placido_aim *b) {
  double cross_D = hypot(a->power_D[1] - b->power_D[1], a->power_D[2] - b->power_D[2]);
  return climb->retina_open ? cross_D : fmax(cross_D, fabs(a->power_D[0] - b->power_D[0]));
}

bool placido_climb_advance(const placido_climb *climb, placido_aim *aim, const placido_aim *change,
                           double times) {
  for (int k = 0; k < UNKNOWNS; k++) {
    aim->power_D[k] += times * change->power_D[k];
  }
  aim->x += times * change->x;
  aim->y += times * change->y;
  double sphere_D = aim->power_D[0];
  bool in_range = climb->retina_open ? sphere_D >= vergence_min_D && sphere_D <= vergence_max_D
                                     : fabs(sphere_D) <= PLACIDO_SPHERE_MAX_D;
  return in_range && hypot(aim->power_D[1], aim->power_D[2]) <= PLACIDO_CROSS_MAX_D;
}

static void gather(placido_climb *climb, placido_trial *trial, double width_arcmin) {
  double width = width_arcmin * placido_climb_arcmin(climb, &trial->aim);
  trial->gathered = placido_pencil_gather(&climb->pencil, &trial->aim, width);
  climb->asked++;
}

static bool step_uphill(placido_climb *climb, placido_trial *trial, double width_arcmin) {
  placido_aim change;
  double left;
  gather(climb, trial, width_arcmin); /* for its weights */
  if (!placido_pencil_fit(&climb->pencil, climb->open, &change, &left)) {
    return false;
  }
  placido_trial start = *trial;
  for (int times = 1; times <= STRETCH_MAX; times *= 2) {
    placido_trial next = start;
    if (!placido_climb_advance(climb, &next.aim, &change, times)) {
      return times > 1;
    }
    gather(climb, &next, width_arcmin);
    if (times > 1 && !(next.gathered > trial->gathered)) {
      break;
    }
    *trial = next;
  }
  return true;
}

bool placido_climb_run(placido_climb *climb, placido_trial *trial, double width_arcmin, int steps) {
  for (int i = 0; i < steps; i++) {
    placido_aim before = trial->aim;
    if (!step_uphill(climb, trial, width_arcmin)) {
      return false;
    }
    if (placido_aim_distance_D(&before, &trial->aim) < still_D) {
      break;
    }
  }
  return true;
}

bool placido_climb_part(placido_climb *climb, const placido_patch *part, placido_trial *trial,
                        double *rms) {
  placido_aim change;
  placido_pencil_aim(&climb->pencil, &trial->aim);
  return placido_pencil_select(&climb->pencil, part) >= RAYS_MIN &&
         placido_pencil_fit(&climb->pencil, climb->open, &change, rms) &&
         placido_climb_advance(climb, &trial->aim, &change, 1);
}

void placido_climb_trace(placido_climb *climb, const placido_rays *rays, const placido_aim *aim) {
  placido_eye eye = placido_climb_lens(climb, aim);
  placido_pencil_trace(&climb->pencil, rays, &eye);
}

bool placido_climb_settle(placido_climb *climb, const placido_rays *rays, placido_trial *trial) {
  for (int i = 0; i < RETRACES; i++) {
    placido_aim before = trial->aim;
    placido_climb_trace(climb, rays, &trial->aim);
    if (!placido_climb_run(climb, trial, PLACIDO_FOCUS_WIDTH_ARCMIN, SETTLE_STEPS)) {
      return false;
    }
    if (placido_climb_lens_distance_D(climb, &before, &trial->aim) < retrace_D) {
      break;
    }
  }
  return true;
}

bool placido_climb_refraction(placido_climb *climb, const placido_rays *rays,
                              placido_aim *refraction) {
  const placido_patch whole = {0, 0, 0, climb->eye.pupil_mm};
  const placido_correction *worn = &climb->eye.correction;
  double sphere_D = climb->retina_open ? usual_power_D : worn->m_D, rms;
  placido_trial trial = {.aim = {.power_D = {sphere_D, worn->j0_D, worn->j45_D}}};
  for (int i = 0; i < RETRACES; i++) {
    placido_aim before = trial.aim;
    placido_climb_trace(climb, rays, &trial.aim);
    if (!placido_climb_part(climb, &whole, &trial, &rms)) {
      return false;
    }
    if (placido_climb_lens_distance_D(climb, &before, &trial.aim) < retrace_D) {
      break;
    }
  }
  *refraction = trial.aim;
  return true;
}

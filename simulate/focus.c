/* Search of the best correction in power-vector form: sphere, J0, J45, and the place of the peak.
 *
 * What is made greatest is the visual Strehl ratio of Thibos, Hong, Bradley and Applegate (J. Vision
 * 4 (2004) 329, "VSX") in the limit of geometric optics: light counts by the neural profile
 * (1 + d²/w²)^-3/2 of its distance d from the peak, wherever that is (docs/correction.md). Sparse
 * rays find the places worth a look, dense rays decide among them. */
#include "simulate/focus.h"

#include "base/memory.h"
#include "simulate/focus_climb.h"
#include "simulate/focus_starts.h"
#include "simulate/light.h"

#include <math.h>

static const double trifle_D = 0.002;
static const double worth_settling = 0.8; /* of what the best gathers with the sparse rays */

double placido_focus_arcmin_mm(const placido_focus *focus, const placido_eye *eye) {
  const placido_optics *optics = focus->optics;
  double bucket_um = placido_apex_bucket_um(focus->apex, optics, eye->index, eye->retina_mm);
  return bucket_um / optics->bucket_arcmin / 1000;
}

static int refuse(const placido_climb *climb, placido_error *err) {
  if (!climb->retina_open) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no lens of up to %d D focuses this cornea on a retina %g mm behind it",
                             PLACIDO_SPHERE_MAX_D, climb->eye.retina_mm);
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "no focus: within its pupil of %g mm the cornea has no power of %d to "
                           "%d D",
                           climb->eye.pupil_mm, PLACIDO_FOCUS_VERGENCE_MIN_D,
                           PLACIDO_FOCUS_VERGENCE_MAX_D);
}

/* A cylinder below the search's own resolution is none. */
static void drop_trifle(placido_correction *correction) {
  if (hypot(correction->j0_D, correction->j45_D) < trifle_D) {
    correction->j0_D = correction->j45_D = 0;
  }
}

/* The best of the trials by the dense rays; false where none is left. */
static bool settle_best(placido_climb *climb, placido_trial *trials, int count,
                        placido_trial *best) {
  bool found = false;
  for (int i = 0; i < count; i++) {
    placido_trial trial = trials[i];
    if (trials[i].gathered >= worth_settling * trials[0].gathered &&
        placido_climb_settle(climb, climb->focus->dense, &trial) &&
        (!found || trial.gathered > best->gathered)) {
      *best = trial;
      found = true;
    }
  }
  return found;
}

static int decide(placido_climb *climb, placido_eye *eye, placido_focus_found *found,
                  placido_error *err) {
  placido_aim refraction;
  placido_trial kept[PLACIDO_FOCUS_KEPT], best;
  if (!placido_climb_refraction(climb, climb->focus->sparse, &refraction)) {
    return refuse(climb, err);
  }
  int count = placido_focus_starts(climb, &refraction, kept);
  if (!settle_best(climb, kept, count, &best)) {
    return refuse(climb, err);
  }
  *eye = placido_climb_eye(climb, &best.aim);
  if (climb->open[1]) {
    drop_trifle(&eye->correction);
  }
  found->quality = best.gathered / (double)climb->pencil.count;
  found->trials = climb->asked;
  return PLACIDO_OK;
}

int placido_focus_find(const placido_focus *focus, placido_eye *eye, placido_focus_found *found,
                       placido_error *err) {
  placido_focus_found ignored;
  found = found != NULL ? found : &ignored;
  *found = (placido_focus_found){.quality = NAN};
  bool retina_open = eye->retina_mm == 0, cylinder_open = eye->correct == PLACIDO_CORRECT_FULL;
  if (!retina_open && eye->correct == PLACIDO_CORRECT_NONE) {
    return PLACIDO_OK;
  }
  placido_climb climb = {.focus = focus,
                         .eye = *eye,
                         .retina_open = retina_open,
                         .open = {true, cylinder_open, cylinder_open}};
  int status = placido_pencil_new(&climb.pencil, focus->sparse->count + focus->dense->count, err);
  if (status == PLACIDO_OK) {
    status = decide(&climb, eye, found, err);
  }
  placido_pencil_free(&climb.pencil);
  return status;
}

int placido_focus_search(const placido_focus *focus, placido_eye *eye, placido_error *err) {
  return placido_focus_find(focus, eye, NULL, err);
}

int placido_focus_peak(const placido_focus *focus, const placido_eye *eye, double peak_mm[2],
                       placido_error *err) {
  const placido_rays *rays = focus->dense;
  size_t landed = 0, count = rays->count;
  float *x = placido_memory_new(count, 2 * sizeof *x, err);
  if (x == NULL) {
    return PLACIDO_MEMORY;
  }
  float *y = x + count;
  for (size_t i = 0; i < count; i++) {
    double at[2];
    if (placido_entry_trace(&rays->entries[i], eye, eye->retina_mm, &at[0], &at[1])) {
      x[landed] = (float)at[0];
      y[landed] = (float)at[1];
      landed++;
    }
  }
  double width_mm = PLACIDO_FOCUS_WIDTH_ARCMIN * placido_focus_arcmin_mm(focus, eye);
  placido_light_peak(x, y, landed, width_mm, peak_mm);
  placido_memory_free(x);
  return PLACIDO_OK;
}

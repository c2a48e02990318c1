/* Uphill to the best focus from anywhere: the state of a search, and its steps. */
#ifndef PLACIDO_SIMULATE_FOCUS_CLIMB_H
#define PLACIDO_SIMULATE_FOCUS_CLIMB_H

#include "simulate/focus.h"
#include "simulate/pencil.h"

typedef struct placido_trial {
  placido_aim aim;
  double gathered; /* light within the profile, in rays of the pencil */
} placido_trial;

/* What all trials of one search share. `pencil` is freed by whoever made it. */
typedef struct placido_climb {
  const placido_focus *focus;
  placido_pencil pencil;
  placido_eye eye; /* as it came */
  bool retina_open, open[PLACIDO_PENCIL_UNKNOWNS];
  long asked; /* how often all rays were gathered */
} placido_climb;

/* The eye with the aim's lens; and with its retina, too. */
placido_eye placido_climb_lens(const placido_climb *climb, const placido_aim *aim);
placido_eye placido_climb_eye(const placido_climb *climb, const placido_aim *aim);

/* A minute of the visual field as slope behind the cornea. */
double placido_climb_arcmin(const placido_climb *climb, const placido_aim *aim);

/* The change of power that moves the light of the pupil's rim by `arcmin`. */
double placido_climb_dioptres(const placido_climb *climb, double arcmin);

/* Largest difference of power; and of what changes the slopes before the retina. */
double placido_aim_distance_D(const placido_aim *a, const placido_aim *b);
double placido_climb_lens_distance_D(const placido_climb *climb, const placido_aim *a,
                                     const placido_aim *b);

/* aim + times × change; false where that leaves the range. */
bool placido_climb_advance(const placido_climb *climb, placido_aim *aim, const placido_aim *change,
                           double times);

/* At most `steps` steps up the light within the width, fewer where they no longer lead anywhere.
 * False where the light does not determine a step. */
bool placido_climb_run(placido_climb *climb, placido_trial *trial, double width_arcmin, int steps);

/* A part of the pupil brought to its own focus, which leaves it `rms` wide (as a slope). */
bool placido_climb_part(placido_climb *climb, const placido_patch *part, placido_trial *trial,
                        double *rms);

/* Traces rays about the lens of `aim`. */
void placido_climb_trace(placido_climb *climb, const placido_rays *rays, const placido_aim *aim);

/* Climbs with `rays`, traced through the trial's own lens. */
bool placido_climb_settle(placido_climb *climb, const placido_rays *rays, placido_trial *trial);

/* The refraction of the whole pupil, and the rays about its lens. */
bool placido_climb_refraction(placido_climb *climb, const placido_rays *rays,
                              placido_aim *refraction);

#endif

/* A plan's run: the effects act on a view in their order, and before those that work on the picture
 * light is spread. What IMAGE effects need to say before that (the core's share) they say when they
 * are prepared. */
#ifndef PLACIDO_SIMULATE_RUN_H
#define PLACIDO_SIMULATE_RUN_H

#include "simulate/effects/effect.h"
#include "simulate/plan/view.h"

/* What is to be run, everything decided and borrowed. */
typedef struct placido_run {
  const placido_surface *surface;
  const placido_scene *scene;
  const placido_facts *facts;
  const placido_plan_settings *settings;
  const placido_eye *eye;               /* settled, for the cornea alone: its focus is not sought */
  enum placido_correct open;            /* what of it was sought before (effect.h) */
  const placido_effect *const *effects; /* those that run, `count` of them, ordered by stage */
  size_t count;
  int threads;                          /* 1 to 256; no result depends on it */
} placido_run;

/* The scene as it is seen, the bleed cut off; free with placido_image_free. `psf` (may be NULL)
 * receives the spread in the middle of the picture, of the first light and of what is nearest to
 * its focus; free with placido_psf_free. Every effect is released whatever happens. Returns
 * PLACIDO_OK, or what a scene, a pupil or an effect is refused with: PLACIDO_INPUT,
 * PLACIDO_QUALITY, PLACIDO_MEMORY, PLACIDO_SYSTEM. */
int placido_view_run(placido_image *seen, placido_psf *psf, const placido_run *run,
                     placido_error *err);

/* The fixed step after the effects of the stage FIELD: the picture in view->seen, the bleed with
 * it, and view->psf. Where the canvas has holes, colours stay weighted by alpha. PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_view_spread(placido_view *view, placido_error *err);

#endif

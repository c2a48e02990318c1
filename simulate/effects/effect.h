/* The shape of an effect: a row of the table in effects/table.c and a file of its own.
 *
 * An effect is asked once for a scene and an eye. It answers what it would do to a sketch of the
 * spread (its strokes) and what it costs; the planner draws sketches with and without it and so
 * knows what leaving it out would be worth beside the others that run. What runs is prepared and
 * applied to the view, stage by stage; what is left out is never called again. */
#ifndef PLACIDO_SIMULATE_EFFECT_H
#define PLACIDO_SIMULATE_EFFECT_H

#include "simulate/effects/facts.h"
#include "simulate/effects/strokes.h"

#include <placido/plan.h>

struct placido_view;

/* When it acts on the view, in this order. Up to FIELD effects only say how light is to be spread;
 * IMAGE comes after that. */
enum placido_stage {
  PLACIDO_STAGE_EYE,
  PLACIDO_STAGE_PUPIL,
  PLACIDO_STAGE_SPECTRUM,
  PLACIDO_STAGE_PSF,
  PLACIDO_STAGE_FIELD,
  PLACIDO_STAGE_IMAGE,
  PLACIDO_STAGES
};

/* What one effect may need of another: bits. */
enum {
  PLACIDO_GIVES_SPECTRUM = 1,
  PLACIDO_GIVES_PUPIL = 2,
  PLACIDO_GIVES_FIELD = 4,
  PLACIDO_GIVES_WHOLE_EYE = 8
};

/* What effects are asked about; everything borrowed. */
typedef struct placido_question {
  const placido_surface *surface;
  const placido_scene *scene;
  const placido_facts *facts;       /* of the scene */
  const placido_eye *eye;           /* settled, its focus found; for `settle`
                                       as given */
  enum placido_correct open;        /* what of it was sought: PLACIDO_CORRECT_SPHERE where that was
                                       only the retina's place or the lens's sphere */
  const placido_sketch_rays *rays;  /* a few rays of that eye */
  double bucket_arcmin;             /* of the seen picture */
  double tolerance;
  unsigned refused;                 /* what effects that are forced off would give */
} placido_question;

/* What an effect answers; zeroed before. */
typedef struct placido_answer {
  bool applies;            /* false: nothing to do in this scene and eye; leaving it out is exact */
  double bound;            /* of what its strokes cannot show (light far away, say) [0] */
  double share;            /* of the scene's contrast that its strokes meet; 0: all of it */
  double cost_ms;          /* of its own work; what it makes others do more of is the planner's */
  placido_strokes *strokes; /* the caller's, zeroed: what it does to the spread */
  char reason[160];        /* why it matters or why not: one sentence without a full stop */
} placido_answer;

/* One effect. NULL where there is nothing to do. */
typedef struct placido_effect {
  const char *name, *summary;
  enum placido_stage stage;
  unsigned needs, gives;
  /* Decides what of `eye` follows from the scene, before its focus is sought: the pupil. Only in
   * the stages EYE and PUPIL. `answer` as for ask, but for strokes. */
  int (*settle)(placido_eye *eye, const placido_question *question, enum placido_force force,
                placido_answer *answer, placido_error *err);
  /* Pure and cheap: no allocation, some microseconds. */
  void (*ask)(const placido_question *question, placido_answer *answer);
  /* What it keeps for this run goes into *state, NULL before. */
  int (*prepare)(void **state, struct placido_view *view, placido_error *err);
  int (*apply)(void *state, struct placido_view *view, placido_error *err);
  void (*release)(void *state); /* legal with NULL; called after the run whatever happened */
} placido_effect;

/* The effects that this build knows, `*count` rows, ordered by stage. */
const placido_effect *const *placido_effect_table(size_t *count);

extern const placido_effect placido_effect_pupil, placido_effect_stiles_crawford,
  placido_effect_rest_of_eye, placido_effect_longitudinal_chromatic, placido_effect_transverse_chromatic,
  placido_effect_diffraction, placido_effect_object_distance, placido_effect_field,
  placido_effect_straylight, placido_effect_receptors;

#endif

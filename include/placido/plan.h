/* The plan: which effects a scene calls for in an eye, decided and accounted for before anything
 * runs. The third narrow waist. */
#ifndef PLACIDO_PLAN_H
#define PLACIDO_PLAN_H

#include <placido/eye.h>
#include <placido/image.h>
#include <placido/notes.h>
#include <placido/psf.h>
#include <placido/scene.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#define PLACIDO_EFFECTS_MAX 16

/* What a person wants of an effect. */
enum placido_force {
  PLACIDO_FORCE_NONE, /* the planner decides */
  PLACIDO_FORCE_ON,
  PLACIDO_FORCE_OFF
};

/* How a plan is to be made; zero means the default in brackets. */
typedef struct placido_plan_wish {
  double tolerance;       /* largest error of the seen picture, linear light relative to white, up
                             to white: 1e-6 to 1 [the scene's] */
  double bucket_arcmin;   /* of the seen picture [0.5] */
  enum placido_force force[PLACIDO_EFFECTS_MAX]; /* by row of placido_effect_find */
  bool finest;            /* every approximation at its finest, whatever the tolerance: what plans
                             are measured against */
  int threads;            /* 1 to 256 [1]; no result depends on it */
} placido_plan_wish;

/* What was decided about an effect, and why. */
typedef struct placido_verdict {
  const char *name, *summary;
  bool runs;
  bool applies;           /* false: this scene and eye have nothing for it to do */
  enum placido_force force;
  double bound;           /* at most so much of the seen picture, linear light relative to white,
                             would be wrong without it; of what was left out: at that moment,
                             effects left out before it being out */
  double cost_ms;         /* what it adds to the run on one core, estimated */
  char reason[192];       /* one sentence */
} placido_verdict;

/* How finely what runs is computed: chosen so that all of it together stays within the part of the
 * tolerance that leaving out does not use. */
typedef struct placido_plan_settings {
  int pupil_samples;      /* rays across the pupil */
  int wavelengths;        /* a light */
  int layers;             /* of depth, at most */
  int nodes;              /* of the field a side: odd; 1: one spread for all of it */
  double bucket_arcmin;
  int buckets;            /* of a PSF a side, odd */
  bool doubles;           /* convolved in double precision */
  double bound;           /* of the error that all of this may cause */
  double cost_ms;         /* of the whole run on one core, estimated */
} placido_plan_settings;

/* Immutable once made; any number of threads may run it at the same time. */
typedef struct placido_plan placido_plan;

/* The effects that this build knows: name and a sentence of number `index`; false beyond the
 * last. */
bool placido_effect_at(size_t index, const char **name, const char **summary);

/* Number of the effect called `name`, -1 where there is none. */
int placido_effect_find(const char *name);

/* Settles the eye (a pupil_mm of 0 asks for the pupil that the scene's luminance gives; what is
 * open in it is searched), asks every effect what leaving it out would cost in this scene, and
 * leaves out the smallest while their sum stays within the tolerance. `surface` and `scene` are
 * borrowed until placido_plan_free. Returns PLACIDO_OK, PLACIDO_INPUT (an argument out of range; a
 * pupil that is neither given nor follows from a luminance; an effect forced off that another one
 * forced on needs), PLACIDO_QUALITY (no focus, a scene too coarse), PLACIDO_MEMORY,
 * PLACIDO_SYSTEM (a depth map that cannot be read). */
int placido_plan_new(placido_plan **plan, const placido_surface *surface, const placido_eye *eye,
                     const placido_scene *scene, const placido_plan_wish *wish,
                     placido_notes *notes, placido_error *err);
void placido_plan_free(placido_plan *plan);

/* One verdict an effect, in the order in which they run; borrowed until placido_plan_free. */
const placido_verdict *placido_plan_verdicts(const placido_plan *plan, size_t *count);
const placido_plan_settings *placido_plan_settings_of(const placido_plan *plan);

/* The eye with everything decided: pupil, retina, correction. Borrowed. */
const placido_eye *placido_plan_eye(const placido_plan *plan);

/* What the plan itself took, seconds: `asking` and deciding, and settling the eye's focus before. */
void placido_plan_seconds(const placido_plan *plan, double *asking, double *settling);

/* The scene as this eye sees it, in linear light; free with placido_image_free. `psf` (may be NULL)
 * receives the spread in the middle of the picture, of the first light and of what is in focus;
 * free with placido_psf_free. Returns PLACIDO_OK, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_plan_run(placido_image *seen, placido_psf *psf, const placido_plan *plan,
                     placido_error *err);

/* The table that a person reads: every effect, run or left out, with its bound, cost and sentence.
 * Returns PLACIDO_OK or PLACIDO_SYSTEM (the stream cannot be written). */
int placido_plan_write(const placido_plan *plan, FILE *stream, placido_error *err);

/* The same as `placido-plan/1` (docs/formats.md), by way of a temporary name. */
int placido_plan_save(const placido_plan *plan, const char *path, placido_error *err);

#endif

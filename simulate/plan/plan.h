/* What a plan holds, and the parts of making one. */
#ifndef PLACIDO_SIMULATE_PLAN_PLAN_H
#define PLACIDO_SIMULATE_PLAN_PLAN_H

#include "simulate/effects/effect.h"
#include "simulate/plan/sketch.h"

#include <placido/plan.h>

#include <stdint.h>

/* The parts of the tolerance: what leaving effects out may use, and how finely the others are
 * computed. */
#define PLACIDO_PLAN_LEFT_OUT_SHARE 0.7
#define PLACIDO_PLAN_SETTINGS_SHARE 0.3

/* Rows of a table of effects, ordered by stage; borrowed. */
typedef struct placido_effects {
  const placido_effect *const *rows;
  size_t count; /* at most PLACIDO_EFFECTS_MAX */
} placido_effects;

struct placido_plan {
  const placido_surface *surface;
  const placido_scene *scene;
  placido_effects effects;
  placido_plan_wish wish;    /* every default filled in */
  placido_eye eye;
  enum placido_correct open; /* what of it was sought */
  placido_facts facts;
  placido_verdict verdicts[PLACIDO_EFFECTS_MAX];
  bool own[PLACIDO_EFFECTS_MAX]; /* left out by the planner, not by a person */
  double left_out;           /* sum of the bounds of those */
  placido_plan_settings settings;
  double settings_share[6];  /* of settings.bound: one for each of placido_plan_setting_names */
  int64_t asking_ns, settling_ns;
};

/* What the settings' shares of the error belong to. */
extern const char *const placido_plan_setting_names[6];

/* What is known while a plan is made: the answers, and the transfer function of the set that
 * runs. */
typedef struct placido_deliberation {
  placido_plan *plan;
  placido_sketch sketch;
  placido_sketch_scale scale;
  double tolerance;          /* for what is left out */
  placido_answer answers[PLACIDO_EFFECTS_MAX];
  bool settled[PLACIDO_EFFECTS_MAX]; /* decided with the eye: nothing to leave out any more */
  bool running[PLACIDO_EFFECTS_MAX];
  placido_strokes strokes[PLACIDO_EFFECTS_MAX];
  placido_strokes set;       /* of all that run */
  bool drawn;
  placido_sketch_otf otf;    /* of the set, where it is drawn */
  double one_wave;           /* what one wavelength instead of many would cost; -1: not asked yet */
  double three_nodes;        /* what is amiss half-way between three nodes a side; likewise */
} placido_deliberation;

/* The plan that a table of effects gives: what placido_plan_new makes with the build's own. */
int placido_plan_of_effects(placido_plan **plan, placido_effects effects,
                            const placido_surface *surface, const placido_eye *eye,
                            const placido_scene *scene, const placido_plan_wish *wish,
                            placido_notes *notes, placido_error *err);

/* Decides what runs: fills the plan's verdicts but for names and reasons. PLACIDO_OK, or
 * PLACIDO_INPUT where one effect forced on needs another that is forced off. */
int placido_plan_decide(placido_deliberation *d, placido_error *err);

/* At most so much changes where effect `index` joins or leaves the set that runs: what the sketch
 * shows, and the effect's own bound. */
double placido_plan_bound_of(placido_deliberation *d, size_t index);

/* The part of the scene that is best in focus, in place of the one that is worst off. */
void placido_plan_relieve(placido_strokes *strokes);

/* The transfer function of the set that runs, where focus is best. Borrowed, until the set
 * changes. */
const placido_sketch_otf *placido_plan_transfer(placido_deliberation *d);

/* What an effect adds to a run of the set, milliseconds on one core: its own work, and the spreads and
 * layers that there are because of it. After the settings are chosen. */
double placido_plan_cost_of(const placido_deliberation *d, size_t index);

/* Of the whole run. */
double placido_plan_cost(const placido_deliberation *d);

/* Chooses the plan's settings for the set that runs. */
void placido_plan_settle_settings(placido_deliberation *d);

#endif

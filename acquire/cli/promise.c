/* The step that chooses settings before any work, and the steps that hold them against what came
 * out. */
#include "acquire/cli/promise.h"

#include "acquire/cli/bench_time.h"
#include "acquire/cli/examination.h"
#include "acquire/cli/promise_knobs.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define ZONE_MM 6
#define FIXED_SIZE 512
#define PARTS_SIZE 80

/* The least that planning and showing a scene takes, and the share of the time that scenes are left
 * at first: what is chosen for the other stages is to leave some room to see well. */
#define SCENE_LEAST_PROBES 25
#define SCENES_SHARE 0.5

/* For each pupil's acuity draws of the surface are looked through as well: so many point spread
 * functions of 100 rays a side, read at few sizes each (acuity.c). */
#define DRAWS 17
#define DRAW_SETTING "samples=100"
#define DRAW_READS 0.85

#define CONDITION_PROBES 4.5 /* what step_condition takes */

/* What a command does of an examination. */
struct work {
  bool measures, sees;
  size_t pupils, sights, tests;
};

static bool has_step(const struct recipe *recipe, examination_step *wanted) {
  examination_step *const *step = recipe->steps;
  while (*step && *step != wanted) {
    step++;
  }
  return *step != NULL;
}

static struct work work_of(const struct examination *examination) {
  const struct settings *settings = examination->settings;
  const size_t scenes = settings->scenes.count ? settings->scenes.count : 1;
  struct work work = {.measures = has_step(examination->recipe, step_fit),
                      .sees = has_step(examination->recipe, step_see)};
  for (size_t i = 0; work.sees && i < settings->pupils_mm.count; i++) {
    const bool automatic = settings->pupils_mm.values[i] == PUPIL_AUTO;
    work.pupils += automatic ? scenes : 1;
    work.sights += scenes;
  }
  if (work.sees && !settings->acuity.none) {
    work.tests = settings->acuity.count ? settings->acuity.count : 1;
  }
  return work;
}

/* What the table knows nothing of cannot be promised. */
static int check(const struct settings *settings, placido_error *err) {
  const bool timed = settings->accuracy.max_time_ms > 0;
  const bool waves = settings->rays.wavelength_nm > 0, curve = settings->rays.through_focus_D > 0;
  if (timed && (waves || curve || settings->combine > 1)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--max-time: nothing is known of the time that --%s takes: leave one "
                             "of them out",
                             waves ? "diffraction" : curve ? "through-focus" : "combine");
  }
  if (settings->accuracy.max_error_psf > 0 && waves) {
    return placido_error_set(err, STATUS_USAGE,
                             "--max-error-psf is of rays: leave --diffraction out");
  }
  return PLACIDO_OK;
}

/* The user's own table, if there is one that can be read, else the program's. */
static int load_table(struct accuracy_table *table, struct promise *promise, placido_notes *notes,
                      placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_error reason = {0};
  *table = (struct accuracy_table){0};
  bool own = accuracy_table_path(path, sizeof path, NULL) == PLACIDO_OK && access(path, F_OK) == 0;
  if (own && accuracy_table_load(table, path, &reason) != PLACIDO_OK) {
    placido_notes_add(notes, "your own accuracy table is not used: %s", reason.text);
    own = false;
  }
  const int status = own ? PLACIDO_OK : accuracy_table_built_in(table, err);
  promise->built_in = !own;
  promise->probe_ms = accuracy_probe_ms();
  if (status == PLACIDO_OK) {
    promise->table_probe_ms = table->probe_ms;
    memcpy(promise->created, table->created, sizeof promise->created);
    memcpy(promise->machine, table->machine, sizeof promise->machine);
  }
  return status;
}

static struct accuracy_wish wish_of(const struct promise *promise, const struct work *work,
                                    char parts[PARTS_SIZE], const char *fixed) {
  const struct accuracy_settings *asked = &promise->settings.accuracy;
  const double speed = promise->probe_ms / promise->table_probe_ms;
  const double pupils = (double)work->pupils, draws = work->measures ? DRAWS : 0;
  struct accuracy_wish wish = {.time_ms = asked->max_time_ms > 0 ? asked->max_time_ms : INFINITY,
                               .fixed = fixed,
                               .parts = parts,
                               .speed = speed};
  if (work->measures) {
    snprintf(parts, PARTS_SIZE, "maps=1 indices=1 rings=1 wavefront=1 focus=%zu", work->pupils);
  } else {
    snprintf(parts, PARTS_SIZE, "focus=%zu", work->pupils);
  }
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    wish.error[k] = INFINITY;
  }
  wish.error[ACCURACY_ELEVATION_UM] = asked->max_error_um > 0 ? asked->max_error_um : INFINITY;
  wish.error[ACCURACY_PSF_OTF] = asked->max_error_psf > 0 ? asked->max_error_psf : INFINITY;
  wish.counts[ACCURACY_MIRES] = wish.counts[ACCURACY_FIT] = wish.counts[ACCURACY_FLOOR] =
      work->measures;
  wish.counts[ACCURACY_TRACE] = work->sees;
  wish.counts[ACCURACY_ACUITY] = work->tests > 0;
  const bool timed = asked->max_time_ms > 0;
  wish.needed[ACCURACY_MIRES] = wish.needed[ACCURACY_FIT] = wish.needed[ACCURACY_FLOOR] = true;
  wish.needed[ACCURACY_TRACE] = timed || asked->max_error_psf > 0;
  wish.needed[ACCURACY_ACUITY] = timed;
  wish.runs[ACCURACY_MIRES] = wish.runs[ACCURACY_FIT] = work->measures;
  wish.runs[ACCURACY_TRACE] = pupils;
  wish.runs[ACCURACY_ACUITY] = pupils * (double)work->tests * (1 + DRAW_READS * draws);
  wish.extra_ms = promise->further_ms;
  return wish;
}

/* Leaves scenes their share where that is possible, else the least that they take. */
static int choose(struct promise *promise, const struct accuracy_table *table,
                  struct accuracy_wish *wish, const struct work *work, placido_error *err) {
  const double least_ms = (double)work->sights * SCENE_LEAST_PROBES * promise->probe_ms;
  const double share_ms = SCENES_SHARE * wish->time_ms;
  if (!isfinite(wish->time_ms) || work->sights == 0) {
    return accuracy_choose(&promise->choice, table, wish, err);
  }
  double scenes_ms = fmax(least_ms, share_ms);
  wish->extra_ms = promise->further_ms + scenes_ms;
  int status = accuracy_choose(&promise->choice, table, wish, NULL);
  if (status == PLACIDO_QUALITY) {
    scenes_ms = least_ms;
    wish->extra_ms = promise->further_ms + scenes_ms;
    status = accuracy_choose(&promise->choice, table, wish, err);
  }
  promise->choice.time_ms -= scenes_ms;
  return status;
}

/* Settings by name hold whether or not the table knows what they are worth. */
static int look_up(struct promise *promise, const struct accuracy_table *table,
                   const struct work *work, placido_notes *notes, placido_error *err) {
  char fixed[FIXED_SIZE], parts[PARTS_SIZE];
  placido_error reason = {0};
  const struct choosable choosable = promise_choosable(&promise->settings.accuracy);
  if (work->measures) {
    promise->further_ms = CONDITION_PROBES * promise->probe_ms;
  }
  if (work->measures && work->tests > 0) {
    promise->further_ms += (double)work->pupils * DRAWS *
                           accuracy_setting_ms(table, ACCURACY_TRACE, DRAW_SETTING,
                                               promise->probe_ms / promise->table_probe_ms);
  }
  promise_fix(fixed, sizeof fixed, &promise->settings, &choosable);
  struct accuracy_wish wish = wish_of(promise, work, parts, fixed);
  int status = choose(promise, table, &wish, work, &reason);
  promise->kept_in_table = status == PLACIDO_OK;
  if (status == PLACIDO_QUALITY && promise->settings.accuracy.named != ACCURACY_UNNAMED) {
    placido_notes_add(notes, "nothing is promised of these settings: %s", reason.text);
    status = PLACIDO_OK;
  } else if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  promise_apply(&promise->settings, &promise->choice, &choosable);
  promise->pupils_left = work->pupils;
  promise->sights_left = work->sights;
  if (work->pupils > 0) {
    promise->pupil_ms = promise->choice.stage_ms[ACCURACY_TRACE] / (double)work->pupils +
                        accuracy_setting_ms(table, ACCURACY_REST, "part=focus", wish.speed);
  }
  return PLACIDO_OK;
}

int step_promise(struct examination *examination, placido_error *err) {
  struct promise *promise = &examination->promise;
  placido_notes *notes = &examination->outcome->notes;
  struct accuracy_table table = {0};
  int status = accuracy_settings_check(examination->settings, err);
  if (status != PLACIDO_OK || !accuracy_asked(examination->settings)) {
    return status;
  }
  stages_next(&examination->outcome->stages, "choose");
  const struct work work = work_of(examination);
  promise->made = true;
  promise->settings = *examination->settings;
  status = check(examination->settings, err);
  if (status == PLACIDO_OK) {
    status = load_table(&table, promise, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = look_up(promise, &table, &work, notes, err);
  }
  accuracy_table_free(&table);
  if (status == PLACIDO_OK) {
    examination->settings = &promise->settings;
  }
  return status;
}

int step_begin(struct examination *examination, placido_error *err) {
  (void)err;
  examination->promise.began_ms = 1e3 * bench_processor_s();
  examination->promise.wall_began_ms = 1e3 * bench_wall_s();
  return PLACIDO_OK;
}

double promise_time_ms(const struct promise *promise) {
  return promise->kept_in_table ? promise->choice.time_ms + promise->scenes_ms : (double)NAN;
}

bool promise_error_kept(const struct promise *promise) {
  const double asked_um = promise->settings.accuracy.max_error_um;
  return !(asked_um > 0 && promise->sigma_um > asked_um);
}

/* The error bars of the fit, by source, rms over the central 6 mm. */
static void find_sigma(struct promise *promise, const placido_fit *fit) {
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  double squares = 0;
  placido_fit_budget(fit, ZONE_MM, budget);
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    promise->by_um[i] = budget[i].z_um;
    squares += isfinite(budget[i].z_um) ? budget[i].z_um * budget[i].z_um : 0;
  }
  promise->sigma_um = sqrt(squares);
}

static void judge_error(const struct promise *promise, placido_notes *notes) {
  static const char *const causes[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = "the noise of the edge points",
      [PLACIDO_SIGMA_DISTANCE] = "the uncertain distance of the cornea (--axis-z)",
      [PLACIDO_SIGMA_GEOMETRY] = "the uncertain geometry of the instrument",
  };
  int most = PLACIDO_SIGMA_NOISE;
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    most = promise->by_um[i] > promise->by_um[most] ? i : most;
  }
  if (!promise_error_kept(promise)) {
    placido_notes_add(notes,
                      "--max-error %g um is not kept: the error bars of this measurement are %.2g "
                      "um rms over %d mm, as %s makes %.2g um of it; no settings change that",
                      promise->settings.accuracy.max_error_um, promise->sigma_um, ZONE_MM,
                      causes[most], promise->by_um[most]);
  }
}

int step_outcome(struct examination *examination, placido_error *err) {
  struct promise *promise = &examination->promise;
  placido_notes *notes = &examination->outcome->notes;
  const double asked_ms = promise->settings.accuracy.max_time_ms;
  (void)err;
  if (!promise->made) {
    return PLACIDO_OK;
  }
  promise->found_ms = 1e3 * bench_processor_s() - promise->began_ms;
  promise->found_wall_ms = 1e3 * bench_wall_s() - promise->wall_began_ms;
  promise->sigma_um = NAN;
  if (examination->fit) {
    find_sigma(promise, examination->fit);
    judge_error(promise, notes);
  }
  if (examination->mires.folded > 0) {
    placido_notes_add(notes,
                      "the mires show a fold on %.0f %% of the meridians: errors are promised for "
                      "corneas without one",
                      100 * examination->mires.folded);
  }
  if (asked_ms > 0 && promise->found_ms > asked_ms) {
    placido_notes_add(notes, "--max-time %g ms is not kept: it took %.0f ms of processor time%s",
                      asked_ms, promise->found_ms,
                      promise->late ? ", as a scene cannot be seen in less"
                                    : "; the machine was busier than when it was asked");
  }
  return PLACIDO_OK;
}

void promise_pupil_done(struct promise *promise) {
  promise->pupils_left -= promise->pupils_left > 0;
}

/* For one of the scenes that are left: its share of the time that nothing else will take. */
static double share_ms(const struct promise *promise) {
  const double used_ms = 1e3 * bench_processor_s() - promise->began_ms;
  const double later_ms = promise->pupil_ms * (double)promise->pupils_left +
                          promise->choice.stage_ms[ACCURACY_ACUITY] + promise->further_ms;
  const double left_ms = promise->settings.accuracy.max_time_ms - used_ms - later_ms;
  return left_ms / (double)(promise->sights_left > 0 ? promise->sights_left : 1);
}

/* What a plan's run takes on this machine at most: its estimate is for a probe of 3.4 ms and good to
 * a third (simulate/plan/cost.c). */
static double run_ms(const struct promise *promise, const placido_plan *plan) {
  const double reference_probe_ms = 3.4, margin = 1.2;
  return margin * promise->probe_ms / reference_probe_ms *
         placido_plan_settings_of(plan)->cost_ms;
}

static int plan_once(placido_plan **plan, struct examination *examination, size_t scene,
                     const placido_eye *eye, double tolerance, placido_error *err) {
  placido_plan_wish wish = plan_settings_read(examination->settings, examination->threads);
  wish.tolerance = tolerance;
  return placido_plan_new(plan, examination->surface, eye, &examination->views.scenes[scene],
                          &wish, &examination->outcome->notes, err);
}

/* From fine to coarse. */
static int plan_within(placido_plan **plan, struct examination *examination, size_t scene,
                       const placido_eye *eye, double limit_ms, placido_error *err) {
  static const double tolerances[] = {0.003, 0.01, 0.03, 0.1, 0.3};
  const size_t count = sizeof tolerances / sizeof *tolerances;
  placido_eye settled = *eye;
  int status = PLACIDO_OK;
  *plan = NULL;
  for (size_t i = 0; i < count; i++) {
    placido_plan_free(*plan);
    status = plan_once(plan, examination, scene, &settled, tolerances[i], err);
    if (status != PLACIDO_OK || run_ms(&examination->promise, *plan) <= limit_ms) {
      break;
    }
    settled = *placido_plan_eye(*plan);
  }
  if (status == PLACIDO_OK && run_ms(&examination->promise, *plan) > limit_ms) {
    examination->promise.late = true;
    placido_notes_add(&examination->outcome->notes,
                      "scene %s takes about %.0f ms at its coarsest, more than the %.0f ms that "
                      "are left for it",
                      examination->views.scenes[scene].name,
                      run_ms(&examination->promise, *plan), fmax(limit_ms, 0));
  }
  return status;
}

int promise_plan(placido_plan **plan, struct examination *examination, size_t scene,
                 const placido_eye *eye, placido_error *err) {
  struct promise *promise = &examination->promise;
  const struct settings *settings = examination->settings;
  const bool limited = promise->made && settings->accuracy.max_time_ms > 0 &&
                       settings->plan.tolerance == 0;
  const double begun_ms = 1e3 * bench_processor_s();
  const int status = limited ? plan_within(plan, examination, scene, eye, share_ms(promise), err)
                             : plan_once(plan, examination, scene, eye, settings->plan.tolerance,
                                         err);
  if (promise->made) {
    promise->sights_left -= promise->sights_left > 0;
    promise->scenes_ms += 1e3 * bench_processor_s() - begun_ms;
    promise->scenes_ms += status == PLACIDO_OK ? run_ms(promise, *plan) : 0;
  }
  return status;
}

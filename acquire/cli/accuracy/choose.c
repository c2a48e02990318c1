/* Searches all combinations of one setting a stage: there are some thousands at most, as settings
 * that another one beats at everything are left out before. */
#include "acquire/cli/accuracy/choose.h"

#include "acquire/cli/accuracy/candidates.h"
#include "acquire/cli/accuracy/setting_text.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* What the search is after. */
enum goal {
  GOAL_ERROR,   /* the least of one error, whatever the time */
  GOAL_TIME,    /* the least time, whatever the errors */
  GOAL_CHEAP,   /* the least time within the errors' limits */
  GOAL_ACCURATE /* the errors nearest to their least within the time */
};

struct search {
  const struct accuracy_wish *wish;
  double parts_ms;               /* of the rest */
  struct table_eyes eyes;
  struct candidates stages[ACCURACY_STAGES];
  bool told[ACCURACY_ERRORS];    /* whether the table knows all of that error */
  bool untimed;                  /* a stage's time is not known */
  double least[ACCURACY_ERRORS]; /* that any choice leaves */

  enum goal goal;
  int error;                               /* of GOAL_ERROR */
  const struct candidate *at[ACCURACY_STAGES]; /* being looked at; NULL: does not count */
  const struct candidate *best[ACCURACY_STAGES];
  double best_value, best_time_ms;
};

/* Fits are measured on the points of so many meridians, and maps of a surface with such knots; more
 * of them take longer, in proportion. */
#define FIT_MERIDIANS 360
#define REST_KNOT_MM 0.5

static double points_share(const struct candidate *mires) {
  struct knob meridians;
  return mires && knob_find(&meridians, mires->setting, "meridians")
             ? fmax(knob_number(meridians.value) / FIT_MERIDIANS, 1)
             : 1.0;
}

/* Knots of 0 mm are as residuals ask for them: so were those of the surface that was measured. */
static double knots_share(const struct candidate *fit) {
  struct knob knot;
  const double knot_mm =
      fit && knob_find(&knot, fit->setting, "knot_mm") ? knob_number(knot.value) : 0;
  return knot_mm > 0 ? fmax(REST_KNOT_MM / knot_mm, 1) : 1.0;
}

static double stage_ms(const struct search *s, const struct candidate *const *at, int stage) {
  if (stage == ACCURACY_REST) {
    return s->parts_ms * knots_share(at[ACCURACY_FIT]);
  }
  const double ms = at[stage] ? at[stage]->ms * s->wish->runs[stage] * s->wish->speed : 0.0;
  return stage == ACCURACY_FIT ? ms * points_share(at[ACCURACY_MIRES]) : ms;
}

static double time_of(const struct search *s, const struct candidate *const *at) {
  double sum = s->wish->extra_ms;
  for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
    sum += stage_ms(s, at, stage);
  }
  return sum;
}

/* The largest of the eyes' sums. `eye` (may be NULL) receives which it is. */
static double error_of(const struct search *s, const struct candidate *const *at, int error,
                       size_t *eye) {
  double most = -1;
  for (size_t i = 0; i < s->eyes.count; i++) {
    double sum = 0;
    for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
      sum += at[stage] ? at[stage]->error[i][error] : 0.0;
    }
    if (sum > most && eye) {
      *eye = i;
    }
    most = fmax(most, sum);
  }
  return most;
}

static bool within_errors(const struct search *s) {
  bool within = true;
  for (int k = 0; k < ACCURACY_ERRORS && within; k++) {
    const double limit = s->wish->error[k];
    within = !isfinite(limit) || error_of(s, s->at, k, NULL) <= limit;
  }
  return within;
}

/* How many times the least each error is, added up, in whole hundredths. */
static double excess(const struct search *s) {
  double sum = 0;
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    sum += s->told[k] && s->least[k] > 0 ? error_of(s, s->at, k, NULL) / s->least[k] : 0.0;
  }
  return ceil(100 * sum) / 100;
}

/* The smaller the better; infinite: not allowed. */
static double value_of(const struct search *s, double time_ms) {
  if (s->goal == GOAL_ERROR) {
    return error_of(s, s->at, s->error, NULL);
  }
  if (s->goal == GOAL_CHEAP) {
    return within_errors(s) ? time_ms : INFINITY;
  }
  if (s->goal == GOAL_ACCURATE) {
    return time_ms <= s->wish->time_ms ? excess(s) : INFINITY;
  }
  return time_ms;
}

static void look(struct search *s) {
  const double time_ms = time_of(s, s->at), value = value_of(s, time_ms);
  if (value < s->best_value || (value == s->best_value && time_ms < s->best_time_ms)) {
    s->best_value = value;
    s->best_time_ms = time_ms;
    memcpy(s->best, s->at, sizeof s->best);
  }
}

static void walk(struct search *s, int stage) {
  if (stage == ACCURACY_STAGES) {
    look(s);
    return;
  }
  if (s->stages[stage].count == 0) {
    s->at[stage] = NULL;
    walk(s, stage + 1);
  }
  for (size_t i = 0; i < s->stages[stage].count; i++) {
    s->at[stage] = &s->stages[stage].items[i];
    walk(s, stage + 1);
  }
}

/* Fills `best`; false where nothing is allowed. */
static bool search_for(struct search *s, enum goal goal, int error) {
  s->goal = goal;
  s->error = error;
  s->best_value = s->best_time_ms = INFINITY;
  walk(s, 0);
  return isfinite(s->best_value);
}

/* What a refusal calls the stage that limits. */
static const char *const limits[ACCURACY_STAGES] = {
    [ACCURACY_MIRES] = "finding the mires",
    [ACCURACY_FIT] = "the fit",
    [ACCURACY_TRACE] = "tracing rays",
    [ACCURACY_PSF] = "the width of the point spread function's buckets",
    [ACCURACY_CONVOLUTION] = "convolving",
    [ACCURACY_ACUITY] = "predicting acuity",
    [ACCURACY_REST] = "making maps, indices and wavefront",
    [ACCURACY_FLOOR] = "what the picture shows of the mires",
};

static const struct {
  const char *name, *unit;
} words[ACCURACY_ERRORS] = {
    [ACCURACY_ELEVATION_UM] = {"an elevation", " um"}, [ACCURACY_AXIAL_D] = {"axial power", " D"},
    [ACCURACY_PSF_OTF] = {"a transfer function", ""},  [ACCURACY_IMAGE] = {"a picture", ""},
    [ACCURACY_LOGMAR] = {"an acuity", " logMAR"},
};

/* The stage with the largest part in an error of an eye. */
static int find_limit(const struct search *s, int error, size_t eye) {
  int found = ACCURACY_FLOOR;
  double most = 0;
  for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
    if (s->best[stage] && s->best[stage]->error[eye][error] > most) {
      most = s->best[stage]->error[eye][error];
      found = stage;
    }
  }
  return found;
}

static int refuse_error(struct search *s, int error, placido_error *err) {
  size_t eye = 0;
  search_for(s, GOAL_ERROR, error);
  const double reached = error_of(s, s->best, error, &eye);
  return placido_error_set(err, PLACIDO_QUALITY,
                           "%s to %g%s cannot be promised: the best settings reach %.2g%s (of the "
                           "table's eye \"%s\"), as %s limits it",
                           words[error].name, s->wish->error[error], words[error].unit, reached,
                           words[error].unit, s->eyes.names[eye],
                           limits[find_limit(s, error, eye)]);
}

/* Which limit nothing reaches; where each can be reached alone, all of them together. */
static int refuse_errors(struct search *s, placido_error *err) {
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    if (isfinite(s->wish->error[k]) && s->least[k] > s->wish->error[k]) {
      return refuse_error(s, k, err);
    }
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "these errors can be promised one by one, but not together");
}

static int refuse_time(struct search *s, double needed_ms, const char *what, placido_error *err) {
  int longest = ACCURACY_REST;
  for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
    if (stage_ms(s, s->best, stage) > stage_ms(s, s->best, longest)) {
      longest = stage;
    }
  }
  const double most_ms = stage_ms(s, s->best, longest);
  const bool extra = s->wish->extra_ms > most_ms;
  return placido_error_set(err, PLACIDO_QUALITY,
                           "%.0f ms cannot be promised: %s take %.0f ms, of which %.0f are for %s",
                           s->wish->time_ms, what, needed_ms, extra ? s->wish->extra_ms : most_ms,
                           extra ? "seeing the scenes" : limits[longest]);
}

static int find_best(struct search *s, placido_error *err) {
  bool limited = false;
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    if (isfinite(s->wish->error[k]) && !s->told[k]) {
      return placido_error_set(err, PLACIDO_QUALITY,
                               "the accuracy table does not tell how true %s is", words[k].name);
    }
    limited = limited || isfinite(s->wish->error[k]);
    search_for(s, GOAL_ERROR, k);
    s->least[k] = s->best_value;
  }
  if (limited) {
    if (!search_for(s, GOAL_CHEAP, 0)) {
      return refuse_errors(s, err);
    }
    return s->best_time_ms <= s->wish->time_ms
               ? PLACIDO_OK
               : refuse_time(s, s->best_time_ms, "the cheapest settings that are accurate enough",
                             err);
  }
  if (search_for(s, GOAL_ACCURATE, 0)) {
    return PLACIDO_OK;
  }
  search_for(s, GOAL_TIME, 0);
  return refuse_time(s, s->best_time_ms, "the quickest settings", err);
}

static void hand_out(struct accuracy_choice *choice, const struct search *s) {
  for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
    const struct candidate *c = s->best[stage];
    snprintf(choice->setting[stage], sizeof choice->setting[stage], "%s", c ? c->setting : "");
    choice->stage_ms[stage] = stage_ms(s, s->best, stage);
  }
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    choice->error[k] = s->told[k] ? error_of(s, s->best, k, NULL) : (double)NAN;
  }
  choice->time_ms = s->untimed ? (double)NAN : time_of(s, s->best);
}

/* An error is told of where the floor is: without it stages know only how far they are apart. */
static void note_told(struct search *s, const struct accuracy_table *table) {
  for (size_t i = 0; i < table->count; i++) {
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      s->told[k] = s->told[k] || (table->rows[i].stage == ACCURACY_FLOOR &&
                                  isfinite(table->rows[i].error[k]));
    }
  }
}

/* What a stage would have to tell, and does not. */
static void note_untold(struct search *s, const struct accuracy_table *table, int stage) {
  s->untimed = s->untimed || s->wish->runs[stage] > 0;
  for (size_t i = 0; i < table->count; i++) {
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      s->told[k] = s->told[k] && !(table->rows[i].stage == (enum accuracy_stage)stage &&
                                   isfinite(table->rows[i].error[k]));
    }
  }
}

static int gather(struct search *s, const struct accuracy_table *table, placido_error *err) {
  int status = table_eyes_list(&s->eyes, table, err);
  for (int stage = 0; stage < ACCURACY_STAGES && status == PLACIDO_OK; stage++) {
    placido_error reason = {0};
    if (s->wish->counts[stage]) {
      status = candidates_new(&s->stages[stage], table, &s->eyes, (enum accuracy_stage)stage,
                              s->wish->fixed, &reason);
    }
    if (status == PLACIDO_QUALITY && !s->wish->needed[stage]) {
      note_untold(s, table, stage);
      status = PLACIDO_OK;
    } else if (status != PLACIDO_OK) {
      placido_error_set(err, status, "%s", reason.text);
    }
  }
  return status;
}

double accuracy_setting_ms(const struct accuracy_table *table, enum accuracy_stage stage,
                           const char *setting, double speed) {
  struct slowest slowest = {0};
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    if (row->stage == stage && strcmp(row->setting, setting) == 0 &&
        table_eye_measurable(table, row->eye)) {
      slowest_add(&slowest, row->ms);
    }
  }
  return slowest_ms(&slowest, stage) * speed;
}

static double parts_ms(const struct accuracy_table *table, const struct accuracy_wish *wish) {
  const char *rest = wish->parts;
  struct knob part;
  double sum = 0;
  while (knob_next(&part, &rest)) {
    char setting[96];
    snprintf(setting, sizeof setting, "part=%s", part.name);
    sum += knob_number(part.value) *
           accuracy_setting_ms(table, ACCURACY_REST, setting, wish->speed);
  }
  return sum;
}

int accuracy_choose(struct accuracy_choice *choice, const struct accuracy_table *table,
                    const struct accuracy_wish *wish, placido_error *err) {
  *choice = (struct accuracy_choice){0};
  struct search *s = placido_memory_new(1, sizeof *s, err);
  if (!s) {
    return PLACIDO_MEMORY;
  }
  s->wish = wish;
  s->parts_ms = parts_ms(table, wish);
  note_told(s, table);
  int status = gather(s, table, err);
  if (status == PLACIDO_OK) {
    status = find_best(s, err);
  }
  if (status == PLACIDO_OK) {
    hand_out(choice, s);
  }
  for (int stage = 0; stage < ACCURACY_STAGES; stage++) {
    candidates_free(&s->stages[stage]);
  }
  placido_memory_free(s);
  return status;
}

/* Gathers a stage's settings from the table's rows. */
#include "acquire/cli/accuracy/candidates.h"

#include "acquire/cli/accuracy/setting_text.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static size_t find_eye(const struct table_eyes *eyes, const char *name) {
  size_t i = 0;
  while (i < eyes->count && strcmp(eyes->names[i], name) != 0) {
    i++;
  }
  return i;
}

bool table_eye_measurable(const struct accuracy_table *table, const char *eye) {
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    if (row->stage == ACCURACY_FLOOR && strcmp(row->eye, eye) == 0 &&
        row->error[ACCURACY_ELEVATION_UM] > ACCURACY_MEASURABLE_UM) {
      return false;
    }
  }
  return true;
}

int table_eyes_list(struct table_eyes *eyes, const struct accuracy_table *table,
                    placido_error *err) {
  *eyes = (struct table_eyes){0};
  for (size_t i = 0; i < table->count; i++) {
    const char *name = table->rows[i].eye;
    if (find_eye(eyes, name) < eyes->count || !table_eye_measurable(table, name)) {
      continue;
    }
    if (eyes->count == ACCURACY_EYES_MAX) {
      return placido_error_set(err, PLACIDO_QUALITY, "the accuracy table has over %d eyes",
                               ACCURACY_EYES_MAX);
    }
    eyes->names[eyes->count++] = name;
  }
  return eyes->count > 0 ? PLACIDO_OK
                         : placido_error_set(err, PLACIDO_QUALITY,
                                             "the accuracy table has no eye that can be measured");
}

/* What a knob is where a setting does not name it, of each stage that is chosen from. */
static const char *const finest[ACCURACY_STAGES] = {
    [ACCURACY_MIRES] = "meridians=1440 filter_px=1",
    [ACCURACY_FIT] = "knot_mm=0 degree=5 tolerance=0.001",
    [ACCURACY_TRACE] = "samples=800 pattern=crosshatch light=spread",
    [ACCURACY_PSF] = "",
    [ACCURACY_CONVOLUTION] = "",
    [ACCURACY_ACUITY] = "trials=262144",
    [ACCURACY_REST] = "",
    [ACCURACY_FLOOR] = "",
    [ACCURACY_EXAM] = "",
};

/* The setting with all of the stage's knobs, in their order. */
static void complete(char out[96], enum accuracy_stage stage, const char *setting) {
  snprintf(out, 96, "%s", finest[stage]);
  struct knob knob;
  while (knob_next(&knob, &setting)) {
    char next[96];
    knob_replace(next, sizeof next, out, &knob);
    snprintf(out, 96, "%s", next);
  }
}

static struct candidate *find(const struct candidates *candidates, const char *setting) {
  for (size_t i = 0; i < candidates->count; i++) {
    if (strcmp(candidates->items[i].setting, setting) == 0) {
      return &candidates->items[i];
    }
  }
  return NULL;
}

#define EYES_ENOUGH 4

void slowest_add(struct slowest *slowest, double ms) {
  slowest->second_ms = fmax(slowest->second_ms, fmin(ms, slowest->first_ms));
  slowest->first_ms = fmax(slowest->first_ms, ms);
  slowest->eyes++;
}

double slowest_ms(const struct slowest *slowest, enum accuracy_stage stage) {
  const bool seen =
      stage == ACCURACY_TRACE || stage == ACCURACY_ACUITY || stage == ACCURACY_REST;
  return seen && slowest->eyes >= EYES_ENOUGH ? slowest->second_ms : slowest->first_ms;
}

static struct candidate *add(struct candidates *candidates, const char *setting,
                             placido_error *err) {
  struct candidate *items =
      placido_memory_grow(candidates->items, candidates->count + 1, sizeof *items, err);
  if (!items) {
    return NULL;
  }
  candidates->items = items;
  struct candidate *added = &items[candidates->count++];
  *added = (struct candidate){0};
  snprintf(added->setting, sizeof added->setting, "%s", setting);
  for (size_t i = 0; i < ACCURACY_EYES_MAX; i++) {
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      added->error[i][k] = NAN;
    }
  }
  return added;
}

static int gather(struct candidates *candidates, const struct accuracy_table *table,
                  const struct table_eyes *eyes, enum accuracy_stage stage,
                  placido_error *err) {
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    const size_t eye = find_eye(eyes, row->eye);
    if (row->stage != stage || eye == eyes->count) {
      continue;
    }
    char setting[96];
    complete(setting, stage, row->setting);
    struct candidate *c = find(candidates, setting);
    if (!c) {
      c = add(candidates, setting, err);
    }
    if (!c) {
      return PLACIDO_MEMORY;
    }
    double *error = c->error[eye];
    c->measured[eye] = true;
    slowest_add(&c->slowest, row->ms);
    c->ms = slowest_ms(&c->slowest, stage);
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      error[k] = fmax(error[k], row->error[k]);
    }
  }
  return PLACIDO_OK;
}

/* Where no row stands, nothing could be found. */
static void drop_failed(struct candidates *candidates, size_t eyes) {
  size_t kept = 0;
  bool possible[ACCURACY_EYES_MAX] = {false};
  for (size_t i = 0; i < candidates->count; i++) {
    for (size_t k = 0; k < eyes; k++) {
      possible[k] = possible[k] || candidates->items[i].measured[k];
    }
  }
  for (size_t i = 0; i < candidates->count; i++) {
    bool failed = false;
    for (size_t k = 0; k < eyes; k++) {
      failed = failed || (possible[k] && !candidates->items[i].measured[k]);
    }
    if (!failed) {
      candidates->items[kept++] = candidates->items[i];
    }
  }
  candidates->count = kept;
}

/* What was not measured is as bad as the worst that was. */
static void fill_gaps(struct candidate *c, size_t eyes) {
  for (int k = 0; k < ACCURACY_ERRORS; k++) {
    double most = 0;
    for (size_t i = 0; i < eyes; i++) {
      most = fmax(most, c->error[i][k]);
    }
    for (size_t i = 0; i < eyes; i++) {
      c->error[i][k] = isfinite(c->error[i][k]) ? c->error[i][k] : most;
    }
  }
}

/* The worse of both at everything. */
static void take_worse(struct candidate *c, const struct candidate *other) {
  c->ms = fmax(c->ms, other->ms);
  for (size_t i = 0; i < ACCURACY_EYES_MAX; i++) {
    for (int k = 0; k < ACCURACY_ERRORS; k++) {
      c->error[i][k] = fmax(c->error[i][k], other->error[i][k]);
    }
  }
}

/* The values of a knob between which the wanted one lies, or which it is, as the table has them. */
static bool find_neighbours(struct knob *below, struct knob *above,
                            const struct candidates *candidates, const struct knob *wanted) {
  const double value = knob_number(wanted->value);
  double low = -INFINITY, high = INFINITY;
  bool exact = false;
  for (size_t i = 0; i < candidates->count; i++) {
    struct knob knob;
    if (!knob_find(&knob, candidates->items[i].setting, wanted->name)) {
      continue;
    }
    const double number = knob_number(knob.value); /* 0 is the default, and no neighbour */
    if (knob_same(knob.value, wanted->value)) {
      exact = true;
      *below = *above = knob;
    }
    if (!exact && number != 0 && number <= value && number > low) {
      low = number;
      *below = knob;
    }
    if (!exact && number != 0 && number >= value && number < high) {
      high = number;
      *above = knob;
    }
  }
  return exact || (isfinite(low) && isfinite(high));
}

static bool has_knob(const struct candidates *candidates, const char *name) {
  struct knob knob;
  return candidates->count > 0 && knob_find(&knob, candidates->items[0].setting, name);
}

/* Keeps the settings with that value of the knob, or those of its neighbours made into one. */
static int fix_knob(struct candidates *candidates, const struct knob *wanted, placido_error *err) {
  struct knob below = {0}, above = {0}, knob;
  size_t kept = 0;
  if (!find_neighbours(&below, &above, candidates, wanted)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "nothing can be promised of %s=%s: the accuracy table does not reach "
                             "there", wanted->name, wanted->value);
  }
  for (size_t i = 0; i < candidates->count; i++) {
    struct candidate *c = &candidates->items[i];
    if (!knob_find(&knob, c->setting, wanted->name) || !knob_same(knob.value, below.value)) {
      continue;
    }
    char partner[sizeof c->setting];
    knob_replace(partner, sizeof partner, c->setting, &above);
    const struct candidate *other = find(candidates, partner);
    if (other) {
      take_worse(c, other);
      knob_replace(partner, sizeof partner, c->setting, wanted);
      snprintf(c->setting, sizeof c->setting, "%s", partner);
      candidates->items[kept++] = *c;
    }
  }
  candidates->count = kept;
  return PLACIDO_OK;
}

static int fix_knobs(struct candidates *candidates, const char *fixed, placido_error *err) {
  struct knob wanted;
  int status = PLACIDO_OK;
  while (status == PLACIDO_OK && knob_next(&wanted, &fixed)) {
    if (has_knob(candidates, wanted.name)) {
      status = fix_knob(candidates, &wanted, err);
    }
  }
  return status;
}

/* Whether `a` is at nothing better than `b`. */
static bool is_beaten(const struct candidate *a, const struct candidate *b, size_t eyes) {
  bool beaten = a->ms >= b->ms;
  for (size_t i = 0; i < eyes && beaten; i++) {
    for (int k = 0; k < ACCURACY_ERRORS && beaten; k++) {
      beaten = a->error[i][k] >= b->error[i][k];
    }
  }
  return beaten;
}

/* Of two that are alike the first stays. */
static void drop_beaten(struct candidates *candidates, size_t eyes) {
  size_t kept = 0;
  for (size_t i = 0; i < candidates->count; i++) {
    const struct candidate *c = &candidates->items[i];
    bool beaten = false;
    for (size_t j = 0; j < kept && !beaten; j++) {
      beaten = is_beaten(c, &candidates->items[j], eyes);
    }
    for (size_t j = i + 1; j < candidates->count && !beaten; j++) {
      beaten = is_beaten(c, &candidates->items[j], eyes) &&
               !is_beaten(&candidates->items[j], c, eyes);
    }
    if (!beaten) {
      candidates->items[kept++] = *c;
    }
  }
  candidates->count = kept;
}

int candidates_new(struct candidates *candidates, const struct accuracy_table *table,
                   const struct table_eyes *eyes, enum accuracy_stage stage, const char *fixed,
                   placido_error *err) {
  *candidates = (struct candidates){0};
  int status = gather(candidates, table, eyes, stage, err);
  drop_failed(candidates, eyes->count);
  for (size_t i = 0; i < candidates->count; i++) {
    fill_gaps(&candidates->items[i], eyes->count);
  }
  if (status == PLACIDO_OK) {
    status = fix_knobs(candidates, fixed, err);
  }
  if (status == PLACIDO_OK && candidates->count == 0) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "nothing can be promised: the accuracy table has no rows of %s that "
                               "agree with the command line", accuracy_stage_names[stage]);
  }
  if (status != PLACIDO_OK) {
    candidates_free(candidates);
    return status;
  }
  drop_beaten(candidates, eyes->count);
  return PLACIDO_OK;
}

void candidates_free(struct candidates *candidates) {
  placido_memory_free(candidates->items);
  *candidates = (struct candidates){0};
}

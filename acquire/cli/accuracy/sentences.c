/* Sentences from an accuracy table. */
#include "acquire/cli/accuracy/sentences.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define POINTS_MAX 96
#define LITTLE 0.1 /* of what is left anyway: to lower it buys nothing */
#define WORDS 128

static const struct {
  enum accuracy_error error; /* by which it is judged */
  const char *subject;
} judged[ACCURACY_STAGES] = {
    [ACCURACY_MIRES] = {ACCURACY_ELEVATION_UM, "The detection of the mires"},
    [ACCURACY_FIT] = {ACCURACY_ELEVATION_UM, "The fit"},
    [ACCURACY_TRACE] = {ACCURACY_PSF_OTF, "The trace"},
    [ACCURACY_PSF] = {ACCURACY_PSF_OTF, "The point spread function in white light"},
    [ACCURACY_CONVOLUTION] = {ACCURACY_IMAGE, "The convolution"},
    [ACCURACY_ACUITY] = {ACCURACY_LOGMAR, "The acuity"},
    [ACCURACY_REST] = {ACCURACY_ERRORS, NULL},
    [ACCURACY_FLOOR] = {ACCURACY_ERRORS, NULL},
    [ACCURACY_EXAM] = {ACCURACY_ELEVATION_UM, "A whole examination"},
};

enum accuracy_error accuracy_stage_error(enum accuracy_stage stage) {
  return judged[stage].error;
}

void accuracy_error_say(char *text, size_t size, enum accuracy_error error, double value) {
  static const char *const units[ACCURACY_ERRORS] = {
      [ACCURACY_ELEVATION_UM] = " µm", [ACCURACY_AXIAL_D] = " D",
      [ACCURACY_PSF_OTF] = "",         [ACCURACY_IMAGE] = " of white",
      [ACCURACY_LOGMAR] = " logMAR"};
  snprintf(text, size, "%.2g%s", value, units[error]);
}

static void say_ms(char text[32], double ms) {
  snprintf(text, 32, ms < 10 ? "%.2g ms" : "%.0f ms", ms);
}

/* Eyes that the stage has any row of. */
static size_t count_eyes(const struct accuracy_table *table, enum accuracy_stage stage) {
  size_t count = 0;
  for (size_t i = 0; i < table->count; i++) {
    bool first = table->rows[i].stage == stage;
    for (size_t k = 0; k < i && first; k++) {
      first = table->rows[k].stage != stage ||
              strcmp(table->rows[k].eye, table->rows[i].eye) != 0;
    }
    count += first;
  }
  return count;
}

/* The setting of row number `index`; false where an earlier row has it, or an eye has not. */
static bool take_point(struct accuracy_point *point, const struct accuracy_table *table,
                       size_t index, enum accuracy_error error, size_t eyes) {
  const struct accuracy_row *first = &table->rows[index];
  size_t seen = 0;
  *point = (struct accuracy_point){.setting = first->setting};
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    if (row->stage != first->stage || strcmp(row->setting, first->setting) != 0) {
      continue;
    }
    if (i < index || !isfinite(row->error[error])) {
      return false;
    }
    point->error = fmax(point->error, row->error[error]);
    point->ms = fmax(point->ms, row->ms);
    seen++;
  }
  return seen == eyes;
}

size_t accuracy_points_find(struct accuracy_point *points, size_t most,
                            const struct accuracy_table *table, enum accuracy_stage stage,
                            enum accuracy_error error) {
  const size_t eyes = count_eyes(table, stage);
  size_t count = 0;
  for (size_t i = 0; i < table->count && count < most; i++) {
    if (table->rows[i].stage == stage) {
      count += take_point(&points[count], table, i, error, eyes);
    }
  }
  return count;
}

/* Appends to a text that ends somewhere within `size`. */
static void append(char *text, size_t size, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void append(char *text, size_t size, const char *format, ...) {
  const size_t used = strlen(text);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text + used, size - used, format, arguments);
  va_end(arguments);
}

static void append_setting(char *text, size_t size, const char *setting) {
  char words[WORDS];
  accuracy_setting_say(words, sizeof words, setting);
  append(text, size, " (%s)", words);
}

static const struct accuracy_point *cheapest_within(const struct accuracy_point *points,
                                                    size_t count, double error) {
  const struct accuracy_point *best = NULL;
  for (size_t i = 0; i < count; i++) {
    if (points[i].error <= error && (!best || points[i].ms < best->ms)) {
      best = &points[i];
    }
  }
  return best;
}

static double least_error(const struct accuracy_point *points, size_t count) {
  double least = points[0].error;
  for (size_t i = 1; i < count; i++) {
    least = fmin(least, points[i].error);
  }
  return least;
}

static char *new_sentence(struct accuracy_sentences *sentences, enum accuracy_stage stage) {
  if (sentences->count == ACCURACY_SENTENCES_MAX) {
    return NULL;
  }
  struct accuracy_sentence *sentence = &sentences->items[sentences->count++];
  *sentence = (struct accuracy_sentence){.stage = stage};
  return sentence->text;
}

static void append_rung(char *text, enum accuracy_error error, double value,
                        const struct accuracy_point *point, const char *before) {
  char what[WORDS], ms[32];
  accuracy_error_say(what, sizeof what, error, value);
  say_ms(ms, point->ms);
  append(text, ACCURACY_SENTENCE_SIZE, "%s%s costs %s", before, what, ms);
  append_setting(text, ACCURACY_SENTENCE_SIZE, point->setting);
}

/* Powers of ten of the error, each with what it costs at least: "1 µm costs 20 ms (...), 0.1 µm
 * costs 25 ms (...)"; last the least error that there is. */
static void say_ladder(struct accuracy_sentences *sentences, const struct accuracy_table *table,
                       enum accuracy_stage stage, enum accuracy_error error) {
  static const char *const kinds[ACCURACY_ERRORS] = {
      [ACCURACY_ELEVATION_UM] = "elevation", [ACCURACY_AXIAL_D] = "axial power",
      [ACCURACY_PSF_OTF] = "the transfer function", [ACCURACY_IMAGE] = "the seen chart",
      [ACCURACY_LOGMAR] = "acuity"};
  struct accuracy_point points[POINTS_MAX];
  const size_t count = accuracy_points_find(points, POINTS_MAX, table, stage, error);
  char *text = count > 0 ? new_sentence(sentences, stage) : NULL;
  if (!text) {
    return;
  }
  const double least = least_error(points, count);
  const struct accuracy_point *finest = cheapest_within(points, count, least);
  const struct accuracy_point *last = NULL;
  double level = 1;
  append(text, ACCURACY_SENTENCE_SIZE, "%s, error of %s in the hardest of %zu eyes: ",
         judged[stage].subject, kinds[error], count_eyes(table, stage));
  for (int power = 1; power >= -9 && (level = pow(10, power)) >= least && least > 0; power--) {
    const struct accuracy_point *next = cheapest_within(points, count, level / 10);
    const struct accuracy_point *point = cheapest_within(points, count, level);
    if (point != next && point != finest) { /* else a lower power says it, or the end */
      append_rung(text, error, level, point, last ? ", " : "");
      last = point;
    }
  }
  append_rung(text, error, least, finest, last ? "; the least, " : "");
  append(text, ACCURACY_SENTENCE_SIZE, ".");
}

double accuracy_floor_find(const struct accuracy_table *table, enum accuracy_error error) {
  double most = NAN;
  for (size_t i = 0; i < table->count; i++) {
    if (table->rows[i].stage == ACCURACY_FLOOR) {
      most = fmax(most, table->rows[i].error[error]);
    }
  }
  return most;
}

/* What more than `enough` costs and buys. */
static void append_more(char *text, enum accuracy_error error, const struct accuracy_point *enough,
                        const struct accuracy_point *finest, double limit) {
  char before[WORDS], after[WORDS];
  if (finest->ms <= enough->ms) {
    append(text, ACCURACY_SENTENCE_SIZE, ".");
    return;
  }
  accuracy_error_say(before, sizeof before, error, limit + enough->error);
  accuracy_error_say(after, sizeof after, error, limit + finest->error);
  append(text, ACCURACY_SENTENCE_SIZE, "; %.2g times the time", finest->ms / enough->ms);
  append_setting(text, ACCURACY_SENTENCE_SIZE, finest->setting);
  append(text, ACCURACY_SENTENCE_SIZE,
         strcmp(before, after) == 0 ? " buys nothing: %s is left in all."
                                    : " buys next to nothing: %s are left in all, then %s.",
         before, after);
}

/* From where on more time buys nothing, as measuring itself leaves more than the stage does. */
static void say_limit(struct accuracy_sentences *sentences, const struct accuracy_table *table,
                      enum accuracy_stage stage, enum accuracy_error error) {
  struct accuracy_point points[POINTS_MAX];
  char left[WORDS], anyway[WORDS], ms[32];
  const size_t count = accuracy_points_find(points, POINTS_MAX, table, stage, error);
  const double limit = accuracy_floor_find(table, error);
  char *text = count > 0 && limit > 0 ? new_sentence(sentences, stage) : NULL;
  if (!text) {
    return;
  }
  const struct accuracy_point *finest = cheapest_within(points, count, least_error(points, count));
  const struct accuracy_point *enough = cheapest_within(points, count, LITTLE * limit);
  const struct accuracy_point *point = enough ? enough : finest;
  accuracy_error_say(anyway, sizeof anyway, error, limit);
  accuracy_error_say(left, sizeof left, error, point->error);
  say_ms(ms, point->ms);
  append(text, ACCURACY_SENTENCE_SIZE, "%s leaves %s for %s", judged[stage].subject, left, ms);
  append_setting(text, ACCURACY_SENTENCE_SIZE, point->setting);
  if (point->error > limit) {
    append(text, ACCURACY_SENTENCE_SIZE,
           ", at its best: more than the %s that noise and camera leave, so that it limits you.",
           anyway);
  } else if (!enough) {
    append(text, ACCURACY_SENTENCE_SIZE,
           ", at its best: noise and camera, which leave %s, limit you as well.", anyway);
  } else {
    append(text, ACCURACY_SENTENCE_SIZE,
           ", while noise and camera leave %s whatever the knobs", anyway);
    append_more(text, error, point, finest, limit);
  }
}

/* The longest time of a part in any eye; 0 where row number `index` is not its first. */
static double part_ms(const struct accuracy_table *table, size_t index) {
  double most = 0;
  for (size_t i = 0; i < table->count; i++) {
    const struct accuracy_row *row = &table->rows[i];
    if (row->stage == ACCURACY_REST && strcmp(row->setting, table->rows[index].setting) == 0) {
      if (i < index) {
        return 0;
      }
      most = fmax(most, row->ms);
    }
  }
  return most;
}

/* How much of an examination no knob changes. */
static void say_rest(struct accuracy_sentences *sentences, const struct accuracy_table *table) {
  struct accuracy_point exams[POINTS_MAX];
  const size_t count = accuracy_points_find(exams, POINTS_MAX, table, ACCURACY_EXAM,
                                            judged[ACCURACY_EXAM].error);
  const struct accuracy_point *quickest = cheapest_within(exams, count, INFINITY);
  double rest_ms = 0;
  for (size_t i = 0; i < table->count; i++) {
    rest_ms += table->rows[i].stage == ACCURACY_REST ? part_ms(table, i) : 0;
  }
  char *text = rest_ms > 0 ? new_sentence(sentences, ACCURACY_REST) : NULL;
  if (!text) {
    return;
  }
  char ms[32];
  say_ms(ms, rest_ms);
  append(text, ACCURACY_SENTENCE_SIZE,
         "Maps, indices, wavefront and the search for focus take up to %s, which no knob changes",
         ms);
  if (quickest) {
    say_ms(ms, quickest->ms);
    append(text, ACCURACY_SENTENCE_SIZE, "; the quickest examination as a whole takes up to %s",
           ms);
  }
  append(text, ACCURACY_SENTENCE_SIZE, ".");
}

static void say_floor(struct accuracy_sentences *sentences, const struct accuracy_table *table) {
  const double elevation_um = accuracy_floor_find(table, ACCURACY_ELEVATION_UM);
  const double otf = accuracy_floor_find(table, ACCURACY_PSF_OTF);
  char *text = isfinite(elevation_um) ? new_sentence(sentences, ACCURACY_FLOOR) : NULL;
  if (!text) {
    return;
  }
  char height[WORDS], transfer[WORDS];
  accuracy_error_say(height, sizeof height, ACCURACY_ELEVATION_UM, elevation_um);
  accuracy_error_say(transfer, sizeof transfer, ACCURACY_PSF_OTF, otf);
  append(text, ACCURACY_SENTENCE_SIZE, "With everything at its finest %s is wrong in the hardest "
         "eye", height);
  if (isfinite(otf)) {
    append(text, ACCURACY_SENTENCE_SIZE, ", and %s of the transfer function", transfer);
  }
  append(text, ACCURACY_SENTENCE_SIZE, ": noise and camera, which no knob changes.");
}

void accuracy_sentences_find(struct accuracy_sentences *sentences,
                             const struct accuracy_table *table) {
  *sentences = (struct accuracy_sentences){0};
  for (enum accuracy_stage stage = 0; stage < ACCURACY_STAGES; stage++) {
    const enum accuracy_error error = judged[stage].error;
    if (stage == ACCURACY_REST) {
      say_rest(sentences, table);
    } else if (stage == ACCURACY_FLOOR) {
      say_floor(sentences, table);
    } else {
      say_ladder(sentences, table, stage, error);
    }
    if (stage == ACCURACY_EXAM) {
      say_ladder(sentences, table, stage, ACCURACY_PSF_OTF);
    } else if (error != ACCURACY_ERRORS) {
      say_limit(sentences, table, stage, error);
    }
  }
}

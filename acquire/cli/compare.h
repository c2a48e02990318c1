/* Two exams on their way to a comparison. */
#ifndef PLACIDO_CLI_COMPARE_H
#define PLACIDO_CLI_COMPARE_H

#include "acquire/cli/command.h"
#include "base/file.h"

#include <placido/difference.h>

#define COMPARE_MARKER "compare.json"
#define COMPARE_INDICES_MAX 256

/* An index as indices.json has it; NaN where it has none. */
struct compared_index {
  char name[64], unit[16];
  double value, sigma;
};

/* One exam's directory. */
struct compared_exam {
  const char *path;
  char eye[8], created[40]; /* empty where the exam does not say */
  placido_measured measured;
  struct compared_index indices[COMPARE_INDICES_MAX];
  size_t index_count;
};

/* An index of both. */
struct compared_change {
  const char *name, *unit; /* borrowed from the first exam */
  double first, second, difference, sigma;
};

struct comparison {
  const struct settings *settings;
  struct outcome *outcome;
  char created[32];
  struct compared_exam exams[2];
  placido_alignment alignment;
  placido_difference difference;
  struct compared_change changes[COMPARE_INDICES_MAX];
  size_t change_count;
  placido_directory directory;
};

/* Reads an exam; a mirrored one has its indices mirrored, too. Refuses a directory that is no exam.
 */
int compared_exam_load(struct compared_exam *exam, const char *path, bool mirrored,
                       placido_notes *notes, placido_error *err);

/* The differences of the indices that both have. */
void compared_indices_find(struct comparison *comparison);

/* compare.json as a new reference; NULL when memory is out. */
json_t *comparison_json(const struct comparison *comparison);

/* Pictures and compare.html, where the build can draw. */
int comparison_draw(struct comparison *comparison, placido_error *err);

#endif

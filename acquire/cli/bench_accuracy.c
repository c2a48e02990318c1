/* `placido bench accuracy`: what accuracy costs in time on this machine, measured, told, and kept
 * for `placido exam` to choose by. */
#include "acquire/cli/accuracy/page.h"
#include "acquire/cli/accuracy/sentences.h"
#include "acquire/cli/accuracy/sweep.h"
#include "acquire/cli/bench.h"
#include "base/file.h"
#include "base/text.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define POINTS_MAX 96

/* The folders above a file, for the user alone as caches are. */
static int make_folders(const char *path, placido_error *err) {
  char folder[PLACIDO_PATH_MAX];
  snprintf(folder, sizeof folder, "%s", path);
  for (char *end = strchr(folder + 1, '/'); end; end = strchr(end + 1, '/')) {
    *end = '\0';
    if (mkdir(folder, 0700) != 0 && errno != EEXIST) {
      return placido_error_set(err, PLACIDO_SYSTEM, "cannot make %s: %s",
                               placido_text_tail(folder), strerror(errno));
    }
    *end = '/';
  }
  return PLACIDO_OK;
}

/* The user's own table, from which later examinations choose. */
static int keep(const struct accuracy_table *table, struct bench_run *bench, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = accuracy_table_path(path, sizeof path, err);
  if (status == PLACIDO_OK) {
    status = make_folders(path, err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_table_save(table, path, err);
  }
  return status == PLACIDO_OK
             ? bench_report_say(&bench->report, err, "placido exam --max-error ... chooses by %s",
                                path)
             : status;
}

/* Everything that stands in DIR; a build without figures says that it has none. */
static int write_folder(const struct accuracy_table *table, const char *folder,
                        struct bench_run *bench, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_error reason = {0};
  int status = placido_path_join(path, folder, "accuracy.csv", err);
  if (status == PLACIDO_OK) {
    status = accuracy_table_save(table, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = accuracy_page_write(table, folder, &reason);
  if (status == PLACIDO_UNSUPPORTED) {
    return bench_report_say(&bench->report, err, "%s", reason.text);
  }
  return status == PLACIDO_OK ? bench_report_say(&bench->report, err, "the page is %s/accuracy.html",
                                                 folder)
                              : placido_error_set(err, status, "%s", reason.text);
}

/* Before minutes of work: whether that can be written; the folder itself is made where it is not
 * there. */
static int check_folder(const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot make %s: %s", placido_text_tail(folder),
                             strerror(errno));
  }
  int status = placido_path_join(path, folder, "accuracy.csv", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  placido_file_discard(&file);
  return status;
}

/* The least error of a stage, against what is left whatever its knobs, and its time. */
static int tell_stage(struct bench_run *bench, const struct accuracy_table *table,
                      enum accuracy_stage stage, placido_error *err) {
  static const char *const units[ACCURACY_ERRORS] = {[ACCURACY_ELEVATION_UM] = "µm",
                                                     [ACCURACY_AXIAL_D] = "D",
                                                     [ACCURACY_LOGMAR] = "logMAR"};
  const enum accuracy_error error = accuracy_stage_error(stage);
  struct accuracy_point points[POINTS_MAX];
  char what[64];
  if (error == ACCURACY_ERRORS) {
    return PLACIDO_OK;
  }
  const size_t count = accuracy_points_find(points, POINTS_MAX, table, stage, error);
  const struct accuracy_point *least = points;
  for (size_t i = 1; i < count; i++) {
    least = points[i].error < least->error ? &points[i] : least;
  }
  if (count == 0) {
    return PLACIDO_OK;
  }
  const double floor = accuracy_floor_find(table, error);
  snprintf(what, sizeof what, "%s: least error", accuracy_stage_names[stage]);
  int status = bench_report_number(&bench->report, what, least->error,
                                   units[error] ? units[error] : "", least->error / floor,
                                   isfinite(floor) ? "what measuring leaves" : NULL, err);
  snprintf(what, sizeof what, "%s: its time", accuracy_stage_names[stage]);
  return status == PLACIDO_OK
             ? bench_report_number(&bench->report, what, least->ms, "ms",
                                   least->ms / table->probe_ms, "the probe", err)
             : status;
}

static int tell(struct bench_run *bench, const struct accuracy_table *table, placido_error *err) {
  struct accuracy_sentences sentences;
  int status = bench_report_number(&bench->report, "the probe", table->probe_ms, "ms", (double)NAN,
                                   NULL, err);
  for (enum accuracy_stage stage = 0; stage < ACCURACY_STAGES && status == PLACIDO_OK; stage++) {
    status = tell_stage(bench, table, stage, err);
  }
  accuracy_sentences_find(&sentences, table);
  for (size_t i = 0; i < sentences.count && status == PLACIDO_OK; i++) {
    status = bench_report_say(&bench->report, err, "%s", sentences.items[i].text);
  }
  return status;
}

static int run(struct bench_run *bench, placido_error *err) {
  const struct settings *settings = bench->settings;
  struct accuracy_table table = {0};
  int status = settings->output ? check_folder(settings->output, err) : PLACIDO_OK;
  if (status == PLACIDO_OK) {
    status = accuracy_sweep(&table, settings, settings->quick, &bench->outcome->stages, err);
  }
  if (status == PLACIDO_OK) {
    status = tell(bench, &table, err);
  }
  if (status == PLACIDO_OK && settings->output) {
    status = write_folder(&table, settings->output, bench, err);
  }
  if (status == PLACIDO_OK && !settings->quick) {
    status = keep(&table, bench, err);
  }
  accuracy_table_free(&table);
  return status;
}

const struct bench bench_accuracy = {
    .name = "accuracy",
    .summary = "error against time, of every stage and the whole, on eyes from easy to hard",
    .by_name = true,
    .run = run,
};

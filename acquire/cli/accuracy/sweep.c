/* The table of stages, and the loop over them. */
#include "acquire/cli/accuracy/sweep.h"

#include "acquire/cli/accuracy/stage.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const struct accuracy_measure *const measures[] = {
    &accuracy_measure_mires,       &accuracy_measure_fit,    &accuracy_measure_trace,
    &accuracy_measure_psf,         &accuracy_measure_convolution,
    &accuracy_measure_acuity,      &accuracy_measure_rest,   &accuracy_measure_floor,
    &accuracy_measure_exam,
};
#define MEASURES (sizeof measures / sizeof *measures)

static int measure_setting(struct accuracy_table *table, const struct accuracy_measure *measure,
                           struct accuracy_trial *trial, placido_error *err) {
  struct accuracy_row row = {.stage = measure->stage};
  placido_error reason = {0};
  int status = PLACIDO_OK;
  snprintf(row.setting, sizeof row.setting, "%s", trial->setting);
  snprintf(row.eye, sizeof row.eye, "%s", trial->eye->name);
  for (size_t i = 0; i < ACCURACY_ERRORS; i++) {
    row.error[i] = NAN;
  }
  trial->knobs = measure->defaults ? (struct accuracy_knobs){.meridians = 0} : trial->bench->finest;
  if (!measure->words) {
    status = accuracy_knobs_read(&trial->knobs, trial->setting, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = measure->run(&row, trial, &reason);
  if (status == PLACIDO_QUALITY) {
    return PLACIDO_OK;
  }
  return status == PLACIDO_OK ? accuracy_table_add(table, &row, err)
                              : placido_error_set(err, status, "%s", reason.text);
}

static int measure_eye(struct accuracy_table *table, const struct accuracy_measure *measure,
                       const struct accuracy_bench *bench, const struct accuracy_eye *eye,
                       placido_error *err) {
  struct accuracy_trial trial = {.bench = bench, .eye = eye};
  const char *const *settings = bench->quick ? measure->quick : measure->settings;
  int status =
      measure->prepare ? measure->prepare(&trial.prepared, bench, eye, err) : PLACIDO_OK;
  for (; *settings && status == PLACIDO_OK; settings++) {
    trial.setting = *settings;
    status = measure_setting(table, measure, &trial, err);
  }
  if (measure->release) {
    measure->release(trial.prepared);
  }
  return status;
}

static void show_eye(void *user, const char *eye) {
  struct stages *progress = user;
  if (progress) {
    stages_next(progress, "eye %s", eye);
  }
}

static int measure_all(struct accuracy_table *table, const struct accuracy_bench *bench,
                       struct stages *progress, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < MEASURES && status == PLACIDO_OK; i++) {
    for (size_t k = 0; k < bench->count && status == PLACIDO_OK; k++) {
      const struct accuracy_eye *eye = &bench->eyes[k];
      if (progress) {
        stages_next(progress, "%.11s %.19s", accuracy_stage_names[measures[i]->stage], eye->name);
      }
      status = measure_eye(table, measures[i], bench, eye, err);
    }
  }
  return status;
}

/* "model name	: Intel ..." of /proc/cpuinfo; "" where there is none. */
static void read_processor(char name[64]) {
  char line[256];
  FILE *stream = fopen("/proc/cpuinfo", "r");
  name[0] = '\0';
  while (stream && name[0] == '\0' && fgets(line, sizeof line, stream)) {
    const char *value = strchr(line, ':');
    if (value && strncmp(line, "model name", 10) == 0) {
      value += 1 + strspn(value + 1, " ");
      snprintf(name, 64, "%.*s", (int)strcspn(value, "\n"), value);
    }
  }
  if (stream) {
    fclose(stream);
  }
}

static void describe(struct accuracy_table *table) {
  char processor[64];
  const time_t now = time(NULL);
  struct tm utc;
  read_processor(processor);
  snprintf(table->machine, sizeof table->machine, "%s%s%ld processors", processor,
           processor[0] ? "; " : "", sysconf(_SC_NPROCESSORS_ONLN));
  if (!gmtime_r(&now, &utc) ||
      strftime(table->created, sizeof table->created, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    table->created[0] = '\0';
  }
}

int accuracy_sweep(struct accuracy_table *table, const struct settings *settings, bool quick,
                   struct stages *progress, placido_error *err) {
  struct settings own = *settings;
  struct accuracy_bench bench;
  *table = (struct accuracy_table){0};
  describe(table);
  settings_use_threads(settings);
  int status = accuracy_bench_new(&bench, &own, quick, show_eye, progress, err);
  own.threads = 1;
  settings_use_threads(&own);
  table->probe_ms = accuracy_probe_ms();
  if (status == PLACIDO_OK) {
    status = measure_all(table, &bench, progress, err);
  }
  table->probe_ms = fmin(table->probe_ms, accuracy_probe_ms());
  settings_use_threads(settings);
  accuracy_bench_free(&bench);
  return status;
}

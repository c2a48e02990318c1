/* `placido study`: all corneas of a folder, or the phantom's, through every pupil before every
 * scene. */
#include "acquire/cli/study.h"

#include "acquire/cli/place.h"
#include "base/memory.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define MARKER "study.json"
#define QUICK_TRIALS 1024

/* A folder's name of any file's name. */
static void make_stem(char *stem, size_t size, const char *name) {
  snprintf(stem, size, "eyes/%s", name);
  for (char *c = stem + strlen("eyes/"); *c; c++) {
    if (!isalnum((unsigned char)*c) && !strchr("._-", *c)) {
      *c = '-';
    }
  }
}

static bool is_name_taken(const struct study *study, const placido_study_eye *eye) {
  for (size_t i = 0; i < study->eye_count; i++) {
    if (strcmp(study->eyes[i].folder, eye->folder) == 0) {
      return true;
    }
  }
  return false;
}

int study_add(placido_study_eye **added, struct study *study, const char *name,
              placido_error *err) {
  *added = NULL;
  if (study->eye_count == STUDY_EYES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "more than %d surfaces: --eyes chooses",
                             STUDY_EYES_MAX);
  }
  placido_study_eye *eye = &study->eyes[study->eye_count];
  *eye = (placido_study_eye){.group = "", .note = "", .ghost_deg = (double)NAN};
  snprintf(eye->name, sizeof eye->name, "%s", name);
  make_stem(eye->folder, sizeof eye->folder, eye->name);
  for (int k = 2; is_name_taken(study, eye); k++) {
    snprintf(eye->name, sizeof eye->name, "%.80s-%d", name, k);
    make_stem(eye->folder, sizeof eye->folder, eye->name);
  }
  study->eye_count++;
  *added = eye;
  return PLACIDO_OK;
}

static void note_time(char created[32]) {
  const time_t now = time(NULL);
  struct tm utc;
  if (!gmtime_r(&now, &utc) || strftime(created, 32, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    created[0] = '\0';
  }
}

/* Two pupils are the same where they would share a folder. */
static int check_pupils(const struct number_list *pupils, placido_error *err) {
  for (size_t i = 0; i < pupils->count; i++) {
    for (size_t k = 0; k < i; k++) {
      char one[32], other[32];
      snprintf(one, sizeof one, "%g", pupils->values[i]);
      snprintf(other, sizeof other, "%g", pupils->values[k]);
      if (strcmp(one, other) == 0) {
        return placido_error_set(err, STATUS_USAGE, "--pupils: %s stands twice", one);
      }
    }
  }
  return PLACIDO_OK;
}

static int list_eyes(struct study *study, placido_error *err) {
  study->eyes = placido_memory_new(STUDY_EYES_MAX, sizeof *study->eyes, err);
  study->surfaces = placido_memory_new(STUDY_EYES_MAX, sizeof(placido_surface *), err);
  if (!study->eyes || !study->surfaces) {
    return PLACIDO_MEMORY;
  }
  const char *folder = study->settings->input;
  return folder ? study_list_folder(study, folder, err) : study_list_built_in(study, err);
}

static int make_cells(struct study *study, placido_error *err) {
  const struct number_list *pupils = &study->settings->pupils_mm;
  const size_t count = study->eye_count * pupils->count;
  study->cells = placido_memory_new(count, sizeof *study->cells, err);
  study->cell_notes = placido_memory_new(count, sizeof *study->cell_notes, err);
  if (!study->cells || !study->cell_notes) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    study->cells[i].pupil_mm = pupils->values[i % pupils->count];
  }
  for (size_t i = 0; i < study->eye_count; i++) {
    study->eyes[i].cells = study->cells + i * pupils->count;
  }
  return PLACIDO_OK;
}

static int make_observer(struct study *study, placido_error *err) {
  const placido_acuity_test *test = placido_acuity_test_find("e");
  const placido_acuity_options options = {.trials = study->settings->quick ? QUICK_TRIALS : 0};
  snprintf(study->test, sizeof study->test, "%s, %.3g %% right", test->title,
           100 * test->criterion);
  return placido_observer_new(&study->observer, test, &options, err);
}

static void describe(struct study *study) {
  const struct settings *settings = study->settings;
  placido_study *page = &study->page;
  page->software = PROGRAM_VERSION;
  page->created = study->created;
  page->source = settings->input ? settings->input : "the phantom's";
  page->test = study->test;
  page->eyes = study->eyes;
  page->eye_count = study->eye_count;
  page->pupils_mm = settings->pupils_mm.values;
  page->pupil_count = settings->pupils_mm.count;
  page->notes = &study->outcome->notes;
}

static int prepare(struct study *study, placido_error *err) {
  note_time(study->created);
  stages_next(&study->outcome->stages, "read");
  int status = check_pupils(&study->settings->pupils_mm, err);
  if (status == PLACIDO_OK) {
    status = study_read_scenes(study, err);
  }
  if (status == PLACIDO_OK) {
    status = list_eyes(study, err);
  }
  if (status == PLACIDO_OK) {
    status = make_cells(study, err);
  }
  if (status == PLACIDO_OK) {
    status = make_observer(study, err);
  }
  describe(study);
  return status;
}

static int make_place(struct study *study, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = place_check(study->settings->output, MARKER, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  interrupt_hold(study->outcome->interrupt);
  status = placido_directory_create(&study->directory, study->settings->output, MARKER, err);
  interrupt_release(study->outcome->interrupt, &study->directory);
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, study->directory.temporary, "eyes", err);
  }
  if (status == PLACIDO_OK && mkdir(path, 0777) != 0) {
    status = placido_error_set(err, PLACIDO_SYSTEM, "%s: cannot be made: %s", path,
                               strerror(errno));
  }
  return status;
}

static int examine_eyes(struct study *study, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < study->eye_count && status == PLACIDO_OK; i++) {
    if (study->surfaces[i]) {
      status = study_examine_eye(study, i, err);
    }
  }
  return status;
}

static void tell_progress(struct study *study, size_t done, size_t count) {
  char text[64];
  snprintf(text, sizeof text, "%zu of %zu pupils", done, count);
  progress_say(study->outcome->stages.progress, text);
}

/* Cells are independent; of several failures the first in the list is told. */
static int examine_cells(struct study *study, placido_error *err) {
  const size_t pupils = study->settings->pupils_mm.count, count = study->eye_count * pupils;
  size_t failed = count, done = 0;
  int status = PLACIDO_OK;
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < count; i++) {
    placido_error reason = {0};
    int ended = PLACIDO_OK;
    if (study->surfaces[i / pupils]) {
      ended = study_examine_cell(study, i / pupils, i % pupils, &reason);
    }
#pragma omp critical(placido_cli_study)
    {
      tell_progress(study, ++done, count);
      if (ended != PLACIDO_OK && i < failed) {
        failed = i;
        status = placido_error_set(err, ended, "%s", reason.text);
      }
    }
  }
  return status;
}

/* The cells' notes in their order, whoever came first. */
static void collect_notes(struct study *study) {
  const size_t pupils = study->settings->pupils_mm.count;
  for (size_t i = 0; i < study->eye_count * pupils; i++) {
    for (size_t k = 0; k < study->cell_notes[i].count; k++) {
      placido_notes_add(&study->outcome->notes, "%s: %s", study->eyes[i / pupils].name,
                        study->cell_notes[i].lines[k]);
    }
  }
}

static int save(struct study *study, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  stages_next(&study->outcome->stages, "page");
  int status = study_draw_page(study, err);
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, study->directory.temporary, "study.csv", err);
  }
  if (status == PLACIDO_OK) {
    status = study_save_csv(&study->page, path, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, study->directory.temporary, MARKER, err);
  }
  if (status == PLACIDO_OK) {
    status = study_save_json(&study->page, path, err);
  }
  interrupt_hold(study->outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_directory_commit(&study->directory, err);
  }
  interrupt_release(study->outcome->interrupt, &study->directory);
  return status;
}

static void print_eye(const struct study *study, const placido_study_eye *eye) {
  char line[512];
  size_t length = 0;
  line[0] = '\0';
  for (size_t k = 0; k < study->page.pupil_count && length < sizeof line; k++) {
    const placido_study_cell *cell = &eye->cells[k];
    char text[112];
    snprintf(text, sizeof text, "%s (%s)", cell->bars_text, cell->acuity_text);
    length += (size_t)snprintf(line + length, sizeof line - length, " %28s",
                               cell->failure[0] == '\0' ? text : "-");
  }
  say(study->settings, "%-24s%s", eye->name, eye->failure[0] == '\0' ? line : " left out");
}

static void print_result(const struct study *study) {
  const placido_study *page = &study->page;
  char head[512];
  size_t length = 0;
  head[0] = '\0';
  for (size_t k = 0; k < page->pupil_count && length < sizeof head; k++) {
    length += (size_t)snprintf(head + length, sizeof head - length, " %25g mm",
                               page->pupils_mm[k]);
  }
  say(study->settings, "Finest bars in the picture with a tenth of their contrast (and what an "
      "ideal observer reads)");
  say(study->settings, "%-24s%s", "pupil", head);
  for (size_t i = 0; i < page->eye_count; i++) {
    print_eye(study, &page->eyes[i]);
  }
  for (size_t k = 0; k < page->finding_count; k++) {
    const placido_study_finding *f = &page->findings[k];
    say(study->settings, "%s%s: %s (seed); pictures 20/%.0f to 20/%.0f, %zu of %zu agree; observer "
        "20/%.0f to 20/%.0f", k == 0 ? "\n" : "", f->group, f->claim, f->best, f->worst, f->met,
        f->cells, f->observer_best, f->observer_worst);
  }
}

static int examine(struct study *study, placido_error *err) {
  struct stages *stages = &study->outcome->stages;
  stages_next(stages, "maps");
  int status = examine_eyes(study, err);
  if (status == PLACIDO_OK) {
    stages_next(stages, "eyes");
    status = examine_cells(study, err);
  }
  collect_notes(study);
  if (status == PLACIDO_OK) {
    study_find(&study->page);
    status = save(study, err);
  }
  stages_end(stages);
  return status;
}

static void study_free(struct study *study) {
  placido_directory_discard(&study->directory);
  for (size_t i = 0; i < study->eye_count; i++) {
    placido_surface_free(study->surfaces[i]);
  }
  for (size_t i = 0; study->cell_notes && i < study->eye_count * study->page.pupil_count; i++) {
    placido_notes_clear(&study->cell_notes[i]);
  }
  for (size_t i = 0; i < study->scene_count; i++) {
    placido_scene_free(&study->scenes[i]);
  }
  placido_observer_free(study->observer);
  placido_memory_free(study->cell_notes);
  placido_memory_free(study->cells);
  placido_memory_free(study->surfaces);
  placido_memory_free(study->eyes);
  placido_memory_free(study);
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct study *study = placido_memory_new(1, sizeof *study, err);
  if (!study) {
    return PLACIDO_MEMORY;
  }
  study->settings = settings;
  study->outcome = outcome;
  settings_use_threads(settings);
  int status = prepare(study, err);
  if (status == PLACIDO_OK) {
    status = make_place(study, err);
  }
  if (status == PLACIDO_OK) {
    status = examine(study, err);
  }
  if (status == PLACIDO_OK) {
    outcome->result = study_json(&study->page);
    print_result(study);
  }
  if (status == PLACIDO_OK && study->failed > 0) {
    status = placido_error_set(err, PLACIDO_INPUT, "%zu of %zu surfaces cannot be read and are left "
                               "out", study->failed, study->eye_count);
  }
  study_free(study);
  return status;
}

static const struct option_group *const groups[] = {&options_study, &options_general, NULL};

const struct command command_study = {
    .name = "study",
    .summary = "What many corneas see through several pupils, and how well: one page.",
    .usage = "[DIR_OF_SURFACES] -o DIR [OPTION...]",
    .examples =
        "  placido study -o study\n"
        "      the phantom's regular, operated, keratoconic and diplopic eyes: study/study.html\n"
        "  placido study exams -o study --pupils 3,6 --scenes tumbling-e,street\n"
        "      every placido-surface/1 file and every exam in the folder exams\n",
    .groups = groups,
    .list = views_list_charts,
    .may_have_word = true,
    .needs_output = true,
    .run = run,
};

/* What the eyes of a study look at. */
#include "acquire/cli/study.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static const char usual[] = "tumbling-e,fan,building", quick[] = "tumbling-e";

/* A scene's name as a file name. */
static void make_stem(char stem[80], const char *name) {
  const size_t length = strnlen(name, 79);
  memcpy(stem, name, length);
  stem[length] = '\0';
  for (char *c = stem; *c; c++) {
    if (!isalnum((unsigned char)*c) && !strchr("._-", *c)) {
      *c = '-';
    }
  }
  if (stem[0] == '.' || stem[0] == '\0') {
    stem[0] = '-';
  }
}

/* Two scenes of one name would be one file; the PSF's own pictures have their names already. */
static bool is_taken(const struct study *study, const char *stem) {
  bool taken = strcmp(stem, "psf") == 0 || strcmp(stem, "psf-small") == 0;
  for (size_t i = 0; i < study->scene_count; i++) {
    taken = taken || strcmp(stem, study->stems[i]) == 0;
  }
  return taken;
}

static int read_scene(struct study *study, const char *name, placido_error *err) {
  const size_t k = study->scene_count;
  if (k == PLACIDO_STUDY_SCENES_MAX) {
    return placido_error_set(err, STATUS_USAGE, "--scenes: at most %d", PLACIDO_STUDY_SCENES_MAX);
  }
  const int status =
      placido_scene_load(&study->scenes[k], name, 0, &study->outcome->notes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  make_stem(study->stems[k], study->scenes[k].name);
  if (is_taken(study, study->stems[k])) {
    placido_scene_free(&study->scenes[k]);
    return placido_error_set(err, STATUS_USAGE, "--scenes: %s.png is taken; give one of the scenes "
                             "another name", study->stems[k]);
  }
  study->page.scene_names[k] = study->scenes[k].name;
  study->page.scene_stems[k] = study->stems[k];
  study->page.scene_count = ++study->scene_count;
  return PLACIDO_OK;
}

int study_read_scenes(struct study *study, placido_error *err) {
  const struct settings *settings = study->settings;
  const char *list = settings->study_scenes;
  list = list ? list : settings->quick ? quick : usual;
  int status = PLACIDO_OK;
  while (*list && status == PLACIDO_OK) {
    char name[1024];
    const size_t length = strcspn(list, ",");
    if (length == 0 || length >= sizeof name) {
      return placido_error_set(err, STATUS_USAGE, "--scenes: names between commas were expected");
    }
    snprintf(name, sizeof name, "%.*s", (int)length, list);
    status = read_scene(study, name, err);
    list += length + (list[length] == ',');
  }
  return status;
}

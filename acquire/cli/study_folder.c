/* The surfaces of a folder: files, exams, or a folder of exams. */
#include "acquire/cli/study.h"
#include "base/memory.h"
#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define NAMES_MAX 100000

/* The entries of a folder. */
struct names {
  size_t count, room;
  char **items;
};

static void names_free(struct names *names) {
  for (size_t i = 0; i < names->count; i++) {
    placido_memory_free(names->items[i]);
  }
  placido_memory_free(names->items);
}

static int add_name(struct names *names, const char *name, placido_error *err) {
  if (names->count == NAMES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "a folder of more than %d files", NAMES_MAX);
  }
  if (names->count == names->room) {
    const size_t room = names->room ? 2 * names->room : 64;
    char **items = placido_memory_grow(names->items, room, sizeof *items, err);
    if (!items) {
      return PLACIDO_MEMORY;
    }
    names->items = items;
    names->room = room;
  }
  char *copy = placido_memory_string(name, err);
  if (!copy) {
    return PLACIDO_MEMORY;
  }
  names->items[names->count++] = copy;
  return PLACIDO_OK;
}

static int compare(const void *a, const void *b) {
  return strcmp(*(char *const *)a, *(char *const *)b);
}

static int read_names(struct names *names, const char *folder, placido_error *err) {
  DIR *listing = opendir(folder);
  if (!listing) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s: cannot be read as a folder: %s",
                             placido_text_tail(folder), strerror(errno));
  }
  int status = PLACIDO_OK;
  for (struct dirent *entry; status == PLACIDO_OK && (entry = readdir(listing));) {
    if (entry->d_name[0] != '.') {
      status = add_name(names, entry->d_name, err);
    }
  }
  closedir(listing);
  if (names->count > 0) {
    qsort(names->items, names->count, sizeof *names->items, compare);
  }
  return status;
}

static bool is_folder(const char *path) {
  struct stat found;
  return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

static bool is_there(const char *path) {
  struct stat found;
  return stat(path, &found) == 0;
}

/* Whether a file is well-formed and says that it is another of the project's formats. */
static bool is_other(const char *path) {
  json_t *root = json_load_file(path, 0, NULL);
  const char *format = json_string_value(json_object_get(root, "format"));
  const bool other = format && strncmp(format, "placido-", 8) == 0 &&
                     strncmp(format, "placido-surface/", 16) != 0;
  json_decref(root);
  return other;
}

static int add_file(struct study *study, const char *name, const char *path, placido_error *err) {
  const char *list = study->settings->study_eyes;
  if ((list && !study_is_listed(list, name)) || is_other(path)) {
    return PLACIDO_OK;
  }
  placido_study_eye *eye;
  int status = study_add(&eye, study, name, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_error reason = {0};
  snprintf(eye->source, sizeof eye->source, "%s", path);
  status = placido_surface_load(&study->surfaces[study->eye_count - 1], path,
                                &study->outcome->notes, &reason);
  if (status == PLACIDO_MEMORY) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  if (status != PLACIDO_OK) {
    snprintf(eye->failure, sizeof eye->failure, "%s", reason.text);
    placido_notes_add(&study->outcome->notes, "left out: %s", reason.text);
    study->failed++;
  }
  return PLACIDO_OK;
}

static int add_entry(struct study *study, const char *folder, const char *name,
                     placido_error *err) {
  char path[PLACIDO_PATH_MAX], surface[PLACIDO_PATH_MAX], stem[256];
  int status = placido_path_join(path, folder, name, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (is_folder(path)) {
    status = placido_path_join(surface, path, "surface.json", err);
    return status == PLACIDO_OK && is_there(surface) ? add_file(study, name, surface, err) : status;
  }
  const size_t length = strlen(name), ending = strlen(".json");
  if (length <= ending || strcmp(name + length - ending, ".json") != 0) {
    return PLACIDO_OK;
  }
  snprintf(stem, sizeof stem, "%.*s", (int)(length - ending), name);
  return add_file(study, stem, path, err);
}

/* --eyes names what is there. */
static int check_listed(const struct study *study, const char *folder, placido_error *err) {
  const char *list = study->settings->study_eyes;
  for (const char *at = list ? list : ""; *at;) {
    char name[256];
    bool found = false;
    const size_t length = strcspn(at, ",");
    snprintf(name, sizeof name, "%.*s", (int)length, at);
    for (size_t i = 0; i < study->eye_count; i++) {
      found = found || strcmp(study->eyes[i].name, name) == 0;
    }
    if (!found) {
      return placido_error_set(err, STATUS_USAGE, "--eyes: %s has no surface \"%s\"",
                               placido_text_tail(folder), name);
    }
    at += length + (at[length] == ',');
  }
  return PLACIDO_OK;
}

static int check_found(const struct study *study, const char *folder, placido_error *err) {
  if (study->eye_count == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: holds no surface (placido-surface/1), nor "
                             "exams", placido_text_tail(folder));
  }
  if (study->failed == study->eye_count) {
    return placido_error_set(err, PLACIDO_INPUT, "no surface can be read: %s",
                             study->eyes[0].failure);
  }
  return PLACIDO_OK;
}

int study_list_folder(struct study *study, const char *folder, placido_error *err) {
  struct names names = {0};
  int status = read_names(&names, folder, err);
  for (size_t i = 0; i < names.count && status == PLACIDO_OK; i++) {
    status = add_entry(study, folder, names.items[i], err);
  }
  names_free(&names);
  if (status == PLACIDO_OK) {
    status = check_listed(study, folder, err);
  }
  return status == PLACIDO_OK ? check_found(study, folder, err) : status;
}

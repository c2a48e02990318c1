/* Directories that appear whole or not at all: filled under a temporary name, then renamed. */
#include "base/file.h"
#include "base/temporary.h"
#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int refuse_write(const char *path, int cause, placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(path),
                           strerror(cause));
}

static bool is_dot(const char *name) {
  return strcmp(name, ".") == 0 || strcmp(name, "..") == 0;
}

/* 1 where the directory has nothing in it, 0 where it has, -1 where it cannot be read. */
static int is_empty(const char *path) {
  DIR *listing = opendir(path);
  if (!listing) {
    return -1;
  }
  int empty = 1;
  for (struct dirent *entry; empty && (entry = readdir(listing));) {
    empty = is_dot(entry->d_name);
  }
  closedir(listing);
  return empty;
}

/* Removes a tree; what cannot be removed stays. Links are removed, not followed. */
static void remove_tree(const char *path) {
  struct stat found;
  if (lstat(path, &found) != 0) {
    return;
  }
  if (!S_ISDIR(found.st_mode)) {
    unlink(path);
    return;
  }
  DIR *listing = opendir(path);
  if (listing) {
    char child[PLACIDO_PATH_MAX];
    for (struct dirent *entry; (entry = readdir(listing));) {
      if (!is_dot(entry->d_name) && !placido_path_join(child, path, entry->d_name, NULL)) {
        remove_tree(child);
      }
    }
    closedir(listing);
  }
  rmdir(path);
}

/* Whether a path that exists may be put aside for a new directory. */
static int check_replaceable(const char *path, const char *replaceable, placido_error *err) {
  int empty = is_empty(path);
  if (empty < 0) {
    return refuse_write(path, errno == ENOTDIR ? EEXIST : errno, err);
  }
  if (empty) {
    return PLACIDO_OK;
  }
  if (!replaceable) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s exists and is not empty: not overwritten",
                             placido_text_tail(path));
  }
  char marker[PLACIDO_PATH_MAX];
  int status = placido_path_join(marker, path, replaceable, err);
  if (!status && access(marker, F_OK) != 0) {
    status = placido_error_set(err, PLACIDO_SYSTEM,
                               "%s exists, and there is no %s in it: not overwritten",
                               placido_text_tail(path), replaceable);
  }
  return status;
}

/* The final name: without trailing slashes, and of what exists the place itself, not a link. */
static int final_name(char *out, const char *path, placido_error *err) {
  if (realpath(path, out)) {
    return PLACIDO_OK;
  }
  int length = snprintf(out, PLACIDO_PATH_MAX, "%s", path);
  if (length < 1 || length >= PLACIDO_PATH_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "the output directory's name is %s",
                             length < 1 ? "empty" : "too long");
  }
  while (length > 1 && out[length - 1] == '/') {
    out[--length] = '\0';
  }
  return PLACIDO_OK;
}

int placido_directory_create(placido_directory *directory, const char *path,
                             const char *replaceable, placido_error *err) {
  *directory = (placido_directory){0};
  int status = final_name(directory->path, path, err);
  struct stat found;
  if (!status && lstat(directory->path, &found) == 0) {
    status = check_replaceable(directory->path, replaceable, err);
  }
  for (int attempt = 0; !status; attempt++) {
    status = placido_temporary_name(directory->temporary, directory->path, attempt, "tmp", err);
    if (status || mkdir(directory->temporary, 0777) == 0) {
      break;
    }
    if (errno != EEXIST || attempt >= PLACIDO_TEMPORARY_ATTEMPTS) {
      status = refuse_write(path, errno, err);
    }
  }
  if (status) {
    directory->temporary[0] = '\0';
  }
  return status;
}

/* Puts what stands at `path` aside, the new directory there, and only then removes the old one. */
static int replace(const placido_directory *directory) {
  char old[PLACIDO_PATH_MAX];
  int moved = -1;
  for (int attempt = 0; moved != 0; attempt++) {
    if (placido_temporary_name(old, directory->path, attempt, "old", NULL)) {
      return ENAMETOOLONG;
    }
    moved = rename(directory->path, old);
    if (moved != 0 && ((errno != EEXIST && errno != ENOTEMPTY) ||
                       attempt >= PLACIDO_TEMPORARY_ATTEMPTS)) {
      return errno;
    }
  }
  if (rename(directory->temporary, directory->path) != 0) {
    int cause = errno;
    return rename(old, directory->path) == 0 ? cause : errno;
  }
  remove_tree(old);
  return 0;
}

int placido_directory_commit(placido_directory *directory, placido_error *err) {
  int cause = rename(directory->temporary, directory->path) == 0 ? 0 : errno;
  if (cause == ENOTEMPTY || cause == EEXIST) {
    cause = replace(directory);
  }
  if (cause) {
    placido_directory_discard(directory);
    return refuse_write(directory->path, cause, err);
  }
  directory->temporary[0] = '\0';
  return PLACIDO_OK;
}

void placido_directory_discard(placido_directory *directory) {
  if (directory && directory->temporary[0]) {
    remove_tree(directory->temporary);
    directory->temporary[0] = '\0';
  }
}

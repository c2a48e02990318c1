/* Files and folders of a session on the disk. */
#include "base/session/disk.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int placido_disk_sync(const char *path, placido_error *err) {
  int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  int cause = descriptor < 0 || fsync(descriptor) != 0 ? errno : 0;
  if (descriptor >= 0) {
    close(descriptor);
  }
  if (cause) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", placido_text_tail(path),
                             strerror(cause));
  }
  return PLACIDO_OK;
}

int placido_disk_copy(const char *to, const char *from, placido_error *err) {
  char *bytes;
  size_t size;
  placido_file file = {0};
  int status = placido_file_read(&bytes, &size, from, 0, err);
  if (!status) {
    status = placido_file_create(&file, to, err);
  }
  if (!status) {
    fwrite(bytes, 1, size, file.stream); /* commit looks whether it went well */
    status = placido_file_commit(&file, err);
  }
  if (!status) {
    status = placido_disk_sync(to, err);
  }
  placido_memory_free(bytes);
  return status;
}

static bool is_among(const char *name, const char *const *names) {
  for (; *names; names++) {
    if (strcmp(name, *names) == 0) {
      return true;
    }
  }
  return false;
}

static int copy_entry(const char *to, const char *from, const char *name, placido_notes *notes,
                      placido_error *err) {
  char source[PLACIDO_PATH_MAX], target[PLACIDO_PATH_MAX];
  struct stat found;
  int status = placido_path_join(source, from, name, err);
  if (!status) {
    status = placido_path_join(target, to, name, err);
  }
  if (!status && (lstat(source, &found) != 0 || !S_ISREG(found.st_mode))) {
    placido_notes_add(notes, "%s is no regular file: not copied", placido_text_tail(source));
    return PLACIDO_OK;
  }
  return status ? status : placido_disk_copy(target, source, err);
}

int placido_disk_copy_folder(const char *to, const char *from, const char *const *except,
                             placido_notes *notes, placido_error *err) {
  static const char *const dots[] = {".", "..", NULL};
  DIR *listing = opendir(from);
  if (!listing) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot read %s: %s", placido_text_tail(from),
                             strerror(errno));
  }
  int status = PLACIDO_OK;
  for (struct dirent *entry; !status && (entry = readdir(listing));) {
    if (!is_among(entry->d_name, dots) && !is_among(entry->d_name, except)) {
      status = copy_entry(to, from, entry->d_name, notes, err);
    }
  }
  closedir(listing);
  return status;
}

int placido_disk_check_folder(const char *path, placido_error *err) {
  struct stat found;
  int cause = stat(path, &found) != 0 ? errno : S_ISDIR(found.st_mode) ? 0 : ENOTDIR;
  if (cause) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot open the session %s: %s",
                             placido_text_tail(path), strerror(cause));
  }
  return PLACIDO_OK;
}

int placido_disk_check_regular(const char *path, placido_error *err) {
  struct stat found;
  if (stat(path, &found) == 0 && !S_ISREG(found.st_mode)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s is not a regular file",
                             placido_text_tail(path));
  }
  return PLACIDO_OK;
}

bool placido_disk_has(const char *folder, const char *name) {
  char path[PLACIDO_PATH_MAX];
  return placido_path_join(path, folder, name, NULL) == PLACIDO_OK && access(path, F_OK) == 0;
}

int64_t placido_disk_size(const char *folder, const char *name) {
  char path[PLACIDO_PATH_MAX];
  struct stat found;
  bool there = placido_path_join(path, folder, name, NULL) == PLACIDO_OK &&
               stat(path, &found) == 0;
  return there ? (int64_t)found.st_size : 0;
}

/* Plans that were measured for this machine, kept in a file: opt-in, as measuring finds another
 * plan each time, and another plan rounds otherwise.
 *
 * The file holds FFTW's own text for one precision. It is read and replaced whole; of two programs
 * that measure at once the later one's stays, and the other's is measured again some day. */
#include "simulate/convolve/wisdom.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "simulate/fft.h"

#include <placido/convolution.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const size_t file_size_max = 4 << 20;

int placido_wisdom_folder(char *folder, size_t size, placido_error *err) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  int length = -1;
  folder[0] = '\0';
  if (cache != NULL && cache[0] == '/') { /* a relative one is to be ignored, says the standard */
    length = snprintf(folder, size, "%s/placido", cache);
  } else if (home != NULL && home[0] == '/') {
    length = snprintf(folder, size, "%s/.cache/placido", home);
  }
  if (length < 0 || (size_t)length >= size) {
    folder[0] = '\0';
    return placido_error_set(err, PLACIDO_SYSTEM,
                             length < 0 ? "neither XDG_CACHE_HOME nor HOME names a folder"
                                        : "the cache folder's name is too long");
  }
  return PLACIDO_OK;
}

/* Makes a folder and those above it, for the user alone as caches are. */
static int make_folder(const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int length = snprintf(path, sizeof path, "%s", folder);
  if (length < 1 || length >= (int)sizeof path) {
    return placido_error_set(err, PLACIDO_INPUT, "the folder's name is %s",
                             length < 1 ? "empty" : "too long");
  }
  for (char *end = path + 1; end != NULL;) {
    end = strchr(end, '/');
    if (end != NULL) {
      *end = '\0';
    }
    if (mkdir(path, 0700) != 0 && errno != EEXIST) {
      return placido_error_set(err, PLACIDO_SYSTEM, "cannot make %s: %s", placido_text_tail(path),
                               strerror(errno));
    }
    if (end != NULL) {
      *end++ = '/';
    }
  }
  return PLACIDO_OK;
}

static int find_file(char *path, const char *folder, const placido_precision *precision,
                     placido_error *err) {
  char name[64];
  snprintf(name, sizeof name, "fftw-%s.wisdom", precision->name);
  return placido_path_join(path, folder, name, err);
}

static bool exists(const char *path) {
  struct stat found;
  return stat(path, &found) == 0;
}

/* The file's text, or NULL where there is none. */
static char *read_file(const char *path, placido_notes *notes) {
  placido_error reason = {0};
  char *text = NULL;
  size_t size;
  if (exists(path) && placido_file_read(&text, &size, path, file_size_max, &reason) != PLACIDO_OK) {
    placido_notes_add(notes, "measured transforms are not used: %s", reason.text);
  }
  return text;
}

static int write_file(const char *path, const char *text, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status == PLACIDO_OK) {
    fputs(text, file.stream); /* the commit sees whether it went well */
    status = placido_file_commit(&file, err);
  }
  return status;
}

static void keep(const char *folder, const char *path, const char *text, placido_notes *notes) {
  placido_error reason = {0};
  if (make_folder(folder, &reason) != PLACIDO_OK || write_file(path, text, &reason) != PLACIDO_OK) {
    placido_notes_add(notes, "measured transforms are not kept: %s", reason.text);
  }
}

/* With `known` (may be NULL) as all the wisdom there is: what is known then, to be freed. */
static char *measure(placido_plans *plans, const placido_precision *precision,
                     const placido_workspace *work, const char *known, const char *path,
                     placido_notes *notes, bool *made) {
  placido_fft_lock();
  char *others = precision->wisdom_get();
  precision->wisdom_forget();
  bool broken = known != NULL && !precision->wisdom_put(known);
  *made = precision->make_plans(plans, work, true);
  char *after = precision->wisdom_get();
  precision->wisdom_forget();
  if (others != NULL) {
    precision->wisdom_put(others);
  }
  placido_fft_unlock();
  free(others); /* FFTW's own allocation */
  if (broken) {
    placido_notes_add(notes, "%s is no wisdom of this FFTW: not used", placido_text_tail(path));
  }
  return after;
}

static bool make_measured(placido_plans *plans, const placido_precision *precision,
                          const placido_workspace *work, const char *folder, placido_notes *notes) {
  char path[PLACIDO_PATH_MAX];
  placido_error reason = {0};
  bool made;
  if (find_file(path, folder, precision, &reason) != PLACIDO_OK) {
    placido_notes_add(notes, "measured transforms are not kept: %s", reason.text);
    path[0] = '\0';
  }
  char *known = path[0] != '\0' ? read_file(path, notes) : NULL;
  char *after = measure(plans, precision, work, known, path, notes, &made);
  /* FFTW writes what it knows in any order: only something new makes it longer. */
  bool learned = after != NULL && (known == NULL || strlen(known) != strlen(after));
  if (made && learned && path[0] != '\0') {
    keep(folder, path, after, notes);
  }
  free(after); /* FFTW's own allocation */
  placido_memory_free(known);
  return made;
}

static bool make_estimated(placido_plans *plans, const placido_precision *precision,
                           const placido_workspace *work) {
  placido_fft_lock();
  bool made = precision->make_plans(plans, work, false);
  placido_fft_unlock();
  return made;
}

int placido_plans_new(placido_plans *plans, const placido_shape *shape,
                      const placido_precision *precision, const placido_workspace *work,
                      const char *folder, placido_notes *notes, placido_error *err) {
  *plans = (placido_plans){.shape = *shape};
  bool made = folder != NULL ? make_measured(plans, precision, work, folder, notes)
                             : make_estimated(plans, precision, work);
  if (!made) {
    placido_plans_free(plans, precision);
    return placido_error_set(err, PLACIDO_MEMORY, "no transform of %d by %d samples could be made",
                             shape->columns, shape->rows);
  }
  return PLACIDO_OK;
}

void placido_plans_free(placido_plans *plans, const placido_precision *precision) {
  placido_fft_lock();
  precision->free_plans(plans);
  placido_fft_unlock();
  *plans = (placido_plans){0};
}

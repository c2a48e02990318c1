/* The files of a result: a list of independent jobs, run side by side. */
#ifndef PLACIDO_CLI_SAVE_H
#define PLACIDO_CLI_SAVE_H

#include "acquire/cli/examination.h"

#define JOBS_MAX 1024
#define JOB_NAME_SIZE 128

/* Writes one file; `a` and `b` say which (a map, a pupil and a scene). */
typedef int save_function(const struct examination *examination, size_t a, size_t b,
                          const char *path, placido_error *err);

struct job {
  save_function *save;
  size_t a, b;
  char name[JOB_NAME_SIZE]; /* of the file within the directory */
};

struct jobs {
  size_t count;
  struct job items[JOBS_MAX];
};

/* Adds a job whose file is named like printf does. What does not fit any more is counted and makes
 * the run fail. */
#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
void jobs_add(struct jobs *jobs, save_function *save, size_t a, size_t b, const char *format, ...);

#endif

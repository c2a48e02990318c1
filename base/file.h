/* Files and directories that appear whole or not at all: written under a temporary name beside
 * their place, then renamed. */
#ifndef PLACIDO_BASE_FILE_H
#define PLACIDO_BASE_FILE_H

#include <placido/status.h>
#include <stddef.h>
#include <stdio.h>

#define PLACIDO_PATH_MAX 4096

/* A file being written. */
typedef struct placido_file {
  FILE *stream;
  char path[PLACIDO_PATH_MAX], temporary[PLACIDO_PATH_MAX];
} placido_file;

/* Opens a temporary file beside `path`. End with commit or discard. */
int placido_file_create(placido_file *file, const char *path, placido_error *err);
/* Flushes, checks every write, and renames to the final name; on failure the temporary is removed.
 * The stream is closed whatever the status. */
int placido_file_commit(placido_file *file, placido_error *err);
/* Removes the temporary file; legal after commit and on a zeroed struct. */
void placido_file_discard(placido_file *file);

/* Reads a whole file; `*text` gets a zero byte behind its `*size` bytes. Free with
 * placido_memory_free. Refuses files over `limit` bytes (0: 1 GiB). */
int placido_file_read(char **text, size_t *size, const char *path, size_t limit,
                      placido_error *err);

/* A directory being written. */
typedef struct placido_directory {
  char path[PLACIDO_PATH_MAX], temporary[PLACIDO_PATH_MAX];
} placido_directory;

/* Makes a temporary directory beside `path`; the caller writes into directory->temporary. Refuses,
 * before any work, a `path` that cannot be written and one that exists, unless it is an empty
 * directory or holds a file called `replaceable` (may be NULL): then commit puts the new one in its
 * place. */
int placido_directory_create(placido_directory *directory, const char *path,
                             const char *replaceable, placido_error *err);
int placido_directory_commit(placido_directory *directory, placido_error *err);
/* Removes the temporary directory and what is in it; legal after commit and on a zeroed struct. */
void placido_directory_discard(placido_directory *directory);

/* Joins "folder/name" into `out` of PLACIDO_PATH_MAX bytes; PLACIDO_INPUT where it is too long. */
int placido_path_join(char *out, const char *folder, const char *name, placido_error *err);

#endif

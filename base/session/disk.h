/* Files and folders of a session on the disk: whole, and there after a power cut. */
#ifndef PLACIDO_BASE_SESSION_DISK_H
#define PLACIDO_BASE_SESSION_DISK_H

#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

/* Puts a finished file, or the names in a folder, on the disk. */
int placido_disk_sync(const char *path, placido_error *err);

/* Copies a file byte for byte, by way of a temporary name, and puts the copy on the disk. */
int placido_disk_copy(const char *to, const char *from, placido_error *err);

/* Copies the regular files of a folder but those named in `except` (NULL-terminated), into a folder
 * that is there; what is no regular file is left out with a note. */
int placido_disk_copy_folder(const char *to, const char *from, const char *const *except,
                             placido_notes *notes, placido_error *err);

/* PLACIDO_SYSTEM where `path` is no folder. */
int placido_disk_check_folder(const char *path, placido_error *err);

/* PLACIDO_INPUT where `path` is there and no regular file: a demuxer would wait for ever at a
 * pipe. */
int placido_disk_check_regular(const char *path, placido_error *err);

bool placido_disk_has(const char *folder, const char *name);

/* Bytes of a file, 0 where it is not there. */
int64_t placido_disk_size(const char *folder, const char *name);

#endif

/* A directory of a test's own, gone when the test ends. */
#ifndef PLACIDO_TESTS_BASE_SCRATCH_H
#define PLACIDO_TESTS_BASE_SCRATCH_H

#include <stddef.h>

/* cmocka's setup and teardown: `*state` is the directory. */
int scratch_setup(void **state);
int scratch_teardown(void **state);

/* The path of a name in the directory; free with free. */
char *scratch_path(void **state, const char *name);

/* Writes a file into the directory and returns its path; free with free. */
char *scratch_write(void **state, const char *name, const void *bytes, size_t size);
char *scratch_write_text(void **state, const char *name, const char *text);

/* How many files and directories stand directly in a directory. */
size_t scratch_count(const char *path);

#endif

/* Files for readers that take paths, and what must be true of every reader's answer. */
#ifndef PLACIDO_TESTS_FUZZ_FILES_H
#define PLACIDO_TESTS_FUZZ_FILES_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Stops the program, as a fuzzer understands it, where the truth named is none. */
#define FUZZ_REQUIRE(truth) fuzz_require((truth), #truth, __FILE__, __LINE__)
void fuzz_require(bool truth, const char *text, const char *file, int line);

/* A status that is one, and on failure one line that says why. True on PLACIDO_OK. */
bool fuzz_check(int status, const placido_error *err);

/* The path of a file in a folder of this process alone, which goes when the process ends. Valid
 * until the name is asked for four more times. */
const char *fuzz_path(const char *name);

/* The same, with these bytes in it. */
const char *fuzz_file(const char *name, const void *bytes, size_t size);

/* Removes a file, or a folder with all that is in it. */
void fuzz_remove(const char *path);

/* Whether two files hold the same bytes. */
bool fuzz_same(const char *first, const char *second);

/* The next part of an input that holds several files: up to a record separator (ASCII 30), or to
 * the end. Moves `*data` and `*size` behind it; an input that is used up gives empty parts. */
const uint8_t *fuzz_part(size_t *part_size, const uint8_t **data, size_t *size);

/* The next byte, 0 where there is none. */
uint8_t fuzz_byte(const uint8_t **data, size_t *size);

#endif

/* Allocation that tests can make fail: every allocation of the project's C code comes from here. */
#ifndef PLACIDO_BASE_MEMORY_H
#define PLACIDO_BASE_MEMORY_H

#include <placido/status.h>
#include <stddef.h>

/* Room for `count` elements of `size` bytes each, zeroed; NULL with the error set to
 * PLACIDO_MEMORY when there is none or the product overflows. count 0 gives one byte.
 * Free with placido_memory_free. */
void *placido_memory_new(size_t count, size_t size, placido_error *err);

/* `bytes` bytes, not initialised, at a multiple of 64; NULL with the error set. For samples, which
 * are read by vector instructions. Free with placido_memory_free. */
void *placido_memory_new_aligned(size_t bytes, placido_error *err);

/* Like realloc for an array; the old block stays valid where NULL comes back. New bytes are not
 * initialised. */
void *placido_memory_grow(void *block, size_t count, size_t size, placido_error *err);

/* A copy of a string; NULL with the error set. */
char *placido_memory_string(const char *text, placido_error *err);

void placido_memory_free(void *block);

/* For tests: the n-th allocation from now fails, once (1 = the next); 0 switches it off. Returns
 * how many allocations were made since the last call. Process-wide and atomic: the one mutable
 * state of the libraries, because an allocator is shared by nature. */
unsigned long placido_memory_fail_at(unsigned long n);

#endif

/* Allocation that tests can make fail at a chosen place. */
#include "base/memory.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define ALIGNMENT_BYTES 64 /* a cache line, and the widest vector registers */

static atomic_ulong allocations_made;
static atomic_ulong allocations_until_failure; /* 0: none will fail */

unsigned long placido_memory_fail_at(unsigned long n) {
  atomic_store(&allocations_until_failure, n);
  return atomic_exchange(&allocations_made, 0);
}

/* Counts an allocation; false where this is the one that a test wants to fail. */
static bool permit(void) {
  atomic_fetch_add(&allocations_made, 1);
  unsigned long left = atomic_load(&allocations_until_failure);
  while (left > 0) {
    if (atomic_compare_exchange_weak(&allocations_until_failure, &left, left - 1)) {
      return left != 1;
    }
  }
  return true;
}

/* The bytes of an array, at least 1; false where the product overflows. */
static bool array_bytes(size_t *bytes, size_t count, size_t size) {
  if (size != 0 && count > PTRDIFF_MAX / size) {
    return false;
  }
  *bytes = count * size > 0 ? count * size : 1;
  return true;
}

static void refuse(size_t count, size_t size, placido_error *err) {
  placido_error_set(err, PLACIDO_MEMORY, "out of memory (%zu elements of %zu bytes)", count, size);
}

void *placido_memory_new(size_t count, size_t size, placido_error *err) {
  size_t bytes;
  void *block = NULL;
  if (permit() && array_bytes(&bytes, count, size)) {
    block = calloc(1, bytes);
  }
  if (!block) {
    refuse(count, size, err);
  }
  return block;
}

void *placido_memory_new_aligned(size_t bytes, placido_error *err) {
  void *block = NULL;
  if (!permit() || bytes > PTRDIFF_MAX ||
      posix_memalign(&block, ALIGNMENT_BYTES, bytes > 0 ? bytes : 1) != 0) {
    block = NULL;
    refuse(bytes, 1, err);
  }
  return block;
}

void *placido_memory_grow(void *block, size_t count, size_t size, placido_error *err) {
  size_t bytes;
  void *grown = NULL;
  if (permit() && array_bytes(&bytes, count, size)) {
    grown = realloc(block, bytes);
  }
  if (!grown) {
    refuse(count, size, err);
  }
  return grown;
}

char *placido_memory_string(const char *text, placido_error *err) {
  size_t bytes = strlen(text) + 1;
  char *copy = placido_memory_new(bytes, 1, err);
  if (copy) {
    memcpy(copy, text, bytes);
  }
  return copy;
}

void placido_memory_free(void *block) {
  free(block);
}

/* A camera that is a piece of memory: descriptions are tried on it. */
#ifndef PLACIDO_TESTS_GENICAM_MEMORY_PORT_H
#define PLACIDO_TESTS_GENICAM_MEMORY_PORT_H

#include "drivers/genicam/genicam.h"

#define MEMORY_BYTES 4096

struct memory {
  uint8_t bytes[MEMORY_BYTES];
  placido_genicam_port port;
  unsigned reads, writes;
  unsigned until_failure;     /* the access that fails, from 1; 0: none */
  uint64_t address;           /* of the last access */
  size_t size;
  placido_genicam *features;
  placido_error err;
};

/* Starts with zeros everywhere. */
void memory_reset(struct memory *memory);

/* Each asserts that reading succeeds; the nodes stand within a RegisterDescription. Close frees. */
void memory_open_file(struct memory *memory, const char *name);
void memory_open_nodes(struct memory *memory, const char *nodes);
void memory_close(struct memory *memory);

/* Reads the nodes and returns the status; `features` is NULL where it fails. */
int memory_try(struct memory *memory, const char *nodes);

/* Numbers straight in memory. */
void memory_put(struct memory *memory, uint64_t address, size_t size, bool is_big_endian,
                uint64_t value);
uint64_t memory_take(const struct memory *memory, uint64_t address, size_t size,
                     bool is_big_endian);

/* Asserts that the feature can be read, and gives its value. */
int64_t integer_of(struct memory *memory, const char *name);
double float_of(struct memory *memory, const char *name);
placido_feature description_of(struct memory *memory, const char *name);

/* Asserts that a message has been set that contains `words`. */
void assert_says(const struct memory *memory, const char *words);

#endif

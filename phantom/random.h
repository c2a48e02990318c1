/* Random numbers from a counter: each is a function of its key alone, so that pictures do not
 * depend on the order or the number of threads that draw them. */
#ifndef PLACIDO_PHANTOM_RANDOM_H
#define PLACIDO_PHANTOM_RANDOM_H

#include <stdint.h>

/* What numbers are drawn for; keeps the sequences apart. */
enum placido_phantom_stream {
  PLACIDO_PHANTOM_LASHES = 1,
  PLACIDO_PHANTOM_FILM,
  PLACIDO_PHANTOM_MOVEMENT,
  PLACIDO_PHANTOM_NOISE = 1000, /* plus the number of the frame */
};

/* 64 random bits for the `counter`-th draw of `stream`. */
uint64_t placido_phantom_bits(uint64_t seed, uint64_t stream, uint64_t counter);

/* Uniform in [low, high). */
double placido_phantom_uniform(uint64_t seed, uint64_t stream, uint64_t counter, double low,
                               double high);

/* Normal with mean 0 and standard deviation 1, cut at 6.8 by the 32 bits it is made of. */
double placido_phantom_normal(uint64_t seed, uint64_t stream, uint64_t counter);

#endif

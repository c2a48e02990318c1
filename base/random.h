/* Random numbers from a counter: each is a function of its key alone, so that results do not
 * depend on the order or the number of threads that draw them. */
#ifndef PLACIDO_BASE_RANDOM_H
#define PLACIDO_BASE_RANDOM_H

#include <stdint.h>

/* 64 random bits for the `counter`-th draw of `stream`. */
uint64_t placido_random_bits(uint64_t seed, uint64_t stream, uint64_t counter);

/* Uniform in [low, high). */
double placido_random_uniform(uint64_t seed, uint64_t stream, uint64_t counter, double low,
                              double high);

/* Normal with mean 0 and standard deviation 1, cut at 6.8 by the 32 bits it is made of. */
double placido_random_normal(uint64_t seed, uint64_t stream, uint64_t counter);

#endif

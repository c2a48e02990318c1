/* Counter-based random numbers by hashing: the finaliser of SplitMix64 (Steele, Lea, Flood,
 * OOPSLA 2014), and normals by Box and Muller (Ann. Math. Stat. 29:610, 1958). */
#include "base/random.h"

#include <math.h>

static const double turn = 6.283185307179586;

static uint64_t mix(uint64_t bits) {
  bits += 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

uint64_t placido_random_bits(uint64_t seed, uint64_t stream, uint64_t counter) {
  return mix(mix(mix(seed) + stream) + counter);
}

double placido_random_uniform(uint64_t seed, uint64_t stream, uint64_t counter, double low,
                               double high) {
  double share = (double)(placido_random_bits(seed, stream, counter) >> 11) * 0x1p-53;
  return low + (high - low) * share;
}

double placido_random_normal(uint64_t seed, uint64_t stream, uint64_t counter) {
  uint64_t bits = placido_random_bits(seed, stream, counter);
  double length = ((double)(bits >> 32) + 0.5) * 0x1p-32; /* never 0: its logarithm is taken */
  double angle = (double)(bits & 0xffffffffu) * 0x1p-32;
  return sqrt(-2 * log(length)) * cos(turn * angle);
}

/* Loops over numbers that gain from wide vectors are compiled for several widths, and the processor
 * chooses when the program starts. Results are the same: every number is computed alone and in the
 * same order, and C11's strict mode contracts no products into sums. */
#ifndef PLACIDO_BASE_DISPATCH_H
#define PLACIDO_BASE_DISPATCH_H

#include <float.h>

/* Arithmetic as it must be everywhere: every number rounded to its own type (no x87), NaN missing.
 * tests/architecture looks at the options of every file. */
_Static_assert(FLT_EVAL_METHOD == 0, "numbers must be rounded to their type: -mfpmath=sse");
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "NaN means missing here: -ffast-math and -ffinite-math-only are out"
#endif

/* Other compilers, and the sanitizers, which come up after the choice is made, do without. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLACIDO_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PLACIDO_WIDE
#endif

/* What such a loop calls becomes part of it, else it is not compiled with it. */
#define PLACIDO_INSIDE static inline __attribute__((always_inline))

#endif

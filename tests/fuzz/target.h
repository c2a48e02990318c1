/* What a fuzz target is: a function of bytes that must not crash, hang or leak on any of them. */
#ifndef PLACIDO_TESTS_FUZZ_TARGET_H
#define PLACIDO_TESTS_FUZZ_TARGET_H

#include <stddef.h>
#include <stdint.h>

/* Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif

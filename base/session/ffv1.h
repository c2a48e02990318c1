/* The checksums of an FFV1 frame. */
#ifndef PLACIDO_BASE_SESSION_FFV1_H
#define PLACIDO_BASE_SESSION_FFV1_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Whether the slices of a packet (version 3) are as they were written. A file may be without
 * checksums; `*has_checksums`, false before its first packet, becomes true with the first slice
 * whose checksum is right, and only then are wrong ones taken for damage. */
bool placido_ffv1_check(const uint8_t *packet, size_t size, bool *has_checksums);

#endif

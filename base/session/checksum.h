/* The checksum of a frame's samples. */
#ifndef PLACIDO_BASE_SESSION_CHECKSUM_H
#define PLACIDO_BASE_SESSION_CHECKSUM_H

#include <placido/frame.h>
#include <stdint.h>

/* CRC-32 as zlib and PNG have it, of the rows without their padding, 16-bit samples with the low
 * byte first. */
uint32_t placido_frame_checksum(const placido_frame *frame);

#endif

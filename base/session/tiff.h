/* Grey frames as TIFF. */
#ifndef PLACIDO_BASE_SESSION_TIFF_H
#define PLACIDO_BASE_SESSION_TIFF_H

#include <placido/frame.h>
#include <placido/status.h>

/* Writes a MONO8 or MONO16 frame as it is, uncompressed, by way of a temporary name. PLACIDO_INPUT
 * (too large for the format), PLACIDO_SYSTEM. */
int placido_tiff_save(const placido_frame *frame, const char *path, placido_error *err);

#endif

/* What of an image file can be told without decoding it. */
#ifndef PLACIDO_BASE_IMAGE_CHECK_H
#define PLACIDO_BASE_IMAGE_CHECK_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* What the decoder has to know before it starts. */
typedef struct placido_image_kind {
  bool keeps_own_orientation; /* TIFF: its decoder turns the image itself */
  bool alpha;                 /* PNG with an alpha channel or a palette */
  bool multiplied;            /* TIFF: its colours are multiplied by alpha */
  int full_scale;             /* PNM: the sample value of white; 0: the type's largest */
} placido_image_kind;

/* Looks at the frame of a file's bytes: PLACIDO_INPUT where it is no image or its end is missing.
 * The decoders behind OpenCV print to stderr about such files, and fill the missing rest with grey.
 * `name` is the file's name for messages. */
int placido_image_check(placido_image_kind *kind, const unsigned char *bytes, size_t size,
                        const char *name, placido_error *err);

#endif

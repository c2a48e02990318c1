/* A picture as floating-point planes, for measuring and for simulation. */
#ifndef PLACIDO_IMAGE_H
#define PLACIDO_IMAGE_H

#include <placido/frame.h>
#include <placido/status.h>
#include <stddef.h>

/* Planar: sample (x, y) of plane c stands at data[(c * height_px + y) * width_px + x].
 * What the numbers mean is the user's business (linear light relative to white in simulate,
 * camera counts in reconstruct). */
typedef struct placido_image {
  int width_px, height_px;
  int planes; /* 1 grey, 3 red green blue, 4 with alpha */
  float *data;
} placido_image;

/* Allocates a zeroed image. Free with placido_image_free.
 * Returns PLACIDO_OK, PLACIDO_INPUT (size not within 1 to 65,536, planes not 1 to 4),
 * PLACIDO_MEMORY. */
int placido_image_new(placido_image *image, int width_px, int height_px, int planes,
                      placido_error *err);

/* Frees the samples and zeroes the struct. */
void placido_image_free(placido_image *image);

/* The first sample of plane `plane`. Borrowed from the image. */
float *placido_image_plane(const placido_image *image, int plane);

/* Reads PNG, TIFF, PGM/PPM, JPEG, 8 or 16 bit, and applies the EXIF orientation. Samples come
 * scaled to 0..1 of the file's full range, still encoded as in the file (no gamma undone);
 * 1, 3 or 4 planes, in the order red, green, blue, alpha. Free with placido_image_free.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM (cannot read), PLACIDO_INPUT (not an image), PLACIDO_MEMORY.
 */
int placido_image_load(placido_image *image, const char *path, placido_error *err);

/* The same, and the file's bits a sample: `*bits` is 8 or 16. Also reads TIFF of 32-bit floating
 * point, whose samples come as they stand, NaN and all: `*bits` is 32. Colours of a TIFF that were
 * multiplied by alpha are divided again. */
int placido_image_load_bits(placido_image *image, int *bits, const char *path, placido_error *err);

/* Writes an 8-bit PNG of samples clipped to 0..1, by way of a temporary name.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_MEMORY. */
int placido_image_save_png(const placido_image *image, const char *path, placido_error *err);

/* The same with 8 bits a sample, or with 16 where `bits` is more than 8. */
int placido_image_save_png_bits(const placido_image *image, int bits, const char *path,
                                placido_error *err);

/* sRGB (IEC 61966-2-1) to linear light and back, on the colour planes (a fourth plane, alpha, is
 * left as it is). In place. */
void placido_image_to_linear(placido_image *image);
void placido_image_to_srgb(placido_image *image);

/* Reads an image file as a camera frame: grey stays MONO8 or MONO16, colour becomes RGB8; EXIF
 * orientation applied. `frame` is the caller's. Errors as placido_image_load. */
int placido_frame_load(placido_frame *frame, const char *path, placido_error *err);

/* Writes a frame as PNG (8 or 16 bit), by way of a temporary name. */
int placido_frame_save_png(const placido_frame *frame, const char *path, placido_error *err);

#endif

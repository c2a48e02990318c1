/* OpenCV behind a C interface: plain arrays in and out. The one place that sees its C++ API. */
#ifndef PLACIDO_BASE_CV_H
#define PLACIDO_BASE_CV_H

#include <placido/frame.h>
#include <placido/image.h>
#include <placido/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How placido_cv_resize and placido_cv_remap take samples. */
enum placido_cv_sampling { PLACIDO_CV_LINEAR, PLACIDO_CV_CUBIC, PLACIDO_CV_AREA };

/* Decodes an image file (PNG, TIFF, PNM, JPEG), EXIF orientation applied. Grey of 8 or 16 bit, or
 * colour of 8 or 16 bit with or without alpha. Samples scaled to 0..1 in `image`; those of 32-bit
 * floating point (TIFF) as they stand, with *bits 32. */
int placido_cv_load(placido_image *image, int *bits, const char *path, placido_error *err);

/* The same file as a camera frame: grey of 8 bit MONO8, grey of 16 bit MONO16, colour RGB8 (of 16
 * bit the upper 8; alpha dropped). */
int placido_cv_load_frame(placido_frame *frame, const char *path, placido_error *err);

/* Encodes 8- or 16-bit samples, interleaved red-green-blue(-alpha), as PNG to exactly this path
 * (temporary names are the caller's affair). */
int placido_cv_save_png(const void *samples, int width_px, int height_px, int channels, int bits,
                        size_t stride_bytes, const char *path, placido_error *err);

/* Resamples every plane of `source` to the size of `target` (allocated by the caller). */
int placido_cv_resize(placido_image *target, const placido_image *source,
                      enum placido_cv_sampling sampling, placido_error *err);

/* target(x, y) = source(map_x(x, y), map_y(x, y)) for every plane; positions in pixels, (0, 0) the
 * centre of the top-left one; positions outside give `border`. Maps have the target's size. */
int placido_cv_remap(placido_image *target, const placido_image *source, const float *map_x,
                     const float *map_y, enum placido_cv_sampling sampling, float border,
                     placido_error *err);

/* Normalised, undistorted coordinates of `count` image points (u, v pairs) of a camera with focal
 * lengths, principal point and distortion (k1 k2 p1 p2 k3). */
int placido_cv_undistort(double *normalised_xy, const double *image_uv, size_t count,
                         const double focal_px[2], const double principal_px[2],
                         const double distortion[5], placido_error *err);

/* Gaussian blur of every plane in place, standard deviations in px; borders mirrored. */
int placido_cv_blur(placido_image *image, double sigma_x_px, double sigma_y_px,
                    placido_error *err);

#ifdef __cplusplus
}
#endif
#endif

/* Images and frames as files: decoding and encoding is OpenCV's, whole files are ours. */
#include <placido/frame.h>
#include <placido/image.h>

#include "base/cv/cv.h"
#include "base/file.h"
#include "base/memory.h"

#include <math.h>
#include <stdint.h>

int placido_image_load(placido_image *image, const char *path, placido_error *err) {
  int bits;
  return placido_cv_load(image, &bits, path, err);
}

int placido_frame_load(placido_frame *frame, const char *path, placido_error *err) {
  return placido_cv_load_frame(frame, path, err);
}

/* Interleaved samples to a PNG by way of a temporary name. */
static int save_png(const void *samples, int width_px, int height_px, int channels, int bits,
                    size_t stride_bytes, const char *path, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (!status) {
    status = placido_cv_save_png(samples, width_px, height_px, channels, bits, stride_bytes,
                                 file.temporary, err);
  }
  if (status) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}

/* A sample as a byte; NaN, which has no brightness, is black. */
static uint8_t byte_of(float sample) {
  if (!(sample > 0)) {
    return 0;
  }
  return sample >= 1 ? 255 : (uint8_t)lrintf(sample * 255);
}

int placido_image_save_png(const placido_image *image, const char *path, placido_error *err) {
  size_t width = (size_t)image->width_px, pixels = width * (size_t)image->height_px;
  /* PNG through OpenCV has 1, 3 or 4 channels: two planes have no meaning in a picture file. */
  if (image->planes == 2) {
    return placido_error_set(err, PLACIDO_INPUT, "an image of 2 planes cannot be a PNG file");
  }
  size_t planes = (size_t)image->planes;
  uint8_t *samples = placido_memory_new(pixels, planes, err);
  if (!samples) {
    return PLACIDO_MEMORY;
  }
  for (size_t c = 0; c < planes; c++) {
    const float *plane = placido_image_plane(image, (int)c);
    for (size_t i = 0; i < pixels; i++) {
      samples[i * planes + c] = byte_of(plane[i]);
    }
  }
  int status = save_png(samples, image->width_px, image->height_px, image->planes, 8,
                        width * planes, path, err);
  placido_memory_free(samples);
  return status;
}

int placido_frame_save_png(const placido_frame *frame, const char *path, placido_error *err) {
  int channels = frame->format == PLACIDO_RGB8 ? 3 : 1;
  int bits = frame->format == PLACIDO_MONO16 ? 16 : 8;
  return save_png(frame->data, frame->width_px, frame->height_px, channels, bits,
                  frame->stride_bytes, path, err);
}

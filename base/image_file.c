/* Images and frames as files: decoding and encoding is OpenCV's, whole files are ours. */
#include <placido/frame.h>
#include <placido/image.h>

#include "base/cv/cv.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

int placido_image_load_bits(placido_image *image, int *bits, const char *path,
                            placido_error *err) {
  return placido_cv_load(image, bits, path, err);
}

int placido_image_load(placido_image *image, const char *path, placido_error *err) {
  int bits;
  int status = placido_cv_load(image, &bits, path, err);
  if (!status && bits > 16) {
    placido_image_free(image);
    status = placido_error_set(err, PLACIDO_INPUT,
                               "%s: samples of 8 or 16 bit in 1, 3 or 4 channels are expected",
                               placido_text_tail(path));
  }
  return status;
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

/* A sample as a whole number up to `white`; NaN, which has no brightness, is black. */
static long whole_of(float sample, float white) {
  if (!(sample > 0)) {
    return 0;
  }
  return sample >= 1 ? (long)white : lrintf(sample * white);
}

static void pack_bytes(void *samples, const placido_image *image) {
  uint8_t *bytes = samples;
  size_t planes = (size_t)image->planes;
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  for (size_t c = 0; c < planes; c++) {
    const float *plane = placido_image_plane(image, (int)c);
    for (size_t i = 0; i < pixels; i++) {
      bytes[i * planes + c] = (uint8_t)whole_of(plane[i], UINT8_MAX);
    }
  }
}

static void pack_words(void *samples, const placido_image *image) {
  uint16_t *words = samples;
  size_t planes = (size_t)image->planes;
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  for (size_t c = 0; c < planes; c++) {
    const float *plane = placido_image_plane(image, (int)c);
    for (size_t i = 0; i < pixels; i++) {
      words[i * planes + c] = (uint16_t)whole_of(plane[i], UINT16_MAX);
    }
  }
}

int placido_image_save_png_bits(const placido_image *image, int bits, const char *path,
                                placido_error *err) {
  /* PNG through OpenCV has 1, 3 or 4 channels: two planes have no meaning in a picture file. */
  if (image->planes == 2) {
    return placido_error_set(err, PLACIDO_INPUT, "an image of 2 planes cannot be a PNG file");
  }
  const bool wide = bits > 8;
  size_t pixel_bytes = (size_t)image->planes * (wide ? 2 : 1);
  size_t stride_bytes = (size_t)image->width_px * pixel_bytes;
  void *samples = placido_memory_new((size_t)image->height_px, stride_bytes, err);
  if (!samples) {
    return PLACIDO_MEMORY;
  }
  (wide ? pack_words : pack_bytes)(samples, image);
  int status = save_png(samples, image->width_px, image->height_px, image->planes, wide ? 16 : 8,
                        stride_bytes, path, err);
  placido_memory_free(samples);
  return status;
}

int placido_image_save_png(const placido_image *image, const char *path, placido_error *err) {
  return placido_image_save_png_bits(image, 8, path, err);
}

int placido_frame_save_png(const placido_frame *frame, const char *path, placido_error *err) {
  int channels = frame->format == PLACIDO_RGB8 ? 3 : 1;
  int bits = frame->format == PLACIDO_MONO16 ? 16 : 8;
  return save_png(frame->data, frame->width_px, frame->height_px, channels, bits,
                  frame->stride_bytes, path, err);
}

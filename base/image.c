/* A picture as floating-point planes: room for it, and its way between sRGB and linear light
 * (IEC 61966-2-1:1999, section 5.2). */
#include <placido/image.h>

#include "base/memory.h"

#include <math.h>

#define SIDE_MAX_PX 65536

int placido_image_new(placido_image *image, int width_px, int height_px, int planes,
                      placido_error *err) {
  *image = (placido_image){0};
  if (width_px < 1 || height_px < 1 || width_px > SIDE_MAX_PX || height_px > SIDE_MAX_PX ||
      planes < 1 || planes > 4) {
    return placido_error_set(
        err, PLACIDO_INPUT,
        "an image of %d x %d pixels and %d planes: sides must be 1 to %d, planes 1 to 4", width_px,
        height_px, planes, SIDE_MAX_PX);
  }
  size_t row_bytes = (size_t)width_px * (size_t)planes * sizeof *image->data;
  float *data = placido_memory_new((size_t)height_px, row_bytes, err);
  if (!data) {
    return PLACIDO_MEMORY;
  }
  *image = (placido_image){
      .width_px = width_px, .height_px = height_px, .planes = planes, .data = data};
  return PLACIDO_OK;
}

void placido_image_free(placido_image *image) {
  if (!image) {
    return;
  }
  placido_memory_free(image->data);
  *image = (placido_image){0};
}

float *placido_image_plane(const placido_image *image, int plane) {
  return image->data + (size_t)plane * (size_t)image->width_px * (size_t)image->height_px;
}

static float srgb_to_linear(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : powf((encoded + 0.055f) / 1.055f, 2.4f);
}

static float linear_to_srgb(float light) {
  return light <= 0.0031308f ? light * 12.92f : 1.055f * powf(light, 1 / 2.4f) - 0.055f;
}

static void convert(placido_image *image, float (*curve)(float)) {
  size_t width = (size_t)image->width_px;
  long rows = (long)image->height_px * (image->planes < 4 ? image->planes : 3);
#pragma omp parallel for
  for (long row = 0; row < rows; row++) {
    float *samples = image->data + (size_t)row * width;
    for (size_t x = 0; x < width; x++) {
      samples[x] = curve(samples[x]);
    }
  }
}

void placido_image_to_linear(placido_image *image) {
  convert(image, srgb_to_linear);
}

void placido_image_to_srgb(placido_image *image) {
  convert(image, linear_to_srgb);
}

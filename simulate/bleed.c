/* Bleed as printers have it: put around a picture, and cut off again. */
#include "simulate/bleed.h"

#include <string.h>

static int within(int value, int size) {
  return value < 0 ? 0 : value < size ? value : size - 1;
}

int placido_bleed_widen(placido_image *wide, const placido_image *image, int more_px,
                        placido_error *err) {
  int status = placido_image_new(wide, image->width_px + 2 * more_px,
                                 image->height_px + 2 * more_px, image->planes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  float *to = wide->data;
  for (int plane = 0; plane < image->planes; plane++) {
    for (int y = 0; y < wide->height_px; y++, to += wide->width_px) {
      const float *from = placido_image_plane(image, plane) +
                          (size_t)within(y - more_px, image->height_px) * (size_t)image->width_px;
      for (int x = 0; x < wide->width_px; x++) {
        to[x] = from[within(x - more_px, image->width_px)];
      }
    }
  }
  return PLACIDO_OK;
}

void placido_bleed_cut(placido_image *image, int bleed_px) {
  const int width = image->width_px - 2 * bleed_px, height = image->height_px - 2 * bleed_px;
  float *to = image->data;
  for (int plane = 0; bleed_px > 0 && plane < image->planes; plane++) {
    const float *from = placido_image_plane(image, plane) + bleed_px +
                        (size_t)bleed_px * (size_t)image->width_px;
    for (int y = 0; y < height; y++, to += width, from += image->width_px) {
      memmove(to, from, (size_t)width * sizeof *to);
    }
  }
  image->width_px = width;
  image->height_px = height;
}

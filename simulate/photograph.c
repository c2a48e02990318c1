/* Photographs in linear light. */
#include "base/text.h"
#include "simulate/scene_file.h"

#include <math.h>

/* Samples that are no numbers, and darker than dark. */
typedef struct faults {
  size_t missing, negative;
} faults;

static faults count_faults(const placido_image *image) {
  size_t samples =
    (size_t)image->planes * (size_t)image->width_px * (size_t)image->height_px;
  faults found = {0, 0};
  for (size_t i = 0; i < samples; i++) {
    found.missing += !isfinite(image->data[i]);
    found.negative += image->data[i] < 0;
  }
  return found;
}

static void lift_negatives(placido_image *image) {
  size_t samples =
    (size_t)image->planes * (size_t)image->width_px * (size_t)image->height_px;
  for (size_t i = 0; i < samples; i++) {
    image->data[i] = fmaxf(image->data[i], 0);
  }
}

/* One such sample would spread over as much as the PSF, and by a transform over everything. */
static int check_floats(placido_image *image, const char *path, placido_notes *notes,
                        placido_error *err) {
  faults found = count_faults(image);
  const char *name = placido_text_tail(path);
  if (found.missing > 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %zu samples are not numbers (NaN or "
                             "infinite): light is expected in every pixel", name, found.missing);
  }
  if (found.negative > 0) {
    placido_notes_add(notes, "%s: %zu samples are below 0 and count as dark", name,
                      found.negative);
    lift_negatives(image);
  }
  return PLACIDO_OK;
}

int placido_photograph_load(placido_image *image, int *bits, const char *path,
                            placido_notes *notes, placido_error *err) {
  int status = placido_image_load_bits(image, bits, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (*bits < 32) {
    placido_image_to_linear(image);
    return PLACIDO_OK;
  }
  status = check_floats(image, path, notes, err);
  if (status != PLACIDO_OK) {
    placido_image_free(image);
  }
  return status;
}

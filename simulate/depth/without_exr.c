/* For builds without OpenEXR: its depth maps are refused with the reason. */
#include "simulate/depth/map.h"

int placido_depth_read_exr(placido_image *metres, const placido_depth_file *file, const int size[2],
                           placido_error *err) {
  (void)size;
  *metres = (placido_image){0};
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s: this build reads no EXR (OpenEXR was left out); PFM, TIFF of 32 "
                           "bits or PNG of 16 are expected", file->name);
}

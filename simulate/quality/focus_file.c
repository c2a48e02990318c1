/* A curve through focus on disk. */
#include <placido/quality.h>

#include "base/file.h"

int placido_focus_curve_save_csv(const placido_focus_curve *curve, const char *path,
                                 placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  fputs("lens_D,peak,visual_strehl,mtf_area\n", file.stream);
  for (int k = 0; k < curve->count; k++) {
    fprintf(file.stream, "%.17g,%.17g,%.17g,%.17g\n", curve->lens_D[k], curve->peak[k],
            curve->visual_strehl[k], curve->mtf_area[k]);
  }
  return placido_file_commit(&file, err);
}

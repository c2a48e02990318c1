/* mires.csv: every edge point, one row each. */
#include <placido/mires.h>

#include "base/file.h"

#include <math.h>

int placido_mires_save(const placido_mires *mires, const char *path, placido_error *err) {
  placido_file file = {0};
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fputs("edge,meridian_deg,u_px,v_px,sigma_px,used,residual_px\n", file.stream);
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    fprintf(file.stream, "%d,%.17g,%.17g,%.17g,%.17g,%d,", p->edge, p->meridian_deg, p->u_px,
            p->v_px, p->sigma_px, p->used);
    if (isfinite(p->residual_px)) {
      fprintf(file.stream, "%.17g", p->residual_px);
    }
    fputc('\n', file.stream);
  }
  return placido_file_commit(&file, err);
}

/* mires.csv: every edge point, one row each. */
#include <placido/mires.h>

#include "base/file.h"

#include <math.h>

static void write_point(FILE *stream, const placido_mire_point *p) {
  fprintf(stream, "%d,%.17g,%.17g,%.17g,%.17g,%d,", p->edge, p->meridian_deg, p->u_px, p->v_px,
          p->sigma_px, p->used);
  if (isfinite(p->residual_px)) {
    fprintf(stream, "%.17g", p->residual_px);
  }
  fputc('\n', stream);
}

static bool comes_first(const placido_mire_point *a, const placido_mire_point *b) {
  return a->edge != b->edge ? a->edge < b->edge : a->meridian_deg < b->meridian_deg;
}

int placido_mires_save(const placido_mires *mires, const char *path, placido_error *err) {
  placido_file file = {0};
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fputs("edge,meridian_deg,u_px,v_px,sigma_px,used,residual_px\n", file.stream);
  size_t i = 0, j = 0;
  while (i < mires->count || j < mires->doubtful_count) {
    bool doubtful = i == mires->count ||
                    (j < mires->doubtful_count &&
                     comes_first(&mires->doubtful[j], &mires->points[i]));
    write_point(file.stream, doubtful ? &mires->doubtful[j++] : &mires->points[i++]);
  }
  return placido_file_commit(&file, err);
}

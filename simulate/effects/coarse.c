/* Means of a coarse picture, whose last cells may stick out of the fine one. */
#include "simulate/effects/coarse.h"

#include <math.h>

/* Of cell number `cell` along a side of `length_px` pixels. */
static double filled(int cell, int length_px, double cell_px) {
  return fmin(fmax(length_px / cell_px - cell, 0), 1);
}

double placido_coarse_area(const placido_facts *facts, const placido_scene *scene, int column,
                           int row) {
  double cell_px = facts->cell_arcmin / scene->arcmin_per_px;
  return filled(column, scene->image.width_px, cell_px) *
         filled(row, scene->image.height_px, cell_px);
}

double placido_coarse_mean(const placido_facts *facts, const placido_scene *scene) {
  double sum = 0, whole = 0;
  for (int i = 0; i < facts->rows * facts->columns; i++) {
    double area = placido_coarse_area(facts, scene, i % facts->columns, i / facts->columns);
    sum += area * (double)facts->luminance[i];
    whole += area;
  }
  return whole > 0 ? sum / whole : 0;
}

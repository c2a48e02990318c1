/* The place is found on the coarse picture. What the field does grows at least linearly from the
 * middle outwards, and what is seen of it by no more than the square of that: so the cell where
 * contrast times squared distance is largest stands for all, whichever of the two is true. Were it
 * linear, cells that are nearer might matter more, by contrast times distance. */
#include "simulate/effects/aside.h"

#include "simulate/plan/nodes.h"

#include <math.h>

/* How much the light differs in a cell of the coarse picture and to the ones after it. */
static double contrast(const placido_facts *facts, int column, int row) {
  double most = -INFINITY, least = INFINITY;
  for (int i = 0; i < 4; i++) {
    int x = column + i % 2, y = row + i / 2;
    if (x < facts->columns && y < facts->rows) {
      most = fmax(most, (double)facts->most[y * facts->columns + x]);
      least = fmin(least, (double)facts->least[y * facts->columns + x]);
    }
  }
  return most - least;
}

/* The outer end of the two cells that are compared, from the middle of the picture, within what is
 * seen. */
static double outer_end(int cell, double cell_arcmin, double bleed_arcmin, double seen_arcmin) {
  double half = seen_arcmin / 2, begin = cell * cell_arcmin - bleed_arcmin - half;
  double end = begin + 2 * cell_arcmin;
  double outer = fabs(begin) > fabs(end) ? begin : end;
  return fmin(fmax(outer, -half), half);
}

/* What differs most in all of the scene. */
static double all_contrast(const placido_facts *facts) {
  double most = facts->brightest[0], least = facts->darkest[0];
  for (int plane = 1; plane < facts->planes; plane++) {
    most = fmax(most, facts->brightest[plane]);
    least = fmin(least, facts->darkest[plane]);
  }
  return most - least;
}

double placido_aside_deg(double field_deg[2], const placido_question *question) {
  const placido_facts *facts = question->facts;
  const double bleed_arcmin = question->scene->bleed_px * question->scene->arcmin_per_px;
  double squared = 0, linear = 0, way = 0;
  field_deg[0] = field_deg[1] = 0;
  for (int cell = 0; cell < facts->columns * facts->rows; cell++) {
    int column = cell % facts->columns, row = cell / facts->columns;
    double x = outer_end(column, facts->cell_arcmin, bleed_arcmin, 60 * facts->width_deg);
    double y = outer_end(row, facts->cell_arcmin, bleed_arcmin, 60 * facts->height_deg);
    double differs = contrast(facts, column, row), apart = hypot(x, y);
    linear = fmax(linear, differs * apart);
    if (differs * apart * apart > squared) {
      squared = differs * apart * apart;
      way = apart;
      placido_field_of_px(field_deg, x, y, 1);
    }
  }
  return squared > 0 ? fmin(linear / way / all_contrast(facts), 1) : 0;
}

/* How far each ray is seen from where it is in the middle. */
static void find_turns(float *turn_x, float *turn_y, const placido_question *question,
                       const placido_eye *eye, const placido_ocular *ocular,
                       const double field_deg[2]) {
  static const double middle_deg[2] = {0, 0}, no_offset[2] = {0, 0};
  const placido_sketch_rays *rays = question->rays;
  float x[PLACIDO_SKETCH_RAYS], y[PLACIDO_SKETCH_RAYS];
  placido_ocular_angles(x, y, rays->x_mm, rays->y_mm, rays->count, question->surface, eye, ocular,
                        middle_deg, no_offset);
  placido_ocular_angles(turn_x, turn_y, rays->x_mm, rays->y_mm, rays->count, question->surface, eye,
                        ocular, field_deg, no_offset);
  for (int i = 0; i < rays->count; i++) {
    turn_x[i] = isfinite(turn_x[i] - x[i]) ? turn_x[i] - x[i] : 0;
    turn_y[i] = isfinite(turn_y[i] - y[i]) ? turn_y[i] - y[i] : 0;
  }
}

double placido_aside_turns(float *turn_x, float *turn_y, const placido_question *question,
                           const placido_ocular *ocular, double retina_mm,
                           const double field_deg[2]) {
  const placido_sketch_rays *rays = question->rays;
  placido_ocular behind = *ocular;
  placido_eye eye = *question->eye;
  double weight = 0, mean_x = 0, mean_y = 0, square = 0;
  behind.curved = true;
  eye.retina_mm = retina_mm;
  find_turns(turn_x, turn_y, question, &eye, &behind, field_deg);
  for (int i = 0; i < rays->count; i++) {
    weight += (double)rays->weight[i];
    mean_x += (double)(rays->weight[i] * turn_x[i]);
    mean_y += (double)(rays->weight[i] * turn_y[i]);
  }
  for (int i = 0; i < rays->count; i++) {
    turn_x[i] -= (float)(mean_x / weight);
    turn_y[i] -= (float)(mean_y / weight);
    square += (double)(rays->weight[i] * (turn_x[i] * turn_x[i] + turn_y[i] * turn_y[i]));
  }
  return weight > 0 ? sqrt(square / weight) : 0;
}

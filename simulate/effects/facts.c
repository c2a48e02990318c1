/* One pass over a scene's picture: extremes and steps of its planes, and a coarse picture, a row of
 * cells at a time, so that it is read while it is near. */
#include "simulate/effects/facts.h"

#include "base/dispatch.h"
#include "simulate/canvas.h"

#include <math.h>

enum { STRIP = 1024, ROWS = 4 };

static const double to_luminance[3] = {0.2126, 0.7152, 0.0722}; /* ITU-R BT.709, linear light */

/* What is found of a plane. */
typedef struct extremes {
  float least, most, step;
} extremes;

/* For each column of a strip: what its samples in a row of cells come to. */
typedef struct strip {
  float sum[3][STRIP], most[STRIP], least[STRIP], colour[STRIP];
} strip;

/* The grid of the coarse picture over the fine one. */
typedef struct cells {
  double side_px;
  int columns, rows;
} cells;

PLACIDO_INSIDE float larger(float a, float b) { return a > b ? a : b; }
PLACIDO_INSIDE float smaller(float a, float b) { return a < b ? a : b; }

/* The largest step between a sample and the one to its right or below it. */
PLACIDO_INSIDE float step_at(const float *at, const float *below, int i) {
  return larger(fabsf(at[i + 1] - at[i]), fabsf(below[i] - at[i]));
}

/* ROWS rows of a plane and the one below them, `width` samples each. */
PLACIDO_WIDE static void scan_rows(extremes *found, const float *const rows[ROWS + 1], int width) {
  const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
  const int last = width - 1;
  float least = found->least, most = found->most, step = found->step;
#pragma omp simd reduction(min : least) reduction(max : most, step)
  for (int i = 0; i < last; i++) {
    least = smaller(least, smaller(smaller(a[i], b[i]), smaller(c[i], d[i])));
    most = larger(most, larger(larger(a[i], b[i]), larger(c[i], d[i])));
    step = larger(step, larger(larger(step_at(a, b, i), step_at(b, c, i)),
                               larger(step_at(c, d, i), step_at(d, e, i))));
  }
  for (int row = 0; row < ROWS; row++) {
    float value = rows[row][last];
    least = smaller(least, value);
    most = larger(most, value);
    step = larger(step, fabsf(rows[row + 1][last] - value));
  }
  *found = (extremes){least, most, step};
}

/* Rows from `first` to before `end` of a plane; below the picture its last row goes on. */
static void scan_plane(extremes *found, const placido_image *image, int plane, int first, int end) {
  const float *data = placido_image_plane(image, plane);
  for (int y = first; y < end; y += ROWS) {
    const float *rows[ROWS + 1];
    for (int row = 0; row <= ROWS; row++) {
      int at = y + row < image->height_px ? y + row : image->height_px - 1;
      rows[row] = data + (size_t)at * (size_t)image->width_px;
    }
    scan_rows(found, rows, image->width_px);
  }
}

PLACIDO_WIDE static void add_grey(strip *restrict s, const float *restrict grey, int count) {
#pragma omp simd
  for (int i = 0; i < count; i++) {
    s->sum[0][i] += grey[i];
    s->most[i] = larger(s->most[i], grey[i]);
    s->least[i] = smaller(s->least[i], grey[i]);
  }
}

PLACIDO_WIDE static void add_colours(strip *restrict s, const float *restrict red,
                                     const float *restrict green, const float *restrict blue,
                                     int count) {
#pragma omp simd
  for (int i = 0; i < count; i++) {
    float most = larger(larger(red[i], green[i]), blue[i]);
    float least = smaller(smaller(red[i], green[i]), blue[i]);
    s->sum[0][i] += red[i];
    s->sum[1][i] += green[i];
    s->sum[2][i] += blue[i];
    s->most[i] = larger(s->most[i], most);
    s->least[i] = smaller(s->least[i], least);
    s->colour[i] = larger(s->colour[i], most - least);
  }
}

static cells divide(const placido_image *image) {
  int longer = image->width_px > image->height_px ? image->width_px : image->height_px;
  double side_px = fmax((double)longer / PLACIDO_FACTS_SIDE, 1);
  cells grid = {side_px, (int)((image->width_px - 1) / side_px) + 1,
                (int)((image->height_px - 1) / side_px) + 1};
  grid.columns = grid.columns < PLACIDO_FACTS_SIDE ? grid.columns : PLACIDO_FACTS_SIDE;
  grid.rows = grid.rows < PLACIDO_FACTS_SIDE ? grid.rows : PLACIDO_FACTS_SIDE;
  return grid;
}

/* The first sample of cell `index`, of `count` over `length` samples. */
static int cell_start(const cells *grid, int index, int count, int length) {
  return index >= count ? length : (int)ceil(index * grid->side_px);
}

/* Adds columns from x on to the cells of a row; `light` gathers sums. */
static void flush(placido_facts *facts, const cells *grid, const strip *s, int x, int count,
                  int row, int width_px) {
  float colour = (float)facts->colour;
  int column = (int)(x / grid->side_px), i = 0;
  for (int cell = row * grid->columns + column; i < count; cell++, column++) {
    int end = cell_start(grid, column + 1, grid->columns, width_px) - x;
    for (end = end < count ? end : count; i < end; i++) {
      for (int plane = 0; plane < facts->planes; plane++) {
      facts->light[plane][cell] += s->sum[plane][i];
    }
      facts->most[cell] = larger(facts->most[cell], s->most[i]);
      facts->least[cell] = smaller(facts->least[cell], s->least[i]);
      colour = larger(colour, s->colour[i]);
    }
  }
  facts->colour = (double)colour;
}

static void clear(strip *s, int count) {
  for (int i = 0; i < count; i++) {
    s->sum[0][i] = s->sum[1][i] = s->sum[2][i] = s->colour[i] = 0;
    s->most[i] = -INFINITY;
    s->least[i] = INFINITY;
  }
}

/* The picture's rows from `first` to before `end`, which make a row of cells. */
static void fill_cells(placido_facts *facts, const placido_image *image, const cells *grid, int row,
                       int first, int end) {
  strip columns;
  for (int x = 0; x < image->width_px; x += STRIP) {
    int count = image->width_px - x < STRIP ? image->width_px - x : STRIP;
    clear(&columns, count);
    for (int y = first; y < end; y++) {
      size_t at = (size_t)y * (size_t)image->width_px + (size_t)x;
      const float *red = placido_image_plane(image, 0) + at;
      if (facts->planes == 1) {
        add_grey(&columns, red, count);
      } else {
        add_colours(&columns, red, placido_image_plane(image, 1) + at,
                    placido_image_plane(image, 2) + at, count);
      }
    }
    flush(facts, grid, &columns, x, count, row, image->width_px);
  }
}

/* The mean of a cell's planes as a luminance. */
static double luminance(const placido_facts *facts, int cell) {
  double sum = 0;
  if (facts->planes == 1) {
    return (double)facts->light[0][cell];
  }
  for (int plane = 0; plane < 3; plane++) {
    sum += to_luminance[plane] * (double)facts->light[plane][cell];
  }
  return sum;
}

/* Sums to means. */
static void average(placido_facts *facts, const cells *grid, const placido_image *image) {
  for (int row = 0; row < grid->rows; row++) {
    int height = cell_start(grid, row + 1, grid->rows, image->height_px) -
                 cell_start(grid, row, grid->rows, image->height_px);
    for (int column = 0; column < grid->columns; column++) {
      int width = cell_start(grid, column + 1, grid->columns, image->width_px) -
                  cell_start(grid, column, grid->columns, image->width_px);
      int cell = row * grid->columns + column;
      for (int plane = 0; plane < facts->planes; plane++) {
        facts->light[plane][cell] /= (float)width * (float)height;
      }
      facts->luminance[cell] = (float)luminance(facts, cell);
    }
  }
}

/* What shows through holes is not known: at their rims a step may be as large as can be. */
static bool has_holes(const placido_image *image) {
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  const float *alpha = image->planes == 4 ? placido_image_plane(image, 3) : NULL;
  float least = 1;
  for (size_t i = 0; alpha != NULL && i < pixels; i++) {
    least = alpha[i] < least ? alpha[i] : least;
  }
  return least < 1;
}

static void set_extremes(placido_facts *facts, const extremes found[3], bool holes) {
  for (int plane = 0; plane < facts->planes; plane++) {
    facts->darkest[plane] = holes ? fmin((double)found[plane].least, 0)
                                  : (double)found[plane].least;
    facts->brightest[plane] = (double)found[plane].most;
    facts->step[plane] = holes ? facts->brightest[plane] - facts->darkest[plane]
                               : (double)found[plane].step;
  }
}

static void scan(placido_facts *facts, const placido_image *image) {
  const cells grid = divide(image);
  const extremes none = {INFINITY, -INFINITY, 0};
  extremes found[3] = {none, none, none};
  facts->columns = grid.columns;
  facts->rows = grid.rows;
  for (int i = 0; i < grid.columns * grid.rows; i++) {
    facts->most[i] = -INFINITY;
    facts->least[i] = INFINITY;
  }
  for (int row = 0; row < grid.rows; row++) {
    int first = cell_start(&grid, row, grid.rows, image->height_px);
    int end = cell_start(&grid, row + 1, grid.rows, image->height_px);
    for (int plane = 0; plane < facts->planes; plane++) {
      scan_plane(&found[plane], image, plane, first, end);
    }
    fill_cells(facts, image, &grid, row, first, end);
  }
  average(facts, &grid, image);
  set_extremes(facts, found, has_holes(image));
}

/* Vergences of a depth map of `count` pixels. */
PLACIDO_WIDE static void scan_depth(placido_facts *facts, const float *depth_D, size_t count) {
  float nearest = -INFINITY, farthest = INFINITY;
#pragma omp simd reduction(max : nearest) reduction(min : farthest)
  for (size_t i = 0; i < count; i++) {
    nearest = larger(nearest, depth_D[i]);
    farthest = smaller(farthest, depth_D[i]);
  }
  facts->nearest_D = (double)nearest;
  facts->farthest_D = (double)farthest;
}

static double vergence_D(double distance_m) { return isfinite(distance_m) ? 1 / distance_m : 0; }

int placido_facts_find(placido_facts *facts, const placido_scene *scene, placido_error *err) {
  const placido_image *image = &scene->image;
  *facts = (placido_facts){0};
  if (image->data == NULL || image->width_px < 1 || image->height_px < 1 ||
      !(image->planes == 1 || image->planes == 3 || image->planes == 4)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "scene %s: %d by %d samples in %d planes, expected 1, 3 or 4 planes",
                             scene->name, image->width_px, image->height_px, image->planes);
  }
  int status = placido_scene_check_light(scene, err);
  if (status == PLACIDO_OK) {
    status = placido_scene_check_depth(scene, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  facts->planes = image->planes == 1 ? 1 : 3;
  facts->width_deg = (image->width_px - 2 * scene->bleed_px) * scene->arcmin_per_px / 60;
  facts->height_deg = (image->height_px - 2 * scene->bleed_px) * scene->arcmin_per_px / 60;
  facts->cell_arcmin = divide(image).side_px * scene->arcmin_per_px;
  facts->focus_D = vergence_D(scene->conditions.distance_m);
  facts->nearest_D = facts->farthest_D = facts->focus_D;
  if (scene->depth_D != NULL) {
    scan_depth(facts, scene->depth_D, (size_t)image->width_px * (size_t)image->height_px);
  }
  scan(facts, image);
  return PLACIDO_OK;
}

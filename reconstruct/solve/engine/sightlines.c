/* Newton's method along many rays at a time: rays that come far on the cornea ask the shape again,
 * where they are then. */
#include "reconstruct/solve/engine/sightlines.h"

#include "base/memory.h"
#include "reconstruct/solve/engine/batch.h"

#include <string.h>

#define BATCH PLACIDO_BATCH
#define CELL PLACIDO_SPLINE_CELL
#define TILES 40
#define TILE_MM 0.5
#define PASSES_MAX 30
/* A ray that meets the shape so near to where the shape was asked needs not ask again: its jet
 * there follows from the second derivatives, to 1e-9 of slope. */
#define ASIDE_MM 1e-4

/* The square of the cornea that a sample's ray starts from. */
static size_t tile_of(const placido_sample *s) {
  int at[2];
  for (int axis = 0; axis < 2; axis++) {
    double x_mm = s->ray.origin[axis] + s->t * s->ray.direction[axis];
    at[axis] = (int)fmax(0, fmin(TILES - 1, x_mm / TILE_MM + TILES / 2));
  }
  return (size_t)(at[1] * TILES + at[0]);
}

/* Counting sort of the samples by square. */
static void find_order(size_t *order, const placido_sample *samples, size_t count) {
  size_t starts[TILES * TILES + 1] = {0};
  for (size_t i = 0; i < count; i++) {
    starts[tile_of(&samples[i]) + 1]++;
  }
  for (size_t k = 0; k < TILES * TILES; k++) {
    starts[k + 1] += starts[k];
  }
  for (size_t i = 0; i < count; i++) {
    order[starts[tile_of(&samples[i])]++] = i;
  }
}

static void copy_ray(placido_sightlines *sightlines, size_t i, const placido_sample *s) {
  const placido_ray *ray = &s->ray;
  bool moves = ray->origin_u[0] != 0 || ray->origin_u[1] != 0;
  const double *by_u = moves ? ray->origin_u : ray->direction_u;
  const double *by_v = moves ? ray->origin_v : ray->direction_v;
  const double values[] = {
      ray->origin[0], ray->origin[1], ray->direction[0],  ray->direction[1], by_u[0],  by_u[1],
      by_v[0],        by_v[1],        s->edge->radius_mm, s->edge->z_mm,     s->noise, s->t};
  for (size_t k = 0; k < sizeof values / sizeof values[0]; k++) {
    sightlines->numbers[k][i] = values[k];
  }
  sightlines->used[i] = s->used;
  sightlines->origin_z_mm = ray->origin[2];
  sightlines->moves_origin = moves;
}

int placido_sightlines_new(placido_sightlines *sightlines, placido_sample *samples, size_t count,
                           placido_error *err) {
  *sightlines = (placido_sightlines){.samples = samples, .count = count, .starts_room = 2};
  double *block = placido_memory_new(count, PLACIDO_RAY_NUMBERS * sizeof *block, err);
  sightlines->numbers[0] = block;
  sightlines->sample = placido_memory_new(count, sizeof *sightlines->sample, err);
  sightlines->used = placido_memory_new(count, sizeof *sightlines->used, err);
  sightlines->chosen = placido_memory_new(count, sizeof *sightlines->chosen, err);
  sightlines->cells = placido_memory_new(count, sizeof *sightlines->cells, err);
  sightlines->order = placido_memory_new(count, sizeof *sightlines->order, err);
  sightlines->starts = placido_memory_new(sightlines->starts_room, sizeof *sightlines->starts, err);
  if (!block || !sightlines->sample || !sightlines->used || !sightlines->chosen ||
      !sightlines->cells || !sightlines->order || !sightlines->starts) {
    placido_sightlines_free(sightlines);
    return PLACIDO_MEMORY;
  }
  for (int k = 0; k < PLACIDO_RAY_NUMBERS; k++) {
    sightlines->numbers[k] = block + (size_t)k * count;
  }
  find_order(sightlines->sample, samples, count);
  for (size_t i = 0; i < count; i++) {
    copy_ray(sightlines, i, &samples[sightlines->sample[i]]);
  }
  return PLACIDO_OK;
}

void placido_sightlines_free(placido_sightlines *sightlines) {
  placido_memory_free(sightlines->numbers[0]);
  placido_memory_free(sightlines->cells);
  placido_memory_free(sightlines->sample);
  placido_memory_free(sightlines->used);
  placido_memory_free(sightlines->chosen);
  placido_memory_free(sightlines->order);
  placido_memory_free(sightlines->starts);
  *sightlines = (placido_sightlines){0};
}

static size_t cells_of(const placido_grid *grid) {
  return grid ? (size_t)grid->cells * (size_t)grid->cells : 1;
}

int placido_sightlines_fit_grid(placido_sightlines *sightlines, const placido_grid *grid,
                                placido_error *err) {
  size_t room = cells_of(grid) + 1;
  if (room <= sightlines->starts_room) {
    return PLACIDO_OK;
  }
  size_t *starts = placido_memory_grow(sightlines->starts, room, sizeof *starts, err);
  if (!starts) {
    return PLACIDO_MEMORY;
  }
  sightlines->starts = starts;
  sightlines->starts_room = room;
  return PLACIDO_OK;
}

/* Counting sort by cell of the rays that are chosen. */
static void sort(placido_sightlines *sightlines, size_t cells) {
  size_t *starts = sightlines->starts;
  memset(starts, 0, (cells + 1) * sizeof *starts);
  for (size_t i = 0; i < sightlines->count; i++) {
    if (sightlines->chosen[i]) {
      starts[sightlines->cells[i] + 1]++;
    }
  }
  for (size_t c = 0; c < cells; c++) {
    starts[c + 1] += starts[c];
  }
  for (size_t i = 0; i < sightlines->count; i++) {
    if (sightlines->chosen[i]) {
      sightlines->order[starts[sightlines->cells[i]]++] = i;
    }
  }
  memmove(starts + 1, starts, cells * sizeof *starts);
  starts[0] = 0;
}

/* The cell that a ray is asked in next, and its place there. Returns false outside the grid. */
static bool find_place(placido_sightlines *sightlines, const placido_grid *grid, size_t i) {
  double *const *numbers = sightlines->numbers;
  sightlines->cells[i] = 0;
  if (!grid) {
    return true;
  }
  int column, row;
  double t = numbers[PLACIDO_RAY_T][i];
  double x = numbers[PLACIDO_RAY_ORIGIN_X][i] + t * numbers[PLACIDO_RAY_DIRECTION_X][i];
  double y = numbers[PLACIDO_RAY_ORIGIN_Y][i] + t * numbers[PLACIDO_RAY_DIRECTION_Y][i];
  if (!placido_grid_locate(grid, x, y, &column, &row, &numbers[PLACIDO_RAY_PLACE_X][i],
                           &numbers[PLACIDO_RAY_PLACE_Y][i])) {
    return false;
  }
  sightlines->cells[i] = row * grid->cells + column;
  return true;
}

static void tell_batch(const placido_batch *b, placido_sightlines *sightlines, const size_t *which,
                       placido_spot spot) {
  for (int i = 0; i < b->count; i++) {
    placido_sample *s = &sightlines->samples[sightlines->sample[which[i]]];
    s->hit =
        (placido_hit){b->x[i], b->y[i], b->z[i], b->p[i], b->q[i], b->xx[i], b->xy[i], b->yy[i]};
    s->miss = (placido_miss){b->f[i],    b->by_z[i], b->by_p[i],      b->by_q[i],
                             b->by_u[i], b->by_v[i], b->by_radius[i], b->by_height[i]};
    s->slope = b->slope[i];
    s->basis = spot;
    s->basis.x = b->in[PLACIDO_RAY_PLACE_X][i];
    s->basis.y = b->in[PLACIDO_RAY_PLACE_Y][i];
    s->residual_px = b->in[PLACIDO_RAY_RESIDUAL_PX][i];
  }
}

/* One evaluation of all rays that have been sorted: a step of theirs, or what is told of them. */
static void evaluate_all(placido_sightlines *sightlines, const placido_target *target, bool tells,
                         int threads) {
  const placido_grid *grid = target->grid;
  size_t cells = cells_of(grid);
  double knot_mm = grid ? grid->knot_mm : 1;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 16)
  for (size_t c = 0; c < cells; c++) {
    placido_batch batch;
    double polynomial[CELL];
    int column = grid ? (int)c % grid->cells : 0, row = grid ? (int)c / grid->cells : 0;
    if (grid && sightlines->starts[c] < sightlines->starts[c + 1]) {
      placido_grid_polynomial(grid, target->coefficients, column, row, polynomial);
    }
    for (size_t at = sightlines->starts[c]; at < sightlines->starts[c + 1]; at += BATCH) {
      const size_t *which = sightlines->order + at, left = sightlines->starts[c + 1] - at;
      placido_batch_gather(&batch, sightlines, which, left < BATCH ? (int)left : BATCH);
      placido_batch_evaluate(&batch, &target->base, grid ? polynomial : NULL, knot_mm,
                             sightlines->origin_z_mm, sightlines->moves_origin);
      if (!tells) {
        placido_batch_scatter(&batch, sightlines, which);
      } else {
        const placido_spot spot = {
            .column = column, .row = row, .order = grid ? grid->order : 0, .knot_mm = knot_mm};
        tell_batch(&batch, sightlines, which, spot);
      }
    }
  }
}

void placido_sightlines_hear(placido_sightlines *sightlines) {
  static const int scaled[] = {PLACIDO_RAY_RESIDUAL_PX, PLACIDO_RAY_BY_Z, PLACIDO_RAY_BY_P,
                               PLACIDO_RAY_BY_Q};
  double *noise = sightlines->numbers[PLACIDO_RAY_NOISE];
  for (size_t i = 0; i < sightlines->count; i++) {
    const placido_sample *s = &sightlines->samples[sightlines->sample[i]];
    sightlines->used[i] = s->used;
    for (size_t k = 0; k < sizeof scaled / sizeof scaled[0] && s->noise != noise[i]; k++) {
      sightlines->numbers[scaled[k]][i] *= noise[i] / s->noise;
    }
    noise[i] = s->noise;
  }
}

/* Rays that missed before start anew. */
static void begin(placido_sightlines *sightlines, const placido_grid *grid) {
  for (size_t i = 0; i < sightlines->count; i++) {
    double *residual_px = &sightlines->numbers[PLACIDO_RAY_RESIDUAL_PX][i];
    if (isnan(*residual_px)) {
      sightlines->numbers[PLACIDO_RAY_T][i] = sightlines->samples[sightlines->sample[i]].t;
    }
    *residual_px = NAN;
    sightlines->chosen[i] = find_place(sightlines, grid, i);
  }
}

/* Chooses the rays that came so far that they have to ask the shape again, where they are now. */
static bool choose_again(placido_sightlines *sightlines, const placido_grid *grid) {
  bool any = false;
  for (size_t i = 0; i < sightlines->count; i++) {
    if (sightlines->chosen[i]) {
      bool again = sightlines->numbers[PLACIDO_RAY_ASIDE][i] > ASIDE_MM;
      if (again) {
        sightlines->numbers[PLACIDO_RAY_RESIDUAL_PX][i] = NAN;
      }
      sightlines->chosen[i] = again && find_place(sightlines, grid, i);
      any |= sightlines->chosen[i];
    }
  }
  return any;
}

void placido_sightlines_trace(placido_sightlines *sightlines, const placido_target *target,
                              int threads) {
  bool open = true;
  begin(sightlines, target->grid);
  for (int pass = 0; pass < PASSES_MAX && open; pass++) {
    sort(sightlines, cells_of(target->grid));
    evaluate_all(sightlines, target, false, threads);
    open = choose_again(sightlines, target->grid);
  }
}

/* Whether a ray counts in the fit. */
static bool counts(const placido_sightlines *sightlines, size_t i) {
  return sightlines->used[i] && !isnan(sightlines->numbers[PLACIDO_RAY_RESIDUAL_PX][i]);
}

void placido_sightlines_sort(placido_sightlines *sightlines, const placido_grid *grid) {
  for (size_t i = 0; i < sightlines->count; i++) {
    sightlines->chosen[i] = counts(sightlines, i);
  }
  sort(sightlines, cells_of(grid));
}

void placido_sightlines_tell(const placido_sightlines *sightlines) {
  double *const *numbers = sightlines->numbers;
  for (size_t i = 0; i < sightlines->count; i++) {
    placido_sample *s = &sightlines->samples[sightlines->sample[i]];
    double t = numbers[PLACIDO_RAY_T][i];
    s->residual_px = numbers[PLACIDO_RAY_RESIDUAL_PX][i];
    if (!isnan(s->residual_px)) {
      s->t = t;
      s->hit.x = numbers[PLACIDO_RAY_ORIGIN_X][i] + t * numbers[PLACIDO_RAY_DIRECTION_X][i];
      s->hit.y = numbers[PLACIDO_RAY_ORIGIN_Y][i] + t * numbers[PLACIDO_RAY_DIRECTION_Y][i];
    }
  }
}

void placido_sightlines_tell_all(placido_sightlines *sightlines, const placido_target *target,
                                 int threads) {
  placido_sightlines_tell(sightlines);
  for (size_t i = 0; i < sightlines->count; i++) {
    sightlines->chosen[i] = !isnan(sightlines->numbers[PLACIDO_RAY_RESIDUAL_PX][i]) &&
                            find_place(sightlines, target->grid, i);
  }
  sort(sightlines, cells_of(target->grid));
  evaluate_all(sightlines, target, true, threads);
}

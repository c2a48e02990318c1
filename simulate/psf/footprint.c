/* Footprints: rays to the retina, and the cells about them by differences to their neighbours.
 *
 * In the crosshatch the neighbours are the rays to the left and right, above and below in the same
 * grid, so three rows are kept at a time. A pattern without rows has no neighbours: there the
 * surface's second derivatives say where a ray a little aside would go. */
#include "simulate/psf/footprint.h"

#include "base/dispatch.h"
#include "base/memory.h"
#include "simulate/rays/refract.h"

#include <math.h>
#include <string.h>

enum {
  ROWS = 3,
  ROW_COLUMNS = 3,  /* x, y and light of a row kept */
  RAY_COLUMNS = 11, /* of placido_ray_columns */
  SPOT_COLUMNS = 6  /* of placido_spots, without those of a row */
};

/* One traced row: as long as the longest with an empty place at either end; places of other rows in
 * the same column have the same number. What is not there is NaN. */
typedef struct row {
  double *x, *y, *light;
  int first, count;
  placido_arrivals lost;
} row;

/* A thread's room. */
typedef struct desk {
  const placido_light_count *how;
  placido_ray_columns rays;
  placido_spots spots;
  row rows[ROWS];
  double *block;
} desk;

static int desk_new(desk *d, const placido_light_count *how, placido_error *err) {
  size_t room = (size_t)how->tracer->pattern.run_max + 2;
  size_t columns = ROWS * ROW_COLUMNS + RAY_COLUMNS + SPOT_COLUMNS;
  *d = (desk){.how = how};
  d->block = placido_memory_new(room * columns + how->tracer->work, sizeof *d->block, err);
  if (d->block == NULL) {
    return PLACIDO_MEMORY;
  }
  double **places[ROWS * ROW_COLUMNS + RAY_COLUMNS + SPOT_COLUMNS] = {
    &d->rows[0].x,    &d->rows[0].y,   &d->rows[0].light, &d->rows[1].x,   &d->rows[1].y,
    &d->rows[1].light, &d->rows[2].x,  &d->rows[2].y,     &d->rows[2].light, &d->rays.x_mm,
    &d->rays.y_mm,    &d->rays.depth_mm, &d->rays.sx,     &d->rays.sy,     &d->rays.u,
    &d->rays.v,       &d->rays.weight, &d->rays.sxx,      &d->rays.sxy,    &d->rays.syy,
    &d->spots.ax,     &d->spots.ay,    &d->spots.bx,      &d->spots.by,    &d->spots.width,
    &d->spots.height};
  for (size_t i = 0; i < columns; i++) {
    *places[i] = d->block + i * room;
  }
  d->rays.work = d->block + columns * room;
  d->rays.weight = how->spread ? d->rays.weight : NULL;
  return PLACIDO_OK;
}

/* Where rays meet the retina, in buckets from the corner of the first. */
PLACIDO_WIDE
static void land(double *restrict to, const double *restrict from_mm,
                 const double *restrict depth_mm, const double *restrict slope, size_t count,
                 double retina_mm, double centre_mm, double bucket_mm, double middle) {
  for (size_t i = 0; i < count; i++) {
    double hit_mm = from_mm[i] + (retina_mm - depth_mm[i]) * slope[i];
    to[i] = (hit_mm - centre_mm) / bucket_mm + middle;
  }
}

PLACIDO_WIDE
static void weigh(double *restrict light, const double *restrict weight, size_t count,
                  double unit) {
  for (size_t i = 0; i < count; i++) {
    light[i] = floor(weight[i] * unit);
  }
}

/* Looks at those that do not arrive. */
static void count_lost(placido_arrivals *lost, const desk *d, int count) {
  const placido_ray_columns *c = &d->rays;
  for (int i = 0; i < count; i++) {
    if (isnan(c->u[i])) {
      enum placido_fate fate = placido_refract_fate(c->x_mm[i], c->y_mm[i], c->sx[i], c->sy[i],
                                                    &d->how->tracer->eye);
      lost->missed += fate == PLACIDO_FATE_MISSED;
      lost->grazed += fate == PLACIDO_FATE_GRAZED;
      lost->reflected += fate == PLACIDO_FATE_REFLECTED;
    }
  }
}

/* Traces a run; its first ray gets the number `first`. */
static void trace(desk *d, long run, int first, row *r) {
  const placido_light_count *how = d->how;
  const placido_raster *w = &how->raster;
  const double retina_mm = how->tracer->eye.retina_mm, middle = w->n / 2.0;
  const placido_ray_columns *c = &d->rays;
  const size_t count = (size_t)placido_tracer_run(how->tracer, run, c);
  r->first = first;
  r->count = (int)count;
  r->lost = (placido_arrivals){0};
  land(r->x + first, c->x_mm, c->depth_mm, c->u, count, retina_mm, w->centre_x_mm, w->bucket_mm,
       middle);
  land(r->y + first, c->y_mm, c->depth_mm, c->v, count, retina_mm, w->centre_y_mm, w->bucket_mm,
       middle);
  if (how->spread) {
    weigh(r->light + first, c->weight, count, how->unit);
  }
  count_lost(&r->lost, d, r->count);
}

static void clear_row(row *r, int room) {
  r->first = r->count = 0;
  r->lost = (placido_arrivals){0};
  for (int i = 0; i < room; i++) {
    r->x[i] = r->y[i] = NAN;
  }
}

/* A row of the crosshatch's grid of `size` columns, all else in it NaN. */
static void trace_row(desk *d, long run, int size, row *r) {
  int count = placido_pattern_count(&d->how->tracer->pattern, run);
  int first = 1 + (size - count) / 2;
  trace(d, run, first, r);
  for (int i = 0; i < first; i++) {
    r->x[i] = r->y[i] = NAN;
  }
  for (int i = first + count; i < size + 2; i++) {
    r->x[i] = r->y[i] = NAN;
  }
}

/* Half the way from the ray before to the one after; where one is not there, from or to this one;
 * nothing where neither is. */
PLACIDO_INSIDE double middle_step(double before, double here, double after) {
  double to = after - here, from = here - before;
  double first = isnan(from) ? to : from, last = isnan(to) ? from : to;
  double step = (first + last) / 2;
  return isnan(step) ? 0 : step;
}

PLACIDO_WIDE
static void find_steps(double *restrict step, const double *restrict before,
                       const double *restrict here, const double *restrict after, size_t count) {
  for (size_t i = 0; i < count; i++) {
    step[i] = middle_step(before[i], here[i], after[i]);
  }
}

PLACIDO_WIDE
static void find_steps_along(double *restrict step, const double *restrict here, size_t count) {
  for (size_t i = 0; i < count; i++) {
    step[i] = middle_step(here[(ptrdiff_t)i - 1], here[i], here[i + 1]);
  }
}

/* Adds up what arrives: everything that is not NaN. */
static void count_arrivals(placido_arrivals *arrivals, const row *r) {
  for (int i = r->first; i < r->first + r->count; i++) {
    if (!isnan(r->x[i])) {
      arrivals->entered++;
      arrivals->light += (int64_t)r->light[i];
    }
  }
  arrivals->missed += r->lost.missed;
  arrivals->grazed += r->lost.grazed;
  arrivals->reflected += r->lost.reflected;
}

static void put_row(placido_tally *tally, placido_arrivals *arrivals, desk *d, const row *r) {
  d->spots.count = (size_t)r->count;
  d->spots.x = r->x + r->first;
  d->spots.y = r->y + r->first;
  d->spots.light = r->light + r->first;
  count_arrivals(arrivals, r);
  arrivals->landed += d->how->spread ? placido_tally_spread(tally, &d->spots)
                                     : placido_tally_count(tally, &d->spots);
}

/* Footprints of a row between its neighbours. */
static void outline_row(desk *d, const row *above, const row *r, const row *below) {
  size_t count = (size_t)r->count;
  int at = r->first;
  find_steps_along(d->spots.ax, r->x + at, count);
  find_steps_along(d->spots.ay, r->y + at, count);
  find_steps(d->spots.bx, above->x + at, r->x + at, below->x + at, count);
  find_steps(d->spots.by, above->y + at, r->y + at, below->y + at, count);
}

/* Rows `begin` to before `end` of a grid whose rows are `first` to before `last`. */
static void count_rows(placido_tally *tally, placido_arrivals *arrivals, desk *d, long first,
                       long last, long begin, long end) {
  int size = (int)(last - first);
  row *above = &d->rows[0], *here = &d->rows[1], *below = &d->rows[2];
  clear_row(above, size + 2);
  if (begin > first && d->how->spread) {
    trace_row(d, begin - 1, size, above);
  }
  trace_row(d, begin, size, here);
  for (long run = begin; run < end; run++) {
    if (run + 1 < (d->how->spread ? last : end)) {
      trace_row(d, run + 1, size, below);
    } else {
      clear_row(below, size + 2);
    }
    if (d->how->spread) {
      outline_row(d, above, here, below);
    }
    put_row(tally, arrivals, d, here);
    row *spare = above;
    above = here;
    here = below;
    below = spare;
  }
}

/* Slopes of the ray that enters by (dx, dy) aside, to first order in the surface. */
static void refract_aside(desk *d, double dx, double dy, double *u, double *v, size_t count) {
  const placido_ray_columns *c = &d->rays;
  for (size_t i = 0; i < count; i++) {
    c->x_mm[i] += dx;
    c->y_mm[i] += dy;
    c->depth_mm[i] += c->sx[i] * dx + c->sy[i] * dy;
    c->sx[i] += c->sxx[i] * dx + c->sxy[i] * dy;
    c->sy[i] += c->sxy[i] * dx + c->syy[i] * dy;
  }
  placido_refract(u, v, c->x_mm, c->y_mm, c->sx, c->sy, count, &d->how->tracer->eye);
}

/* Side (from, to)/step × cell of each footprint. */
static void find_sides(double *side, const double *here, size_t count, double scale) {
  for (size_t i = 0; i < count; i++) {
    side[i] = isnan(side[i] - here[i]) ? 0 : (side[i] - here[i]) * scale;
  }
}

/* Footprints of a run without rows: a ray a little to the right, then one a little above as well,
 * show what a square cell becomes. */
static void outline_run(desk *d, const row *r) {
  const placido_light_count *how = d->how;
  const placido_raster *w = &how->raster;
  const placido_pattern *p = &how->tracer->pattern;
  const double pi = 3.14159265358979323846, aside_mm = 1e-4, middle = w->n / 2.0;
  const double cell_mm = p->radius_mm * sqrt(pi / (double)p->total);
  const double retina_mm = how->tracer->eye.retina_mm;
  const placido_ray_columns *c = &d->rays;
  size_t count = (size_t)r->count;
  double *sides[2][2] = {{d->spots.ax, d->spots.ay}, {d->spots.bx, d->spots.by}};
  for (int k = 0; k < 2; k++) { /* the second from where the first has gone */
    refract_aside(d, k == 0 ? aside_mm : -aside_mm, k == 0 ? 0 : aside_mm, c->u, c->v, count);
    land(sides[k][0], c->x_mm, c->depth_mm, c->u, count, retina_mm, w->centre_x_mm, w->bucket_mm,
         middle);
    land(sides[k][1], c->y_mm, c->depth_mm, c->v, count, retina_mm, w->centre_y_mm, w->bucket_mm,
         middle);
    find_sides(sides[k][0], r->x + r->first, count, cell_mm / aside_mm);
    find_sides(sides[k][1], r->y + r->first, count, cell_mm / aside_mm);
  }
}

static void count_runs(placido_tally *tally, placido_arrivals *arrivals, desk *d, int share,
                       int shares) {
  for (long run = share; run < d->how->tracer->pattern.runs; run += shares) {
    trace(d, run, 1, &d->rows[0]);
    if (d->how->spread) {
      outline_run(d, &d->rows[0]);
    }
    put_row(tally, arrivals, d, &d->rows[0]);
  }
}

static void count_grids(placido_tally *tally, placido_arrivals *arrivals, desk *d, int share,
                        int shares) {
  const long samples = d->how->tracer->pattern.crosshatch.samples;
  const long first[2] = {0, samples}, last[2] = {samples, 2 * samples - 1};
  for (int grid = 0; grid < 2; grid++) {
    long rows = last[grid] - first[grid];
    count_rows(tally, arrivals, d, first[grid], last[grid], first[grid] + rows * share / shares,
               first[grid] + rows * (share + 1) / shares);
  }
}

int placido_footprint_count(placido_tally *tally, placido_arrivals *arrivals,
                            const placido_light_count *how, int share, int shares,
                            placido_error *err) {
  desk d;
  int status = desk_new(&d, how, err);
  *arrivals = (placido_arrivals){0};
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int i = 0; i < how->tracer->pattern.run_max + 2 && !how->spread; i++) {
    d.rows[0].light[i] = d.rows[1].light[i] = d.rows[2].light[i] = 1;
  }
  if (how->tracer->pattern.kind == PLACIDO_PATTERN_CROSSHATCH) {
    count_grids(tally, arrivals, &d, share, shares);
  } else {
    count_runs(tally, arrivals, &d, share, shares);
  }
  placido_memory_free(d.block);
  return PLACIDO_OK;
}

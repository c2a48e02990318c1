/* Several frames of one eye as one. The first frame's own fit serves as a yardstick that moves with
 * the eye: what is averaged are the edges' distances from it, which are small and smooth, so that
 * points of the same edge and meridian may be compared although the eye moved between them. */
#include <placido/combine.h>

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/movement.h"
#include "reconstruct/surface/surface.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 12
#define RIM_MM 0.5
#define PIVOT_MM 7.8 /* the centre of curvature, below the vertex of an ordinary cornea */
/* A frame is set aside where it is so many times the usual off the others, and by more than a good
 * frame may. */
#define APART 1.6
#define APART_LEAST_PX 0.05
/* Blocks of neighbouring edges, about as wide as the surface's knots: noise averages out over them,
 * and what makes a wrong surface does not. */
#define BLOCK_DEG 15
#define BLOCK_EDGES 6
#define SPREAD_LEAST_PX 0.01 /* better than this no two frames agree but by chance */
#define STRAY 3.5        /* spreads of its frame at which a single edge point is not believed */
#define NEWTON_STEPS 8
#define NEWTON_REACH_PX 30
#define NEWTON_CLOSE_PX 1e-7

/* One frame's edges as distances from the moved yardstick. */
typedef struct view {
  placido_pose pose;
  double *residual_px; /* by edge, then meridian; NaN: not seen */
  double spread_px;    /* of single points about the frames' middle */
  double weight;       /* its share in the means; of all frames 1 */
  double bias_px;      /* spread of whole blocks, told as that of the points that would explain it */
  bool used;
} view;

typedef struct combination {
  const placido_mires *list;
  size_t count;
  const placido_instrument *instrument;
  placido_surface *surface; /* the first frame's: the yardstick */
  placido_shape shape;      /* the same */
  double axis_z_mm;
  int threads;
  size_t places; /* edges × meridians */
  view views[PLACIDO_COMBINE_MAX];
  placido_pose mean;       /* of the frames of use: where the eye is put */
  double centre_px[2];     /* the mires' centre there */
  placido_mire_point *starts; /* about where each place is with the eye there; used: known */
  double *middle_px; /* median over the frames of use, by place; NaN: too few have it */
  double *work;      /* `places` numbers */
} combination;

static size_t place_of(const placido_mires *mires, const placido_mire_point *point) {
  long meridian = lrint(point->meridian_deg * mires->meridian_count / 360) % mires->meridian_count;
  return (size_t)point->edge * (size_t)mires->meridian_count + (size_t)meridian;
}

static int check_lists(const placido_mires *list, size_t count,
                       const placido_instrument *instrument, placido_error *err) {
  if (count < 1 || count > PLACIDO_COMBINE_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "%zu frames to combine, 1 to %d are possible",
                             count, PLACIDO_COMBINE_MAX);
  }
  for (size_t i = 0; i < count; i++) {
    const placido_mires *mires = &list[i];
    if (mires->edge_count != instrument->edge_count || mires->meridian_count < 1 ||
        mires->meridian_count != list[0].meridian_count ||
        mires->count > (size_t)mires->edge_count * (size_t)mires->meridian_count) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "frame %zu has %zu points of %d edges on %d meridians, expected %d "
                               "edges on %d meridians",
                               i, mires->count, mires->edge_count, mires->meridian_count,
                               instrument->edge_count, list[0].meridian_count);
    }
  }
  return PLACIDO_OK;
}

static int copy_mires(placido_mires *copy, const placido_mires *mires, placido_error *err) {
  *copy = *mires;
  copy->points = placido_memory_new(mires->count, sizeof *copy->points, err);
  if (!copy->points) {
    *copy = (placido_mires){0};
    return PLACIDO_MEMORY;
  }
  memcpy(copy->points, mires->points, mires->count * sizeof *copy->points);
  return PLACIDO_OK;
}

/* The surface with a rim as wide as an eye moves, of what the spline has beyond the outermost points.
 */
static int widen(placido_surface **wide, const placido_surface *surface, placido_error *err) {
  placido_part *parts = placido_memory_new(surface->term_count, sizeof *parts, err);
  if (!parts) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < surface->term_count; i++) {
    parts[i] = surface->terms[i].part;
  }
  int status = placido_surface_new(wide, surface->vertex_z_mm, surface->radius_mm + RIM_MM, parts,
                                   surface->term_count, NULL, err);
  placido_memory_free(parts);
  return status;
}

/* Fits a copy of the first frame's mires: a fit marks the points that it uses. */
static int make_yardstick(combination *c, const placido_fit_options *options, placido_error *err) {
  placido_mires first;
  placido_fit *fit = NULL;
  int status = copy_mires(&first, &c->list[0], err);
  if (!status) {
    status = placido_fit_new(&fit, &first, c->instrument, options, NULL, err);
  }
  if (!status) {
    status = widen(&c->surface, placido_fit_surface(fit), err);
    c->shape.base = c->surface;
  }
  placido_fit_free(fit);
  placido_mires_free(&first);
  return status;
}

static int make_room(combination *c, placido_error *err) {
  c->middle_px = placido_memory_new(c->places, sizeof *c->middle_px, err);
  c->work = placido_memory_new(c->places, sizeof *c->work, err);
  c->starts = placido_memory_new(c->places, sizeof *c->starts, err);
  bool enough = c->middle_px && c->work && c->starts;
  for (size_t i = 0; i < c->count && enough; i++) {
    c->views[i].residual_px = placido_memory_new(c->places, sizeof(double), err);
    enough = c->views[i].residual_px != NULL;
  }
  return enough ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* Where the eye would be if the mires' centre went with it: the start of the search. */
static placido_pose pose_by_centre(const combination *c, const placido_mires *mires) {
  placido_pose pose = {.pivot_mm = {0, 0, c->axis_z_mm - PIVOT_MM}};
  const placido_mires *both[2] = {&c->list[0], mires};
  for (int i = 0; i < 2; i++) {
    placido_ray ray =
        placido_camera_ray(c->instrument, both[i]->centre_u_px, both[i]->centre_v_px);
    double t = ray.origin[2] - c->axis_z_mm;
    for (int axis = 0; axis < 2; axis++) {
      double at_mm = ray.origin[axis] + t * ray.direction[axis];
      pose.shift_mm[axis] += i == 0 ? -at_mm : at_mm;
    }
  }
  return pose;
}

/* Finds where the eye was in a frame, and the frame's edges' distances from the yardstick there. The
 * first frame tells where it is to be. */
static int take_view(combination *c, size_t i, placido_error *err) {
  const placido_mires *mires = &c->list[i];
  view *v = &c->views[i];
  placido_sample *samples;
  int status = placido_samples_new(&samples, mires, c->instrument, c->axis_z_mm, err);
  if (status) {
    return status;
  }
  v->pose = pose_by_centre(c, mires);
  v->used = placido_pose_find(&v->pose, samples, mires->count, &c->shape,
                              i > 0 ? STEPS_MAX : 0, c->threads, c->work);
  for (size_t place = 0; place < c->places; place++) {
    v->residual_px[place] = NAN;
  }
  for (size_t s = 0; s < mires->count; s++) {
    v->residual_px[place_of(mires, &mires->points[s])] = samples[s].residual_px;
  }
  placido_memory_free(samples);
  return PLACIDO_OK;
}

/* The distances at one place of the frames of use, `values` and their frames; returns how many. */
static size_t gather(const combination *c, size_t place, double *values, size_t *frames) {
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) {
    if (c->views[i].used && !isnan(c->views[i].residual_px[place])) {
      frames[n] = i;
      values[n++] = c->views[i].residual_px[place];
    }
  }
  return n;
}

static double median(const double *values, size_t count) {
  double sorted[PLACIDO_COMBINE_MAX];
  memcpy(sorted, values, count * sizeof *sorted);
  double low = placido_quantile(sorted, count, 0.5);
  if (count % 2 != 0) {
    return low;
  }
  double high = INFINITY;
  for (size_t i = count / 2; i < count; i++) {
    high = fmin(high, sorted[i]);
  }
  return (low + high) / 2;
}

static size_t used_count(const combination *c) {
  size_t used = 0;
  for (size_t i = 0; i < c->count; i++) {
    used += c->views[i].used;
  }
  return used;
}

/* Medians by place, where at least half of the frames of use have it. */
static void find_middle(combination *c) {
  size_t used = used_count(c), frames[PLACIDO_COMBINE_MAX];
  for (size_t place = 0; place < c->places; place++) {
    double values[PLACIDO_COMBINE_MAX];
    size_t n = gather(c, place, values, frames);
    c->middle_px[place] = n > 0 && 2 * n >= used ? median(values, n) : NAN;
  }
}

static double median_size(double *values, size_t count) {
  for (size_t i = 0; i < count; i++) {
    values[i] = fabs(values[i]);
  }
  return 1.4826 * placido_quantile(values, count, 0.5);
}

/* The mean of a frame's distances from the middle over a block that begins at `edge` and `meridian`;
 * NaN where less than half of it is seen. */
static double block_mean(const combination *c, const view *v, int edge, int meridian, int width) {
  double sum = 0;
  int n = 0;
  for (int k = edge; k < edge + BLOCK_EDGES; k++) {
    for (int m = meridian; m < meridian + width; m++) {
      size_t place = (size_t)k * (size_t)c->list->meridian_count + (size_t)m;
      double off = v->residual_px[place] - c->middle_px[place];
      n += !isnan(off);
      sum += isnan(off) ? 0 : off;
    }
  }
  return 2 * n > BLOCK_EDGES * width ? sum / n : NAN;
}

/* Robust spreads of a frame about the middle: of points, and of blocks. */
static void find_spread(combination *c, view *v) {
  const int width = (c->list->meridian_count * BLOCK_DEG + 359) / 360;
  size_t points = 0, blocks = 0;
  for (size_t place = 0; place < c->places; place++) {
    double off = v->residual_px[place] - c->middle_px[place];
    if (!isnan(off)) {
      c->work[points++] = off;
    }
  }
  v->spread_px = fmax(median_size(c->work, points), SPREAD_LEAST_PX);
  for (int k = 0; k + BLOCK_EDGES <= c->list->edge_count; k += BLOCK_EDGES) {
    for (int m = 0; m + width <= c->list->meridian_count; m += width) {
      double mean = block_mean(c, v, k, m, width);
      if (!isnan(mean)) {
        c->work[blocks++] = mean;
      }
    }
  }
  v->bias_px = median_size(c->work, blocks) * sqrt(width * BLOCK_EDGES);
  v->bias_px = v->bias_px > v->spread_px ? v->bias_px : v->spread_px;
}

static double usual_bias(const combination *c) {
  double biases[PLACIDO_COMBINE_MAX];
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) {
    if (c->views[i].used) {
      biases[n++] = c->views[i].bias_px;
    }
  }
  return median(biases, n);
}

/* Takes the frame that agrees least with the others out of use, where that is far worse than the
 * usual. */
static bool set_one_aside(combination *c) {
  view *worst = NULL;
  find_middle(c);
  for (size_t i = 0; i < c->count; i++) {
    view *v = &c->views[i];
    find_spread(c, v);
    if (v->used && (!worst || v->bias_px > worst->bias_px)) {
      worst = v;
    }
  }
  if (!worst || worst->bias_px < fmax(APART * usual_bias(c), APART_LEAST_PX)) {
    return false;
  }
  worst->used = false;
  return true;
}

/* A worse frame than usual has a lesser share; better ones than usual are so by chance. */
static double set_weights(combination *c) {
  double usual_px = usual_bias(c), sum = 0;
  for (size_t i = 0; i < c->count; i++) {
    view *v = &c->views[i];
    v->weight = v->used ? pow(fmax(v->bias_px, usual_px), -2) : 0;
    sum += v->weight;
  }
  return sum;
}

/* The eye's mean place: a frame's noise moves the eye too, and averages out with the rest. */
static void find_mean(combination *c) {
  double sum = set_weights(c);
  c->mean = (placido_pose){.pivot_mm = {0, 0, c->views[0].pose.pivot_mm[2]}};
  for (size_t i = 0; i < c->count; i++) {
    view *v = &c->views[i];
    v->weight /= sum;
    for (int axis = 0; axis < 3; axis++) {
      c->mean.shift_mm[axis] += v->weight * v->pose.shift_mm[axis];
      c->mean.turn_rad[axis] += v->weight * v->pose.turn_rad[axis];
    }
    c->centre_px[0] += v->weight * c->list[i].centre_u_px;
    c->centre_px[1] += v->weight * c->list[i].centre_v_px;
  }
}

/* The mean at a place of the frames of use, without strays, and its standard deviation: from the
 * scatter, but no less than the frames' own spreads give. Returns false where too few frames have
 * it. */
static bool mean_at(const combination *c, size_t place, double *mean_px, double *sigma_px) {
  double values[PLACIDO_COMBINE_MAX], sum = 0, weights = 0, squares = 0, variance = 0;
  size_t frames[PLACIDO_COMBINE_MAX], n = gather(c, place, values, frames), kept = 0;
  for (size_t i = 0; i < n; i++) {
    const view *v = &c->views[frames[i]];
    double off = values[i] - c->middle_px[place];
    if (fabs(off) < STRAY * v->spread_px) {
      weights += v->weight;
      sum += v->weight * off;
      squares += off * off / (v->spread_px * v->spread_px);
      variance += v->weight * v->weight * v->spread_px * v->spread_px;
      kept++;
    }
  }
  if (kept == 0 || 2 * kept < used_count(c)) {
    return false;
  }
  *mean_px = c->middle_px[place] + sum / weights;
  double scatter = kept > 1 ? squares / (double)(kept - 1) : 1;
  *sigma_px = sqrt(variance * fmax(scatter, 1)) / weights;
  return true;
}

/* Moves a point along its meridian to where its distance from the yardstick at the mean place is
 * `residual_px`. */
static bool place_point(const combination *c, placido_mire_point *point, double residual_px) {
  double angle = point->meridian_deg * (M_PI / 180), across = cos(angle), along = -sin(angle);
  double moved_px = 0;
  for (int step = 0; step < NEWTON_STEPS; step++) {
    placido_sample sample = {.ray = placido_camera_ray(c->instrument, point->u_px, point->v_px),
                             .edge = &c->instrument->edges[point->edge]};
    sample.t = sample.ray.origin[2] - c->axis_z_mm;
    placido_sample_trace_moved(&sample, &c->shape, &c->mean);
    double slope = (sample.miss.by_u * across + sample.miss.by_v * along) / sample.slope;
    double change = (residual_px - sample.residual_px) / slope;
    if (!(fabs(moved_px += change) < NEWTON_REACH_PX)) { /* not a number either */
      return false;
    }
    point->u_px += change * across;
    point->v_px += change * along;
    if (fabs(change) < NEWTON_CLOSE_PX) {
      return true;
    }
  }
  return false;
}

/* Where each place is about: as the earliest frame that has it shows it about its centre. */
static void find_starts(combination *c) {
  for (size_t i = c->count; i-- > 0;) {
    const placido_mires *mires = &c->list[i];
    for (size_t s = 0; s < mires->count; s++) {
      placido_mire_point *start = &c->starts[place_of(mires, &mires->points[s])];
      *start = mires->points[s];
      start->u_px += c->centre_px[0] - mires->centre_u_px;
      start->v_px += c->centre_px[1] - mires->centre_v_px;
      start->used = true;
      start->residual_px = NAN;
    }
  }
}

static int write_mires(placido_mires *combined, combination *c, placido_error *err) {
  placido_mire_point *points = placido_memory_new(c->places, sizeof *points, err);
  if (!points) {
    return PLACIDO_MEMORY;
  }
  *combined = c->list[0];
  combined->points = points;
  combined->count = 0;
  combined->centre_u_px = c->centre_px[0];
  combined->centre_v_px = c->centre_px[1];
  find_starts(c);
  for (size_t place = 0; place < c->places; place++) {
    placido_mire_point point = c->starts[place];
    double mean_px;
    if (point.used && mean_at(c, place, &mean_px, &point.sigma_px) &&
        place_point(c, &point, mean_px)) {
      points[combined->count++] = point;
    }
  }
  combined->coverage = (double)combined->count / (double)c->places;
  return PLACIDO_OK;
}

static void tell_movements(const combination *c, placido_movement *movements) {
  const double vertex[3] = {0, 0, c->axis_z_mm};
  double mean[3], carried[3];
  placido_pose_carry(&c->mean, vertex, mean);
  for (size_t i = 0; i < c->count; i++) {
    const view *v = &c->views[i];
    movements[i] = (placido_movement){
        .weight = v->weight, .spread_px = v->spread_px, .bias_px = v->bias_px};
    placido_pose_carry(&v->pose, vertex, carried);
    for (int axis = 0; axis < 3; axis++) {
      double turn_rad = v->pose.turn_rad[axis] - c->mean.turn_rad[axis];
      movements[i].shift_mm[axis] = carried[axis] - mean[axis];
      movements[i].turn_deg[axis] = turn_rad * (180 / M_PI);
    }
  }
}

static void combination_free(combination *c) {
  for (size_t i = 0; i < c->count; i++) {
    placido_memory_free(c->views[i].residual_px);
  }
  placido_memory_free(c->starts);
  placido_memory_free(c->middle_px);
  placido_memory_free(c->work);
  placido_surface_free(c->surface);
}

int placido_mires_combine(placido_mires *combined, placido_movement *movements,
                          const placido_mires *list, size_t count,
                          const placido_instrument *instrument,
                          const placido_fit_options *options, placido_error *err) {
  *combined = (placido_mires){0};
  int status = check_lists(list, count, instrument, err);
  if (status) {
    return status;
  }
  combination *c = placido_memory_new(1, sizeof *c, err);
  if (!c) {
    return PLACIDO_MEMORY;
  }
  *c = (combination){.list = list,
                     .count = count,
                     .instrument = instrument,
                     .axis_z_mm = options ? options->axis_z_mm : 0,
                     .threads = options && options->threads > 0 ? options->threads : 1,
                     .places = (size_t)list->edge_count * (size_t)list->meridian_count};
  status = make_room(c, err);
  if (!status) {
    status = make_yardstick(c, options, err);
  }
  for (size_t i = 0; i < count && !status; i++) {
    status = take_view(c, i, err);
  }
  if (!status) {
    while (set_one_aside(c)) {
    }
    find_mean(c);
    status = write_mires(combined, c, err);
  }
  if (!status && movements) {
    tell_movements(c, movements);
  }
  combination_free(c);
  placido_memory_free(c);
  return status;
}

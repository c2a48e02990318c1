/* Several frames of one eye as one. The first frame's own fit serves as a yardstick that moves with
 * the eye: what is averaged are the edges' distances from it, which are small and smooth, so that
 * points of the same edge and meridian may be compared although the eye moved between them. */
#include <placido/combine.h>

#include "base/memory.h"
#include "reconstruct/solve/agreement.h"
#include "reconstruct/solve/movement.h"
#include "reconstruct/surface/surface.h"

#include <math.h>
#include <string.h>

#define STEPS_MAX 12
#define RIM_MM 0.5 /* the spline reaches 0.6 mm beyond the outermost points */
#define PIVOT_MM 7.8 /* the centre of curvature, below the vertex of an ordinary cornea */
#define NEWTON_STEPS 8
#define NEWTON_REACH_PX 30
#define NEWTON_CLOSE_PX 1e-7

typedef struct combination {
  const placido_mires *list;
  const placido_instrument *instrument;
  double axis_z_mm;
  int threads;
  placido_surface *surface; /* the first frame's: the yardstick */
  placido_shape shape;      /* the same */
  placido_pose poses[PLACIDO_COMBINE_MAX];
  placido_agreement agreement;
  placido_pose mean;          /* of the frames of use: where the eye is put */
  double centre_px[2];        /* the mires' centre there */
  placido_mire_point *starts; /* about where each place is with the eye there; used: known */
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
  copy->doubtful = NULL;
  copy->doubtful_count = 0;
  copy->points = placido_memory_new(mires->count, sizeof *copy->points, err);
  if (!copy->points) {
    *copy = (placido_mires){0};
    return PLACIDO_MEMORY;
  }
  memcpy(copy->points, mires->points, mires->count * sizeof *copy->points);
  return PLACIDO_OK;
}

/* The surface with a rim as wide as an eye moves, where the spline goes on. */
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

/* Where the eye would be if the mires' centre went with it: the start of the search. */
static placido_pose pose_by_centre(const combination *c, const placido_mires *mires) {
  placido_pose pose = {.pivot_mm = {0, 0, c->axis_z_mm - PIVOT_MM}};
  const placido_mires *both[2] = {&c->list[0], mires};
  for (int i = 0; i < 2; i++) {
    placido_ray ray = placido_camera_ray(c->instrument, both[i]->centre_u_px, both[i]->centre_v_px);
    double t = ray.origin[2] - c->axis_z_mm;
    for (int axis = 0; axis < 2; axis++) {
      double at_mm = ray.origin[axis] + t * ray.direction[axis];
      pose.shift_mm[axis] += i == 0 ? -at_mm : at_mm;
    }
  }
  return pose;
}

/* Finds where the eye was in a frame, and the frame's edges' distances from the yardstick there.
 * The first frame tells where it is to be. */
static int take_frame(combination *c, size_t i, placido_error *err) {
  const placido_mires *mires = &c->list[i];
  placido_testimony *frame = &c->agreement.frames[i];
  placido_sample *samples;
  int status = placido_samples_new(&samples, mires, c->instrument, c->axis_z_mm, err);
  if (status) {
    return status;
  }
  c->poses[i] = pose_by_centre(c, mires);
  frame->used = placido_pose_find(&c->poses[i], samples, mires->count, &c->shape,
                                  i > 0 ? STEPS_MAX : 0, c->threads, c->agreement.work);
  for (size_t s = 0; s < mires->count; s++) {
    frame->residual_px[place_of(mires, &mires->points[s])] = samples[s].residual_px;
  }
  placido_memory_free(samples);
  return PLACIDO_OK;
}

/* The eye's mean place: a frame's noise moves the eye too, and averages out with the rest. */
static void find_mean(combination *c) {
  c->mean = (placido_pose){.pivot_mm = {0, 0, c->axis_z_mm - PIVOT_MM}};
  for (size_t i = 0; i < c->agreement.count; i++) {
    const double weight = c->agreement.frames[i].weight;
    for (int axis = 0; axis < 3; axis++) {
      c->mean.shift_mm[axis] += weight * c->poses[i].shift_mm[axis];
      c->mean.turn_rad[axis] += weight * c->poses[i].turn_rad[axis];
    }
    c->centre_px[0] += weight * c->list[i].centre_u_px;
    c->centre_px[1] += weight * c->list[i].centre_v_px;
  }
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
  for (size_t i = c->agreement.count; i-- > 0;) {
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
  const size_t places = c->agreement.places;
  placido_mire_point *points = placido_memory_new(places, sizeof *points, err);
  c->starts = placido_memory_new(places, sizeof *c->starts, err);
  if (!points || !c->starts) {
    placido_memory_free(points);
    return PLACIDO_MEMORY;
  }
  *combined = c->list[0];
  combined->points = points;
  combined->doubtful = NULL;
  combined->count = combined->doubtful_count = 0;
  combined->centre_u_px = c->centre_px[0];
  combined->centre_v_px = c->centre_px[1];
  find_starts(c);
  for (size_t place = 0; place < places; place++) {
    placido_mire_point point = c->starts[place];
    double mean_px;
    if (point.used && placido_agreement_mean(&c->agreement, place, &mean_px, &point.sigma_px) &&
        place_point(c, &point, mean_px)) {
      points[combined->count++] = point;
    }
  }
  combined->coverage = (double)combined->count / (double)places;
  return PLACIDO_OK;
}

static void tell_movements(const combination *c, placido_movement *movements) {
  const double vertex[3] = {0, 0, c->axis_z_mm};
  double mean[3], carried[3];
  placido_pose_carry(&c->mean, vertex, mean);
  for (size_t i = 0; i < c->agreement.count; i++) {
    const placido_testimony *frame = &c->agreement.frames[i];
    movements[i] = (placido_movement){
        .weight = frame->weight, .spread_px = frame->spread_px, .bias_px = frame->bias_px};
    placido_pose_carry(&c->poses[i], vertex, carried);
    for (int axis = 0; axis < 3; axis++) {
      const double turn_rad = c->poses[i].turn_rad[axis] - c->mean.turn_rad[axis];
      movements[i].shift_mm[axis] = carried[axis] - mean[axis];
      movements[i].turn_deg[axis] = turn_rad * (180 / M_PI);
    }
  }
}

static int run(placido_mires *combined, combination *c, size_t count,
               const placido_fit_options *options, placido_error *err) {
  int status = placido_agreement_new(&c->agreement, count, c->list->edge_count,
                                     c->list->meridian_count, err);
  if (!status) {
    status = make_yardstick(c, options, err);
  }
  for (size_t i = 0; i < count && !status; i++) {
    status = take_frame(c, i, err);
  }
  if (status) {
    return status;
  }
  placido_agreement_find(&c->agreement);
  find_mean(c);
  return write_mires(combined, c, err);
}

int placido_mires_combine(placido_mires *combined, placido_movement *movements,
                          const placido_mires *list, size_t count,
                          const placido_instrument *instrument, const placido_fit_options *options,
                          placido_error *err) {
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
                     .instrument = instrument,
                     .axis_z_mm = options ? options->axis_z_mm : 0,
                     .threads = options && options->threads > 0 ? options->threads : 1};
  status = run(combined, c, count, options, err);
  if (!status && movements) {
    tell_movements(c, movements);
  }
  placido_agreement_free(&c->agreement);
  placido_surface_free(c->surface);
  placido_memory_free(c->starts);
  placido_memory_free(c);
  return status;
}

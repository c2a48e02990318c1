/* Two threads in a row, as frames come faster than one of them could do both: the first finds the
 * mires of the newest frame, the second fits the surface, starting from that of the frame before.
 * */
#include "acquire/cli/live_topography.h"

#include "base/clock.h"
#include "base/memory.h"

#include <placido/index.h>
#include <placido/reconstruct.h>

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

/* A frame's mires on their way from one thread to the other. */
struct job {
  placido_mires mires;
  uint64_t seq;
  int64_t began_ns;
  placido_error refusal; /* its status is PLACIDO_OK where there are mires */
};

struct live_topography {
  const placido_instrument *instrument;
  double axis_z_mm;
  placido_fit *fit; /* of the last frame that had one; the second thread's own */
  pthread_t finder, fitter;
  bool has_finder, has_fitter; /* threads that have been started */
  pthread_mutex_t lock;        /* guards everything below */
  pthread_cond_t changed;
  bool ends;
  placido_frame newest;
  bool has_frame, is_finding;
  struct job found;
  bool has_job, is_fitting;
  struct live_cornea latest;
};

/* Copies the samples as they are, and all that is told of them. */
static int copy_frame(placido_frame *copy, const placido_frame *frame, placido_error *err) {
  const int status =
      placido_frame_resize(copy, frame->width_px, frame->height_px, frame->format, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const size_t row_bytes = (size_t)frame->width_px * placido_format_bytes(frame->format);
  for (int row = 0; row < frame->height_px; row++) {
    memcpy(copy->data + (size_t)row * copy->stride_bytes,
           frame->data + (size_t)row * frame->stride_bytes, row_bytes);
  }
  copy->bits = frame->bits;
  copy->t_ns = frame->t_ns;
  copy->seq = frame->seq;
  copy->flags = frame->flags;
  return PLACIDO_OK;
}

/* The newest frame into `frame`; false at the end. */
static bool take_frame(struct live_topography *t, placido_frame *frame) {
  pthread_mutex_lock(&t->lock);
  while (!t->has_frame && !t->ends) {
    pthread_cond_wait(&t->changed, &t->lock);
  }
  const bool goes_on = !t->ends;
  if (goes_on) {
    const placido_frame before = *frame;
    *frame = t->newest;
    t->newest = before;
    t->has_frame = false;
    t->is_finding = true;
    pthread_cond_broadcast(&t->changed);
  }
  pthread_mutex_unlock(&t->lock);
  return goes_on;
}

/* Hands the mires on as soon as the other thread has none that wait. */
static void hand_on(struct live_topography *t, const struct job *job) {
  pthread_mutex_lock(&t->lock);
  while (t->has_job && !t->ends) {
    pthread_cond_wait(&t->changed, &t->lock);
  }
  t->is_finding = false;
  if (t->ends) {
    placido_mires mires = job->mires;
    placido_mires_free(&mires);
  } else {
    t->found = *job;
    t->has_job = true;
  }
  pthread_cond_broadcast(&t->changed);
  pthread_mutex_unlock(&t->lock);
}

static void *find(void *context) {
  struct live_topography *t = context;
  const placido_mires_options options = {.threads = 1};
  placido_frame frame = {0};
  while (take_frame(t, &frame)) {
    struct job job = {.seq = frame.seq, .began_ns = placido_clock_now_ns()};
    const int status =
        placido_mires_find(&job.mires, &frame, t->instrument, &options, NULL, &job.refusal);
    job.refusal.status = status;
    hand_on(t, &job);
  }
  placido_frame_free(&frame);
  return NULL;
}

static bool take_job(struct live_topography *t, struct job *job) {
  pthread_mutex_lock(&t->lock);
  while (!t->has_job && !t->ends) {
    pthread_cond_wait(&t->changed, &t->lock);
  }
  const bool goes_on = !t->ends;
  if (goes_on) {
    *job = t->found;
    t->has_job = false;
    t->is_fitting = true;
    pthread_cond_broadcast(&t->changed);
  }
  pthread_mutex_unlock(&t->lock);
  return goes_on;
}

/* The mires' surface, which takes the place of the last one. */
static int fit(struct live_topography *t, struct job *job) {
  const placido_fit_options options = {
      .axis_z_mm = t->axis_z_mm, .threads = 1, .start = t->fit};
  placido_fit *made = NULL;
  const int status = placido_fit_new(&made, &job->mires, t->instrument, &options, NULL,
                                     &job->refusal);
  if (status == PLACIDO_OK) {
    placido_fit_free(t->fit);
    t->fit = made;
  }
  return status;
}

static double value_of(const placido_index_value *values, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return values[i].value;
    }
  }
  return NAN;
}

static int read_keratometry(struct live_cornea *cornea, const placido_surface *surface,
                            placido_error *err) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
  const int status = placido_indices_find(values, &count, surface, NULL, err);
  if (status == PLACIDO_OK) {
    cornea->flat_D = value_of(values, count, "simk_flat_D");
    cornea->flat_axis_deg = value_of(values, count, "simk_flat_axis_deg");
    cornea->steep_D = value_of(values, count, "simk_steep_D");
    cornea->steep_axis_deg = value_of(values, count, "simk_steep_axis_deg");
    cornea->cylinder_D = value_of(values, count, "simk_cylinder_D");
  }
  return status;
}

/* Axial power, 337.5 over the distance along the normal to the axis; on the axis itself, where that
 * has no value, that of the point beside it. */
static double axial_D(const placido_surface *surface, double x_mm, double y_mm) {
  placido_jet jet;
  const double r_mm = hypot(x_mm, y_mm);
  if (r_mm == 0) {
    return axial_D(surface, LIVE_MAP_STEP_MM / 2, 0);
  }
  if (!placido_surface_covered(surface, x_mm, y_mm) ||
      !placido_surface_at(surface, x_mm, y_mm, &jet)) {
    return NAN;
  }
  const double slope = (jet.sx * x_mm + jet.sy * y_mm) / r_mm;
  return 337.5 * slope / (r_mm * sqrt(1 + slope * slope));
}

static void read_map(struct live_cornea *cornea, const placido_surface *surface) {
  const int half = LIVE_MAP_SIDE / 2;
  for (int k = 0; k < LIVE_MAP_SIDE * LIVE_MAP_SIDE; k++) {
    const int i = k % LIVE_MAP_SIDE - half, j = k / LIVE_MAP_SIDE - half;
    cornea->axial_D[k] = (float)axial_D(surface, i * LIVE_MAP_STEP_MM, j * LIVE_MAP_STEP_MM);
  }
}

/* Keeps the figures, and the number of frames. */
static void publish(struct live_topography *t, const struct live_cornea *cornea) {
  pthread_mutex_lock(&t->lock);
  const long count = t->latest.count + 1;
  const long corneas = t->latest.corneas + (cornea->reason[0] == '\0');
  t->latest = *cornea;
  t->latest.count = count;
  t->latest.corneas = corneas;
  t->is_fitting = false;
  pthread_cond_broadcast(&t->changed);
  pthread_mutex_unlock(&t->lock);
}

static void no_cornea(struct live_cornea *cornea) {
  cornea->flat_D = cornea->flat_axis_deg = NAN;
  cornea->steep_D = cornea->steep_axis_deg = cornea->cylinder_D = NAN;
  for (int k = 0; k < LIVE_MAP_SIDE * LIVE_MAP_SIDE; k++) {
    cornea->axial_D[k] = NAN;
  }
}

static void *measure(void *context) {
  struct live_topography *t = context;
  struct job job;
  while (take_job(t, &job)) {
    struct live_cornea cornea = {.seq = job.seq};
    no_cornea(&cornea);
    int status = job.refusal.status;
    if (status == PLACIDO_OK) {
      status = fit(t, &job);
    }
    if (status == PLACIDO_OK) {
      status = read_keratometry(&cornea, placido_fit_surface(t->fit), &job.refusal);
    }
    if (status == PLACIDO_OK) {
      read_map(&cornea, placido_fit_surface(t->fit));
    } else {
      snprintf(cornea.reason, sizeof cornea.reason, "%s", job.refusal.text);
    }
    placido_mires_free(&job.mires);
    cornea.measure_ms = 1e-6 * (double)(placido_clock_now_ns() - job.began_ns);
    publish(t, &cornea);
  }
  return NULL;
}

/* Signals are for the threads that know what to do with them. */
static void start_threads(struct live_topography *t) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, &before);
  t->has_finder = pthread_create(&t->finder, NULL, find, t) == 0;
  t->has_fitter = t->has_finder && pthread_create(&t->fitter, NULL, measure, t) == 0;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

int live_topography_open(struct live_topography **topography, const placido_instrument *instrument,
                         double axis_z_mm, placido_error *err) {
  struct live_topography *t = *topography = placido_memory_new(1, sizeof *t, err);
  if (!t) {
    return PLACIDO_MEMORY;
  }
  t->instrument = instrument;
  t->axis_z_mm = axis_z_mm;
  no_cornea(&t->latest);
  pthread_mutex_init(&t->lock, NULL);
  pthread_cond_init(&t->changed, NULL);
  start_threads(t);
  if (!t->has_fitter) {
    live_topography_close(t);
    *topography = NULL;
    return placido_error_set(err, PLACIDO_SYSTEM, "no thread can be started for the topography");
  }
  return PLACIDO_OK;
}

void live_topography_close(struct live_topography *topography) {
  struct live_topography *t = topography;
  if (!t) {
    return;
  }
  pthread_mutex_lock(&t->lock);
  t->ends = true;
  pthread_cond_broadcast(&t->changed);
  pthread_mutex_unlock(&t->lock);
  if (t->has_finder) {
    pthread_join(t->finder, NULL);
  }
  if (t->has_fitter) {
    pthread_join(t->fitter, NULL);
  }
  if (t->has_job) {
    placido_mires_free(&t->found.mires);
  }
  placido_frame_free(&t->newest);
  placido_fit_free(t->fit);
  pthread_cond_destroy(&t->changed);
  pthread_mutex_destroy(&t->lock);
  placido_memory_free(t);
}

int live_topography_give(struct live_topography *topography, const placido_frame *frame,
                         placido_error *err) {
  pthread_mutex_lock(&topography->lock);
  const int status = copy_frame(&topography->newest, frame, err);
  topography->has_frame = status == PLACIDO_OK;
  pthread_cond_broadcast(&topography->changed);
  pthread_mutex_unlock(&topography->lock);
  return status;
}

void live_topography_wait_taken(struct live_topography *topography) {
  pthread_mutex_lock(&topography->lock);
  while (topography->has_frame) {
    pthread_cond_wait(&topography->changed, &topography->lock);
  }
  pthread_mutex_unlock(&topography->lock);
}

void live_topography_wait_measured(struct live_topography *topography) {
  struct live_topography *t = topography;
  pthread_mutex_lock(&t->lock);
  while (t->has_frame || t->is_finding || t->has_job || t->is_fitting) {
    pthread_cond_wait(&t->changed, &t->lock);
  }
  pthread_mutex_unlock(&t->lock);
}

void live_topography_latest(struct live_topography *topography, struct live_cornea *cornea) {
  pthread_mutex_lock(&topography->lock);
  *cornea = topography->latest;
  pthread_mutex_unlock(&topography->lock);
}

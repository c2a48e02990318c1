/* From a frame to numbered edge points: the steps in their order. */
#include <placido/mires.h>

#include "base/memory.h"
#include "reconstruct/mires/centre.h"
#include "reconstruct/mires/confirm.h"
#include "reconstruct/mires/edges.h"
#include "reconstruct/mires/expect.h"
#include "reconstruct/mires/folds.h"
#include "reconstruct/mires/gate.h"
#include "reconstruct/mires/link.h"
#include "reconstruct/mires/number.h"
#include "reconstruct/mires/plane.h"
#include "reconstruct/mires/polar.h"
#include "reconstruct/mires/settle.h"

#include <math.h>
#include <stdlib.h>

/* What an ordinary cornea would show: the yardstick for windows and tolerances. */
typedef struct yardstick {
  double expected_px[PLACIDO_EDGES_MAX];
  double inner_px;   /* out to the first few edges */
  double reach_px;   /* out to the last edge */
  double spacing_px; /* the usual distance between edges */
  double narrow_px;  /* the least */
} yardstick;

#define ORDINARY_CORNEA_MM 7.8
/* At least so many are looked at: over wider steps edges lose their way. */
#define MERIDIANS_LINKED 300
#define UNMEASURED_PX 0.5 /* standard deviation of what was seen and could not be measured */
#define FLATTEST 1.6 /* mires reach no further than this times the ordinary reach */

static int yardstick_of(yardstick *out, const placido_instrument *instrument,
                        placido_error *err) {
  int n = instrument->edge_count, seen = 0;
  placido_mires_expect(out->expected_px, instrument, ORDINARY_CORNEA_MM);
  while (seen < n && isfinite(out->expected_px[seen])) {
    seen++;
  }
  if (seen < 3) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "instrument: only %d of its %d edges can be mirrored by a cornea of "
                             "%.1f mm, at least 3 are needed",
                             seen, n, ORDINARY_CORNEA_MM);
  }
  out->reach_px = out->expected_px[seen - 1];
  out->inner_px = 1.2 * out->expected_px[1];
  out->spacing_px = (out->reach_px - out->expected_px[0]) / (seen - 1);
  out->narrow_px = out->reach_px;
  for (int k = 1; k < seen; k++) {
    out->narrow_px = fmin(out->narrow_px, out->expected_px[k] - out->expected_px[k - 1]);
  }
  if (!(out->spacing_px > 1)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "instrument: its edges would be %.2f px apart in the image, from the "
                             "innermost out; at least 1 px is needed",
                             out->spacing_px);
  }
  return PLACIDO_OK;
}

static int by_edge(const void *a, const void *b) {
  const placido_mire_point *x = a, *y = b;
  return x->edge != y->edge ? x->edge - y->edge
                            : (x->meridian_deg > y->meridian_deg) -
                                  (x->meridian_deg < y->meridian_deg);
}

static placido_mire_point point_of(const placido_mires *mires, const placido_crossings *all,
                                   const placido_crossing *c) {
  double angle = 2 * M_PI * c->meridian / all->meridians;
  return (placido_mire_point){.edge = c->edge,
                              .meridian_deg = 360.0 * c->meridian / all->meridians,
                              .u_px = mires->centre_u_px + c->radius_px * cos(angle),
                              .v_px = mires->centre_v_px - c->radius_px * sin(angle),
                              .sigma_px = c->sigma_px > 0 ? c->sigma_px : UNMEASURED_PX,
                              .used = !c->doubtful,
                              .residual_px = NAN,
                              .folded = c->folded};
}

/* Copies the numbered crossings of every stride-th meridian out as points. */
static int collect(placido_mires *mires, const placido_crossings *all, int stride,
                   placido_error *err) {
  mires->points = placido_memory_new(all->count, sizeof *mires->points, err);
  mires->doubtful = placido_memory_new(all->count, sizeof *mires->doubtful, err);
  if (!mires->points || !mires->doubtful) {
    return PLACIDO_MEMORY;
  }
  double sum = 0;
  for (size_t i = 0; i < all->count; i++) {
    const placido_crossing *c = &all->list[i];
    if (c->edge < 0 || c->meridian % stride != 0) {
      continue;
    }
    placido_mire_point point = point_of(mires, all, c);
    if (c->doubtful) {
      mires->doubtful[mires->doubtful_count++] = point;
    } else {
      mires->points[mires->count++] = point;
      sum += c->height;
    }
  }
  qsort(mires->points, mires->count, sizeof *mires->points, by_edge);
  qsort(mires->doubtful, mires->doubtful_count, sizeof *mires->doubtful, by_edge);
  mires->contrast = mires->count ? sum / (double)mires->count : 0;
  mires->coverage = (double)(mires->count + mires->doubtful_count) /
                    ((double)mires->edge_count * mires->meridian_count);
  return PLACIDO_OK;
}

/* Refuses where too few edges were seen: never a pretty map from four mires. */
static int check_enough(const placido_mires *mires, int edges_min, placido_error *err) {
  int enough = 0;
  size_t i = 0;
  for (int k = 0; k < mires->edge_count; k++) {
    size_t start = i;
    while (i < mires->count && mires->points[i].edge == k) {
      i++;
    }
    enough += (i - start) * 5 >= (size_t)mires->meridian_count;
  }
  if (enough < edges_min) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "only %d of %d mire edges were seen on at least a fifth of the "
                             "meridians, %d are needed",
                             enough, mires->edge_count, edges_min);
  }
  return PLACIDO_OK;
}

/* Measures the numbered crossings; those that cannot be measured keep their number. */
static int measure(placido_crossings *all, const placido_polar *polar, int threads,
                   placido_error *err) {
  int *numbers = placido_memory_new(all->count, sizeof *numbers, err);
  if (!numbers) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < all->count; i++) {
    numbers[i] = all->list[i].edge;
  }
  int status = placido_crossings_measure(all, polar, threads, err);
  for (size_t i = 0; i < all->count && !status; i++) {
    placido_crossing *c = &all->list[i];
    if (c->edge < 0 && numbers[i] >= 0) {
      c->edge = numbers[i];
      c->sigma_px = 0;
    }
  }
  placido_memory_free(numbers);
  return status;
}

static int check_frame(const placido_frame *frame, const placido_instrument *instrument,
                       placido_error *err) {
  if (frame->width_px != instrument->width_px || frame->height_px != instrument->height_px) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the image is %d×%d px, but the instrument \"%s\" says %d×%d px",
                             frame->width_px, frame->height_px, instrument->name,
                             instrument->width_px, instrument->height_px);
  }
  return PLACIDO_OK;
}

int placido_mires_find(placido_mires *mires, const placido_frame *frame,
                       const placido_instrument *instrument,
                       const placido_mires_options *options, placido_notes *notes,
                       placido_error *err) {
  int meridians = options && options->meridians ? options->meridians : 360;
  int edges_min = options && options->edges_min ? options->edges_min : 5;
  int threads = options && options->threads ? options->threads : 1;
  int stride = 1, linked = meridians;
  if (meridians > 0 && meridians < MERIDIANS_LINKED) {
    stride = (MERIDIANS_LINKED + meridians - 1) / meridians;
    linked = meridians * stride;
  }
  *mires = (placido_mires){.edge_count = instrument->edge_count, .meridian_count = meridians};
  placido_image plane = {0};
  placido_polar polar = {0};
  placido_crossings crossings = {0};
  placido_chains chains = {0};
  yardstick yard;
  double centre[2] = {0};
  int status = check_frame(frame, instrument, err);
  if (!status && (meridians < 24 || meridians > 3600)) {
    status = placido_error_set(err, PLACIDO_INPUT, "%d meridians, expected 24 to 3600",
                               meridians);
  }
  if (status || (status = yardstick_of(&yard, instrument, err)) ||
      (status = placido_mires_plane(&plane, frame, err)) ||
      (status = placido_mires_centre(centre, &plane, yard.reach_px, yard.inner_px,
                                     yard.narrow_px, err)) ||
      (status = placido_polar_new(&polar, &plane, centre, FLATTEST * yard.reach_px, linked,
                                  threads, err)) ||
      (status = placido_crossings_find(&crossings, &polar, yard.spacing_px, yard.reach_px, threads,
                                       err)) ||
      (status = placido_chains_link(&chains, &crossings, linked / 60, err)) ||
      (status = placido_chains_number(&chains, &crossings, instrument, yard.expected_px, err)) ||
      (status = placido_crossings_settle(&crossings, &chains, instrument->edge_count,
                                         instrument->first_band_bright, yard.expected_px, err))) {
    goto done;
  }
  if ((status = measure(&crossings, &polar, threads, err))) {
    goto done;
  }
  mires->centre_u_px = centre[0];
  mires->centre_v_px = centre[1];
  if ((status = placido_crossings_gate(&crossings, instrument->edge_count, err)) ||
      (status = placido_crossings_confirm(&crossings, instrument->edge_count, yard.expected_px,
                                          err)) ||
      (status = placido_crossings_folds(&crossings, instrument->edge_count, &mires->folded,
                                        &mires->stray, err)) ||
      (status = collect(mires, &crossings, stride, err)) ||
      (status = check_enough(mires, edges_min, err))) {
    goto done;
  }
  double measured = (double)mires->count / ((double)mires->edge_count * mires->meridian_count);
  if (measured < 0.5) {
    placido_notes_add(notes, "only %.0f %% of the mires could be measured", 100 * measured);
  }
done:
  placido_image_free(&plane);
  placido_polar_free(&polar);
  placido_crossings_free(&crossings);
  placido_chains_free(&chains);
  if (status) {
    placido_mires_free(mires);
  }
  return status;
}

void placido_mires_free(placido_mires *mires) {
  placido_memory_free(mires->points);
  placido_memory_free(mires->doubtful);
  *mires = (placido_mires){0};
}

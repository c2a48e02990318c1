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
#include "reconstruct/mires/outermost.h"
#include "reconstruct/mires/plane.h"
#include "reconstruct/mires/polar.h"
#include "reconstruct/mires/settle.h"

#include <math.h>
#include <string.h>

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
#define FILTER_LEAST_PX 0.6 /* a pixel's own share of it is a B-spline of 0.58 px */
#define FILTER_MOST_PX 4.0
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

static placido_mire_point point_of(const placido_mires *mires, const placido_crossing *c,
                                   double meridian_deg, double cosine, double sine) {
  return (placido_mire_point){.edge = c->edge,
                              .meridian_deg = meridian_deg,
                              .u_px = mires->centre_u_px + c->radius_px * cosine,
                              .v_px = mires->centre_v_px - c->radius_px * sine,
                              .sigma_px = c->sigma_px > 0 ? c->sigma_px : UNMEASURED_PX,
                              .used = !c->doubtful,
                              .residual_px = NAN,
                              .folded = c->folded};
}

/* Where each edge's sure and doubtful points begin in the lists of them. */
typedef struct slots {
  size_t sure[PLACIDO_EDGES_MAX + 1], doubtful[PLACIDO_EDGES_MAX + 1];
} slots;

static slots count_slots(const placido_crossings *all, int stride) {
  slots s = {{0}, {0}};
  for (size_t i = 0; i < all->count; i++) {
    const placido_crossing *c = &all->list[i];
    if (c->edge >= 0 && c->meridian % stride == 0) {
      (c->doubtful ? s.doubtful : s.sure)[c->edge + 1]++;
    }
  }
  for (int k = 0; k < PLACIDO_EDGES_MAX; k++) {
    s.sure[k + 1] += s.sure[k];
    s.doubtful[k + 1] += s.doubtful[k];
  }
  return s;
}

/* Copies the numbered crossings of every stride-th meridian out as points, by edge and meridian. */
static int collect(placido_mires *mires, const placido_crossings *all, int stride,
                   placido_error *err) {
  slots next = count_slots(all, stride);
  mires->count = next.sure[PLACIDO_EDGES_MAX];
  mires->doubtful_count = next.doubtful[PLACIDO_EDGES_MAX];
  mires->points = placido_memory_new(mires->count, sizeof *mires->points, err);
  mires->doubtful = placido_memory_new(mires->doubtful_count, sizeof *mires->doubtful, err);
  if (!mires->points || !mires->doubtful) {
    return PLACIDO_MEMORY;
  }
  double sum = 0;
  for (int m = 0; m < all->meridians; m += stride) {
    double turn = (double)m / all->meridians;
    double cosine = cos(2 * M_PI * turn), sine = sin(2 * M_PI * turn);
    for (size_t i = all->first[m]; i < all->first[m + 1]; i++) {
      const placido_crossing *c = &all->list[i];
      if (c->edge < 0) {
        continue;
      }
      placido_mire_point *point = c->doubtful ? &mires->doubtful[next.doubtful[c->edge]++]
                                              : &mires->points[next.sure[c->edge]++];
      *point = point_of(mires, c, 360 * turn, cosine, sine);
      sum += c->doubtful ? 0 : c->height;
    }
  }
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

/* Measures the numbered crossings. Those that cannot be measured keep number and rough place. */
static int measure(placido_crossings *all, const placido_polar *polar, int threads,
                   placido_error *err) {
  placido_crossing *rough = placido_memory_new(all->count, sizeof *rough, err);
  if (!rough) {
    return PLACIDO_MEMORY;
  }
  memcpy(rough, all->list, all->count * sizeof *rough);
  int status = placido_crossings_measure(all, polar, threads, err);
  for (size_t i = 0; i < all->count && !status; i++) {
    placido_crossing *c = &all->list[i];
    if (rough[i].edge >= 0 && (c->edge < 0 || !(c->sigma_px < fmax(UNMEASURED_PX, c->width_px)))) {
      *c = rough[i];
      c->sigma_px = 0;
    }
  }
  placido_memory_free(rough);
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

/* What the steps hand to each other. */
typedef struct stages {
  const placido_instrument *instrument;
  int linked, stride, threads; /* meridians looked at, and every how many-th is handed out */
  double filter_px;
  yardstick yard;
  double centre_px[2];
  placido_image plane;
  placido_polar polar;
  placido_crossings crossings;
  placido_chains chains;
} stages;

/* From the frame to candidates linked into chains. */
static int look(stages *s, const placido_frame *frame, placido_error *err) {
  const yardstick *y = &s->yard;
  int status = yardstick_of(&s->yard, s->instrument, err);
  if (status || (status = placido_mires_plane(&s->plane, frame, err)) ||
      (status = placido_mires_centre(s->centre_px, &s->plane, y->reach_px, y->inner_px,
                                     y->narrow_px, err)) ||
      (status = placido_polar_new(&s->polar, &s->plane, s->centre_px, FLATTEST * y->reach_px,
                                  s->linked, s->filter_px, s->threads, err)) ||
      (status = placido_crossings_find(&s->crossings, &s->polar, y->spacing_px, y->reach_px,
                                       s->threads, err))) {
    return status;
  }
  return placido_chains_link(&s->chains, &s->crossings, s->linked / 60, err);
}

/* From chains to numbers that agree over the whole image. */
static int number(stages *s, placido_error *err) {
  const placido_instrument *in = s->instrument;
  const double *expected_px = s->yard.expected_px;
  int status = placido_chains_number(&s->chains, &s->crossings, in, expected_px, err);
  if (!status) {
    status = placido_crossings_settle(&s->crossings, &s->chains, in->edge_count,
                                      in->first_band_bright, expected_px, err);
  }
  if (!status) {
    status = placido_crossings_outermost(&s->crossings, in->edge_count, s->centre_px,
                                         s->plane.width_px, s->plane.height_px, s->yard.reach_px,
                                         err);
  }
  return status;
}

/* From numbered candidates to measured points. */
static int judge(placido_mires *mires, stages *s, placido_error *err) {
  int edges = s->instrument->edge_count;
  int status = measure(&s->crossings, &s->polar, s->threads, err);
  if (status || (status = placido_crossings_gate(&s->crossings, edges, err)) ||
      (status = placido_crossings_confirm(&s->crossings, edges, s->yard.expected_px, err)) ||
      (status = placido_crossings_folds(&s->crossings, edges, &mires->folded, &mires->stray,
                                        err))) {
    return status;
  }
  mires->centre_u_px = s->centre_px[0];
  mires->centre_v_px = s->centre_px[1];
  return collect(mires, &s->crossings, s->stride, err);
}

static int check_options(const stages *s, int meridians, placido_error *err) {
  if (meridians < 24 || meridians > 3600) {
    return placido_error_set(err, PLACIDO_INPUT, "%d meridians, expected 24 to 3600", meridians);
  }
  if (!(s->filter_px >= FILTER_LEAST_PX && s->filter_px <= FILTER_MOST_PX)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a filter of %g px along the mires, expected %g to %g px",
                             s->filter_px, FILTER_LEAST_PX, FILTER_MOST_PX);
  }
  return PLACIDO_OK;
}

int placido_mires_find(placido_mires *mires, const placido_frame *frame,
                       const placido_instrument *instrument,
                       const placido_mires_options *options, placido_notes *notes,
                       placido_error *err) {
  int meridians = options && options->meridians ? options->meridians : 360;
  int edges_min = options && options->edges_min ? options->edges_min : 5;
  stages s = {.instrument = instrument,
              .linked = meridians,
              .stride = 1,
              .filter_px = options && options->filter_px != 0 ? options->filter_px : 1,
              .threads = options && options->threads ? options->threads : 1};
  if (meridians > 0 && meridians < MERIDIANS_LINKED) {
    s.stride = (MERIDIANS_LINKED + meridians - 1) / meridians;
    s.linked = meridians * s.stride;
  }
  *mires = (placido_mires){.edge_count = instrument->edge_count, .meridian_count = meridians};
  int status = check_frame(frame, instrument, err);
  if (!status) {
    status = check_options(&s, meridians, err);
  }
  if (!status && !(status = look(&s, frame, err)) && !(status = number(&s, err)) &&
      !(status = judge(mires, &s, err))) {
    status = check_enough(mires, edges_min, err);
  }
  double measured = (double)mires->count / ((double)mires->edge_count * mires->meridian_count);
  if (!status && measured < 0.5) {
    placido_notes_add(notes, "only %.0f %% of the mires could be measured", 100 * measured);
  }
  placido_image_free(&s.plane);
  placido_polar_free(&s.polar);
  placido_crossings_free(&s.crossings);
  placido_chains_free(&s.chains);
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

/* Outliers are told by how far a point lies from what is usual on its own edge, in robust standard
 * deviations. */
#include "reconstruct/solve/doubt/outliers.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/errors/noise.h"

#include <math.h>

#define CUT 5.0         /* in robust standard deviations */
#define CUT_NOISE 2.0   /* most of a point's own noise that the cut allows for */
#define CUT_SPREAD 2    /* neighbours along the edge that go with a cut point */
#define SPREAD_MIN_PX 0.01
#define ASTRAY 0.15     /* of the edges' distance: real eyes stay under a third of it */
#define DOUBTFUL 3.0    /* spread over rough noise from which on the user is warned */

/* Every sample's residual less what is usual on its edge, and the robust spread of the used ones'.
 * A mire that the instrument file puts in a slightly wrong place is off as a whole, which says
 * nothing against one of its points. Free with placido_memory_free. */
static int deviations_new(double **list, double *spread, const placido_sample *samples,
                          size_t count, double *work, placido_error *err) {
  double *deviation = *list = placido_memory_new(count, sizeof *deviation, err);
  if (!deviation) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count;) {
    size_t first = i, n = 0;
    for (; i < count && samples[i].edge == samples[first].edge; i++) {
      deviation[i] = samples[i].residual_px * samples[i].shared;
      if (!isnan(deviation[i])) {
        work[n++] = deviation[i];
      }
    }
    double usual = placido_quantile(work, n, 0.5);
    for (size_t k = first; k < i; k++) {
      deviation[k] -= usual;
    }
  }
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used && !isnan(deviation[i])) {
      work[n++] = fabs(deviation[i]);
    }
  }
  *spread = 1.4826 * placido_quantile(work, n, 0.5);
  return PLACIDO_OK;
}

/* Marks point i and its neighbours along the edge. */
static void mark(const placido_sample *samples, size_t count, size_t i, unsigned char *out) {
  for (size_t j = i > CUT_SPREAD ? i - CUT_SPREAD : 0; j <= i + CUT_SPREAD && j < count; j++) {
    if (samples[j].edge == samples[i].edge) {
      out[j] = 1;
    }
  }
}

int placido_outliers_cut(placido_sample *samples, size_t count, double *work, size_t *cut,
                         bool *changed, placido_error *err) {
  double *deviation, spread;
  unsigned char *out = placido_memory_new(count, 1, err);
  int status = out ? deviations_new(&deviation, &spread, samples, count, work, err)
                   : PLACIDO_MEMORY;
  if (status) {
    placido_memory_free(out);
    return status;
  }
  double limit = CUT * fmax(SPREAD_MIN_PX, spread);
  for (size_t i = 0; i < count; i++) {
    double allowed = limit * fmin(1, CUT_NOISE * samples[i].shared / samples[i].noise);
    if (!(fabs(deviation[i]) < allowed)) {
      mark(samples, count, i, out);
    }
  }
  *cut = 0;
  *changed = false;
  for (size_t i = 0; i < count; i++) {
    *changed |= samples[i].used == (out[i] == 1);
    samples[i].used = !out[i];
    *cut += out[i];
  }
  placido_memory_free(deviation);
  placido_memory_free(out);
  return PLACIDO_OK;
}

/* The median distance of neighbouring edges along a meridian, in the image; NaN where no meridian
 * shows two edges. */
static int edge_distance(double *distance_px, const placido_mires *mires, double *gaps,
                         placido_error *err) {
  size_t meridians = (size_t)mires->meridian_count, n = 0;
  size_t *last = placido_memory_new(meridians, sizeof *last, err);
  if (!last) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *a = &mires->points[i];
    size_t m = (size_t)lrint(a->meridian_deg * (double)meridians / 360) % meridians;
    if (last[m]) {
      const placido_mire_point *b = &mires->points[last[m] - 1];
      if (a->edge > b->edge) {
        gaps[n++] = hypot(a->u_px - b->u_px, a->v_px - b->v_px) / (a->edge - b->edge);
      }
    }
    last[m] = i + 1;
  }
  *distance_px = placido_quantile(gaps, n, 0.5);
  placido_memory_free(last);
  return PLACIDO_OK;
}

int placido_outliers_judge(const placido_sample *samples, size_t count,
                           const placido_mires *mires, double *work, placido_notes *notes,
                           placido_error *err) {
  double distance, *deviation, astray;
  int status = edge_distance(&distance, mires, work, err);
  if (!status) {
    status = deviations_new(&deviation, &astray, samples, count, work, err);
  }
  if (status) {
    return status;
  }
  placido_memory_free(deviation);
  if (isnan(distance)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no meridian shows more than one edge: a surface needs two at least");
  }
  double spread = placido_samples_spread(samples, count, work);
  double rough = placido_noise_rough(samples, count, mires, 1, work);
  if (!(astray < ASTRAY * distance)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no smooth cornea mirrors the mires to where they are seen: along "
                             "the edges points stray by %.1f px (limit %.1f px, %.0f %% of the "
                             "edges' distance)",
                             astray, ASTRAY * distance, 100 * ASTRAY);
  }
  if (spread > DOUBTFUL * fmax(rough, SPREAD_MIN_PX)) {
    placido_notes_add(notes,
                      "the mires lie %.2f px off the fitted surface, %.0f times their own noise: "
                      "the instrument's geometry, the distance, the numbering or knots this "
                      "coarse do not fit, and the error bars do not know of it",
                      spread, spread / rough);
  }
  return PLACIDO_OK;
}

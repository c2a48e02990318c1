/* Points are indices into tables later on, so what is not a number or out of order ends here. */
#include "reconstruct/solve/given.h"

#include <math.h>

#define BESIDE 0.0625 /* of the image, as frames that were laid over each other reach beyond it */

/* Lengths of an instrument that looks at a cornea: far wider than any that was built, and far from
 * those of one whose file is in metres or micrometres. */
#define MIRE_LEAST_MM 1.0 /* radius of the widest edge */
#define MIRE_MOST_MM 1000.0
#define CAMERA_LEAST_MM 5.0 /* from the cornea */
#define CAMERA_MOST_MM 5000.0

static int check_instrument(const placido_instrument *in, double axis_z_mm, placido_error *err) {
  double widest_mm = 0, away_mm = in->position_mm[2] - axis_z_mm;
  for (int k = 0; k < in->edge_count; k++) {
    const placido_edge *edge = &in->edges[k];
    if (!(edge->radius_mm > 0) || !isfinite(edge->radius_mm) || !isfinite(edge->z_mm)) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "edge %d of the instrument has a radius of %g mm and lies at z = %g "
                               "mm: finite numbers and a positive radius are expected",
                               k, edge->radius_mm, edge->z_mm);
    }
    widest_mm = fmax(widest_mm, edge->radius_mm);
  }
  if (!(widest_mm >= MIRE_LEAST_MM && widest_mm <= MIRE_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the widest edge of the instrument has a radius of %g mm, %g to %g mm "
                             "are expected: are its lengths in millimetres?",
                             widest_mm, MIRE_LEAST_MM, MIRE_MOST_MM);
  }
  if (in->model == PLACIDO_PINHOLE && !(away_mm >= CAMERA_LEAST_MM && away_mm <= CAMERA_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera stands %g mm from the cornea, %g to %g mm are expected: "
                             "are the instrument's lengths and the distance in millimetres?",
                             away_mm, CAMERA_LEAST_MM, CAMERA_MOST_MM);
  }
  return PLACIDO_OK;
}

static bool is_within(double at_px, int size_px) {
  double beside = BESIDE * size_px;
  return at_px >= -beside && at_px <= size_px + beside;
}

/* One point, and that it stands behind the one before it, whose place is `last`. */
static int check_point(const placido_mires *mires, const placido_instrument *instrument, size_t i,
                       long *last, placido_error *err) {
  const placido_mire_point *p = &mires->points[i];
  if (p->edge < 0 || p->edge >= instrument->edge_count) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "edge point %zu is of edge %d: the instrument has 0 to %d", i, p->edge,
                             instrument->edge_count - 1);
  }
  if (!is_within(p->u_px, instrument->width_px) || !is_within(p->v_px, instrument->height_px)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "edge point %zu (edge %d, %g degrees) lies at (%g, %g) px, which is "
                             "not in the image of %d x %d px",
                             i, p->edge, p->meridian_deg, p->u_px, p->v_px, instrument->width_px,
                             instrument->height_px);
  }
  if (!(p->sigma_px > 0) || !isfinite(p->sigma_px)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "edge point %zu (edge %d, %g degrees) has a standard deviation of %g "
                             "px: a positive number is expected",
                             i, p->edge, p->meridian_deg, p->sigma_px);
  }
  double turn = p->meridian_deg / 360 * mires->meridian_count;
  if (!(turn >= 0 && turn < mires->meridian_count - 0.5)) {
    return placido_error_set(
        err, PLACIDO_INPUT,
        "edge point %zu (edge %d) lies on a meridian of %g degrees: one of the "
        "%d from 0 to below 360 is expected",
        i, p->edge, p->meridian_deg, mires->meridian_count);
  }
  long place = (long)p->edge * mires->meridian_count + lrint(turn);
  if (place <= *last) {
    return placido_error_set(
        err, PLACIDO_INPUT,
        "edge point %zu (edge %d, %g degrees) %s: one point of an edge on each "
        "of %d meridians is expected, in order of edges, then meridians",
        i, p->edge, p->meridian_deg, place == *last ? "stands twice" : "stands behind later ones",
        mires->meridian_count);
  }
  *last = place;
  return PLACIDO_OK;
}

static int check_numbers(const placido_fit_options *o, placido_error *err) {
  if (!isfinite(o->axis_z_mm) || !(o->axis_z_sigma_mm >= 0) || !isfinite(o->axis_z_sigma_mm)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "z on the axis is given as %g mm with a standard deviation of %g mm: "
                             "finite numbers are expected, the second not negative",
                             o->axis_z_mm, o->axis_z_sigma_mm);
  }
  if (!(o->smoothing >= 0) || !isfinite(o->smoothing) || o->steps_max < 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "smoothing of weight %g in at most %d steps: numbers from 0 are "
                             "expected, 0 for the default",
                             o->smoothing, o->steps_max);
  }
  return PLACIDO_OK;
}

int placido_given_check(const placido_mires *mires, const placido_instrument *instrument,
                        const placido_fit_options *options, placido_error *err) {
  long last = -1;
  int status = options ? check_numbers(options, err) : PLACIDO_OK;
  if (!status && (mires->edge_count != instrument->edge_count || mires->meridian_count < 1)) {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "mires of %d edges on %d meridians, expected the instrument's %d on "
                               "at least one",
                               mires->edge_count, mires->meridian_count, instrument->edge_count);
  }
  if (!status) {
    status = check_instrument(instrument, options ? options->axis_z_mm : 0, err);
  }
  for (size_t i = 0; i < mires->count && !status; i++) {
    status = check_point(mires, instrument, i, &last, err);
  }
  return status;
}

/* A rendered picture flipped and turned by quarters, pixel by pixel: the mires are found where they
 * have gone, and cornea and keratometry follow.
 *
 * The mires' centre, which meridians go through, is found from some of the pixels, other ones in a
 * flipped picture: it is off by c. Meridians then meet an edge up to c farther along it, and their
 * samples lie up to c farther out. A Gaussian of f = 1 px along the mire has smoothed the noise,
 * which loses 1 - exp(-c²/(4 f²)) of its correlation with that before; across, a cubic spline has
 * put it between the pixels nearly as sinc does, whose correlation falls by (π c)²/6. Edges differ
 * by the root of twice that of their noise. */
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/stability/zone.h"
#include "tests/support/named_index.h"

#include <float.h>
#include <math.h>
#include <placido/index.h>
#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define MERIDIANS 120
#define TOLERANCE 1e-4 /* of the fit: what a last step moves residuals by, of their noise */

/* What is found of one picture. */
struct found {
  placido_instrument instrument;
  placido_mires mires;
  placido_fit *fit;
  struct zone zone;
};

static placido_frame frame;
static struct found straight;

static const struct symmetry {
  const char *name;
  double turn[2][2]; /* of x to the right and y upwards */
} symmetries[] = {{"left to right", {{-1, 0}, {0, 1}}},
                  {"upside down", {{1, 0}, {0, -1}}},
                  {"turned by 180 degrees", {{-1, 0}, {0, -1}}},
                  {"turned by 90 degrees", {{0, -1}, {1, 0}}}};

static void add_row(const struct symmetry *symmetry, const char *what, double condition,
                    double perturbation, const char *in_unit, double change, const char *out_unit,
                    double bound) {
  const struct bounded row = {condition, perturbation, in_unit, change, out_unit, bound};
  case_bounded(&row, "%s: %s", symmetry->name, what);
}

/* Where a turn about the picture's middle takes the middle of a pixel. */
static void place_of(double at[2], const placido_frame *to, const double turn[2][2], double u,
                     double v) {
  double x = u - (frame.width_px - 1) / 2.0, y = (frame.height_px - 1) / 2.0 - v;
  at[0] = (to->width_px - 1) / 2.0 + turn[0][0] * x + turn[0][1] * y;
  at[1] = (to->height_px - 1) / 2.0 - (turn[1][0] * x + turn[1][1] * y);
}

static void turn_frame(placido_frame *to, const double turn[2][2]) {
  bool across = turn[0][0] == 0;
  assert_int_equal(placido_frame_resize(to, across ? frame.height_px : frame.width_px,
                                        across ? frame.width_px : frame.height_px, PLACIDO_MONO8,
                                        NULL),
                   PLACIDO_OK);
  for (int v = 0; v < frame.height_px; v++) {
    for (int u = 0; u < frame.width_px; u++) {
      double at[2];
      place_of(at, to, turn, u, v);
      to->data[(size_t)at[1] * to->stride_bytes + (size_t)at[0]] =
          frame.data[(size_t)v * frame.stride_bytes + (size_t)u];
    }
  }
}

static void turn_instrument(placido_instrument *to, const placido_frame *turned,
                            const double turn[2][2]) {
  *to = straight.instrument;
  to->width_px = turned->width_px;
  to->height_px = turned->height_px;
  place_of(to->principal_px, turned, turn, straight.instrument.principal_px[0],
           straight.instrument.principal_px[1]);
}

static void find(struct found *found, const placido_frame *picture, const double turn[2][2]) {
  const placido_mires_options how = {.meridians = MERIDIANS, .threads = 2};
  const placido_fit_options options = {.knot_mm = 0.5, .tolerance = TOLERANCE, .threads = 2};
  placido_error err = {0};
  int status = placido_mires_find(&found->mires, picture, &found->instrument, &how, NULL, &err);
  if (!status) {
    status = placido_fit_new(&found->fit, &found->mires, &found->instrument, &options, NULL, &err);
  }
  if (status) {
    fail_msg("%s", err.text);
  }
  zone_see(&found->zone, placido_fit_surface(found->fit), turn);
}

static void forget(struct found *found) {
  placido_fit_free(found->fit);
  placido_mires_free(&found->mires);
}

/* The point of an edge on a meridian; NULL: there is none. */
static const placido_mire_point *point_at(const placido_mires *mires, int edge, double deg) {
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    if (p->edge == edge && fabs(remainder(p->meridian_deg - deg, 360)) < 180.0 / MERIDIANS) {
      return p;
    }
  }
  return NULL;
}

/* The centre is where gradients' lines meet: 30 at least, each as far off as noise of 1.2 grey
 * levels turns the gradient of a mire (50 levels) over the last window's 30 px, about 1 px; three
 * standard deviations of the difference of two. */
static double centre_bound(void) {
  return 3 * sqrt(2) * 1 / sqrt(30);
}

static double centre_moved(const struct found *found, const placido_frame *picture,
                           const double turn[2][2]) {
  double at[2];
  place_of(at, picture, turn, straight.mires.centre_u_px, straight.mires.centre_v_px);
  return hypot(found->mires.centre_u_px - at[0], found->mires.centre_v_px - at[1]);
}

/* By how much of itself noise differs that far away, as the file's comment has it. */
static double unlike_of(double c) {
  return sqrt(2 * fmin(1, 1 - exp(-c * c / 4) + pow(acos(-1) * c, 2) / 6));
}

/* Root mean square difference of how far points lie from their own fit's edge; gives how many
 * points only one of the pictures has. */
static size_t compare_points(const struct found *found, const double turn[2][2], double *rms_px) {
  size_t alone = 0, both = 0;
  double squares = 0;
  for (size_t i = 0; i < straight.mires.count; i++) {
    const placido_mire_point *p = &straight.mires.points[i];
    double deg = p->meridian_deg * acos(-1) / 180;
    double x = turn[0][0] * cos(deg) + turn[0][1] * sin(deg);
    double y = turn[1][0] * cos(deg) + turn[1][1] * sin(deg);
    const placido_mire_point *q = point_at(&found->mires, p->edge, atan2(y, x) * 180 / acos(-1));
    if (q && q->used && p->used) {
      squares += (q->residual_px - p->residual_px) * (q->residual_px - p->residual_px);
      both++;
    }
    alone += !q || q->used != p->used;
  }
  *rms_px = sqrt(squares / (double)both);
  return alone;
}

/* What independent errors of that size do: 5 standard deviations of per_px times it. A last step
 * leaves TOLERANCE of the noise in all N points from either side, per_px √N of that; a point that
 * only one picture has counts as much as its own residual, some 5 times the noise at most. */
static double change_bound(double per_px, double rms_px, size_t alone) {
  const placido_fit_summary summary = placido_fit_summary_get(straight.fit);
  double left_px = sqrt((double)summary.points_used) * 2 * TOLERANCE * summary.sigma_px;
  return per_px * (5 * rms_px + left_px + sqrt((double)alone) * 5 * summary.sigma_px);
}

static void compare_indices(const struct symmetry *symmetry, const struct found *found,
                            double rms_px, size_t alone) {
  static placido_index_value before[PLACIDO_INDICES_MAX], after[PLACIDO_INDICES_MAX];
  static const char *const names[] = {"simk_steep_D", "simk_flat_D", "simk_steep_axis_deg"};
  const double(*t)[2] = symmetry->turn;
  size_t counts[2];
  assert_int_equal(placido_indices_find(before, &counts[0], placido_fit_surface(straight.fit),
                                        straight.fit, NULL),
                   PLACIDO_OK);
  assert_int_equal(
      placido_indices_find(after, &counts[1], placido_fit_surface(found->fit), NULL, NULL),
      PLACIDO_OK);
  for (size_t i = 0; i < 3; i++) {
    const placido_index_value *a = named_index(before, counts[0], names[i]);
    const placido_index_value *b = named_index(after, counts[1], names[i]);
    double per_px = a->budget[PLACIDO_SIGMA_NOISE] / placido_fit_summary_get(straight.fit).sigma_px;
    double deg = a->value * acos(-1) / 180;
    double x = t[0][0] * cos(deg) + t[0][1] * sin(deg), y = t[1][0] * cos(deg) + t[1][1] * sin(deg);
    double change =
        i < 2 ? b->value - a->value : remainder(b->value - atan2(y, x) * 180 / acos(-1), 180);
    add_row(symmetry, names[i], per_px, rms_px, "px", fabs(change), a->unit,
            change_bound(per_px, rms_px, alone));
  }
}

static void flipped_pictures(void **state) {
  (void)state;
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  double sigma_px = placido_fit_summary_get(straight.fit).sigma_px;
  placido_fit_budget(straight.fit, ZONE_MM, budget);
  for (size_t k = 0; k < sizeof symmetries / sizeof symmetries[0]; k++) {
    const struct symmetry *s = &symmetries[k];
    placido_frame picture = {0};
    struct found found = {0};
    double rms_px, per_px = budget[PLACIDO_SIGMA_NOISE].z_um / sigma_px;
    turn_frame(&picture, s->turn);
    turn_instrument(&found.instrument, &picture, s->turn);
    find(&found, &picture, s->turn);
    double centre_px = centre_moved(&found, &picture, s->turn);
    double unlike = unlike_of(centre_px);
    size_t alone = compare_points(&found, s->turn, &rms_px);
    add_row(s, "mires' centre", NAN, NAN, NULL, centre_px, "px", centre_bound());
    add_row(s, "edges across, rms", unlike, centre_px, "px", rms_px, "px",
            placido_fit_summary_get(straight.fit).rms_px * unlike);
    /* what is used hangs on residuals that change by `unlike` of themselves: few lie that near to
     * the limit of 5 spreads */
    add_row(s, "points of one picture only", NAN, rms_px, "px", (double)alone, "points",
            0.003 * (double)straight.mires.count);
    add_row(s, "height, rms", per_px, rms_px, "px",
            zone_difference(found.zone.height_um, straight.zone.height_um), "um",
            change_bound(per_px, rms_px, alone));
    per_px = budget[PLACIDO_SIGMA_NOISE].axial_D / sigma_px;
    add_row(s, "axial power, rms", per_px, rms_px, "px",
            zone_difference(found.zone.axial_D, straight.zone.axial_D), "D",
            change_bound(per_px, rms_px, alone));
    compare_indices(s, &found, rms_px, alone);
    forget(&found);
    placido_frame_free(&picture);
  }
  assert_int_equal(stability_print("metamorphic: pictures"), 0);
}

static int set_up(void **state) {
  (void)state;
  placido_surface *eye;
  const placido_disturbance disturbance = {.seed = 5, .blur_px = 0.8, .noise = 1.2};
  if (placido_phantom_instrument(&straight.instrument, "cone24", NULL) ||
      placido_phantom_eye(&eye, "keratoconus", NULL)) {
    return 1;
  }
  int status = placido_phantom_render(&frame, eye, &straight.instrument, &disturbance, 0, NULL);
  placido_surface_free(eye);
  if (status == PLACIDO_OK) {
    find(&straight, &frame, NULL);
  }
  return status;
}

static int tear_down(void **state) {
  (void)state;
  forget(&straight);
  placido_frame_free(&frame);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(flipped_pictures)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}

/* Corneas from nearly flat to folded: measured as well as linear theory says, or not shown. */
#include "tests/stability/fits.h"

#include <stdio.h>

#define MERIDIANS 90
#define CUT 5.0 /* standard deviations that a point may be off before it is set aside */

typedef struct cornea {
  const char *name, *instrument;
  placido_part parts[2];
  size_t count;
  double knot_mm; /* 0: as fine as the fit thinks fit */
} cornea;

#define CONE(h, s, x, y)                                                                           \
  { FITS_CONIC(7.7, -0.3, 0, 0), FITS_CONE(h, s, x, y) }

/* The largest sixth derivative of a Gaussian, 15 h/s^6 at its top; a conicoid's own is below 0.02
 * and in the fit's base besides. */
static double sixth_of(const cornea *c) {
  const placido_part *cone = &c->parts[1];
  return c->count > 1 ? 15 * cone->as.bump.height_mm / pow(cone->as.bump.sigma_x_mm, 6) : 0;
}

/* From post-LASIK to the steepest, and cones up to where the mirror image is about to fold: their
 * knots are fine enough that truncation stays below the noise. */
static void flat_and_steep_corneas_are_measured(void **state) {
  (void)state;
  static const cornea corneas[] = {
      {"radius 13.2 mm, cone24", "cone24", {FITS_CONIC(13.2, 0.3, 0, 0.1)}, 1, 0},
      {"radius 12 mm, cone24", "cone24", {FITS_CONIC(12, 0.5, 0.1, 0)}, 1, 0},
      {"radius 12 mm, disc18", "disc18", {FITS_CONIC(12, 0.5, 0.1, 0)}, 1, 0},
      {"radius 5 mm, cone24", "cone24", {FITS_CONIC(5, -0.3, 0.1, 0)}, 1, 0},
      {"radius 5 mm, disc18", "disc18", {FITS_CONIC(5, -0.3, 0.1, 0)}, 1, 0},
      {"radius 4.4 mm, cone24", "cone24", {FITS_CONIC(4.4, -0.3, 0, 0.1)}, 1, 0},
      {"cone of 60 um, sigma 1.15 mm", "cone24", CONE(0.06, 1.15, 0.4, -0.8), 2, 0.25},
      {"cone of 100 um, sigma 0.92 mm", "cone24", CONE(0.10, 0.92, 0.4, -0.8), 2, 0.25},
      {"cone of 100 um, sigma 0.7 mm", "cone24", CONE(0.10, 0.70, 0.4, -0.8), 2, 0.25},
  };
  for (size_t i = 0; i < sizeof corneas / sizeof corneas[0]; i++) {
    const cornea *c = &corneas[i];
    fits_eye eye = fits_eye_new(c->instrument, c->parts, c->count, MERIDIANS);
    placido_fit_options options = {.knot_mm = c->knot_mm};
    placido_fit *fit = fits_of(&eye, NULL, &options);
    eye.truncation_um = fits_truncation_um(sixth_of(c), placido_fit_summary_get(fit).knot_mm);
    fits_error e = fits_compare(fit, &eye);
    fits_add(c->name, fit, &e, 0, eye.truncation_um, "um trunc.");
    assert_true(e.points > 300);
    placido_fit_free(fit);
    fits_eye_free(&eye);
  }
}

/* What no cornea is, is not measured as one. */
static void what_is_too_flat_or_too_steep_is_refused(void **state) {
  (void)state;
  static const cornea corneas[] = {
      {"radius 14.5 mm", "cone24", {FITS_CONIC(14.5, 0, 0, 0)}, 1, 0},
      {"radius 3.9 mm", "cone24", {FITS_CONIC(3.9, 0, 0, 0)}, 1, 0},
  };
  for (size_t i = 0; i < sizeof corneas / sizeof corneas[0]; i++) {
    fits_eye eye = fits_eye_new("cone24", corneas[i].parts, 1, MERIDIANS);
    placido_fit_options options = {.axis_z_mm = eye.axis_z_mm};
    fits_add_refusal(corneas[i].name, &eye.instrument, &eye.mires, &options, PLACIDO_QUALITY,
                     "a cornea has 25 to 80 D");
    fits_eye_free(&eye);
  }
}

/* Where the ray that the camera sees at (x, y) of the true cornea crosses an edge's plane. */
static bool crossing(double out[2], const fits_eye *eye, int edge, double x, double y) {
  placido_jet jet;
  if (!placido_surface_at(eye->truth, x, y, &jet)) {
    return false;
  }
  const double *camera = eye->instrument.position_mm;
  double z = placido_surface_vertex_z_mm(eye->truth) - jet.sag;
  double ray[3] = {x - camera[0], y - camera[1], z - camera[2]}, normal[3] = {jet.sx, jet.sy, 1};
  double along =
      (ray[0] * jet.sx + ray[1] * jet.sy + ray[2]) / (jet.sx * jet.sx + jet.sy * jet.sy + 1);
  for (int i = 0; i < 3; i++) {
    ray[i] -= 2 * along * normal[i];
  }
  double t = (eye->instrument.edges[edge].z_mm - z) / ray[2];
  out[0] = x + t * ray[0];
  out[1] = y + t * ray[1];
  return t > 0;
}

/* Whether the mirror image is turned inside out at (x, y), as it is between two of three places
 * that mirror one ring: the Jacobian of the map from the cornea to the mires is negative. On the
 * plane of the edge that is seen there; false where none is seen within 2 mm. */
static bool is_folded(const fits_eye *eye, double x, double y) {
  const double step = 1e-4;
  double best = 2, at[2], sides[4][2];
  int edge = -1;
  for (int k = 0; k < eye->instrument.edge_count; k++) {
    bool meets = crossing(at, eye, k, x, y);
    double off = meets ? fabs(hypot(at[0], at[1]) - eye->instrument.edges[k].radius_mm) : INFINITY;
    edge = off < best ? k : edge;
    best = fmin(best, off);
  }
  if (edge < 0 || !crossing(sides[0], eye, edge, x + step, y) ||
      !crossing(sides[1], eye, edge, x - step, y) || !crossing(sides[2], eye, edge, x, y + step) ||
      !crossing(sides[3], eye, edge, x, y - step)) {
    return false;
  }
  double xx = sides[0][0] - sides[1][0], xy = sides[0][1] - sides[1][1];
  double yx = sides[2][0] - sides[3][0], yy = sides[2][1] - sides[3][1];
  return xx * yy - xy * yx < 0;
}

/* The area where the true cornea folds, and the part of it that a surface claims to cover (NULL:
 * none), mm². */
static double folded_mm2(double *covered_mm2, const fits_eye *eye, const placido_surface *found) {
  const double step = 0.05;
  double folded = 0;
  *covered_mm2 = 0;
  for (int j = -80; j <= 80; j++) {
    for (int i = -80; i <= 80; i++) {
      double x = i * step, y = j * step;
      if (hypot(x, y) <= 4 && is_folded(eye, x, y)) {
        folded += step * step;
        *covered_mm2 += found && placido_surface_covered(found, x, y) ? step * step : 0;
      }
    }
  }
  return folded;
}

/* Points near a fold that stay in the fit may all be off by what an outlier begins with. Were they
 * heights, a spline makes at most the sum of |weights| of that (4.2, see fits_truncation_um) times
 * what one point's standard deviation is in heights; the spline's own is smaller than that by
 * sqrt(points in a cell of knots / 0.87²), the least diagonal of the projection. In sigmas: */
static double pull_of(const placido_fit *fit) {
  placido_fit_summary s = placido_fit_summary_get(fit);
  double per_mm2 = (double)s.points_used / (M_PI * s.radius_mm * s.radius_mm);
  return CUT * 4.2 / 0.87 * sqrt(per_mm2 * s.knot_mm * s.knot_mm);
}

/* A picture of the cornea, and its mires found in it. Returns a status; the fit's sentence is in
 * err. */
static int photograph(placido_fit **fit, const fits_eye *eye, placido_notes *notes,
                      placido_error *err) {
  const placido_disturbance usual = {.seed = 3, .blur_px = 0.8, .noise = 1.2};
  placido_frame frame = {0};
  placido_mires mires;
  placido_fit_options options = {.axis_z_mm = eye->axis_z_mm};
  *fit = NULL;
  assert_int_equal(placido_phantom_render(&frame, eye->truth, &eye->instrument, &usual, 1, err),
                   PLACIDO_OK);
  int status = placido_mires_find(&mires, &frame, &eye->instrument, NULL, notes, err);
  if (!status) {
    status = placido_fit_new(fit, &mires, &eye->instrument, &options, notes, err);
    placido_mires_free(&mires);
  }
  placido_frame_free(&frame);
  return status;
}

static void check_fold(const cornea *c, bool folds) {
  fits_eye eye = fits_eye_new(c->instrument, c->parts, c->count, 1);
  placido_fit *fit;
  placido_notes notes = {0};
  placido_error err = {0};
  double covered_mm2;
  int status = photograph(&fit, &eye, &notes, &err);
  double folded = folded_mm2(&covered_mm2, &eye, fit ? placido_fit_surface(fit) : NULL);
  assert_true((folded > 0) == folds);
  if (status) {
    assert_int_equal(status, PLACIDO_QUALITY);
    const struct stability_row row = {.name = c->name,
                                      .condition = NAN,
                                      .perturbation = folded,
                                      .in_unit = "mm2 folded",
                                      .change = NAN,
                                      .bound = NAN,
                                      .extended = NAN,
                                      .refused = err.text};
    stability_add(&row);
  } else {
    if (!folds) {
      eye.truncation_um = fits_truncation_um(sixth_of(c), placido_fit_summary_get(fit).knot_mm);
    }
    fits_error e = fits_compare(fit, &eye);
    fits_add(c->name, fit, &e, folds ? pull_of(fit) : 0, folded, "mm2 folded");
    assert_near(covered_mm2, 0, 0);
    assert_true(!folds || notes.count > 0);
  }
  placido_notes_clear(&notes);
  placido_fit_free(fit);
  fits_eye_free(&eye);
}

/* Two points of these corneas mirror one ring. None of what is folded may be shown, the rest may
 * not be pulled along, and somebody must have been told. The last ones are finer than the knots. */
static void folds_are_not_averaged(void **state) {
  (void)state;
  static const cornea whole[] = {
      {"photograph, cone 100 um / 0.92 mm", "cone24", CONE(0.10, 0.92, 0.4, -0.8), 2, 0},
      {"photograph, cone 100 um / 0.70 mm", "cone24", CONE(0.10, 0.70, 1.2, -1.8), 2, 0},
  };
  static const cornea folded[] = {
      {"photograph, fold 100 um / 0.55 mm", "cone24", CONE(0.10, 0.55, 1.2, -1.8), 2, 0},
      {"photograph, fold 100 um / 0.42 mm, disc18", "disc18", CONE(0.10, 0.42, 0.4, -0.8), 2, 0},
      {"photograph, fold 200 um / 0.70 mm", "cone24", CONE(0.20, 0.70, 0.4, -0.8), 2, 0},
      {"photograph, fold 30 um / 0.25 mm", "cone24", CONE(0.03, 0.25, 1.5, -2.2), 2, 0},
      {"photograph, fold 20 um / 0.20 mm, disc18", "disc18", CONE(0.02, 0.20, 0.8, -2.4), 2, 0},
      {"photograph, fold 10 um / 0.15 mm", "cone24", CONE(0.01, 0.15, 1, -1.8), 2, 0},
      {"photograph, fold 8 um / 0.12 mm", "cone24", CONE(0.008, 0.12, 1, -1.8), 2, 0},
      {"photograph, fold 8 um / 0.12 mm, at the axis", "cone24", CONE(0.008, 0.12, 0, 0.3), 2, 0},
  };
  for (size_t i = 0; i < sizeof whole / sizeof whole[0]; i++) {
    check_fold(&whole[i], false);
  }
  for (size_t i = 0; i < sizeof folded / sizeof folded[0]; i++) {
    check_fold(&folded[i], true);
  }
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Fits: flat, steep and folded corneas"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(flat_and_steep_corneas_are_measured),
      cmocka_unit_test(what_is_too_flat_or_too_steep_is_refused),
      cmocka_unit_test(folds_are_not_averaged),
      cmocka_unit_test(the_table_is_good),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

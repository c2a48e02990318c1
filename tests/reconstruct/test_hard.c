/* Hard eyes and unusual instruments, rendered by the phantom: each once gave a wrong surface or
 * none. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>

typedef struct hard_case {
  const char *name, *instrument;
  placido_part parts[2];
  int part_count;
  int edges;      /* as many of the instrument's, evenly chosen; 0: all */
  double enlarge; /* of the picture; 0: 1 */
  bool dark_first;
  double um_8;    /* limit of the elevation error over 8 mm: about twice what was measured */
  double covered; /* of 8 mm, at least; 0: 0.97. A steep cornea shows the mires small */
} hard_case;

#define CONIC(r, q, x, y) {.kind = PLACIDO_PART_BICONIC, .as.biconic = {r, q, r, q, 0, x, y}}
#define CONE(h, s, x, y) {.kind = PLACIDO_PART_BUMP, .as.bump = {h, s, s, x, y, 0}}

static const hard_case cases[] = {
    /* the innermost mire lies wholly beside the centre of the others */
    {"severe cone",
     "cone24",
     {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.92, 0.4, -0.8)},
     2,
     .um_8 = 0.03},
    {"extreme cone", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.12, 1, 0.5, -0.9)}, 2, .um_8 = 0.03},
    /* the mires are half as large again as an ordinary cornea's */
    {"flat", "disc18", {CONIC(12, 0.5, 0, 0)}, 1, .um_8 = 0.03},
    {"steep", "cone24", {CONIC(5.5, -0.3, 0, 0)}, 1, .um_8 = 0.02, .covered = 0.65},
    {"far off the axis", "cone24", {CONIC(7.7, -0.25, 1.2, 0.9)}, 1, .um_8 = 0.02, .covered = 0.8},
    /* broad bands hold far more noise than edges */
    {"few mires", "cone24", {CONIC(7.78, -0.24, 0, 0)}, 1, .edges = 8, .um_8 = 0.1},
    {"large picture", "cone24", {CONIC(7.78, -0.24, 0, 0)}, 1, .enlarge = 2, .um_8 = 0.01},
    /* the innermost band is dark: edge 0 ends a bright disc */
    {"dark first", "cone24", {CONIC(7.78, -0.24, 0, 0)}, 1, .dark_first = true, .um_8 = 0.02},
};

static placido_instrument instrument_of(const hard_case *c) {
  placido_instrument all, in;
  assert_int_equal(placido_phantom_instrument(&all, c->instrument, NULL), PLACIDO_OK);
  in = all;
  for (int k = 0; k < c->edges; k++) {
    in.edges[k] = all.edges[(k * (all.edge_count - 1) + (c->edges - 1) / 2) / (c->edges - 1)];
    in.edge_count = c->edges;
  }
  if (c->enlarge > 0) {
    in.width_px = (int)(in.width_px * c->enlarge);
    in.height_px = (int)(in.height_px * c->enlarge);
    for (int i = 0; i < 2; i++) {
      in.focal_px[i] *= c->enlarge;
      in.principal_px[i] = (in.principal_px[i] + 0.5) * c->enlarge - 0.5;
    }
  }
  in.first_band_bright = !c->dark_first;
  return in;
}

static void check(const hard_case *c) {
  placido_instrument instrument = instrument_of(c);
  placido_surface *truth;
  placido_jet jet;
  placido_error err = {0};
  assert_int_equal(
      placido_surface_new(&truth, 0, 6, c->parts, (size_t)c->part_count, NULL, &err), PLACIDO_OK);
  assert_true(placido_surface_at(truth, 0, 0, &jet));
  placido_disturbance usual = {.seed = 7, .blur_px = 0.8, .noise = 1.2};
  placido_frame frame = {0};
  assert_int_equal(placido_phantom_render(&frame, truth, &instrument, &usual, 2, &err), PLACIDO_OK);
  placido_mires mires;
  placido_mires_options how = {.threads = 2};
  placido_fit *fit = NULL;
  placido_fit_options options = {.axis_z_mm = -jet.sag, .threads = 2};
  int status = placido_mires_find(&mires, &frame, &instrument, &how, NULL, &err);
  if (!status) {
    status = placido_fit_new(&fit, &mires, &instrument, &options, NULL, &err);
  }
  if (status) {
    print_error("%s: %s\n", c->name, err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  truth_error e = truth_compare(fit, truth, 0, 8);
  print_message("%-16s %.4f um over 8 mm, %.3f covered\n", c->name, e.elevation_um, e.covered);
  assert_true(e.elevation_um < c->um_8);
  assert_true(e.covered > (c->covered > 0 ? c->covered : 0.97));
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_frame_free(&frame);
  placido_surface_free(truth);
}

static void hard_eyes_are_measured_rightly(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    check(&cases[i]);
  }
}

/* The largest error of elevation at any point that is covered; the median within 3 mm removed. */
static double worst_um(const placido_surface *found, const placido_surface *truth) {
  enum { HALF = 50 };
  static double errors[(2 * HALF + 1) * (2 * HALF + 1)], inner[(2 * HALF + 1) * (2 * HALF + 1)];
  size_t n = 0, near = 0;
  for (int j = -HALF; j <= HALF; j++) {
    for (int i = -HALF; i <= HALF; i++) {
      double x = 0.1 * i, y = 0.1 * j;
      placido_jet a, b;
      if (placido_surface_covered(found, x, y) && placido_surface_at(found, x, y, &a) &&
          placido_surface_at(truth, x, y, &b)) {
        errors[n] = 1e3 * (b.sag - a.sag);
        inner[near] = errors[n++];
        near += hypot(x, y) <= 1.5;
      }
    }
  }
  double worst = 0, piston = 0;
  for (size_t k = 0; k < near; k++) { /* the value with as many above as below */
    size_t above = 0;
    for (size_t m = 0; m < near; m++) {
      above += inner[m] > inner[k];
    }
    piston = above == near / 2 ? inner[k] : piston;
  }
  for (size_t k = 0; k < n; k++) {
    worst = fmax(worst, fabs(errors[k] - piston));
  }
  return worst;
}

/* Two points of these corneas mirror the same mire. Whatever is fitted through that is wrong by tens
 * of micrometres at a residual that looks fine: it is refused, or the map has a hole there and is
 * right elsewhere. */
static void a_fold_is_refused_or_left_out(void **state) {
  (void)state;
  static const hard_case folds[] = {
      {"10/42", "cone24", {CONIC(7.8, -0.2, 0, 0), CONE(0.10, 0.42, 0.5, -1)}, 2, .edges = 0},
      {"10/42", "disc18", {CONIC(7.8, -0.2, 0, 0), CONE(0.10, 0.42, 0.5, -1)}, 2, .edges = 0},
      {"10/40", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.40, 0.4, -0.8)}, 2, .edges = 0},
      {"10/45", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.45, 0.4, -0.8)}, 2, .edges = 0},
      {"12/40", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.12, 0.40, 0.4, -0.8)}, 2, .edges = 0},
      {"10/42", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.42, -1, 1.4)}, 2, .edges = 0},
      {"10/42", "cone24", {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.42, 0.1, 0.2)}, 2, .edges = 0},
  };
  for (size_t i = 0; i < sizeof folds / sizeof folds[0]; i++) {
    const hard_case *c = &folds[i];
    placido_instrument instrument = instrument_of(c);
    placido_surface *truth;
    placido_jet jet;
    assert_int_equal(placido_surface_new(&truth, 0, 6, c->parts, 2, NULL, NULL), PLACIDO_OK);
    assert_true(placido_surface_at(truth, 0, 0, &jet));
    placido_disturbance usual = {.seed = 3, .blur_px = 0.8, .noise = 1.2};
    placido_frame frame = {0};
    assert_int_equal(placido_phantom_render(&frame, truth, &instrument, &usual, 2, NULL),
                     PLACIDO_OK);
    placido_mires mires;
    placido_fit *fit = NULL;
    placido_notes notes = {0};
    placido_error err = {0};
    placido_fit_options options = {.axis_z_mm = -jet.sag, .threads = 2};
    int status = placido_mires_find(&mires, &frame, &instrument, NULL, &notes, &err);
    if (!status) {
      status = placido_fit_new(&fit, &mires, &instrument, &options, &notes, &err);
      placido_mires_free(&mires);
    }
    if (status) {
      print_message("%s %s: %s\n", c->name, c->instrument, err.text);
      assert_int_equal(status, PLACIDO_QUALITY);
      assert_null(fit);
    } else {
      double worst = worst_um(placido_fit_surface(fit), truth);
      print_message("%s %s: %.3f um at worst\n", c->name, c->instrument, worst);
      assert_true(worst < 1);
      assert_true(notes.count > 0);
    }
    placido_notes_clear(&notes);
    placido_fit_free(fit);
    placido_frame_free(&frame);
    placido_surface_free(truth);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(hard_eyes_are_measured_rightly),
                                     cmocka_unit_test(a_fold_is_refused_or_left_out)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

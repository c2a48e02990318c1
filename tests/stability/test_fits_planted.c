/* What contradicts the rest: wrong ring numbers, and starts that are no help. */
#include "tests/stability/fits.h"

#include <stdio.h>
#include <stdlib.h>

#define MERIDIANS 90

/* Points of which a test knows the true number: by their place, since a fit sorts them anew. */
typedef struct planted {
  placido_mires mires;
  size_t count;
  placido_mire_point *true_points;
} planted;

static int by_place(const void *a, const void *b) {
  const placido_mire_point *p = a, *q = b;
  if (p->edge != q->edge) {
    return p->edge < q->edge ? -1 : 1;
  }
  return (p->meridian_deg > q->meridian_deg) - (p->meridian_deg < q->meridian_deg);
}

static bool is_planted(const planted *p, const placido_mire_point *point, int *true_edge) {
  for (size_t k = 0; k < p->count; k++) {
    if (p->true_points[k].u_px == point->u_px && p->true_points[k].v_px == point->v_px) {
      *true_edge = p->true_points[k].edge;
      return true;
    }
  }
  return false;
}

/* In order again, and where a wrong number meets the right one only the wrong one stays: an edge
 * is seen once on a meridian. */
static void put_in_order(planted *p) {
  placido_mire_point *points = p->mires.points;
  size_t kept = 0;
  int edge;
  qsort(points, p->mires.count, sizeof *points, by_place);
  for (size_t i = 0; i < p->mires.count; i++) {
    if (kept && by_place(&points[kept - 1], &points[i]) == 0) {
      if (is_planted(p, &points[i], &edge)) {
        points[kept - 1] = points[i];
      }
    } else {
      points[kept++] = points[i];
    }
  }
  p->mires.count = kept;
}

/* One point in a hundred is numbered `shift` edges too far out: every hundredth one, or (where
 * `arc_of` is an edge) as many in a row on that edge. */
static planted plant(const fits_eye *eye, int shift, int arc_of) {
  planted p = {.mires = fits_some(eye, NULL, 0)};
  size_t wanted = p.mires.count / 100, first = MERIDIANS / 9;
  p.true_points = calloc(p.mires.count, sizeof *p.true_points);
  assert_non_null(p.true_points);
  for (size_t i = 0; i < p.mires.count; i++) {
    placido_mire_point *point = &p.mires.points[i];
    size_t meridian = (size_t)lrint(point->meridian_deg * MERIDIANS / 360);
    bool chosen = arc_of < 0 ? i % 100 == 7
                             : point->edge == arc_of && meridian >= first && meridian < first + wanted;
    int wrong = point->edge + shift;
    if (chosen && wrong >= 0 && wrong < p.mires.edge_count) {
      p.true_points[p.count++] = *point;
      point->edge = wrong;
    }
  }
  put_in_order(&p);
  return p;
}

static void check_planted(const fits_eye *eye, int shift, int arc_of) {
  char name[64];
  planted p = plant(eye, shift, arc_of);
  placido_fit *fit = fits_of(eye, &p.mires, NULL);
  fits_error e = fits_compare(fit, eye);
  snprintf(name, sizeof name, arc_of < 0 ? "numbers %+d, scattered" : "numbers %+d, arc of edge %d",
           shift, arc_of);
  fits_add(name, fit, &e, 0, 100.0 * (double)p.count / (double)eye->mires.count, "%");
  assert_true(e.covered > 0.99);
  size_t seen = 0;
  for (size_t i = 0; i < p.mires.count; i++) {
    int true_edge;
    if (is_planted(&p, &p.mires.points[i], &true_edge)) {
      seen++;
      assert_true(p.mires.points[i].edge == true_edge || !p.mires.points[i].used);
    }
  }
  assert_int_equal(seen, p.count);
  placido_fit_free(fit);
  placido_mires_free(&p.mires);
  free(p.true_points);
}

/* Not one of them is believed, and what they leave is as good as its error bars. By one edge (the
 * other end of a band) a number cannot be wrong in a picture, since the two differ in polarity, but
 * in a list it can. */
static void wrong_numbers_are_not_believed(void **state) {
  (void)state;
  static const int shifts[] = {-4, -2, -1, 1, 2, 4}, arcs[] = {5, 24, 43};
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i++) {
    check_planted(&eye, shifts[i], -1);
    for (size_t k = 0; k < sizeof arcs / sizeof arcs[0]; k++) {
      check_planted(&eye, shifts[i], arcs[k]);
    }
  }
  fits_eye_free(&eye);
}

/* Whatever another eye's fit was, starting from it ends where starting from nothing does. The last
 * step moves the residuals by at most TOLERANCE of their noise, so the cost falls by at most
 * TOLERANCE² · points in it (in units of chi square), and a height by at most the root of that of
 * its standard deviation (Cauchy-Schwarz in the metric of the normal equations); twice for two fits,
 * and 1.25 as the standard deviation may be off by so much. */
#define TOLERANCE 1e-3

static void starts_from_afar_change_nothing(void **state) {
  (void)state;
  static const struct {
    const char *name, *instrument;
    placido_part parts[2];
    size_t count;
  } starts[] = {
      {"start: itself", "cone24", {FITS_TORIC}, 1},
      {"start: a sphere", "cone24", {FITS_CONIC(7.8, 0, 0, 0)}, 1},
      {"start: 0.9 mm aside", "cone24", {FITS_CONIC(7.8, 0, 0.7, 0.5)}, 1},
      {"start: 12 mm flat", "cone24", {FITS_CONIC(12, 0.5, 0, 0)}, 1},
      {"start: 5 mm steep", "cone24", {FITS_CONIC(5, -0.3, 0, 0)}, 1},
      {"start: severe cone", "cone24", {FITS_CONIC(7.7, -0.3, 0, 0), FITS_CONE(0.1, 0.92, 0.4, -0.8)}, 2},
      {"start: other instrument", "disc18", {FITS_TORIC}, 1},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  placido_fit_options options = {.tolerance = TOLERANCE};
  placido_fit *cold = fits_of(&eye, NULL, &options);
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
    fits_eye other = fits_eye_new(starts[i].instrument, starts[i].parts, starts[i].count, MERIDIANS);
    placido_fit *start = fits_of(&other, NULL, NULL);
    options.start = start;
    placido_fit *warm = fits_of(&eye, NULL, &options);
    const struct stability_row row = {
        .name = starts[i].name,
        .condition = placido_fit_summary_get(warm).condition,
        .perturbation = NAN,
        .change = fits_difference(cold, warm),
        .out_unit = "sigma",
        .bound = 1.25 * 2 * TOLERANCE * sqrt((double)eye.mires.count),
        .extended = NAN};
    stability_add(&row);
    placido_fit_free(warm);
    placido_fit_free(start);
    fits_eye_free(&other);
  }
  placido_fit_free(cold);
  fits_eye_free(&eye);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Fits: wrong numbers, starts from afar"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wrong_numbers_are_not_believed),
      cmocka_unit_test(starts_from_afar_change_nothing),
      cmocka_unit_test(the_table_is_good),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

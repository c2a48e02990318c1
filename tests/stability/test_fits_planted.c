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

static bool beyond(const placido_mire_point *point, size_t index, double edge) {
  (void)index;
  return point->edge >= edge;
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

/* Numbers every chosen point `shift` edges too far out. */
typedef bool chooser(const placido_mire_point *point, size_t index, const int *where);

static planted plant(const fits_eye *eye, int within, int shift, chooser *choose,
                     const int *where) {
  planted p = {.mires = fits_some(eye, beyond, within)};
  p.true_points = calloc(p.mires.count, sizeof *p.true_points);
  assert_non_null(p.true_points);
  for (size_t i = 0; i < p.mires.count; i++) {
    placido_mire_point *point = &p.mires.points[i];
    int wrong = point->edge + shift;
    if (choose(point, i, where) && wrong >= 0 && wrong < p.mires.edge_count) {
      p.true_points[p.count++] = *point;
      point->edge = wrong;
    }
  }
  put_in_order(&p);
  return p;
}

static bool every_hundredth(const placido_mire_point *point, size_t index, const int *where) {
  (void)point;
  (void)where;
  return index % 100 == 7;
}

/* Edges where[0] to where[1], meridians number where[2] to where[3]. */
static bool in_block(const placido_mire_point *point, size_t index, const int *where) {
  (void)index;
  long meridian = lrint(point->meridian_deg * MERIDIANS / 360);
  return point->edge >= where[0] && point->edge <= where[1] && meridian >= where[2] &&
         meridian <= where[3];
}

/* Not one of them is believed, and the rest is as good as its error bars say. */
static void check_planted(const char *name, const fits_eye *eye, planted *p) {
  placido_fit *fit = fits_of(eye, &p->mires, NULL);
  fits_error e = fits_compare(fit, eye);
  fits_add(name, fit, &e, 0, 100.0 * (double)p->count / (double)eye->mires.count, "%");
  assert_true(p->count > 0);
  for (size_t i = 0; i < p->mires.count; i++) {
    int true_edge;
    if (is_planted(p, &p->mires.points[i], &true_edge)) {
      assert_true(p->mires.points[i].edge == true_edge || !p->mires.points[i].used);
    }
  }
  placido_fit_free(fit);
  placido_mires_free(&p->mires);
  free(p->true_points);
}

/* One point in a hundred: scattered, and as many in a row on one edge. By one edge (the other end
 * of a band) a number cannot be wrong in a picture, since the two differ in polarity, but in a list
 * it can. */
static void wrong_numbers_are_not_believed(void **state) {
  (void)state;
  static const int shifts[] = {-4, -2, -1, 1, 2, 4}, arcs[] = {5, 24, 43};
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  int last = 10 + (int)eye.mires.count / 100 - 1;
  for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i++) {
    char name[64];
    planted p = plant(&eye, 0, shifts[i], every_hundredth, NULL);
    snprintf(name, sizeof name, "numbers %+d, scattered", shifts[i]);
    check_planted(name, &eye, &p);
    for (size_t k = 0; k < sizeof arcs / sizeof arcs[0]; k++) {
      const int where[] = {arcs[k], arcs[k], 10, last};
      p = plant(&eye, 0, shifts[i], in_block, where);
      snprintf(name, sizeof name, "numbers %+d, arc of edge %d", shifts[i], arcs[k]);
      check_planted(name, &eye, &p);
    }
  }
  fits_eye_free(&eye);
}

/* Edges of a sector together agree with each other, and beside a hole with a surface that is torn
 * there: the hole in the middle is what lets heights run up around it. */
static void wrong_blocks_do_not_tear_the_surface(void **state) {
  (void)state;
  static const struct {
    int within, shift, where[4];
  } blocks[] = {
      {12, -2, {13, 22, 66, 72}}, {12, -2, {14, 25, 66, 72}}, {12, 2, {12, 20, 20, 26}},
      {18, -4, {20, 30, 20, 26}}, {12, -2, {16, 26, 10, 17}}, {0, -2, {10, 20, 10, 17}},
      {0, 2, {0, 11, 10, 17}},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) {
    char name[64];
    const int *at = blocks[i].where;
    planted p = plant(&eye, blocks[i].within, blocks[i].shift, in_block, at);
    snprintf(name, sizeof name, "numbers %+d, block of edges %d to %d%s", blocks[i].shift, at[0],
             at[1], blocks[i].within ? ", hole" : "");
    check_planted(name, &eye, &p);
  }
  fits_eye_free(&eye);
}

/* Whatever another eye's fit was, starting from it ends where starting from nothing does. The last
 * step moves the residuals by at most TOLERANCE of their noise, so the cost falls by at most
 * TOLERANCE² · points in it (in units of chi square), and a height by at most the root of that of
 * its standard deviation (Cauchy-Schwarz in the metric of the normal equations); twice for two
 * fits, and 1.25 as the standard deviation may be off by so much. */
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
      {"start: severe cone",
       "cone24",
       {FITS_CONIC(7.7, -0.3, 0, 0), FITS_CONE(0.1, 0.92, 0.4, -0.8)},
       2},
      {"start: other instrument", "disc18", {FITS_TORIC}, 1},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  placido_fit_options options = {.tolerance = TOLERANCE};
  placido_fit *cold = fits_of(&eye, NULL, &options);
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
    fits_eye other =
        fits_eye_new(starts[i].instrument, starts[i].parts, starts[i].count, MERIDIANS);
    placido_fit *start = fits_of(&other, NULL, NULL);
    options.start = start;
    placido_fit *warm = fits_of(&eye, NULL, &options);
    const struct stability_row row = {.name = starts[i].name,
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
      cmocka_unit_test(wrong_blocks_do_not_tear_the_surface),
      cmocka_unit_test(starts_from_afar_change_nothing),
      cmocka_unit_test(the_table_is_good),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

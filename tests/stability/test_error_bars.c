/* Error bars are true: over 200 eyes drawn at random the errors are as large as claimed, quantity
 * by quantity. Nothing was chosen by these eyes. */
#include "tests/stability/claims.h"
#include "tests/stability/drawn_eye.h"
#include "tests/stability/table.h"
#include "tests/support/near.h"

#include <stdio.h>
#include <stdlib.h>

#ifdef __SANITIZE_ADDRESS__
#define EYES 12
#else
#define EYES 200
#endif
#define SEED 1
#define RENDERED_EVERY 9 /* eye is a picture whose mires are found; exact points with noise else */

/* Asked for: the root mean square of error over sigma. */
#define LEAST 0.8
#define MOST 1.25
/* Of n errors that are right it scatters by 1/sqrt(2 n): by 5 % of 200, so that the limits are four
 * and more of these away; where fewer are asked they move out by as many. */
#define SCATTER_ASKED (1 / sqrt(2.0 * 200))
#define SCATTERS 4.0

/* Errors over sigmas of a quantity, by family and all together. */
struct column {
  double squares[DRAWN_FAMILIES + 1], within, sigmas[EYES];
  int counts[DRAWN_FAMILIES + 1];
};

static struct column columns[CLAIMS];
static int families[DRAWN_FAMILIES + 1], refused;

static void take(const struct claim_result results[CLAIMS], int family) {
  const int rows[2] = {family, DRAWN_FAMILIES};
  for (int c = 0; c < CLAIMS; c++) {
    struct column *column = &columns[c];
    if (isnan(results[c].square)) {
      continue;
    }
    column->sigmas[column->counts[DRAWN_FAMILIES]] = results[c].sigma;
    column->within += results[c].within;
    for (int k = 0; k < 2; k++) {
      column->squares[rows[k]] += results[c].square;
      column->counts[rows[k]]++;
    }
  }
}

/* Each quarter of the eyes has its own causes of error: noise alone, with the distance, with the
 * geometry, with both; and its own pupil, one after the other. */
static void measure(int number) {
  static const double pupils_mm[4] = {2, 4, 8, 4};
  struct drawn_eye eye;
  struct claim_result results[CLAIMS];
  placido_fit *fit = NULL;
  placido_error err = {0};
  int status = drawn_eye_new(&eye, SEED, number, EYES, number % 4,
                             number % RENDERED_EVERY == RENDERED_EVERY - 2);
  if (!status) {
    status = drawn_eye_fit(&fit, &eye, &err);
  }
  if (status) { /* what cannot be measured well claims nothing */
    assert_int_equal(status, PLACIDO_QUALITY);
    print_message("eye %d, %s: %s\n", number, drawn_family_name(eye.family), err.text);
    refused++;
  } else {
    claims_find(results, fit, eye.cornea, pupils_mm[number / 4 % 4], 1000 + 2 * (uint64_t)number);
    take(results, eye.family);
    families[eye.family]++;
    families[DRAWN_FAMILIES]++;
  }
  placido_fit_free(fit);
  drawn_eye_free(&eye);
}

static void eyes_are_measured(void **state) {
  (void)state;
  for (int i = 0; i < EYES; i++) {
    measure(i);
  }
  assert_true(refused * 20 <= EYES);
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double rms_of(const struct column *column, int row) {
  return sqrt(column->squares[row] / column->counts[row]);
}

static void print_families(void) {
  static const char *const short_names[CLAIMS] = {"elev", "axial", "K1",  "K2",  "Z 3mm",
                                                  "Z 6mm", "S 3mm", "S 6mm", "S psf", "logMAR"};
  print_message("\nrms of error over sigma by family\n%-14s %5s", "family", "eyes");
  for (int c = 0; c < CLAIMS; c++) {
    print_message(" %6s", short_names[c]);
  }
  for (int row = 0; row <= DRAWN_FAMILIES; row++) {
    if (families[row] == 0) {
      continue;
    }
    print_message("\n%-14s %5d", row < DRAWN_FAMILIES ? drawn_family_name(row) : "all",
                  families[row]);
    for (int c = 0; c < CLAIMS; c++) {
      print_message(" %6.2f", rms_of(&columns[c], row));
    }
  }
  print_message("\n");
}

static void print_quantities(void) {
  print_message("\n%-24s %5s %6s %16s %14s\n", "quantity", "eyes", "rms", "within 1 sigma",
                "median sigma");
  for (int c = 0; c < CLAIMS; c++) {
    const struct column *column = &columns[c];
    int eyes = column->counts[DRAWN_FAMILIES];
    print_message("%-24s %5d %6.2f %16.2f %11.2g %s\n", claim_name((enum claim)c), eyes,
                  rms_of(column, DRAWN_FAMILIES), column->within / eyes, column->sigmas[eyes / 2],
                  claim_unit((enum claim)c));
  }
}

static void errors_are_as_large_as_claimed(void **state) {
  (void)state;
  for (int c = 0; c < CLAIMS; c++) {
    struct column *column = &columns[c];
    int eyes = column->counts[DRAWN_FAMILIES];
    assert_true(eyes > EYES / 2);
    qsort(column->sigmas, (size_t)eyes, sizeof *column->sigmas, by_value);
    double rms = rms_of(column, DRAWN_FAMILIES), scatter = 1 / sqrt(2.0 * EYES) - SCATTER_ASKED;
    double out = 1 + SCATTERS * scatter;
    stability_add(&(struct stability_row){.name = claim_name((enum claim)c),
                                          .condition = NAN,
                                          .perturbation = column->sigmas[eyes / 2],
                                          .in_unit = claim_unit((enum claim)c),
                                          .change = fmax(rms / MOST, LEAST / rms),
                                          .bound = out,
                                          .out_unit = "of limit",
                                          .extended = NAN});
  }
  print_families();
  print_quantities();
  assert_int_equal(stability_print("error over sigma, against 1.25 or 0.8 whichever is nearer"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(eyes_are_measured),
                                     cmocka_unit_test(errors_are_as_large_as_claimed)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Each quantity is taken as the examination takes it (acquire/cli/measure.c, wavefront.c, see.c,
 * acuity.c), once from the fit and once from the truth: wavefronts by the same rays and against the
 * same sphere, images through the same lens and on the same retina, found for the fit. */
#include "tests/stability/claims.h"

#include "tests/support/named_index.h"

#include <placido/acuity.h>
#include <placido/index.h>
#include <placido/psf.h>
#include <placido/wavefront.h>
#include <string.h>

#define LEVEL_MM 1.5 /* radius of the zone whose mean height is 0 */
#define LEVEL_STEP_MM 0.25
#define MAP_STEP_MM 0.4 /* of the comparison */
#define MAP_MM 4.0
#define AXIS_MM 0.25 /* nearer to the axis axial power has no limit where the cornea is tilted */

static const struct {
  const char *name, *unit;
} names[CLAIMS] = {
    [CLAIM_ELEVATION] = {"elevation", "um"},
    [CLAIM_AXIAL] = {"axial power", "D"},
    [CLAIM_K1] = {"SimK K1", "D"},
    [CLAIM_K2] = {"SimK K2", "D"},
    [CLAIM_TERMS_3] = {"Zernike terms, 3 mm", "um"},
    [CLAIM_TERMS_6] = {"Zernike terms, 6 mm", "um"},
    [CLAIM_STREHL_3] = {"Strehl at 555 nm, 3 mm", ""},
    [CLAIM_STREHL_6] = {"Strehl at 555 nm, 6 mm", ""},
    [CLAIM_STREHL_G] = {"Strehl of the PSF", ""},
    [CLAIM_LOGMAR] = {"logMAR", ""},
};

const char *claim_name(enum claim claim) {
  return names[claim].name;
}

const char *claim_unit(enum claim claim) {
  return names[claim].unit;
}

/* Sums, from which the means come. */
struct tally {
  double squares, within, errors, sigmas;
  int count;
};

static void add(struct tally *tally, double error, double sigma) {
  if (!isnan(error) && sigma > 0) {
    double over = error / sigma;
    tally->squares += over * over;
    tally->within += fabs(over) <= 1;
    tally->errors += error * error;
    tally->sigmas += sigma * sigma;
    tally->count++;
  }
}

static struct claim_result result_of(const struct tally *tally) {
  double n = tally->count > 0 ? tally->count : (double)NAN;
  return (struct claim_result){tally->squares / n, tally->within / n, sqrt(tally->errors / n),
                               sqrt(tally->sigmas / n)};
}

static double height_um(const placido_surface *surface, const placido_jet *jet) {
  return 1e3 * (placido_surface_vertex_z_mm(surface) - jet->sag);
}

static double axial_D(const placido_jet *jet, double x, double y) {
  double r = hypot(x, y), s = (jet->sx * x + jet->sy * y) / r;
  return 337.5 * s / (r * sqrt(1 + s * s));
}

/* Both jets at a place; false where the fit has no data. */
static bool jets_at(placido_jet *found, placido_jet *true_one, const placido_surface *surface,
                    const placido_surface *truth, double x, double y) {
  return placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, found) &&
         placido_surface_at(truth, x, y, true_one);
}

static double level_um(const placido_surface *surface, const placido_surface *truth) {
  double sum = 0;
  int n = 0, half = (int)(LEVEL_MM / LEVEL_STEP_MM);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * LEVEL_STEP_MM, y = j * LEVEL_STEP_MM;
      placido_jet a, b;
      if (hypot(x, y) <= LEVEL_MM && jets_at(&a, &b, surface, truth, x, y)) {
        sum += height_um(surface, &a) - height_um(truth, &b);
        n++;
      }
    }
  }
  return sum / n;
}

static void hold_maps(struct claim_result results[CLAIMS], const placido_fit *fit,
                      const placido_surface *truth) {
  const placido_surface *surface = placido_fit_surface(fit);
  double level = level_um(surface, truth);
  struct tally elevation = {0}, axial = {0};
  int half = (int)(MAP_MM / MAP_STEP_MM);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * MAP_STEP_MM, y = j * MAP_STEP_MM, sigma_um, sigma_D;
      placido_jet a, b;
      if (hypot(x, y) > MAP_MM || !jets_at(&a, &b, surface, truth, x, y)) {
        continue;
      }
      placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
      add(&elevation, height_um(surface, &a) - height_um(truth, &b) - level, sigma_um);
      if (hypot(x, y) > AXIS_MM) {
        add(&axial, axial_D(&a, x, y) - axial_D(&b, x, y), sigma_D);
      }
    }
  }
  results[CLAIM_ELEVATION] = result_of(&elevation);
  results[CLAIM_AXIAL] = result_of(&axial);
}

static void hold_simk(struct claim_result results[CLAIMS], const placido_fit *fit,
                      const placido_surface *truth) {
  static const char *const simk[2] = {"simk_flat_D", "simk_steep_D"};
  placido_index_value found[PLACIDO_INDICES_MAX], right[PLACIDO_INDICES_MAX];
  size_t found_count, right_count;
  assert_int_equal(placido_indices_find(found, &found_count, placido_fit_surface(fit), fit, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_indices_find(right, &right_count, truth, NULL, NULL), PLACIDO_OK);
  for (int k = 0; k < 2; k++) {
    const placido_index_value *value = named_index(found, found_count, simk[k]);
    struct tally tally = {0};
    add(&tally, value->value - named_index(right, right_count, simk[k])->value, value->sigma);
    results[CLAIM_K1 + k] = result_of(&tally);
  }
}

static double strehl_of(const placido_wavefront *front, const double *terms_um) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(figures[i].name, "strehl_555nm") == 0) {
      return figures[i].at(front, terms_um);
    }
  }
  fail_msg("no Strehl ratio");
  return NAN;
}

static void hold_wavefront(struct claim_result *terms, struct claim_result *strehl,
                           const placido_fit *fit, const placido_surface *truth, double pupil_mm) {
  placido_wavefront front;
  placido_error err = {0};
  const placido_eye eye = {.pupil_mm = pupil_mm};
  double right[PLACIDO_WAVEFRONT_TERMS], other[PLACIDO_WAVEFRONT_TERMS];
  double squares[PLACIDO_WAVEFRONT_TERMS] = {0}, strehl_square = 0;
  *terms = *strehl = (struct claim_result){NAN, NAN, NAN, NAN};
  int status = placido_wavefront_new(&front, placido_fit_surface(fit), &eye, NULL, NULL, &err);
  if (status) {
    assert_int_equal(status, PLACIDO_QUALITY); /* too much of the pupil is hidden */
    return;
  }
  double found_strehl = strehl_of(&front, front.coefficients_um);
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    assert_int_equal(placido_fit_variant(&variant, fit, v, NULL), PLACIDO_OK);
    assert_int_equal(placido_wavefront_again(other, &front, variant, NULL), PLACIDO_OK);
    for (int j = 0; j < front.term_count; j++) {
      squares[j] += pow(other[j] - front.coefficients_um[j], 2);
    }
    strehl_square += pow(strehl_of(&front, other) - found_strehl, 2);
    placido_surface_free(variant);
  }
  struct tally all = {0}, one = {0};
  assert_int_equal(placido_wavefront_again(right, &front, truth, NULL), PLACIDO_OK);
  for (int j = 3; j < front.term_count; j++) {
    add(&all, front.coefficients_um[j] - right[j], sqrt(squares[j]));
  }
  add(&one, found_strehl - strehl_of(&front, right), sqrt(strehl_square));
  *terms = result_of(&all);
  *strehl = result_of(&one);
  placido_wavefront_free(&front);
}

#define DRAWS 16         /* as in acquire/cli/acuity.c, and so many rays a side */
#define DRAW_SAMPLES 100
#define TRIALS_TRUE 32768 /* 8 times as many as usual: they add a sixteenth to an error by trials */

static placido_psf psf_of(const placido_surface *surface, const placido_eye *eye, int samples) {
  const placido_optics optics = {.samples = samples, .grow = 1};
  placido_psf psf;
  assert_int_equal(placido_psf_new(&psf, NULL, surface, eye, &optics, NULL, NULL), PLACIDO_OK);
  return psf;
}

/* What the corneas drawn from a fit see. */
struct drawn_sights {
  placido_psf psfs[DRAWS];
  placido_acuity_variant variants[DRAWS];
};

static void see_drawn(struct drawn_sights *sights, const placido_fit *fit,
                      const placido_eye *eye) {
  for (int d = 0; d < DRAWS; d++) {
    placido_surface *drawn;
    assert_int_equal(placido_fit_draw(&drawn, fit, d, NULL), PLACIDO_OK);
    sights->psfs[d] = psf_of(drawn, eye, DRAW_SAMPLES);
    sights->variants[d] =
        (placido_acuity_variant){.psf = &sights->psfs[d], .weight = 1.0 / DRAWS};
    placido_surface_free(drawn);
  }
}

static double strehl_sigma(const struct drawn_sights *sights, const placido_fit *fit,
                           const placido_eye *eye) {
  placido_psf same = psf_of(placido_fit_surface(fit), eye, DRAW_SAMPLES);
  double sum = 0;
  for (int d = 0; d < DRAWS; d++) {
    sum += pow(sights->psfs[d].strehl_g - same.strehl_g, 2) / DRAWS;
  }
  placido_psf_free(&same);
  return sqrt(sum);
}

static placido_acuity acuity_of(const placido_psf *psf, const placido_acuity_variant *variants,
                                size_t count, uint64_t seed, int trials) {
  const placido_acuity_options options = {.seed = seed, .trials = trials};
  placido_observer *observer;
  placido_acuity acuity;
  assert_int_equal(
      placido_observer_new(&observer, placido_acuity_test_find("e"), &options, NULL), PLACIDO_OK);
  assert_int_equal(placido_acuity_find(&acuity, observer, psf, variants, count, NULL), PLACIDO_OK);
  placido_observer_free(observer);
  return acuity;
}

static void hold_sight(struct claim_result results[CLAIMS], const placido_fit *fit,
                       const placido_surface *truth, double pupil_mm, uint64_t seed) {
  const placido_eye eye = {.pupil_mm = pupil_mm, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics usual = {.grow = 1};
  struct drawn_sights sights;
  struct tally strehl = {0}, logmar = {0};
  placido_eye settled;
  placido_psf psf;
  if (placido_psf_new(&psf, &settled, placido_fit_surface(fit), &eye, &usual, NULL, NULL) == 0) {
    placido_psf right = psf_of(truth, &settled, usual.samples);
    see_drawn(&sights, fit, &settled);
    placido_acuity claimed = acuity_of(&psf, sights.variants, DRAWS, seed, 0);
    add(&strehl, psf.strehl_g - right.strehl_g, strehl_sigma(&sights, fit, &settled));
    add(&logmar, claimed.logmar - acuity_of(&right, NULL, 0, seed + 1, TRIALS_TRUE).logmar,
        hypot(claimed.sigma_optics, claimed.sigma_trials));
    for (int d = 0; d < DRAWS; d++) {
      placido_psf_free(&sights.psfs[d]);
    }
    placido_psf_free(&right);
    placido_psf_free(&psf);
  }
  results[CLAIM_STREHL_G] = result_of(&strehl);
  results[CLAIM_LOGMAR] = result_of(&logmar);
}

void claims_find(struct claim_result results[CLAIMS], const placido_fit *fit,
                 const placido_surface *truth, double pupil_mm, uint64_t seed) {
  hold_maps(results, fit, truth);
  hold_simk(results, fit, truth);
  hold_wavefront(&results[CLAIM_TERMS_3], &results[CLAIM_STREHL_3], fit, truth, 3);
  hold_wavefront(&results[CLAIM_TERMS_6], &results[CLAIM_STREHL_6], fit, truth, 6);
  hold_sight(results, fit, truth, pupil_mm, seed);
}

/* How far errors are alike along an edge is found, whatever else the residuals hold. */
#include "reconstruct/solve/errors/kinship.h"

#include "base/random.h"
#include "tests/support/near.h"

#define EDGES 24
#define MERIDIANS 360

struct picture {
  double residual_px[EDGES * MERIDIANS], step_px[EDGES], work[MERIDIANS];
};

/* Edges at radii from 25 px on, every 8 px, with the noise of a picture that is blurred along them
 * over `blur_px` (standard deviation), plus a smooth wave of the surface's misfit. */
static void fill(struct picture *p, uint64_t seed, double blur_px, double misfit_px) {
  for (int k = 0; k < EDGES; k++) {
    double step = p->step_px[k] = 2 * M_PI * (25 + 8 * k) / MERIDIANS;
    int reach = (int)ceil(3 * blur_px / step);
    for (int m = 0; m < MERIDIANS; m++) {
      double sum = 0, square = 0;
      for (int i = -reach; i <= reach; i++) {
        double off = blur_px > 0 ? i * step / blur_px : 0, weight = exp(-off * off / 2);
        uint64_t place = (uint64_t)((m + i + MERIDIANS) % MERIDIANS);
        sum += weight * placido_random_normal(seed, (uint64_t)k, place);
        square += weight * weight;
      }
      p->residual_px[k * MERIDIANS + m] =
          0.02 * sum / sqrt(square) + misfit_px * cos(3 * 2 * M_PI * m / MERIDIANS + k);
    }
  }
}

static double length_of(struct picture *p) {
  return placido_kinship_length(p->residual_px, p->step_px, EDGES, MERIDIANS, p->work);
}

/* The length in the mean of many pictures: from its square, and one picture's scatters by 0.5 px.
 */
static double usual_length(double blur_px, double misfit_px) {
  enum { PICTURES = 16 };
  static struct picture p;
  double sum = 0;
  for (uint64_t seed = 1; seed <= PICTURES; seed++) {
    fill(&p, seed, blur_px, misfit_px);
    double length = length_of(&p);
    sum += length * length;
  }
  print_message("blur %.1f px, misfit %.3f px: %.2f px\n", blur_px, misfit_px,
                sqrt(sum / PICTURES));
  return sqrt(sum / PICTURES);
}

static void independent_points_are_alike_nowhere(void **state) {
  (void)state;
  assert_true(usual_length(0, 0) < 1); /* negative squares are cut off at 0 */
  assert_near(placido_kinship_factor(0, 1), 1, 1e-15);
}

/* Noise blurred by a Gaussian is correlated by one of twice the variance, whose integral is
 * 2 sqrt(π) blur. */
static void blurred_noise_is_alike_as_far_as_the_blur_reaches(void **state) {
  (void)state;
  const double expected = 2 * sqrt(M_PI);
  assert_near(usual_length(1, 0), expected, 0.12 * expected);
  assert_near(usual_length(1, 0.01), expected, 0.2 * expected);
  /* four meridians to the length: so many points count as one */
  assert_near(placido_kinship_factor(4, 1), sqrt(4), 0.01);
}

static void gaps_do_not_matter(void **state) {
  (void)state;
  static struct picture p;
  fill(&p, 1, 1, 0);
  double whole = length_of(&p);
  for (int i = 0; i < EDGES * MERIDIANS; i++) {
    p.residual_px[i] = i % MERIDIANS < 90 || i % 17 == 0 ? (double)NAN : p.residual_px[i];
  }
  assert_near(length_of(&p), whole, 0.3 * whole); /* a third fewer points */
}

/* Where meridians are far apart, and where there is nothing at all. */
static void what_cannot_be_told_is_taken_as_usual(void **state) {
  (void)state;
  static struct picture p;
  fill(&p, 1, 1, 0);
  for (int k = 0; k < EDGES; k++) {
    p.step_px[k] = 5;
  }
  double usual = length_of(&p);
  assert_true(usual > 2 && usual < 5);
  for (int k = 0; k < EDGES; k++) {
    p.step_px[k] = 0;
  }
  assert_near(length_of(&p), usual, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(independent_points_are_alike_nowhere),
      cmocka_unit_test(blurred_noise_is_alike_as_far_as_the_blur_reaches),
      cmocka_unit_test(gaps_do_not_matter),
      cmocka_unit_test(what_cannot_be_told_is_taken_as_usual),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

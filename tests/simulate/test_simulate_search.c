/* No surprises of the search: on random eyes it finds what an exhaustive search of the same metric
 * finds. PLACIDO_SEARCH_EYES=200 has 200 of them searched instead of a few, in some minutes. */
#include "base/random.h"
#include "random_eyes.h"
#include "simulate/focus.h"
#include "simulate/focus_climb.h"
#include "tests/support/near.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { EYES = 12, STARTS = 600, DENSE_BEST = 6 };

static const double width_arcmin = PLACIDO_FOCUS_WIDTH_ARCMIN;
static const double flat_share = 0.995; /* where tops differ by less, either is the best */
static const double same_D = 0.05;      /* a fifth of the steps that lenses come in */

/* What a search needs of an eye. */
typedef struct subject {
  placido_surface *surface;
  placido_eye eye;
  placido_apex apex;
  placido_optics optics;
  placido_rays sparse, dense;
  placido_focus focus;
} subject;

static void prepare(subject *s, placido_surface *surface, const placido_eye *eye) {
  *s = (subject){.surface = surface};
  assert_int_equal(placido_eye_settle(&s->eye, eye, NULL), PLACIDO_OK);
  assert_int_equal(placido_optics_settle(&s->optics, &(placido_optics){0}, NULL), PLACIDO_OK);
  assert_int_equal(placido_apex_find(&s->apex, surface, &s->eye, NULL), PLACIDO_OK);
  assert_int_equal(placido_rays_new(&s->sparse, surface, &s->apex, &s->eye,
                                    PLACIDO_FOCUS_SEARCH_SAMPLES, NULL), PLACIDO_OK);
  assert_int_equal(placido_rays_new(&s->dense, surface, &s->apex, &s->eye,
                                    PLACIDO_FOCUS_SETTLE_SAMPLES, NULL), PLACIDO_OK);
  s->focus = (placido_focus){&s->sparse, &s->dense, &s->apex, &s->optics};
}

static void clear(subject *s) {
  placido_rays_free(&s->sparse);
  placido_rays_free(&s->dense);
  placido_surface_free(s->surface);
}

/* Sphere and cross-cylinder as a power vector. */
static void vector_of(double vector[3], const placido_eye *eye) {
  vector[0] = 1000 * eye->index / eye->retina_mm;
  vector[1] = eye->correction.j0_D;
  vector[2] = eye->correction.j45_D;
}

static double uniform(int eye, int start, int number, double low, double high) {
  return placido_random_uniform(11, (uint64_t)(eye * 100000 + start), (uint64_t)number, low, high);
}

/* A part of the pupil at random, of any size, brought to its focus, and in every second start moved
 * away from it by up to some dioptres; then uphill with a profile that shrinks from 43'. */
static bool climb_from_anywhere(placido_climb *climb, const placido_aim *refraction, int eye,
                                int start, placido_trial *trial) {
  double radius = climb->eye.pupil_mm / 2, rms;
  double off = radius * sqrt(uniform(eye, start, 0, 0, 1));
  double angle = uniform(eye, start, 1, 0, 2 * acos(-1));
  placido_patch part = {off * cos(angle), off * sin(angle), 0,
                        radius * uniform(eye, start, 2, 0.08, 1.0)};
  trial->aim = *refraction;
  if (!placido_climb_part(climb, &part, trial, &rms)) {
    return false;
  }
  double away_D = start % 2 * uniform(eye, start, 3, 0, 3);
  for (int k = 0; k < PLACIDO_PENCIL_UNKNOWNS; k++) {
    trial->aim.power_D[k] += uniform(eye, start, 4 + k, -away_D, away_D);
  }
  for (int octave = 2 * (start % 4); octave >= 0; octave--) {
    if (!placido_climb_run(climb, trial, ldexp(width_arcmin, octave), octave > 0 ? 2 : 12)) {
      return false;
    }
  }
  return true;
}

/* Settles the best that differ with the dense rays; the share of the light of the best of all. */
static double settle_best(placido_climb *climb, placido_trial *trials, int count,
                          double vector[3]) {
  double best = 0;
  for (int k = 0; k < DENSE_BEST; k++) {
    placido_trial *top = NULL;
    for (int i = 0; i < count; i++) {
      top = top == NULL || trials[i].gathered > top->gathered ? &trials[i] : top;
    }
    placido_trial found = *top;
    for (int i = 0; i < count; i++) {
      trials[i].gathered *= placido_aim_distance_D(&trials[i].aim, &found.aim) >= 0.02;
    }
    if (found.gathered > 0 && placido_climb_settle(climb, climb->focus->dense, &found)) {
      double share = found.gathered / (double)climb->pencil.count;
      if (share > best) {
        best = share;
        placido_eye eye = placido_climb_eye(climb, &found.aim);
        vector_of(vector, &eye);
      }
    }
  }
  return best;
}

static double search_exhaustively(subject *s, int number, double vector[3]) {
  placido_climb climb = {.focus = &s->focus, .eye = s->eye, .retina_open = true,
                         .open = {true, true, true}};
  placido_trial *trials = test_calloc(STARTS, sizeof *trials);
  placido_aim refraction;
  int count = 0;
  assert_int_equal(placido_pencil_new(&climb.pencil, s->dense.count, NULL), PLACIDO_OK);
  assert_true(placido_climb_refraction(&climb, &s->sparse, &refraction));
  for (int i = 0; i < STARTS; i++) {
    count += climb_from_anywhere(&climb, &refraction, number, i, &trials[count]);
  }
  double best = settle_best(&climb, trials, count, vector);
  placido_pencil_free(&climb.pencil);
  test_free(trials);
  return best;
}

static void test_search_finds_what_an_exhaustive_search_finds(void **state) {
  (void)state;
  const char *asked = getenv("PLACIDO_SEARCH_EYES");
  int eyes = asked != NULL ? atoi(asked) : EYES, tied = 0;
  double least = 1, farthest_D = 0, trials = 0;
  for (int i = 0; i < eyes; i++) {
    subject s;
    placido_eye eye, found;
    placido_focus_found figures;
    double vector[3], best[3] = {0, 0, 0};
    placido_surface *surface = random_eye(&eye, i, 0, false);
    prepare(&s, surface, &eye);
    found = s.eye;
    assert_int_equal(placido_focus_find(&s.focus, &found, &figures, NULL), PLACIDO_OK);
    vector_of(vector, &found);
    double share = figures.quality / search_exhaustively(&s, i, best);
    double away_D = sqrt(pow(vector[0] - best[0], 2) + pow(vector[1] - best[1], 2) +
                         pow(vector[2] - best[2], 2));
    if (share < flat_share) {
      fail_msg("eye %d, %s, pupil %g mm: %.4f of the light, %.4f is known, %.2f D away", i,
               random_eye_kind(i), eye.pupil_mm, figures.quality, figures.quality / share, away_D);
    }
    tied += away_D > same_D;
    least = fmin(least, share);
    farthest_D = away_D > same_D ? farthest_D : fmax(farthest_D, away_D);
    trials += (double)figures.trials / eyes;
    clear(&s);
  }
  print_message("%d eyes: %.4f of the best at least; %.3f D from it at most, but for %d with a "
                "second top within 0.5 %%; %.0f trials a search\n",
                eyes, least, farthest_D, tied, trials);
  assert_true(tied <= eyes / 20);
}

/* In the search slopes are linear and numbers have 24 bits: the same light, gathered by rays traced
 * exactly, must be the same, and no less than a little to either side. */
static double gathered_exactly(const subject *s, const placido_eye *eye, const double at_mm[2]) {
  double width_mm = width_arcmin * placido_focus_arcmin_mm(&s->focus, eye), sum = 0;
  for (size_t i = 0; i < s->dense.count; i++) {
    double x, y;
    assert_true(placido_entry_trace(&s->dense.entries[i], eye, eye->retina_mm, &x, &y));
    sum += pow(1 + (pow(x - at_mm[0], 2) + pow(y - at_mm[1], 2)) / pow(width_mm, 2), -1.5);
  }
  return sum / (double)s->dense.count;
}

static void test_what_is_found_is_a_top_of_exactly_traced_light(void **state) {
  (void)state;
  for (int i = 0; i < EYES; i++) {
    subject s;
    placido_eye eye, found;
    placido_focus_found figures;
    double peak_mm[2];
    placido_surface *surface = random_eye(&eye, i, 0, false);
    prepare(&s, surface, &eye);
    found = s.eye;
    assert_int_equal(placido_focus_find(&s.focus, &found, &figures, NULL), PLACIDO_OK);
    assert_int_equal(placido_focus_peak(&s.focus, &found, peak_mm, NULL), PLACIDO_OK);
    double top = gathered_exactly(&s, &found, peak_mm);
    assert_near(top, figures.quality, 0.002 * top);
    for (int k = 0; k < 6; k++) {
      placido_eye beside = found;
      double step_D = k % 2 == 0 ? 0.02 : -0.02; /* below what a lens could be ground to */
      beside.correction.j0_D += k / 2 == 1 ? step_D : 0;
      beside.correction.j45_D += k / 2 == 2 ? step_D : 0;
      double vergence_D = 1000 * found.index / found.retina_mm + (k / 2 == 0 ? step_D : 0);
      beside.retina_mm = 1000 * found.index / vergence_D;
      double at_mm[2];
      assert_int_equal(placido_focus_peak(&s.focus, &beside, at_mm, NULL), PLACIDO_OK);
      assert_true(gathered_exactly(&s, &beside, at_mm) < 1.001 * top);
    }
    clear(&s);
  }
}

/* A turned eye wants the lens turned, a mirrored one the lens mirrored: J0 and J45 turn by twice
 * the angle, and J45 changes its sign in the mirror. */
static void test_lens_follows_the_eye(void **state) {
  (void)state;
  const double turn_deg = 40, twice = 2 * turn_deg * acos(-1) / 180;
  for (int i = 0; i < EYES; i++) {
    double straight[3], moved[3];
    placido_focus_found figures[2];
    for (int k = 0; k < 2; k++) {
      subject s;
      placido_eye eye;
      placido_surface *surface = random_eye(&eye, i, k * turn_deg, k > 0);
      prepare(&s, surface, &eye);
      assert_int_equal(placido_focus_find(&s.focus, &s.eye, &figures[k], NULL), PLACIDO_OK);
      vector_of(k == 0 ? straight : moved, &s.eye);
      clear(&s);
    }
    /* The square pattern of rays does not turn with the eye: half a per cent of its light. */
    assert_near(figures[1].quality, figures[0].quality, 0.005 * figures[0].quality + 2e-4);
    double j0 = straight[1], j45 = -straight[2];
    assert_near(moved[0], straight[0], same_D);
    assert_near(moved[1], cos(twice) * j0 - sin(twice) * j45, same_D);
    assert_near(moved[2], sin(twice) * j0 + cos(twice) * j45, same_D);
  }
}

/* Where the search sets out is the wavefront's refraction: for eyes with little else they agree, by
 * the paths' Zernike terms and by the slopes' least squares. */
static void test_search_sets_out_from_the_wavefront(void **state) {
  (void)state;
  for (int i = 0; i < 3; i++) {
    subject s;
    placido_eye eye;
    placido_wavefront wavefront;
    placido_aim refraction;
    placido_surface *surface = random_eye(&eye, 6 * i + 1, 0, false);
    eye.pupil_mm = 2;
    prepare(&s, surface, &eye);
    placido_climb climb = {.focus = &s.focus, .eye = s.eye, .retina_open = true,
                           .open = {true, true, true}};
    assert_int_equal(placido_pencil_new(&climb.pencil, s.sparse.count, NULL), PLACIDO_OK);
    assert_true(placido_climb_refraction(&climb, &s.sparse, &refraction));
    assert_int_equal(placido_wavefront_new(&wavefront, surface, &eye, NULL, NULL, NULL),
                     PLACIDO_OK);
    double scale = 1 / pow(eye.pupil_mm / 2, 2);
    double power_D = 1000 * s.eye.index / wavefront.focus_mm[2] +
                     4 * sqrt(3) * scale * wavefront.coefficients_um[4];
    assert_near(refraction.power_D[0], power_D, 0.06); /* spherical aberration counts otherwise */
    assert_near(refraction.power_D[1],
                -2 * sqrt(6) * scale * wavefront.coefficients_um[5], 0.03);
    assert_near(refraction.power_D[2],
                -2 * sqrt(6) * scale * wavefront.coefficients_um[3], 0.03);
    placido_wavefront_free(&wavefront);
    placido_pencil_free(&climb.pencil);
    clear(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_search_finds_what_an_exhaustive_search_finds),
    cmocka_unit_test(test_what_is_found_is_a_top_of_exactly_traced_light),
    cmocka_unit_test(test_lens_follows_the_eye),
    cmocka_unit_test(test_search_sets_out_from_the_wavefront),
  };
  return cmocka_run_group_tests_name("simulate_search", tests, NULL, NULL);
}

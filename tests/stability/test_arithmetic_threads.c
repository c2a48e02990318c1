/* Sums do not depend on who adds them up: every stage gives the same bits by 1, 2 and 8 threads,
 * and when it is asked again. */
#include "tests/simulate/planes.h"
#include "tests/stability/record.h"
#include "tests/stability/table.h"

#include <math.h>
#include <placido/combine.h>
#include <placido/index.h>
#include <placido/map.h>
#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <placido/simulate.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* All that the stages share: made once by one thread, so that each stage is looked at alone. */
static struct bench {
  placido_instrument instrument;
  placido_surface *eye;
  placido_frame frame;
  placido_mires mires;
  placido_fit *fit;
} bench;

static const placido_disturbance disturbance = {
    .seed = 3, .blur_px = 0.8, .noise = 1.2, .lashes = 5, .lid = true, .motion_px = 1.5};

static void render(struct record *record, int threads) {
  placido_frame frame = {0};
  assert_int_equal(
      placido_phantom_render(&frame, bench.eye, &bench.instrument, &disturbance, threads, NULL),
      PLACIDO_OK);
  for (int y = 0; y < frame.height_px; y++) {
    for (int x = 0; x < frame.width_px; x++) {
      note(record, frame.data[(size_t)y * frame.stride_bytes + (size_t)x]);
    }
  }
  placido_frame_free(&frame);
}

static void note_points(struct record *record, const placido_mire_point *points, size_t count) {
  for (size_t i = 0; i < count; i++) {
    const placido_mire_point *p = &points[i];
    const double numbers[] = {p->edge, p->meridian_deg, p->u_px,
                              p->v_px, p->sigma_px,     p->residual_px};
    note_all(record, numbers, sizeof numbers / sizeof numbers[0]);
  }
}

static void find_mires(struct record *record, int threads) {
  placido_mires mires;
  const placido_mires_options options = {.meridians = 120, .threads = threads};
  assert_int_equal(
      placido_mires_find(&mires, &bench.frame, &bench.instrument, &options, NULL, NULL),
      PLACIDO_OK);
  note(record, mires.centre_u_px);
  note(record, mires.centre_v_px);
  note_points(record, mires.points, mires.count);
  note_points(record, mires.doubtful, mires.doubtful_count);
  placido_mires_free(&mires);
}

static placido_mires copy_of(const placido_mires *mires) {
  placido_mires copy = *mires;
  copy.doubtful = NULL;
  copy.doubtful_count = 0;
  copy.points = malloc(copy.count * sizeof *copy.points);
  assert_non_null(copy.points);
  memcpy(copy.points, mires->points, copy.count * sizeof *copy.points);
  return copy;
}

static placido_fit *fit_of(placido_mires *mires, int threads) {
  placido_fit *fit;
  placido_uncertainty geometry;
  assert_int_equal(placido_uncertainty_new(&geometry, bench.instrument.edge_count, 2, NULL),
                   PLACIDO_OK);
  geometry.factor[0] = geometry.factor[1] = 8;
  geometry.factor[geometry.parameter_count + PLACIDO_UNCERTAINTY_CAMERA + 20] = 0.02;
  const placido_fit_options options = {
      .axis_z_sigma_mm = 0.05, .geometry = &geometry, .threads = threads};
  assert_int_equal(placido_fit_new(&fit, mires, &bench.instrument, &options, NULL, NULL),
                   PLACIDO_OK);
  placido_uncertainty_free(&geometry);
  return fit;
}

static void note_surface(struct record *record, const placido_surface *surface) {
  for (int i = 0; i < 300; i++) {
    placido_jet jet;
    double r = 0.25 * sqrt(i);
    placido_surface_at(surface, r * cos(2.4 * i), r * sin(2.4 * i), &jet);
    const double numbers[] = {jet.sag, jet.sx, jet.sy, jet.sxx, jet.sxy, jet.syy};
    note_all(record, numbers, 6);
  }
}

static void fit_surface(struct record *record, int threads) {
  placido_mires mires = copy_of(&bench.mires);
  placido_fit *fit = fit_of(&mires, threads);
  note_points(record, mires.points, mires.count);
  note_surface(record, placido_fit_surface(fit));
  for (int i = 0; i < 60; i++) {
    double sigma[2];
    placido_fit_sigma_at(fit, 0.07 * i * cos(i), 0.07 * i * sin(i), &sigma[0], &sigma[1]);
    note_all(record, sigma, 2);
  }
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    assert_int_equal(placido_fit_variant(&variant, fit, v, NULL), PLACIDO_OK);
    note_surface(record, variant);
    placido_surface_free(variant);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
}

static void combine(struct record *record, int threads) {
  placido_mires list[3], combined;
  placido_movement movements[3];
  const placido_fit_options options = {.threads = threads};
  for (int k = 0; k < 3; k++) {
    list[k] = copy_of(&bench.mires);
    for (size_t i = 0; i < list[k].count; i++) { /* moved a little, and noisy */
      list[k].points[i].u_px += 0.5 * k + 0.02 * sin((double)(i * (size_t)(k + 2)));
      list[k].points[i].v_px += 0.02 * cos((double)(i * (size_t)(k + 3)));
    }
  }
  assert_int_equal(
      placido_mires_combine(&combined, movements, list, 3, &bench.instrument, &options, NULL),
      PLACIDO_OK);
  note_points(record, combined.points, combined.count);
  for (int k = 0; k < 3; k++) {
    note_all(record, movements[k].shift_mm, 3);
    note_all(record, movements[k].turn_deg, 3);
    placido_mires_free(&list[k]);
  }
  placido_mires_free(&combined);
}

static void use_threads(int threads) {
#ifdef _OPENMP
  omp_set_num_threads(threads);
#else
  (void)threads;
#endif
}

static void find_maps(struct record *record, int threads) {
  placido_maps maps;
  size_t kinds, area;
  placido_map_kinds(&kinds);
  use_threads(threads);
  assert_int_equal(placido_maps_new(&maps, placido_fit_surface(bench.fit), bench.fit, 0.25, NULL),
                   PLACIDO_OK);
  area = (size_t)maps.size * (size_t)maps.size;
  for (size_t k = 0; k < kinds; k++) {
    note_all(record, maps.values[k], area);
    note_all(record, maps.sigmas[k], area);
  }
  placido_maps_free(&maps);
}

static void find_indices(struct record *record, int threads) {
  static placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
  use_threads(threads);
  assert_int_equal(
      placido_indices_find(values, &count, placido_fit_surface(bench.fit), bench.fit, NULL),
      PLACIDO_OK);
  assert_int_equal(
      placido_indices_of_mires(values, &count, bench.fit, &bench.mires, &bench.instrument, NULL),
      PLACIDO_OK);
  for (size_t i = 0; i < count; i++) {
    note(record, values[i].value);
    note(record, values[i].sigma);
  }
}

static void find_wavefront(struct record *record, int threads) {
  placido_wavefront wavefront;
  const placido_eye eye = {.pupil_mm = 5};
  use_threads(threads);
  assert_int_equal(placido_wavefront_new(&wavefront, bench.eye, &eye, NULL, NULL, NULL),
                   PLACIDO_OK);
  note_all(record, wavefront.coefficients_um, PLACIDO_WAVEFRONT_TERMS);
  note_all(record, wavefront.opd_um, wavefront.count);
  placido_wavefront_free(&wavefront);
}

static void note_psf(struct record *record, const placido_optics *optics) {
  placido_psf psf;
  placido_eye found;
  const placido_eye eye = {.pupil_mm = 5, .correct = PLACIDO_CORRECT_FULL};
  assert_int_equal(placido_psf_new(&psf, &found, bench.eye, &eye, optics, NULL, NULL), PLACIDO_OK);
  note_all(record, psf.values, (size_t)psf.n * (size_t)psf.n);
  const double numbers[] = {found.retina_mm,        found.correction.m_D, found.correction.j0_D,
                            found.correction.j45_D, psf.strehl_g,         psf.outside};
  note_all(record, numbers, 6);
  placido_psf_free(&psf);
}

static void psf_of_rays(struct record *record, int threads) {
  for (int kind = PLACIDO_PATTERN_CROSSHATCH; kind <= PLACIDO_PATTERN_QUASI_RANDOM; kind++) {
    const placido_optics optics = {
        .rays = 40000, .pattern = (enum placido_pattern_kind)kind, .threads = threads};
    note_psf(record, &optics);
  }
  const placido_optics counted = {
      .light = PLACIDO_LIGHT_COUNTED, .samples = 150, .threads = threads};
  note_psf(record, &counted);
}

static void psf_of_waves(struct record *record, int threads) {
  static double values[65 * 65];
  const placido_optics optics = {.buckets = 129, .wavelength_nm = 555, .threads = threads};
  const placido_window window = {.buckets = 65, .threads = threads};
  const double coefficients_um[7] = {0, 0, 0, 0.1, 0.2, -0.1, 0.05};
  placido_wave waves[9];
  placido_pupil pupil;
  note_psf(record, &optics);
  assert_int_equal(placido_waves_white(waves, 9, 450, 650, 555, NULL), PLACIDO_OK);
  assert_int_equal(placido_pupil_of_terms(&pupil, 4, coefficients_um, 7, 0, NULL), PLACIDO_OK);
  assert_int_equal(placido_diffraction(values, NULL, &pupil, waves, 9, &window, NULL), PLACIDO_OK);
  note_all(record, values, 65 * 65);
  placido_pupil_free(&pupil);
}

/* Three planes, in one piece and in tiles, in either precision. */
static void convolve(struct record *record, int threads) {
  enum { WIDTH = 700, HEIGHT = 500, BUCKETS = 31, PLANES = 3 };
  static double values[BUCKETS * BUCKETS];
  const placido_psf psf = noise_psf(values, BUCKETS, 4);
  for (int way = 0; way < 3; way++) {
    const placido_convolution how = {
        .doubles = way == 1, .memory_MB = way == 2 ? 0.5 : 0, .threads = threads};
    placido_convolver *convolver;
    placido_transfer *transfer;
    float *sources[PLANES], *targets[PLANES];
    placido_convolution_term terms[PLANES];
    placido_superposition planes[PLANES];
    assert_int_equal(
        placido_convolver_new(&convolver, WIDTH, HEIGHT, BUCKETS / 2, &how, NULL, NULL),
        PLACIDO_OK);
    assert_int_equal(placido_transfer_new(&transfer, convolver, &psf, NULL), PLACIDO_OK);
    for (int k = 0; k < PLANES; k++) {
      sources[k] = noise_plane(WIDTH, HEIGHT, (unsigned)k);
      targets[k] = noise_plane(WIDTH, HEIGHT, 77);
      terms[k] = (placido_convolution_term){sources[k], transfer};
      planes[k] = (placido_superposition){targets[k], terms, (size_t)k + 1};
    }
    assert_int_equal(placido_convolver_run(convolver, planes, PLANES, NULL), PLACIDO_OK);
    for (int k = 0; k < PLANES; k++) {
      note_floats(record, targets[k], WIDTH * HEIGHT);
      free(sources[k]);
      free(targets[k]);
    }
    placido_transfer_free(transfer);
    placido_convolver_free(convolver);
  }
}

static void run_plan(struct record *record, int threads) {
  placido_scene scene;
  placido_plan *plan;
  placido_image seen;
  const placido_eye eye = {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL};
  const placido_plan_wish wish = {.bucket_arcmin = 1, .tolerance = 0.02, .threads = threads};
  size_t count;
  use_threads(threads);
  assert_int_equal(placido_scene_draw(&scene, "colours", NULL, 1, NULL), PLACIDO_OK);
  assert_int_equal(placido_plan_new(&plan, bench.eye, &eye, &scene, &wish, NULL, NULL), PLACIDO_OK);
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  for (size_t i = 0; i < count; i++) {
    note(record, verdicts[i].bound);
    note(record, verdicts[i].runs);
  }
  assert_int_equal(placido_plan_run(&seen, NULL, plan, NULL), PLACIDO_OK);
  note_floats(record, seen.data, (size_t)(seen.width_px * seen.height_px * seen.planes));
  placido_image_free(&seen);
  placido_plan_free(plan);
  placido_scene_free(&scene);
}

static void find_acuity(struct record *record, int threads) {
  placido_psf psf;
  placido_observer *observer;
  placido_acuity acuity;
  const placido_eye eye = {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.samples = 100, .threads = threads};
  const placido_acuity_options options = {.trials = 256};
  use_threads(threads);
  assert_int_equal(placido_psf_new(&psf, NULL, bench.eye, &eye, &optics, NULL, NULL), PLACIDO_OK);
  assert_int_equal(
      placido_observer_new(&observer, placido_acuity_test_find("sloan"), &options, NULL),
      PLACIDO_OK);
  assert_int_equal(placido_acuity_find(&acuity, observer, &psf, NULL, 0, NULL), PLACIDO_OK);
  note(record, acuity.logmar);
  note(record, acuity.sigma);
  placido_observer_free(observer);
  placido_psf_free(&psf);
}

static const struct stage {
  const char *name;
  void (*run)(struct record *record, int threads);
} stages[] = {
    {"phantom's picture", render},
    {"mires", find_mires},
    {"fit, sigmas, variants", fit_surface},
    {"frames combined", combine},
    {"maps and their sigmas", find_maps},
    {"indices and their sigmas", find_indices},
    {"wavefront", find_wavefront},
    {"PSF of rays", psf_of_rays},
    {"PSF of waves", psf_of_waves},
    {"convolution", convolve},
    {"planned scene", run_plan},
    {"acuity", find_acuity},
};

/* The bound is 0: sums are made in an order of their own, or of whole numbers. */
static void every_stage(void **state) {
  (void)state;
#ifdef __SANITIZE_ADDRESS__
  static const int threads[] = {8}; /* the other builds have them all */
#else
  static const int threads[] = {2, 8, 1};
#endif
  for (size_t s = 0; s < sizeof stages / sizeof stages[0]; s++) {
    struct record first = {0};
    size_t differ = 0;
    stages[s].run(&first, 1);
    for (size_t k = 0; k < sizeof threads / sizeof threads[0]; k++) {
      struct record again = {0};
      stages[s].run(&again, threads[k]);
      differ += differing(&first, &again);
      free(again.numbers);
    }
    assert_true(first.count > 1);
    const struct stability_row row = {.name = stages[s].name,
                                      .condition = NAN,
                                      .perturbation = 8,
                                      .in_unit = "threads",
                                      .change = (double)differ,
                                      .out_unit = "numbers",
                                      .bound = 0,
                                      .extended = NAN};
    stability_add(&row);
    free(first.numbers);
  }
  assert_int_equal(stability_print("arithmetic: 1, 2 and 8 threads, and once more"), 0);
}

static int set_up(void **state) {
  (void)state;
  const placido_mires_options options = {.meridians = 120};
  return placido_phantom_instrument(&bench.instrument, "cone24", NULL) ||
         placido_phantom_eye(&bench.eye, "keratoconus", NULL) ||
         placido_phantom_render(&bench.frame, bench.eye, &bench.instrument, &disturbance, 1,
                                NULL) ||
         placido_mires_find(&bench.mires, &bench.frame, &bench.instrument, &options, NULL, NULL) ||
         (bench.fit = fit_of(&bench.mires, 1)) == NULL;
}

static int tear_down(void **state) {
  (void)state;
  placido_fit_free(bench.fit);
  placido_mires_free(&bench.mires);
  placido_frame_free(&bench.frame);
  placido_surface_free(bench.eye);
  return 0;
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_stage)};
  return cmocka_run_group_tests(tests, set_up, tear_down);
}

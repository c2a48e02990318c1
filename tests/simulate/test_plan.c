/* Planning with invented effects: what runs, what is left out, and what is never touched. */
#include "base/memory.h"
#include "eyes.h"
#include "simulate/plan/plan.h"

#include <jansson.h>
#include <math.h>
#include <placido/scene.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

enum { FAKES = 5 };

/* What an invented effect answers, and how often it was called. */
static struct fake {
  bool applies;
  double bound, defocus_D, aperture_arcmin;
  int asked, prepared, applied, released;
} fakes[FAKES];

static void ask(const placido_question *question, placido_answer *answer, int number) {
  assert_non_null(question->rays);
  assert_true(question->eye->retina_mm > 0);
  fakes[number].asked++;
  answer->applies = fakes[number].applies;
  answer->bound = fakes[number].bound;
  answer->cost_ms = 10 + number;
  answer->strokes->defocus_D = fakes[number].defocus_D;
  answer->strokes->aperture_arcmin = fakes[number].aperture_arcmin;
  snprintf(answer->reason, sizeof answer->reason,
           "invented effect number %d says so, in a sentence that is long enough to need a second "
           "line of the table", number);
}

#define FAKE(number)                                                                     \
  static void ask_##number(const placido_question *question, placido_answer *answer) {   \
    ask(question, answer, number);                                                       \
  }                                                                                      \
  static int prepare_##number(void **state, struct placido_view *view, placido_error *err) { \
    (void)view;                                                                          \
    (void)err;                                                                           \
    *state = &fakes[number];                                                             \
    fakes[number].prepared++;                                                            \
    return PLACIDO_OK;                                                                   \
  }                                                                                      \
  static int apply_##number(void *state, struct placido_view *view, placido_error *err) { \
    (void)view;                                                                          \
    (void)err;                                                                           \
    assert_ptr_equal(state, &fakes[number]);                                             \
    fakes[number].applied++;                                                             \
    return PLACIDO_OK;                                                                   \
  }                                                                                      \
  static void release_##number(void *state) { fakes[number].released += state != NULL; }

FAKE(0)
FAKE(1)
FAKE(2)
FAKE(3)
FAKE(4)

#define CALLS(number)                                                                    \
  .summary = "does what it is told", .ask = ask_##number,                                \
  .prepare = prepare_##number, .apply = apply_##number, .release = release_##number

static const placido_effect zero = {.name = "zero", .stage = PLACIDO_STAGE_EYE, CALLS(0)};
static const placido_effect one = {.name = "one", .stage = PLACIDO_STAGE_PUPIL, CALLS(1)};
static const placido_effect giver = {
  .name = "giver", .stage = PLACIDO_STAGE_SPECTRUM, .gives = PLACIDO_GIVES_SPECTRUM, CALLS(2)};
static const placido_effect needy = {
  .name = "needy", .stage = PLACIDO_STAGE_PSF, .needs = PLACIDO_GIVES_SPECTRUM, CALLS(3)};
static const placido_effect four = {.name = "four", .stage = PLACIDO_STAGE_FIELD, CALLS(4)};
static const placido_effect *const rows[] = {&zero, &one, &giver, &needy, &four};
static const placido_effects all = {rows, FAKES};

/* An eye before a small scene: black bars on white. */
typedef struct setting {
  placido_surface *surface;
  placido_scene scene;
  placido_eye eye;
  placido_plan_wish wish;
} setting;

static setting begin(double tolerance) {
  setting s = {.surface = conic(7.8, -0.26),
               .eye = {.pupil_mm = 3},
               .wish = {.tolerance = tolerance}};
  s.scene = (placido_scene){.name = "bars", .arcmin_per_px = 0.5,
                            .conditions = {.distance_m = INFINITY, .luminance_cd_m2 = NAN,
                                           .wavelength_nm = NAN, .tolerance = 0.02}};
  assert_int_equal(placido_image_new(&s.scene.image, 64, 48, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < 64 * 48; i++) {
    s.scene.image.data[i] = i % 64 / 8 % 2 != 0 ? 1 : 0;
  }
  memset(fakes, 0, sizeof fakes);
  return s;
}

static void end(setting *s) {
  placido_image_free(&s->scene.image);
  placido_surface_free(s->surface);
}

static int try_plan(placido_plan **plan, const setting *s, placido_error *err) {
  return placido_plan_of_effects(plan, all, s->surface, &s->eye, &s->scene, &s->wish, NULL, err);
}

static placido_plan *make(const setting *s) {
  placido_plan *plan;
  placido_error err = {0};
  if (try_plan(&plan, s, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return plan;
}

static void set_bounds(const double bounds[FAKES]) {
  for (int i = 0; i < FAKES; i++) {
    fakes[i].applies = !isnan(bounds[i]);
    fakes[i].bound = isnan(bounds[i]) ? 0 : bounds[i];
  }
}

/* `expected`: a letter an effect, r: runs, o: out. */
static void check_runs(const placido_plan *plan, const char *expected) {
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  assert_int_equal(count, strlen(expected));
  for (size_t i = 0; i < count; i++) {
    if (verdicts[i].runs != (expected[i] == 'r')) {
      fail_msg("effect %s: expected %c", verdicts[i].name, expected[i]);
    }
  }
}

/* 0.001 + 0.002 + 0.003 fits into 0.7 of 0.01; 0.004 does not any more, whatever the order. */
static void the_smallest_go_first_while_their_sum_fits(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0.004, 0.003, 0.5, 0.001, 0.002});
  placido_plan *plan = make(&s);
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  check_runs(plan, "roroo");
  assert_true(fabs(plan->left_out - 0.006) < 1e-12);
  for (int i = 0; i < FAKES; i++) {
    assert_true(fabs(verdicts[i].bound - fakes[i].bound) < 1e-12);
    assert_true(verdicts[i].cost_ms >= 10 + i && verdicts[i].applies);
    assert_int_equal(fakes[i].asked, 1);
  }
  placido_plan_free(plan);
  end(&s);
}

static void many_small_ones_do_not_all_go(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0.003, 0.003, 0.003, NAN, 0.003});
  placido_plan *plan = make(&s);
  int left = 0;
  for (int i = 0; i < FAKES; i++) {
    left += fakes[i].applies && !plan->verdicts[i].runs;
  }
  assert_int_equal(left, 2);
  assert_true(plan->left_out <= 0.7 * 0.01);
  placido_plan_free(plan);
  end(&s);
}

static void what_is_left_out_is_never_called_again(void **state) {
  (void)state;
  setting s = begin(0.01);
  placido_image seen;
  placido_psf psf;
  set_bounds((const double[]){0.5, 0.0001, NAN, 0.0001, 0.5});
  placido_plan *plan = make(&s);
  check_runs(plan, "rooor");
  assert_int_equal(placido_plan_run(&seen, &psf, plan, NULL), PLACIDO_OK);
  assert_int_equal(seen.width_px, 64);
  assert_true(psf.n > 1);
  for (int i = 0; i < FAKES; i++) {
    int calls = plan->verdicts[i].runs ? 1 : 0;
    assert_int_equal(fakes[i].asked, 1);
    assert_int_equal(fakes[i].prepared, calls);
    assert_int_equal(fakes[i].applied, calls);
    assert_int_equal(fakes[i].released, calls);
  }
  placido_image_free(&seen);
  placido_psf_free(&psf);
  placido_plan_free(plan);
  end(&s);
}

static void what_does_not_apply_does_not_run(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){NAN, 0.5, NAN, NAN, NAN});
  s.wish.force[0] = PLACIDO_FORCE_ON;
  placido_plan *plan = make(&s);
  check_runs(plan, "orooo");
  assert_true(plan->left_out == 0 && !plan->verdicts[0].applies && plan->verdicts[0].bound == 0);
  placido_plan_free(plan);
  end(&s);
}

/* What a person switched off is told, and does not use up the planner's tolerance. */
static void a_person_decides(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0.0001, 0.4, NAN, NAN, 0.006});
  s.wish.force[0] = PLACIDO_FORCE_ON;
  s.wish.force[1] = PLACIDO_FORCE_OFF;
  placido_plan *plan = make(&s);
  check_runs(plan, "roooo");
  assert_true(fabs(plan->verdicts[0].bound - 0.0001) < 1e-12);
  assert_true(fabs(plan->verdicts[1].bound - 0.4) < 1e-12);
  assert_int_equal(plan->verdicts[1].force, PLACIDO_FORCE_OFF);
  assert_true(fabs(plan->left_out - 0.006) < 1e-12);
  placido_plan_free(plan);
  end(&s);
}

static void what_is_needed_stays_and_goes_with_its_need(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){NAN, NAN, 0.0001, 0.5, NAN}); /* giver small, needy large */
  placido_plan *plan = make(&s);
  check_runs(plan, "oorro");
  placido_plan_free(plan);
  set_bounds((const double[]){NAN, NAN, 0.0001, 0.002, NAN});
  plan = make(&s);
  check_runs(plan, "ooooo");
  assert_true(fabs(plan->left_out - 0.0021) < 1e-12);
  placido_plan_free(plan);
  end(&s);
}

static void what_is_needed_is_switched_on(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){NAN, NAN, NAN, 0.5, NAN});
  placido_plan *plan = make(&s);
  check_runs(plan, "oorro");
  placido_plan_free(plan);
  set_bounds((const double[]){NAN, NAN, NAN, 0.001, NAN});
  plan = make(&s);
  check_runs(plan, "ooooo");
  placido_plan_free(plan);
  end(&s);
}

static void a_contradiction_is_refused(void **state) {
  (void)state;
  setting s = begin(0.01);
  placido_plan *plan;
  placido_error err;
  set_bounds((const double[]){NAN, NAN, 0.5, 0.5, NAN});
  s.wish.force[2] = PLACIDO_FORCE_OFF;
  s.wish.force[3] = PLACIDO_FORCE_ON;
  assert_int_equal(try_plan(&plan, &s, &err), PLACIDO_INPUT);
  assert_null(plan);
  assert_non_null(strstr(err.text, "needy"));
  assert_non_null(strstr(err.text, "giver"));
  s.wish.force[3] = PLACIDO_FORCE_NONE; /* then it cannot run, and says why */
  plan = make(&s);
  check_runs(plan, "ooooo");
  assert_true(plan->left_out == 0 && plan->verdicts[3].bound == 0.5);
  assert_non_null(strstr(plan->verdicts[3].reason, "giver"));
  placido_plan_free(plan);
  end(&s);
}

/* By its strokes: a hundredth of a dioptre is not seen through 3 mm, a dioptre is. */
static void strokes_are_seen_or_not(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0, 0, NAN, NAN, NAN});
  fakes[0].defocus_D = 1;
  fakes[1].aperture_arcmin = 0.02;
  placido_plan *plan = make(&s);
  check_runs(plan, "roooo");
  assert_true(plan->verdicts[0].bound > 0.2);
  double hidden = plan->verdicts[1].bound;
  placido_plan_free(plan);
  fakes[0].applies = false;
  fakes[0].defocus_D = 0;
  plan = make(&s);
  assert_true(hidden < 0.5 * plan->verdicts[1].bound); /* blur hides the aperture */
  placido_plan_free(plan);
  end(&s);
}

/* What each of two would cost beside the other; both gone is more than either. */
static void bounds_add_up_along_the_way(void **state) {
  (void)state;
  setting s = begin(0.05);
  set_bounds((const double[]){0, 0, NAN, NAN, NAN});
  fakes[0].defocus_D = fakes[1].defocus_D = 0.05;
  placido_plan *plan = make(&s);
  const placido_verdict *v = plan->verdicts;
  double sum = 0;
  for (int i = 0; i < 2; i++) {
    sum += v[i].runs ? 0 : v[i].bound;
  }
  assert_true(fabs(sum - plan->left_out) < 1e-15 && sum <= 0.7 * 0.05);
  placido_plan_free(plan);
  end(&s);
}

static char *table_of(const placido_plan *plan) {
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  assert_non_null(stream);
  assert_int_equal(placido_plan_write(plan, stream, NULL), PLACIDO_OK);
  assert_int_equal(fclose(stream), 0);
  return text;
}

static void the_table_says_all_of_it(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0.5, 0.004, NAN, 0.00002, 0.003});
  s.wish.force[4] = PLACIDO_FORCE_OFF;
  placido_plan *plan = make(&s);
  char *text = table_of(plan);
  const char *const said[] = {"bars", "3.00 mm", "zero", "one", "giver", "needy", "four", "0.5000",
                              "0.0040", "<0.0001", "left out", "nothing to do", "out, forced",
                              "number 3 says so", "tolerance 0.01", "not counted"};
  for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
    if (strstr(text, said[i]) == NULL) {
      fail_msg("\"%s\" is not in\n%s", said[i], text);
    }
  }
  for (const char *line = text; *line != '\0'; line += strcspn(line, "\n") + 1) {
    assert_true(strcspn(line, "\n") <= 120);
  }
  free(text);
  placido_plan_free(plan);
  end(&s);
}

static void a_full_disk_is_told(void **state) {
  (void)state;
  setting s = begin(0.01);
  placido_error err;
  set_bounds((const double[]){0.5, 0.5, 0.5, 0.5, 0.5});
  placido_plan *plan = make(&s);
  FILE *full = fopen("/dev/full", "w");
  assert_non_null(full);
  assert_int_equal(placido_plan_write(plan, full, &err), PLACIDO_SYSTEM);
  fclose(full);
  assert_int_equal(placido_plan_save(plan, "/no/such/folder/plan.json", &err), PLACIDO_SYSTEM);
  placido_plan_free(plan);
  end(&s);
}

static void a_saved_plan_has_every_verdict(void **state) {
  (void)state;
  setting s = begin(0.01);
  char path[] = "/tmp/placido-plan-XXXXXX";
  int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  set_bounds((const double[]){0.5, 0.004, NAN, 0.001, 0.5});
  placido_plan *plan = make(&s);
  assert_int_equal(placido_plan_save(plan, path, NULL), PLACIDO_OK);
  json_t *root = json_load_file(path, 0, NULL);
  assert_non_null(root);
  assert_string_equal(json_string_value(json_object_get(root, "format")), "placido-plan/1");
  const json_t *effects = json_object_get(root, "effects");
  assert_int_equal(json_array_size(effects), FAKES);
  for (size_t i = 0; i < FAKES; i++) {
    const json_t *effect = json_array_get(effects, i);
    assert_string_equal(json_string_value(json_object_get(effect, "name")), rows[i]->name);
    assert_true(json_is_true(json_object_get(effect, "runs")) == plan->verdicts[i].runs);
    assert_true(json_number_value(json_object_get(effect, "bound")) == plan->verdicts[i].bound);
  }
  const json_t *settings = json_object_get(root, "settings");
  assert_int_equal(json_integer_value(json_object_get(settings, "buckets")),
                   placido_plan_settings_of(plan)->buckets);
  json_decref(root);
  unlink(path);
  placido_plan_free(plan);
  end(&s);
}

static void the_same_question_has_the_same_answer(void **state) {
  (void)state;
  setting s = begin(0.01);
  set_bounds((const double[]){0, 0.001, 0.002, 0.003, 0.004});
  fakes[0].defocus_D = 0.02;
  placido_plan *first = make(&s), *second;
  s.wish.threads = 2;
  second = make(&s);
  char *a = table_of(first), *b = table_of(second);
  assert_string_equal(a, b);
  for (int i = 0; i < FAKES; i++) {
    assert_true(first->verdicts[i].bound == second->verdicts[i].bound);
  }
  double asking, settling;
  placido_plan_seconds(first, &asking, &settling);
  assert_true(asking > 0 && settling > 0);
  free(a);
  free(b);
  placido_plan_free(first);
  placido_plan_free(second);
  end(&s);
}

static void memory_may_run_out_anywhere(void **state) {
  (void)state;
  setting s = begin(0.01);
  int failures = 0;
  set_bounds((const double[]){0.5, 0.001, NAN, NAN, 0.5});
  for (unsigned long n = 1;; n++) {
    placido_plan *plan;
    placido_error err;
    placido_memory_fail_at(n);
    int status = try_plan(&plan, &s, &err);
    placido_memory_fail_at(0);
    if (status == PLACIDO_OK) {
      placido_plan_free(plan);
      break;
    }
    assert_int_equal(status, PLACIDO_MEMORY);
    assert_null(plan);
    failures++;
  }
  assert_true(failures >= 2);
  placido_plan_free(NULL);
  end(&s);
}

static void wishes_out_of_range_are_refused(void **state) {
  (void)state;
  setting s = begin(0.01);
  placido_plan *plan;
  placido_error err;
  const placido_plan_wish wrong[] = {
    {.tolerance = 2}, {.tolerance = -0.01}, {.tolerance = NAN},
    {.bucket_arcmin = -1}, {.bucket_arcmin = 100}, {.threads = 300}, {.threads = -1}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    s.wish = wrong[i];
    assert_int_equal(try_plan(&plan, &s, &err), PLACIDO_INPUT);
    assert_null(plan);
  }
  s.wish = (placido_plan_wish){0};
  s.eye.age_years = 120;
  assert_int_equal(try_plan(&plan, &s, &err), PLACIDO_INPUT);
  s.eye.age_years = 0;
  s.eye.pupil_mm = 0;
  assert_int_equal(try_plan(&plan, &s, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "pupil"));
  s.eye.pupil_mm = 3;
  plan = make(&s); /* zero: the scene's tolerance, and every other default */
  assert_true(plan->wish.tolerance == 0.02 && plan->wish.threads == 1);
  assert_true(placido_plan_settings_of(plan)->bucket_arcmin == 0.5);
  assert_true(placido_plan_eye(plan)->age_years == 35);
  placido_plan_free(plan);
  end(&s);
}

static int settle(placido_eye *eye, const placido_question *question, enum placido_force force,
                  placido_answer *answer, placido_error *err) {
  (void)err;
  assert_true(question->facts->planes == 1 && question->eye->pupil_mm == 0);
  assert_int_equal(force, PLACIDO_FORCE_NONE);
  eye->pupil_mm = 4;
  answer->applies = true;
  answer->bound = 0.0001;
  return PLACIDO_OK;
}

/* It is not a candidate, however little it says that it matters: the eye has that pupil. */
static void an_effect_may_settle_the_eye(void **state) {
  (void)state;
  static const placido_effect settler = {
    .name = "settler", .gives = PLACIDO_GIVES_SPECTRUM, .settle = settle};
  static const placido_effect *const two[] = {&settler, &needy};
  const placido_effects effects = {two, 2};
  setting s = begin(0.01);
  placido_plan *plan;
  s.eye.pupil_mm = 0;
  set_bounds((const double[]){NAN, NAN, NAN, 0.5, NAN});
  assert_int_equal(placido_plan_of_effects(&plan, effects, s.surface, &s.eye, &s.scene, &s.wish,
                                           NULL, NULL), PLACIDO_OK);
  check_runs(plan, "rr");
  assert_true(placido_plan_eye(plan)->pupil_mm == 4 && plan->left_out == 0);
  assert_true(placido_plan_eye(plan)->retina_mm > 0);
  placido_plan_free(plan);
  end(&s);
}

/* Finer where less may be wrong; `finest` at least as fine as any. */
static void settings_follow_the_tolerance(void **state) {
  (void)state;
  setting s = begin(0.03);
  s.eye.pupil_mm = 6;
  set_bounds((const double[]){0.5, NAN, NAN, NAN, NAN});
  placido_plan *coarse = make(&s);
  s.wish.tolerance = 0.0003;
  placido_plan *fine = make(&s);
  s.wish.finest = true;
  placido_plan *finest = make(&s);
  const placido_plan_settings *a = placido_plan_settings_of(coarse);
  const placido_plan_settings *b = placido_plan_settings_of(fine);
  const placido_plan_settings *c = placido_plan_settings_of(finest);
  assert_true(a->pupil_samples < b->pupil_samples && b->pupil_samples <= c->pupil_samples);
  assert_true(a->buckets <= b->buckets && b->buckets <= c->buckets && a->buckets % 2 == 1);
  assert_true(a->bound + coarse->left_out <= 0.03 && b->bound + fine->left_out <= 0.0003);
  assert_true(c->doubles);
  placido_plan_free(coarse);
  placido_plan_free(fine);
  placido_plan_free(finest);
  end(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_smallest_go_first_while_their_sum_fits),
    cmocka_unit_test(many_small_ones_do_not_all_go),
    cmocka_unit_test(what_is_left_out_is_never_called_again),
    cmocka_unit_test(what_does_not_apply_does_not_run),
    cmocka_unit_test(a_person_decides),
    cmocka_unit_test(what_is_needed_stays_and_goes_with_its_need),
    cmocka_unit_test(what_is_needed_is_switched_on),
    cmocka_unit_test(a_contradiction_is_refused),
    cmocka_unit_test(strokes_are_seen_or_not),
    cmocka_unit_test(bounds_add_up_along_the_way),
    cmocka_unit_test(the_table_says_all_of_it),
    cmocka_unit_test(a_full_disk_is_told),
    cmocka_unit_test(a_saved_plan_has_every_verdict),
    cmocka_unit_test(the_same_question_has_the_same_answer),
    cmocka_unit_test(memory_may_run_out_anywhere),
    cmocka_unit_test(wishes_out_of_range_are_refused),
    cmocka_unit_test(an_effect_may_settle_the_eye),
    cmocka_unit_test(settings_follow_the_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

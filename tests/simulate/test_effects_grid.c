/* Plans are held to their word: over scenes, eyes and pupils, what a plan shows differs from everything
 * on by no more than the tolerance, and what is worth next to nothing is left out.
 *
 * So that this takes minutes and not hours the scenes are cut to a degree and all but one are grey,
 * tolerances take turns from cell to cell, and everything on is coarser than at its finest; the first
 * test shows what that costs. `placido bench effects` has whole scenes, each for all tolerances. */
#include "grid.h"
#include "simulate/plan/audit.h"
#include "simulate/plan/plan.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifdef __SANITIZE_ADDRESS__
enum { EYES = 2, PUPILS = 2 };
#else
enum { EYES = GRID_EYES, PUPILS = GRID_PUPILS };
#endif

enum { SIDE_PX = 60, TOLERANCES = 3, NODES = 3 };

/* A tolerance, and the wavelengths of a light that everything on has then. */
static const struct {
  double tolerance;
  int wavelengths;
} grades[TOLERANCES] = {{0.03, 5}, {0.01, 7}, {0.003, 11}};

static const double tiny_share = 0.1; /* of the tolerance: an effect worth less had better go */
static const double arcmin_per_px = 1;
static int scene_number; /* of grid_scenes: the program's argument */

/* Who looks at what. */
typedef struct look {
  const char *name;
  const placido_scene *scene;
  const placido_surface *surface;
  placido_eye eye;
} look;

static placido_audit audit_of(const look *l, int grade) {
  placido_audit audit;
  placido_error err = {0};
  if (placido_audit_new(&audit, l->surface, &l->eye, l->scene, arcmin_per_px,
                        grades[grade].tolerance, 1, &err) != PLACIDO_OK) {
    fail_msg("%s, %g mm: %s", l->name, l->eye.pupil_mm, err.text);
  }
  return audit;
}

static int lesser(int one, int other) { return one < other ? one : other; }

/* Fewer nodes and wavelengths than at its finest; a cone needs more nodes, one primary's light fewer
 * wavelengths. At night nothing is ever fine enough for a plan: there some rays and buckets must
 * do. */
static void coarsen(placido_audit *audit, const look *l, int grade) {
  const bool cone = strcmp(l->name, "keratoconus") == 0;
  const bool white = l->scene->image.planes == 1;
  const int wavelengths = grades[grade].wavelengths;
  placido_plan_settings *settings = &audit->settings;
  placido_audit_coarsen(audit, cone && grade == TOLERANCES - 1 ? NODES + 4 : NODES,
                        white ? wavelengths : (wavelengths + 1) / 2);
  settings->pupil_samples = lesser(settings->pupil_samples, 160);
  settings->buckets = lesser(settings->buckets, 257);
}

static placido_image see(const placido_audit *audit, int without) {
  placido_image seen;
  placido_error err = {0};
  if (placido_audit_see(&seen, audit, without, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return seen;
}

/* Everything on, as finely as pictures need it, and as what one effect is worth does. */
typedef struct sight {
  placido_audit fine, rough;
  placido_image everything, roughly;
  double worth[PLACIDO_EFFECTS_MAX]; /* found when it is asked for */
} sight;

/* What the whole grid comes to. */
typedef struct tally {
  int cells, unsafe, tiny, tiny_left;
  bool night;   /* lights far above white */
  double worst; /* largest difference, in tolerances */
} tally;

static double worth_of(sight *s, size_t index) {
  if (isnan(s->worth[index])) {
    placido_image seen = see(&s->rough, (int)index);
    s->worth[index] = placido_audit_difference(&s->roughly, &seen);
    placido_image_free(&seen);
  }
  return s->worth[index];
}

/* Counts those worth next to nothing. What was left out for less than that certainly is. */
static void count_tiny(tally *t, sight *s, const placido_plan *plan, double tolerance) {
  const double tiny = tiny_share * tolerance;
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  for (size_t i = 0; i < count; i++) {
    if (placido_audit_has(&s->rough, i) &&
        ((!verdicts[i].runs && verdicts[i].bound < tiny) || worth_of(s, i) < tiny)) {
      t->tiny++;
      t->tiny_left += !verdicts[i].runs;
      if (verdicts[i].runs) {
        print_message("  %s runs for %g, bounded by %g, at a tolerance of %g\n", verdicts[i].name,
                      s->worth[i], verdicts[i].bound, tolerance);
      }
    }
  }
}

static void tell(const look *l, double tolerance, double difference, const placido_plan *plan) {
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  print_error("%s, %s, %g mm: %g for a tolerance of %g; left out:", l->scene->name, l->name,
              l->eye.pupil_mm, difference, tolerance);
  for (size_t i = 0; i < count; i++) {
    if (!verdicts[i].runs && verdicts[i].applies) {
      print_error(" %s (%g)", verdicts[i].name, verdicts[i].bound);
    }
  }
  print_error("\n");
}

/* The picture as planned. Where lights are brighter than white, thousands of times perhaps, pictures
 * need more wavelengths than everything on can have here: there what is left out is looked at with
 * the same settings for both. */
static placido_image see_as_planned(const placido_plan *plan, const placido_audit *everything) {
  placido_plan run = *plan;
  placido_image seen;
  placido_error err = {0};
  if (plan->facts.brightest[0] > 1) {
    run.settings = everything->settings;
  }
  if (placido_plan_run(&seen, NULL, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return seen;
}

static void hold(tally *t, const look *l, sight *s, double tolerance) {
  const placido_plan_wish wish = {.tolerance = tolerance, .bucket_arcmin = arcmin_per_px};
  placido_plan *plan;
  placido_error err = {0};
  if (placido_plan_new(&plan, l->surface, &l->eye, l->scene, &wish, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s, %g mm: %s", l->name, l->eye.pupil_mm, err.text);
  }
  placido_image seen = see_as_planned(plan, &s->fine);
  double difference = placido_audit_difference(&s->everything, &seen);
  t->worst = fmax(t->worst, difference / tolerance);
  if (!(difference <= tolerance)) {
    t->unsafe++;
    tell(l, tolerance, difference, plan);
  }
  count_tiny(t, s, plan, tolerance);
  placido_image_free(&seen);
  placido_plan_free(plan);
}

static void look_at(tally *t, const look *l, int grade) {
  sight s = {.fine = audit_of(l, grade)};
  coarsen(&s.fine, l, grade);
  s.rough = s.fine;
  placido_audit_coarsen(&s.rough, NODES, 3);
  s.everything = see(&s.fine, -1);
  s.roughly = see(&s.rough, -1);
  for (int i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    s.worth[i] = NAN;
  }
  hold(t, l, &s, grades[grade].tolerance);
  t->night = s.fine.everything->facts.brightest[0] > 10;
  t->cells++;
  placido_image_free(&s.roughly);
  placido_image_free(&s.everything);
  placido_audit_free(&s.fine);
}

static void test_plans_are_safe_and_not_timid(void **state) {
  (void)state;
  tally t = {0};
  placido_scene scene = grid_scene(scene_number, arcmin_per_px, SIDE_PX);
  for (int eye = 0; eye < EYES; eye++) {
    placido_surface *surface = grid_cornea(eye);
    for (int pupil = 0; pupil < PUPILS; pupil++) {
      const look l = {grid_eyes[eye], &scene, surface,
                      {.pupil_mm = grid_pupils_mm[pupil], .correct = PLACIDO_CORRECT_FULL}};
      look_at(&t, &l, (scene_number + eye + pupil) % TOLERANCES);
    }
    placido_surface_free(surface);
  }
  print_message("%s: %d cells, the largest difference is %.2f tolerances; %d of %d tiny effects "
                "left out\n",
                scene.name, t.cells, t.worst, t.tiny_left, t.tiny);
  placido_scene_free(&scene);
  assert_int_equal(t.unsafe, 0);
  /* At night three or four effects of all cells are tiny, as in part of the grid: too few to be a
   * share of. */
  const double few = t.night || t.cells < GRID_EYES * GRID_PUPILS ? 4 : 0;
  assert_true(t.tiny - t.tiny_left <= fmax(0.2 * t.tiny, few));
}

/* Everything as it is seen here against everything at its finest: within half of the tolerance. */
static void test_everything_is_seen_finely_enough(void **state) {
  (void)state;
  const int eyes[] = {0, 2}; /* regular, a cone */
  for (int i = 0; i < EYES / 2 && i < 2; i++) {
    placido_scene scene = grid_scene(0, arcmin_per_px, SIDE_PX);
    placido_surface *surface = grid_cornea(eyes[i]);
    const look l = {grid_eyes[eyes[i]], &scene, surface,
                    {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL}};
    placido_audit audit = audit_of(&l, TOLERANCES - 1);
    placido_image finest = see(&audit, -1);
    for (int grade = TOLERANCES - 1; grade >= 0; grade--) { /* coarser each time */
      coarsen(&audit, &l, grade);
      placido_image coarser = see(&audit, -1);
      double difference = placido_audit_difference(&finest, &coarser);
      print_message("%s: %g for %g\n", l.name, difference, grades[grade].tolerance);
      assert_true(difference < grades[grade].tolerance / 2);
      placido_image_free(&coarser);
    }
    placido_image_free(&finest);
    placido_audit_free(&audit);
    placido_surface_free(surface);
    placido_scene_free(&scene);
  }
}

int main(int argc, char **argv) {
  const struct CMUnitTest everything[] = {cmocka_unit_test(test_everything_is_seen_finely_enough)};
  const struct CMUnitTest grid[] = {cmocka_unit_test(test_plans_are_safe_and_not_timid)};
  if (argc < 2) {
    return cmocka_run_group_tests(everything, NULL, NULL);
  }
  for (scene_number = 0; scene_number < GRID_SCENES; scene_number++) {
    if (strcmp(argv[1], grid_scenes[scene_number]) == 0) {
      return cmocka_run_group_tests(grid, NULL, NULL);
    }
  }
  return 1;
}

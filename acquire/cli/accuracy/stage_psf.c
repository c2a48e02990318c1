/* The point spread function in white light, by waves that the eye's power focuses at different
 * depths: what wider buckets, fewer of them and fewer wavelengths do to it. A plan's run with its
 * settings replaced, of one letter. */
#include "acquire/cli/accuracy/differ.h"
#include "acquire/cli/accuracy/stage.h"
#include "base/memory.h"
#include "simulate/plan/plan.h"
#include "simulate/plan/run.h"

#include <math.h>
#include <string.h>

#define PX_ARCMIN 0.2
#define PX_PER_STROKE 25 /* a letter of 25', an acuity of 20/100 */
#define STROKES 7        /* five, and one of white on either side */
#define PX (PX_PER_STROKE * STROKES)
#define PUPIL_SAMPLES 256

/* Where buckets get wider they get fewer: 102' a side in all of the first. */
static const char *const settings[] = {
    "bucket_arcmin=1 buckets=103", "bucket_arcmin=0.7 buckets=147",
    "bucket_arcmin=0.5 buckets=205", "bucket_arcmin=0.35 buckets=293",
    "bucket_arcmin=0.25 buckets=411", "buckets=65", "buckets=129", "buckets=205", "buckets=321",
    "wavelengths=1", "wavelengths=3", "wavelengths=5", "wavelengths=7", "wavelengths=9",
    "wavelengths=11", "wavelengths=15", "wavelengths=21",
    "bucket_arcmin=0.5 buckets=65 wavelengths=5", "bucket_arcmin=0.5 buckets=129 wavelengths=7",
    "bucket_arcmin=0.5 buckets=257 wavelengths=11", NULL};
static const char *const quick[] = {"bucket_arcmin=0.5 buckets=129 wavelengths=3",
                                    "bucket_arcmin=0.5 buckets=129 wavelengths=5", NULL};

static const struct accuracy_knobs finest = {
    .bucket_arcmin = PX_ARCMIN, .buckets = 513, .wavelengths = 31};
static const struct accuracy_knobs quick_finest = {
    .bucket_arcmin = 0.5, .buckets = 129, .wavelengths = 9};

/* What is seen, and of it the spread in the middle. */
struct view {
  placido_psf psf;
  placido_image image;
  double logmar;
};

struct prepared {
  placido_scene scene;
  struct view view;
};

static void view_free(struct view *view) {
  placido_image_free(&view->image);
  placido_psf_free(&view->psf);
}

static void release(void *state) {
  struct prepared *prepared = state;
  if (prepared) {
    view_free(&prepared->view);
    placido_scene_free(&prepared->scene);
    placido_memory_free(prepared);
  }
}

/* An E in black on white. */
static int draw(placido_scene *scene, placido_error *err) {
  static const char letter[STROKES][STROKES + 1] = {".......", ".#####.", ".#.....", ".#####.",
                                                    ".#.....", ".#####.", "......."};
  const placido_conditions conditions = {.luminance_cd_m2 = NAN,
                                         .distance_m = (double)INFINITY,
                                         .spectrum = PLACIDO_SPECTRUM_DAYLIGHT,
                                         .wavelength_nm = NAN,
                                         .tolerance = 0.01};
  *scene = (placido_scene){
      .name = "letter", .arcmin_per_px = PX_ARCMIN, .bits = 8, .conditions = conditions};
  const int status = placido_image_new(&scene->image, PX, PX, 1, err);
  for (int i = 0; status == PLACIDO_OK && i < PX * PX; i++) {
    const char stroke = letter[i / PX / PX_PER_STROKE][i % PX / PX_PER_STROKE];
    scene->image.data[i] = stroke == '#' ? 0.0f : 1.0f;
  }
  return status;
}

static int plan_letter(placido_plan **plan, const struct accuracy_eye *eye,
                       const placido_scene *scene, const struct accuracy_knobs *knobs,
                       placido_error *err) {
  placido_plan_wish wish = {.bucket_arcmin = knobs->bucket_arcmin, .threads = 1};
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    wish.force[i] = PLACIDO_FORCE_OFF;
  }
  wish.force[placido_effect_find("longitudinal-chromatic")] = PLACIDO_FORCE_ON;
  wish.force[placido_effect_find("diffraction")] = PLACIDO_FORCE_ON;
  return placido_plan_new(plan, eye->seen.surface, &eye->seen.eye, scene, &wish, NULL, err);
}

static int run_plan(struct view *view, const placido_plan *plan,
                    const struct accuracy_knobs *knobs, placido_error *err) {
  const placido_plan_settings settings_of_run = {.pupil_samples = PUPIL_SAMPLES,
                                                 .wavelengths = knobs->wavelengths,
                                                 .layers = 1,
                                                 .nodes = 1,
                                                 .bucket_arcmin = knobs->bucket_arcmin,
                                                 .buckets = knobs->buckets,
                                                 .doubles = true};
  const placido_effect *running[PLACIDO_EFFECTS_MAX];
  size_t count = 0;
  for (size_t i = 0; i < plan->effects.count; i++) {
    if (plan->verdicts[i].runs) {
      running[count++] = plan->effects.rows[i];
    }
  }
  const placido_run run_of_plan = {.surface = plan->surface,
                                   .scene = plan->scene,
                                   .facts = &plan->facts,
                                   .settings = &settings_of_run,
                                   .eye = &plan->eye,
                                   .open = plan->open,
                                   .effects = running,
                                   .count = count,
                                   .threads = 1};
  return placido_view_run(&view->image, &view->psf, &run_of_plan, err);
}

/* One lap or several; the plan's own time does not count. */
static int see(struct view *view, struct accuracy_watch *watch, const struct accuracy_bench *bench,
               const struct accuracy_eye *eye, const placido_scene *scene,
               const struct accuracy_knobs *knobs, placido_error *err) {
  placido_plan *plan;
  int status = plan_letter(&plan, eye, scene, knobs, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  do {
    view_free(view);
    accuracy_watch_begin(watch);
    status = run_plan(view, plan, knobs, err);
    accuracy_watch_end(watch);
  } while (status == PLACIDO_OK && accuracy_watch_again(watch, bench));
  placido_plan_free(plan);
  return status == PLACIDO_OK
             ? accuracy_chart_read(&view->logmar, bench->chart.observer, &view->psf, err)
             : status;
}

static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  struct prepared *prepared = *state = placido_memory_new(1, sizeof *prepared, err);
  struct accuracy_watch once = {.laps = bench->repeats};
  const int status = prepared ? draw(&prepared->scene, err) : PLACIDO_MEMORY;
  return status == PLACIDO_OK ? see(&prepared->view, &once, bench, eye, &prepared->scene,
                                    bench->quick ? &quick_finest : &finest, err)
                              : status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const struct prepared *prepared = trial->prepared;
  struct accuracy_knobs knobs = finest;
  struct accuracy_watch watch = {0};
  struct view view = {.logmar = NAN};
  int status = accuracy_knobs_read(&knobs, trial->setting, err);
  if (status == PLACIDO_OK) {
    status = see(&view, &watch, trial->bench, trial->eye, &prepared->scene, &knobs, err);
  }
  row->ms = watch.least_ms;
  if (status == PLACIDO_OK) {
    row->error[ACCURACY_IMAGE] = accuracy_differ_images(&view.image, &prepared->view.image);
    row->error[ACCURACY_LOGMAR] = fabs(view.logmar - prepared->view.logmar);
    status = accuracy_differ_psfs(&row->error[ACCURACY_PSF_OTF], &view.psf, &prepared->view.psf,
                                  err);
  }
  view_free(&view);
  return status;
}

const struct accuracy_measure accuracy_measure_psf = {.stage = ACCURACY_PSF,
                                                      .settings = settings,
                                                      .quick = quick,
                                                      .prepare = prepare,
                                                      .run = run,
                                                      .release = release};

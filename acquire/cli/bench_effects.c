/* `placido bench effects`: whether plans keep their word. Scenes, eyes and pupils, each seen with
 * everything on, with everything but one effect, and as planned for three tolerances. */
#include "acquire/cli/bench.h"
#include "acquire/cli/bench_effects.h"
#include "acquire/cli/command.h"
#include "base/file.h"

#include <placido/phantom.h>
#include <placido/simulate.h>

#include <math.h>
#include <stdio.h>

#define EYES 6
#define PUPILS 4
#define SCENES 7
#define TINY 0.1 /* of the tolerance: what is worth less had better be left out */
#define ARCMIN_PER_PX 1.0
#define QUICK_ARCMIN_PER_PX 4.0

static const char *const scenes[SCENES] = {"tumbling-e", "building", "street", "monitor",
                                           "page", "stars", "colours"};
/* The last is made here: all rays of a cornea alone meet in a point at Q = -1 / n², -0.559. */
static const char *const eyes[EYES] = {"normal", "astigmatic", "keratoconus", "post-prk",
                                       "irregular", "nearly perfect"};
static const placido_part perfect = {PLACIDO_PART_BICONIC,
                                     {.biconic = {7.8, -0.55, 7.8, -0.55, 0, 0, 0}}};
static const double pupils_mm[PUPILS] = {4, 2, 7, 0};

/* How much of the grid is looked at: the first so many of each. */
struct extent {
  size_t scenes, eyes, pupils, tolerances;
  double arcmin_per_px;
};

/* What the looks at one scene come to. */
struct tally {
  size_t looks, plans;
  double worst;            /* largest difference, in tolerances */
  size_t tiny, tiny_left;  /* effects worth less than TINY tolerances; and left out */
  double planning;         /* largest share of a run */
  double planned_s, everything_s, least_ratio; /* sums, and in the look where it pays least */
  size_t ran[PLACIDO_EFFECTS_MAX];             /* in so many plans */
};

/* What is looked with. */
struct bench_grid {
  struct bench_run *run;
  struct extent extent;
  placido_surface *corneas[EYES];
  placido_file csv;
  bool has_csv;
};

/* By name all of it, which takes a good hour; else what shows it in a minute. */
static struct extent choose_extent(const struct settings *settings) {
  if (settings->quick) {
    return (struct extent){1, 1, 1, 1, QUICK_ARCMIN_PER_PX};
  }
  return settings->input != NULL
           ? (struct extent){SCENES, EYES, PUPILS, BENCH_TOLERANCES, ARCMIN_PER_PX}
           : (struct extent){SCENES, 1, 1, 1, 2 * ARCMIN_PER_PX};
}

static int make_corneas(struct bench_grid *grid, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < grid->extent.eyes && status == PLACIDO_OK; i++) {
    status = i + 1 < EYES
               ? placido_phantom_eye(&grid->corneas[i], eyes[i], err)
               : placido_surface_new(&grid->corneas[i], 0, 5.6, &perfect, 1, NULL, err);
  }
  return status;
}

static int open_csv(struct bench_grid *grid, placido_error *err) {
  const char *folder = grid->run->settings->output;
  char path[PLACIDO_PATH_MAX];
  const char *name, *summary;
  if (folder == NULL || grid->run->settings->input == NULL) {
    return PLACIDO_OK; /* it is for `record` */
  }
  int status = placido_path_join(path, folder, "effects.csv", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&grid->csv, path, err);
  }
  if (status == PLACIDO_OK) {
    grid->has_csv = true;
    fputs("scene,eye,pupil_mm,tolerance,difference,planned_s,everything_s,asking_s",
          grid->csv.stream);
    for (size_t i = 0; placido_effect_at(i, &name, &summary); i++) {
      fprintf(grid->csv.stream, ",%s_ran,%s_bound,%s_worth", name, name, name);
    }
    fputc('\n', grid->csv.stream);
  }
  return status;
}

static void write_row(const struct bench_grid *grid, const struct bench_look *look,
                      double tolerance, const struct bench_planned *planned) {
  const char *name, *summary;
  FILE *stream = grid->csv.stream;
  if (!grid->has_csv) {
    return;
  }
  fprintf(stream, "%s,%s,%.17g,%.17g,%.9g,%.6g,%.6g,%.6g", look->scene_name, look->eye_name,
          look->pupil_mm, tolerance, planned->difference, planned->planned_s,
          planned->everything_s, planned->asking_s);
  for (size_t i = 0; placido_effect_at(i, &name, &summary); i++) {
    fprintf(stream, ",%d,%.9g,%.9g", planned->ran[i], planned->bound[i], planned->worth[i]);
  }
  fputc('\n', stream);
}

static void add(struct tally *tally, double tolerance, const struct bench_planned *planned) {
  double run_s = planned->planned_s + planned->asking_s;
  double ratio = planned->everything_s / run_s;
  tally->plans++;
  tally->worst = fmax(tally->worst, planned->difference / tolerance);
  tally->planning = fmax(tally->planning, planned->asking_s / run_s);
  tally->planned_s += run_s;
  tally->everything_s += planned->everything_s;
  tally->least_ratio = tally->plans == 1 ? ratio : fmin(tally->least_ratio, ratio);
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    bool tiny = planned->worth[i] < TINY * tolerance; /* not where it is NaN */
    tally->tiny += tiny;
    tally->tiny_left += tiny && !planned->ran[i];
    tally->ran[i] += planned->ran[i];
  }
}

static int look_at_scene(struct tally *tally, struct bench_grid *grid, size_t number,
                         placido_error *err) {
  const struct extent *extent = &grid->extent;
  placido_scene scene;
  int status = placido_scene_load(&scene, scenes[number], extent->arcmin_per_px, NULL, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (size_t i = 0; i < extent->eyes * extent->pupils && status == PLACIDO_OK; i++) {
    struct bench_planned planned[BENCH_TOLERANCES];
    const struct bench_look look = {.scene_name = scenes[number],
                                    .eye_name = eyes[i / extent->pupils],
                                    .scene = &scene,
                                    .surface = grid->corneas[i / extent->pupils],
                                    .pupil_mm = pupils_mm[i % extent->pupils],
                                    .threads = 1,
                                    .quick = grid->run->settings->quick};
    status = bench_look_at(planned, &look, extent->tolerances, err);
    for (size_t k = 0; k < extent->tolerances && status == PLACIDO_OK; k++) {
      add(tally, bench_tolerances[k], &planned[k]);
      write_row(grid, &look, bench_tolerances[k], &planned[k]);
    }
    tally->looks++;
  }
  placido_scene_free(&scene);
  return status;
}

/* "diffraction, field": those that ran in at least half of the plans. */
static void list_usual(char *text, size_t size, const struct tally *tally) {
  const char *name, *summary;
  size_t length = 0;
  text[0] = '\0';
  for (size_t i = 0; placido_effect_at(i, &name, &summary) && length < size; i++) {
    if (2 * tally->ran[i] >= tally->plans) {
      length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "",
                                 name);
    }
  }
}

static int report_scene(struct bench_grid *grid, const char *name, const struct tally *tally,
                        placido_error *err) {
  char usual[BENCH_LISTED];
  const struct {
    const char *what;
    double value;
    const char *unit;
    double ratio;
    const char *against;
  } figures[] = {
    {"largest difference", tally->worst, "tolerances", NAN, NULL},
    {"of tiny effects left out", 100.0 * (double)tally->tiny_left / fmax((double)tally->tiny, 1),
     "%", NAN, NULL},
    {"planned", 1e3 * tally->planned_s / (double)tally->plans, "ms",
     tally->planned_s / tally->everything_s, "everything on"},
    {"everything on, where it pays least", tally->least_ratio, "plans", NAN, NULL},
    {"planning, at most", 100 * tally->planning, "%", NAN, NULL},
  };
  int status = PLACIDO_OK;
  for (size_t i = 0; i < sizeof figures / sizeof *figures && status == PLACIDO_OK; i++) {
    char what[64];
    snprintf(what, sizeof what, "%s: %s", name, figures[i].what);
    status = bench_report_number(&grid->run->report, what, figures[i].value, figures[i].unit,
                                 figures[i].ratio, figures[i].against, err);
  }
  list_usual(usual, sizeof usual, tally);
  return status == PLACIDO_OK ? bench_report_say(&grid->run->report, err, "%s: mostly runs %s", name,
                                                 usual[0] != '\0' ? usual : "nothing")
                              : status;
}

static int look_at_all(struct bench_grid *grid, placido_error *err) {
  int status = make_corneas(grid, err);
  if (status == PLACIDO_OK) {
    status = open_csv(grid, err);
  }
  for (size_t i = 0; i < grid->extent.scenes && status == PLACIDO_OK; i++) {
    struct tally tally = {0};
    stages_next(&grid->run->outcome->stages, "effects: %s", scenes[i]);
    status = look_at_scene(&tally, grid, i, err);
    if (status == PLACIDO_OK) {
      status = report_scene(grid, scenes[i], &tally, err);
    }
  }
  return status == PLACIDO_OK && grid->has_csv ? placido_file_commit(&grid->csv, err) : status;
}

static int run(struct bench_run *bench, placido_error *err) {
  struct bench_grid grid = {.run = bench, .extent = choose_extent(bench->settings)};
  int status = look_at_all(&grid, err);
  placido_file_discard(&grid.csv);
  for (size_t i = 0; i < EYES; i++) {
    placido_surface_free(grid.corneas[i]);
  }
  return status;
}

const struct bench bench_effects = {
    .name = "effects",
    .summary = "what plans leave out, against the same scenes with every effect on",
    .run = run,
};

/* Which figures an examination has, and the page that shows them. */
#include "acquire/cli/figures.h"

#include "acquire/cli/plan_json.h"
#include "base/memory.h"
#include "report/iso.h"
#include "report/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define BUDGET_ZONE_MM 6 /* as in exam.json */
#define CAPTURE_WIDTH_PX 640 /* of the picture in the report; the session keeps the frame */

static int draw_map(const struct examination *examination, size_t kind, size_t b,
                    const char *path, placido_error *err) {
  (void)b;
  return placido_figure_map_scaled(&examination->maps, (int)kind,
                                   (enum placido_scale_mode)examination->settings->maps.scale, path,
                                   err);
}

/* Of kind number `kind`, or of z behind the last one. */
static int draw_sigma(const struct examination *examination, size_t kind, size_t b,
                      const char *path, placido_error *err) {
  (void)b;
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  char which[64];
  snprintf(which, sizeof which, "sigma_%s", kind < count ? kinds[kind].name : "z");
  return placido_figure_sigma(&examination->maps, which, path, err);
}

/* Mires of several frames are moved to where the one that is shown has them. */
static int draw_mires(const struct examination *examination, size_t a, size_t b,
                      const char *path, placido_error *err) {
  (void)a;
  (void)b;
  const double *offset_px = examination->combination.offset_px;
  placido_mires shown = examination->mires;
  shown.points = placido_memory_new(shown.count, sizeof *shown.points, err);
  if (!shown.points) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < shown.count; i++) {
    shown.points[i] = examination->mires.points[i];
    shown.points[i].u_px += offset_px[0];
    shown.points[i].v_px += offset_px[1];
  }
  shown.centre_u_px += offset_px[0];
  shown.centre_v_px += offset_px[1];
  const int status = placido_figure_mires(&examination->frame, &shown,
                                          examination_mm_per_px(examination), path, err);
  placido_memory_free(shown.points);
  return status;
}

static int draw_capture(const struct examination *examination, size_t a, size_t b,
                        const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_figure_frame(&examination->frame, CAPTURE_WIDTH_PX, path, err);
}

static int draw_psf(const struct examination *examination, size_t pupil, size_t b,
                    const char *path, placido_error *err) {
  (void)b;
  return placido_figure_psf(&examination->views.items[pupil].psf, path, err);
}

static int draw_quality(const struct examination *examination, size_t pupil, size_t b,
                        const char *path, placido_error *err) {
  (void)b;
  const struct view *view = &examination->views.items[pupil];
  return placido_figure_quality(&view->psf, view->focus.count > 0 ? &view->focus : NULL, path, err);
}

static void name_wavefront(char name[JOB_NAME_SIZE], double pupil_mm) {
  snprintf(name, JOB_NAME_SIZE, "maps/wavefront-%gmm.png", pupil_mm);
}

static int draw_wavefront(const struct examination *examination, size_t index, size_t b,
                          const char *path, placido_error *err) {
  (void)b;
  const struct wavefront_view *view = &examination->wavefronts.items[index];
  double sigma_um[PLACIDO_WAVEFRONT_TERMS];
  for (int j = 0; j < PLACIDO_WAVEFRONT_TERMS; j++) {
    sigma_um[j] = view->terms[j].sigma;
  }
  return placido_figure_wavefront(&view->front, sigma_um, path, err);
}

bool figures_available(void) {
  return true;
}

/* The slowest first: what is begun last is short, so that no thread waits long at the end. */
void figures_add(struct jobs *jobs, const struct examination *examination) {
  if (examination->frame.data) {
    jobs_add(jobs, draw_mires, 0, 0, "mires.png");
  }
  for (size_t i = 0; i < examination->views.count; i++) {
    jobs_add(jobs, draw_psf, i, 0, "%s/psf.png", examination->views.items[i].directory);
    jobs_add(jobs, draw_quality, i, 0, "%s/quality.png", examination->views.items[i].directory);
  }
  if (!examination->fit) {
    return;
  }
  if (examination->frame.data) {
    jobs_add(jobs, draw_capture, 0, 0, "capture.png");
  }
  for (size_t i = 0; i < examination->wavefronts.count; i++) {
    char name[JOB_NAME_SIZE];
    name_wavefront(name, examination->wavefronts.items[i].front.eye.pupil_mm);
    jobs_add(jobs, draw_wavefront, i, 0, "%s", name);
  }
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < count; i++) {
    jobs_add(jobs, draw_map, i, 0, "maps/%s.png", kinds[i].name);
  }
  for (size_t i = 0; i <= count; i++) {
    if (i == count || !kinds[i].more) {
      jobs_add(jobs, draw_sigma, i, 0, "maps/sigma_%s.png", i < count ? kinds[i].name : "z");
    }
  }
}

#define MAPS_MAX 32

/* What the page borrows while it is written. */
struct page {
  char map_files[MAPS_MAX][JOB_NAME_SIZE], map_captions[MAPS_MAX][512];
  placido_report_map maps[MAPS_MAX];
  size_t map_count;
  char wavefront_files[LIST_MAX][JOB_NAME_SIZE];
  double wavefront_sigmas[LIST_MAX][WAVEFRONT_FIGURES_MAX];
  placido_report_wavefront wavefronts[LIST_MAX];
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  char condition[512];
  char chosen[512], by[512];
  placido_report_accuracy accuracy;
  char psf_files[VIEWS_MAX][JOB_NAME_SIZE], scene_files[VIEWS_MAX][LIST_MAX][JOB_NAME_SIZE];
  const char *scene_names[VIEWS_MAX][LIST_MAX], *scene_pictures[VIEWS_MAX][LIST_MAX];
  placido_report_plan plans[VIEWS_MAX][LIST_MAX];
  placido_report_pupil pupils[VIEWS_MAX];
  placido_stage stages[STAGES_MAX];
  placido_fit_summary fit;
};

/* What does not fit any more is left out of the page, not of the directory. */
static void list_map(struct page *page, const char *name, enum placido_report_place place,
                     const char *caption) {
  if (page->map_count == MAPS_MAX) {
    return;
  }
  const size_t index = page->map_count++;
  snprintf(page->map_files[index], sizeof page->map_files[index], "maps/%s.png", name);
  snprintf(page->map_captions[index], sizeof page->map_captions[index], "%s", caption);
  page->maps[index] =
      (placido_report_map){page->map_files[index], page->map_captions[index], place};
}

/* The maps that everyone looks at first, in that order. */
static const char *const main_maps[] = {"axial", "tangential", "elevation", "refractive"};
#define MAIN_MAPS (sizeof main_maps / sizeof main_maps[0])

static bool is_main(const char *name) {
  size_t i = 0;
  while (i < MAIN_MAPS && strcmp(name, main_maps[i]) != 0) {
    i++;
  }
  return i < MAIN_MAPS;
}

static void list_kind(struct page *page, const placido_map_kind *kind,
                      enum placido_report_place place) {
  char caption[512];
  snprintf(caption, sizeof caption, "%s: %s", kind->title, kind->help);
  list_map(page, kind->name, place, caption);
}

static void list_maps(struct page *page) {
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < MAIN_MAPS; i++) {
    list_kind(page, &kinds[placido_maps_find(main_maps[i])], PLACIDO_PLACE_MAIN);
  }
  for (size_t i = 0; i < count; i++) {
    if (!is_main(kinds[i].name)) {
      list_kind(page, &kinds[i], PLACIDO_PLACE_FURTHER);
    }
  }
  list_map(page, "sigma_z", PLACIDO_PLACE_UNCERTAINTY,
           "Height against its mean over the central 3 mm: what edge noise, smoothing and the "
           "cornea's distance leave open, and the instrument's geometry where its file tells.");
  for (size_t i = 0; i < count; i++) {
    if (!kinds[i].more) {
      char name[64];
      snprintf(name, sizeof name, "sigma_%s", kinds[i].name);
      list_map(page, name, PLACIDO_PLACE_UNCERTAINTY, kinds[i].title);
    }
  }
}

static void list_wavefronts(struct page *page, const struct wavefronts *wavefronts) {
  for (size_t i = 0; i < wavefronts->count; i++) {
    const struct wavefront_view *view = &wavefronts->items[i];
    for (int k = 0; k < WAVEFRONT_FIGURES_MAX; k++) {
      page->wavefront_sigmas[i][k] = view->figure_spreads[k].sigma;
    }
    name_wavefront(page->wavefront_files[i], view->front.eye.pupil_mm);
    page->wavefronts[i] = (placido_report_wavefront){.front = &view->front,
                                                     .figures = view->figures,
                                                     .sigmas = page->wavefront_sigmas[i],
                                                     .picture = page->wavefront_files[i]};
  }
}

static placido_report_plan describe_plan(const struct sight *sight, const placido_scene *scene,
                                         const struct settings *settings) {
  placido_report_plan plan = {.tolerance = plan_settings_tolerance(settings, scene),
                              .run_s = sight->run_s};
  double settling_s;
  if (sight->plan) {
    plan.verdicts = placido_plan_verdicts(sight->plan, &plan.count);
    placido_plan_seconds(sight->plan, &plan.planning_s, &settling_s);
    plan.promised = plan_json_promised(sight->plan);
    plan.predicted_s = 1e-3 * placido_plan_settings_of(sight->plan)->cost_ms;
  }
  return plan;
}

static void list_pupil(struct page *page, size_t index, const struct views *views,
                       const struct settings *settings) {
  const struct view *view = &views->items[index];
  placido_report_pupil *pupil = &page->pupils[index];
  snprintf(page->psf_files[index], JOB_NAME_SIZE, "%s/psf.png", view->directory);
  *pupil = (placido_report_pupil){.psf = &view->psf,
                                  .strehl_g_sigma = view->strehl_g_sigma,
                                  .automatic = view->automatic,
                                  .psf_picture = page->psf_files[index],
                                  .scene_names = page->scene_names[index],
                                  .scene_pictures = page->scene_pictures[index],
                                  .plans = page->plans[index],
                                  .scene_arcmin_per_px = view->psf.bucket_arcmin,
                                  .acuities = view->acuity.items,
                                  .acuity_count = view->acuity.count,
                                  .ghosts = &view->acuity.ghosts};
  for (size_t i = 0; i < views->scene_count; i++) {
    if (!view->sights[i].image.data) {
      continue;
    }
    page->plans[index][pupil->scene_count] =
        describe_plan(&view->sights[i], &views->scenes[i], settings);
    char *file = page->scene_files[index][pupil->scene_count];
    snprintf(file, JOB_NAME_SIZE, "%s/%s.png", view->directory, views->stems[i]);
    page->scene_pictures[index][pupil->scene_count] = file;
    page->scene_names[index][pupil->scene_count] = views->scenes[i].name;
    pupil->scene_count++;
  }
}

static void list_stages(struct page *page, const struct stages *stages) {
  for (size_t i = 0; i < stages->count; i++) {
    page->stages[i] = (placido_stage){stages->items[i].name, stages->items[i].seconds};
  }
}

/* The parts that only a capture has. */
static void describe_capture(placido_report *report, struct page *page,
                             const struct examination *examination) {
  page->fit = placido_fit_summary_get(examination->fit);
  list_maps(page);
  report->eye = examination->source.eye;
  report->instrument_name = examination->instrument.name;
  report->calibrated = examination->instrument.calibrated;
  report->axis_z_mm = examination->axis_z_mm;
  report->axis_z_sigma_mm = examination->axis_z_sigma_mm;
  report->mires = &examination->mires;
  report->fit = &page->fit;
  report->capture_picture = "capture.png";
  report->mires_picture = "mires.png";
  report->maps = page->maps;
  report->map_count = page->map_count;
  report->indices = examination->indices;
  report->index_count = examination->index_count;
  list_wavefronts(page, &examination->wavefronts);
  report->wavefronts = page->wavefronts;
  report->wavefront_count = examination->wavefronts.count;
  placido_fit_budget(examination->fit, BUDGET_ZONE_MM, page->budget);
  report->budget = page->budget;
  report->budget_zone_mm = BUDGET_ZONE_MM;
  conditions_tell(page->condition, sizeof page->condition, &examination->conditions);
  report->condition = page->condition[0] ? page->condition : NULL;
}

static double asked(double limit) { return limit > 0 ? limit : (double)NAN; }

static void describe_accuracy(placido_report *report, struct page *page,
                              const struct examination *examination) {
  const struct promise *promise = &examination->promise;
  const struct accuracy_settings *limits = &promise->settings.accuracy;
  promise_describe(page->chosen, page->by, sizeof page->by, promise);
  page->accuracy = (placido_report_accuracy){
      .elevation_um = {asked(limits->max_error_um),
                       promise_error(examination, ACCURACY_ELEVATION_UM), promise->sigma_um},
      .psf = {asked(limits->max_error_psf), promise_error(examination, ACCURACY_PSF_OTF), NAN},
      .time_ms = {asked(limits->max_time_ms), promise_time_ms(promise), promise->found_ms},
      .settings = page->chosen,
      .table = page->by};
  report->accuracy = &page->accuracy;
}

int figures_report(const struct examination *examination, placido_error *err) {
  struct page *page = placido_memory_new(1, sizeof *page, err);
  if (!page) {
    return PLACIDO_MEMORY;
  }
  const struct stages *stages = &examination->outcome->stages;
  placido_report report = {.directory = examination->directory.temporary,
                           .input = examination->settings->input,
                           .software = PROGRAM_VERSION,
                           .created = examination->created,
                           .calibrated = true,
                           .pupils = page->pupils,
                           .pupil_count = examination->views.count,
                           .stages = page->stages,
                           .stage_count = stages->count > 0 ? stages->count - 1 : 0,
                           .notes = &examination->outcome->notes};
  for (size_t i = 0; i < examination->views.count; i++) {
    list_pupil(page, i, &examination->views, examination->settings);
  }
  list_stages(page, stages);
  if (examination->fit) {
    describe_capture(&report, page, examination);
  }
  if (examination->promise.made) {
    describe_accuracy(&report, page, examination);
  }
  const int status = placido_report_write(&report, err);
  placido_memory_free(page);
  return status;
}

int figures_drift(const struct ball_record *records, size_t count, const char *path,
                  placido_notes *notes, placido_error *err) {
  (void)notes;
  placido_drift_point *points = placido_memory_new(count, sizeof *points, err);
  if (!points) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    const struct ball_record *r = &records[i];
    points[i] = (placido_drift_point){.t_s = r->t_s,
                                      .power_D = {r->power_D[0], r->power_D[1], r->power_D[2]},
                                      .shape_um = r->rms_8_um,
                                      .limit_D = r->limit_D,
                                      .limit_um = r->limit_um,
                                      .passed = r->passed};
  }
  const int status = placido_figure_drift(points, count, path, err);
  placido_memory_free(points);
  return status;
}

#define ISO_PICTURE "iso-check.png"

int figures_iso(const placido_iso_result *results, size_t count, const char *instrument,
                const char *created, const char *folder, placido_notes *notes, placido_error *err) {
  (void)notes;
  char path[PLACIDO_PATH_MAX];
  const placido_iso_report report = {.instrument = instrument,
                                     .software = PROGRAM_VERSION,
                                     .created = created,
                                     .note = iso_targets_note,
                                     .results = results,
                                     .count = count};
  int status = placido_path_join(path, folder, ISO_PICTURE, err);
  if (status == PLACIDO_OK) {
    status = placido_figure_iso(results, count, path, err);
  }
  return status == PLACIDO_OK ? placido_report_iso_write(&report, folder, ISO_PICTURE, err)
                              : status;
}

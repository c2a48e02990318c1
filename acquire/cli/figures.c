/* Which figures an examination has, and the page that shows them. */
#include "acquire/cli/figures.h"

#include "base/memory.h"
#include "report/report.h"

#include <stdio.h>

#define CAPTURE_WIDTH_PX 640 /* of the picture in the report; the session keeps the frame */

static const struct {
  const char *name, *caption;
} error_bars[] = {
    {"sigma_z", "Standard deviation of elevation (µm): what edge noise, smoothing and the "
                "cornea's distance leave open, and the instrument's geometry where its file tells."},
    {"sigma_axial", "Standard deviation of axial curvature (D)."},
};
#define ERROR_BARS (sizeof error_bars / sizeof error_bars[0])

static int draw_map(const struct examination *examination, size_t kind, size_t b,
                    const char *path, placido_error *err) {
  (void)b;
  return placido_figure_map(&examination->maps, (int)kind, path, err);
}

static int draw_sigma(const struct examination *examination, size_t which, size_t b,
                      const char *path, placido_error *err) {
  (void)b;
  return placido_figure_sigma(&examination->maps, error_bars[which].name, path, err);
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

bool figures_available(void) {
  return true;
}

/* The slowest first: what is begun last is short, so that no thread waits long at the end. */
void figures_add(struct jobs *jobs, const struct examination *examination) {
  if (examination->fit) {
    jobs_add(jobs, draw_mires, 0, 0, "mires.png");
  }
  for (size_t i = 0; i < examination->views.count; i++) {
    jobs_add(jobs, draw_psf, i, 0, "%s/psf.png", examination->views.items[i].directory);
  }
  if (!examination->fit) {
    return;
  }
  jobs_add(jobs, draw_capture, 0, 0, "capture.png");
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < count; i++) {
    jobs_add(jobs, draw_map, i, 0, "maps/%s.png", kinds[i].name);
  }
  for (size_t i = 0; i < ERROR_BARS; i++) {
    jobs_add(jobs, draw_sigma, i, 0, "maps/%s.png", error_bars[i].name);
  }
}

#define MAPS_MAX 32

/* What the page borrows while it is written. */
struct page {
  char map_files[MAPS_MAX][JOB_NAME_SIZE], map_captions[MAPS_MAX][256];
  const char *map_pictures[MAPS_MAX + 1], *captions[MAPS_MAX + 1];
  char psf_files[LIST_MAX][JOB_NAME_SIZE], scene_files[LIST_MAX][LIST_MAX][JOB_NAME_SIZE];
  const char *scene_names[LIST_MAX][LIST_MAX], *scene_pictures[LIST_MAX][LIST_MAX];
  placido_report_pupil pupils[LIST_MAX];
  placido_stage stages[STAGES_MAX];
  placido_fit_summary fit;
};

static void list_map(struct page *page, size_t index, const char *name, const char *caption) {
  snprintf(page->map_files[index], sizeof page->map_files[index], "maps/%s.png", name);
  snprintf(page->map_captions[index], sizeof page->map_captions[index], "%s", caption);
  page->map_pictures[index] = page->map_files[index];
  page->captions[index] = page->map_captions[index];
}

static void list_maps(struct page *page) {
  size_t count, listed = 0;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  for (size_t i = 0; i < count && listed < MAPS_MAX - ERROR_BARS; i++) {
    char caption[256];
    snprintf(caption, sizeof caption, "%s (%s): %s", kinds[i].name, kinds[i].unit, kinds[i].help);
    list_map(page, listed++, kinds[i].name, caption);
  }
  for (size_t i = 0; i < ERROR_BARS; i++) {
    list_map(page, listed++, error_bars[i].name, error_bars[i].caption);
  }
}

static void list_pupil(struct page *page, size_t index, const struct views *views) {
  const struct view *view = &views->items[index];
  placido_report_pupil *pupil = &page->pupils[index];
  snprintf(page->psf_files[index], JOB_NAME_SIZE, "%s/psf.png", view->directory);
  *pupil = (placido_report_pupil){.psf = &view->psf,
                                  .psf_picture = page->psf_files[index],
                                  .scene_names = page->scene_names[index],
                                  .scene_pictures = page->scene_pictures[index],
                                  .scene_arcmin_per_px = view->psf.bucket_arcmin};
  for (size_t i = 0; i < views->scene_count; i++) {
    if (!view->seen[i].data) {
      continue;
    }
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
  report->map_pictures = page->map_pictures;
  report->map_captions = page->captions;
  report->indices = examination->indices;
  report->index_count = examination->index_count;
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
    list_pupil(page, i, &examination->views);
  }
  list_stages(page, stages);
  if (examination->fit) {
    describe_capture(&report, page, examination);
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

/* The pictures and the page of a study. */
#include "acquire/cli/study.h"

#include "report/report.h"

#define MAP_STEP_MM 0.1

int study_draw_map(const struct study *study, size_t eye, const char *path, placido_error *err) {
  placido_maps maps;
  int status = placido_maps_new(&maps, study->surfaces[eye], NULL, MAP_STEP_MM, err);
  if (status == PLACIDO_OK) {
    status = placido_figure_study_map(&maps, study->page.pupils_mm, study->page.pupil_count, path,
                                      err);
    placido_maps_free(&maps);
  }
  return status;
}

int study_draw_psf(const placido_psf *psf, const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, "psf.png", err);
  if (status == PLACIDO_OK) {
    status = placido_figure_psf(psf, path, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, "psf-small.png", err);
  }
  return status == PLACIDO_OK ? placido_figure_study_psf(psf, path, err) : status;
}

int study_draw_page(struct study *study, placido_error *err) {
  return placido_report_study_write(&study->page, study->directory.temporary, err);
}

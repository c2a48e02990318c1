/* This build cannot draw (PLACIDO_FIGURES is off): says so in the result. */
#include "acquire/cli/study.h"

int study_draw_map(const struct study *study, size_t eye, const char *path, placido_error *err) {
  (void)study;
  (void)eye;
  (void)path;
  (void)err;
  return PLACIDO_OK;
}

int study_draw_psf(const placido_psf *psf, const char *folder, placido_error *err) {
  (void)psf;
  (void)folder;
  (void)err;
  return PLACIDO_OK;
}

int study_draw_page(struct study *study, placido_error *err) {
  (void)err;
  placido_notes_add(&study->outcome->notes, "this build draws no figures: maps, point spread "
                    "functions and study.html are left out (PLACIDO_FIGURES)");
  return PLACIDO_OK;
}

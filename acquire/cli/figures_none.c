/* This build cannot draw (PLACIDO_FIGURES is off): says so in the result. */
#include "acquire/cli/figures.h"

bool figures_available(void) {
  return false;
}

void figures_add(struct jobs *jobs, const struct examination *examination) {
  (void)jobs;
  placido_notes_add(&examination->outcome->notes,
                    "this build draws no figures: maps/*.png, psf.png and report.html are left "
                    "out (PLACIDO_FIGURES)");
}

int figures_report(const struct examination *examination, placido_error *err) {
  (void)examination;
  (void)err;
  return PLACIDO_OK;
}

int figures_drift(const struct ball_record *records, size_t count, const char *path,
                  placido_notes *notes, placido_error *err) {
  (void)records;
  (void)count;
  (void)err;
  placido_notes_add(notes, "this build draws no figures: %s is left out (PLACIDO_FIGURES)", path);
  return PLACIDO_OK;
}

int figures_iso(const placido_iso_result *results, size_t count, const char *instrument,
                const char *created, const char *folder, placido_notes *notes, placido_error *err) {
  (void)results;
  (void)count;
  (void)instrument;
  (void)created;
  (void)folder;
  (void)err;
  placido_notes_add(notes, "this build draws no figures: iso-check.html is left out "
                    "(PLACIDO_FIGURES)");
  return PLACIDO_OK;
}

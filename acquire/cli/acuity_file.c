/* Writes acuity.json: what one pupil lets read, and the ghosts it shows. */
#include "acquire/cli/acuity.h"
#include "base/json.h"

static const char *const verdicts[] = {
    [PLACIDO_ACUITY_FOUND] = "found",
    [PLACIDO_ACUITY_BEYOND_CHART] = "beyond-chart",
    [PLACIDO_ACUITY_BEYOND_WINDOW] = "beyond-window",
    [PLACIDO_ACUITY_ALL_READ] = "all-read",
};

static json_t *write_sources(const placido_acuity *acuity) {
  return json_pack("{s:o, s:o, s:o}", "trials", placido_json_real(acuity->sigma_trials), "observer",
                   placido_json_real(acuity->sigma_observer), "optics",
                   placido_json_real(acuity->sigma_optics));
}

static json_t *write_acuity(const placido_acuity *acuity) {
  const placido_acuity_test *test = acuity->test;
  return json_pack("{s:s, s:s, s:i, s:f, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
                   "name", test->name, "title", test->title, "choices", test->choices,
                   "criterion", test->criterion,
                   "verdict", verdicts[acuity->verdict], "logmar",
                   placido_json_real(acuity->logmar), "snellen_20",
                   placido_json_real(placido_acuity_snellen(acuity->logmar, 20)), "bound_logmar",
                   placido_json_real(acuity->bound_logmar), "low_logmar",
                   placido_json_real(acuity->low_logmar), "high_logmar",
                   placido_json_real(acuity->high_logmar), "sigma",
                   placido_json_real(acuity->sigma), "sources", write_sources(acuity));
}

static json_t *write_ghosts(const placido_ghosts *ghosts) {
  char sentence[256];
  json_t *images = json_array();
  bool failed = !images;
  placido_ghosts_write(sentence, sizeof sentence, ghosts);
  for (int i = 0; i < ghosts->count; i++) {
    const placido_ghost *ghost = &ghosts->items[i];
    json_t *image = json_pack("{s:f, s:f, s:f, s:f}", "separation_arcmin", ghost->separation_arcmin,
                              "direction_deg", ghost->direction_deg, "clock_h", ghost->clock_h,
                              "share", ghost->share);
    failed = json_array_append_new(images, image) != 0 || failed;
  }
  if (failed) {
    json_decref(images);
    return NULL;
  }
  return json_pack("{s:s, s:b, s:f, s:f, s:o}", "sentence", sentence, "diplopia", ghosts->diplopia,
                   "scale_arcmin", ghosts->scale_arcmin, "main_share", ghosts->main_share, "images",
                   images);
}

int acuity_save(const struct acuity_view *view, double pupil_mm, const char *path,
                placido_error *err) {
  json_t *tests = json_array();
  bool failed = !tests;
  for (size_t i = 0; i < view->count; i++) {
    failed = json_array_append_new(tests, write_acuity(&view->items[i])) != 0 || failed;
  }
  json_t *root = json_pack("{s:s, s:f, s:o, s:o, s:f}", "format", "placido-acuity/1", "pupil_mm",
                           pupil_mm, "tests", tests, "ghosts", write_ghosts(&view->ghosts),
                           "seconds", view->seconds);
  const int status = placido_json_save(failed ? NULL : root, path, err);
  json_decref(root);
  return status;
}

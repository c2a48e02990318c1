/* The pictures and the page of a comparison. */
#include "acquire/cli/compare.h"

#include "report/compare.h"
#include "report/report.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static int draw_maps(const struct comparison *comparison, placido_error *err) {
  const char *folder = comparison->directory.temporary;
  const char *names[2] = {comparison->exams[0].path, comparison->exams[1].path};
  char path[PLACIDO_PATH_MAX], name[64];
  int status = placido_path_join(path, folder, "maps", err);
  if (status == PLACIDO_OK && mkdir(path, 0777) != 0) {
    status =
        placido_error_set(err, PLACIDO_SYSTEM, "%s: cannot be made: %s", path, strerror(errno));
  }
  for (int k = 0; k < PLACIDO_DIFFERENCES && status == PLACIDO_OK; k++) {
    enum placido_difference_kind kind = (enum placido_difference_kind)k;
    snprintf(name, sizeof name, "maps/%s.png", placido_difference_name(kind));
    status = placido_path_join(path, folder, name, err);
    if (status == PLACIDO_OK) {
      status = placido_figure_difference(&comparison->difference, kind, names, path, err);
    }
  }
  return status;
}

int comparison_draw(struct comparison *comparison, placido_error *err) {
  const struct compared_exam *exams = comparison->exams;
  placido_report_change changes[COMPARE_INDICES_MAX];
  for (size_t k = 0; k < comparison->change_count; k++) {
    const struct compared_change *c = &comparison->changes[k];
    changes[k] =
        (placido_report_change){c->name, c->unit, c->first, c->second, c->difference, c->sigma};
  }
  const placido_report_comparison report = {.names = {exams[0].path, exams[1].path},
                                            .eyes = {exams[0].eye, exams[1].eye},
                                            .created = {exams[0].created, exams[1].created},
                                            .mirrored = exams[1].measured.mirrored,
                                            .software = PROGRAM_VERSION,
                                            .today = comparison->created,
                                            .alignment = &comparison->alignment,
                                            .difference = &comparison->difference,
                                            .changes = changes,
                                            .change_count = comparison->change_count,
                                            .notes = &comparison->outcome->notes};
  const int status = draw_maps(comparison, err);
  return status == PLACIDO_OK
             ? placido_report_comparison_write(&report, comparison->directory.temporary, err)
             : status;
}

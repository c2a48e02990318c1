/* Knows what a result's directory holds, so that only results are replaced. */
#include "acquire/cli/place.h"

#include "base/file.h"
#include "base/text.h"

#include <dirent.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>

/* docs/formats.md, "Exam". */
static const char *const known[] = {".",          "..",         "exam.json",
                                    "maps",       "maps.csv",   "reconstruction.json",
                                    "mires.csv",  "mires.png",  "simulation.json",
                                    "report.html", "capture.png", "surface.json",
                                    "indices.json", "maps_more.csv", "maps_sigma.csv",
                                    "compare.json", "compare.html", "difference.csv",
                                    "import.json", "wavefront.json", "iso-check.html",
                                    "iso-check.png", "iso-check.csv", "iso-check.json",
                                    "study.html", "study.csv", "study.json", "eyes"};
static const char pupil_folder[] = "pupil-";

static bool is_known(const char *name) {
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    if (strcmp(name, known[i]) == 0) {
      return true;
    }
  }
  return strncmp(name, pupil_folder, sizeof pupil_folder - 1) == 0;
}

static bool holds_result(const char *path, const char *marker) {
  char file[PLACIDO_PATH_MAX];
  struct stat found;
  return placido_path_join(file, path, marker, NULL) == PLACIDO_OK && stat(file, &found) == 0;
}

int place_check(const char *path, const char *marker, placido_error *err) {
  if (!holds_result(path, marker)) {
    return PLACIDO_OK;
  }
  int status = PLACIDO_OK;
  DIR *listing = opendir(path);
  for (struct dirent *entry; listing && status == PLACIDO_OK && (entry = readdir(listing));) {
    if (!is_known(entry->d_name)) {
      status = placido_error_set(err, PLACIDO_SYSTEM,
                                 "%s holds %s beside an earlier result: not overwritten",
                                 placido_text_tail(path), entry->d_name);
    }
  }
  if (listing) {
    closedir(listing);
  }
  return status;
}

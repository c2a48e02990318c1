/* The phantom's eyes of the study: which kind of cornea each is, and what the seed found of it. */
#include "acquire/cli/study.h"

#include <placido/phantom.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define REGULAR "Regular corneas"
#define PRK "After photorefractive keratectomy"
#define KERATOCONUS "Keratoconus"
#define DIPLOPIA "Monocular diplopia"

/* The crease of both diplopic eyes runs along 10° as the examiner sees it; the ghost lies across it,
 * and the patient sees left and right exchanged. */
#define ACROSS_CREASE_DEG 80.0

static const struct {
  const char *name, *group, *note;
  double ghost_deg;
} known[] = {
    {"normal", REGULAR, "Mean radius and asphericity of healthy eyes, 0.5 D with the rule.",
     (double)NAN},
    {"steep", REGULAR, "46 D, the steep end of what is healthy.", (double)NAN},
    {"flat", REGULAR, "41 D, the flat end.", (double)NAN},
    {"with-the-rule", REGULAR, "43 and 45 D, astigmatism with the rule.", (double)NAN},
    {"astigmatic", REGULAR, "3.2 D of regular oblique astigmatism.", (double)NAN},
    {"post-prk", PRK, "4.5 D ablated over 6 mm, well centred, with a transition of 1.6 mm.",
     (double)NAN},
    {"post-prk-early", PRK, "6 D ablated over 5 mm with hardly a transition, 1 mm off the middle, "
     "with a central island of 10 µm.", (double)NAN},
    {"keratoconus", KERATOCONUS, "Grade I of Alió and Shabayek: a cone of 36 µm.", (double)NAN},
    {"keratoconus-advanced", KERATOCONUS, "Grade III: a cone of 90 µm.", (double)NAN},
    {"keratoconus-severe", KERATOCONUS, "Grade IV: a cone of 120 µm and irregularity.",
     (double)NAN},
    {"diplopic", DIPLOPIA, "A soft crease of 5 mrad, 0.6 mm above the middle.", ACROSS_CREASE_DEG},
    {"diplopic-scar", DIPLOPIA, "A crease of 12 mrad, 0.3 mm above the middle, with trefoil and "
     "coma.", ACROSS_CREASE_DEG},
};
#define KNOWN_COUNT (sizeof known / sizeof known[0])

/* D. Garcia, CWhatUC (Berkeley 2000). "About 20/80" allows two lines either way. */
static const placido_study_finding claims[] = {
    {.group = REGULAR, .claim = "20/10 to 20/40 at every pupil", .least_pupil_mm = 0, .low = 9.5,
     .high = 40.5},
    {.group = PRK, .claim = "about 20/80 at large pupils", .least_pupil_mm = 6, .low = 50,
     .high = 127},
    {.group = KERATOCONUS, .claim = "worse than 20/160", .least_pupil_mm = 0, .low = 160,
     .high = (double)INFINITY},
    {.group = DIPLOPIA, .claim = "about 20/80 at large pupils, a ghost in the direction of the "
     "ridge", .least_pupil_mm = 6, .low = 50, .high = 127},
};

bool study_is_listed(const char *list, const char *name) {
  const size_t length = strlen(name);
  for (const char *at = list; *at;) {
    const size_t word = strcspn(at, ",");
    if (word == length && strncmp(at, name, length) == 0) {
      return true;
    }
    at += word + (at[word] == ',');
  }
  return false;
}

static int add_built_in(struct study *study, const char *name, placido_error *err) {
  placido_surface *surface;
  int status = placido_phantom_eye(&surface, name, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_study_eye *eye;
  status = study_add(&eye, study, name, err);
  if (status != PLACIDO_OK) {
    placido_surface_free(surface);
    return status;
  }
  study->surfaces[study->eye_count - 1] = surface;
  for (size_t i = 0; i < KNOWN_COUNT; i++) {
    if (strcmp(known[i].name, name) == 0) {
      eye->group = known[i].group;
      eye->note = known[i].note;
      eye->ghost_deg = known[i].ghost_deg;
    }
  }
  return PLACIDO_OK;
}

/* Those of --eyes, in the order in which they stand there. */
static int add_listed(struct study *study, const char *list, placido_error *err) {
  int status = PLACIDO_OK;
  for (const char *at = list; *at && status == PLACIDO_OK;) {
    char name[96];
    const size_t length = strcspn(at, ",");
    snprintf(name, sizeof name, "%.*s", (int)length, at);
    status = add_built_in(study, name, err);
    at += length + (at[length] == ',');
  }
  return status == PLACIDO_INPUT ? STATUS_USAGE : status;
}

int study_list_built_in(struct study *study, placido_error *err) {
  const char *list = study->settings->study_eyes;
  if (list) {
    return add_listed(study, list, err);
  }
  int status = PLACIDO_OK;
  for (size_t i = 0; i < KNOWN_COUNT && status == PLACIDO_OK; i++) {
    status = add_built_in(study, known[i].name, err);
  }
  return status;
}

static bool has_expected_ghost(const placido_study_eye *eye, const placido_study_cell *cell) {
  if (isnan(eye->ghost_deg)) {
    return true;
  }
  bool found = false;
  for (int k = 0; k < cell->ghosts.count; k++) {
    const double off = fabs(remainder(cell->ghosts.items[k].direction_deg - eye->ghost_deg, 360));
    found = found || off < 20; /* of the crease's blurred image */
  }
  return found;
}

static void count_cell(placido_study_finding *finding, const placido_study_eye *eye,
                       const placido_study_cell *cell) {
  const bool found = cell->acuity.verdict == PLACIDO_ACUITY_FOUND;
  const double logmar = found ? cell->acuity.logmar : cell->acuity.bound_logmar;
  const double observer = placido_acuity_snellen(logmar, 20);
  const double x = isnan(cell->bars_logmar) ? (double)INFINITY
                                            : placido_acuity_snellen(cell->bars_logmar, 20);
  finding->cells++;
  finding->met += x >= finding->low && x <= finding->high && has_expected_ghost(eye, cell);
  finding->best = fmin(finding->best, x);
  finding->worst = fmax(finding->worst, x);
  finding->observer_best = fmin(finding->observer_best, observer);
  finding->observer_worst = fmax(finding->observer_worst, observer);
}

void study_find(placido_study *page) {
  for (size_t k = 0; k < sizeof claims / sizeof claims[0]; k++) {
    placido_study_finding finding = claims[k];
    finding.best = finding.worst = (double)NAN; /* fmin and fmax take the other */
    finding.observer_best = finding.observer_worst = (double)NAN;
    for (size_t i = 0; i < page->eye_count; i++) {
      const placido_study_eye *eye = &page->eyes[i];
      for (size_t p = 0; p < page->pupil_count && strcmp(eye->group, finding.group) == 0; p++) {
        const placido_study_cell *cell = &eye->cells[p];
        if (cell->failure[0] == '\0' && cell->pupil_mm >= finding.least_pupil_mm) {
          count_cell(&finding, eye, cell);
        }
      }
    }
    if (finding.cells > 0) {
      page->findings[page->finding_count++] = finding;
    }
  }
}

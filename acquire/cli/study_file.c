/* The numbers of a study as a table and for machines. */
#include "acquire/cli/record.h"
#include "acquire/cli/study.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <string.h>

/* As study.csv and study.json call them. */
static const char *verdict_name(const placido_study_cell *cell) {
  static const char *const names[] = {
      [PLACIDO_ACUITY_FOUND] = "found",
      [PLACIDO_ACUITY_BEYOND_CHART] = "beyond_chart",
      [PLACIDO_ACUITY_BEYOND_WINDOW] = "beyond_window",
      [PLACIDO_ACUITY_ALL_READ] = "all_read",
  };
  return cell->failure[0] != '\0' ? "left_out" : names[cell->acuity.verdict];
}

/* A figure of a cell: the columns of study.csv and the fields of study.json. */
struct figure {
  const char *name;
  double value;
};
#define FIGURES_MAX 24

static size_t list_figures(struct figure figures[FIGURES_MAX], const placido_study_cell *cell) {
  const placido_acuity *acuity = &cell->acuity;
  const placido_ghost *ghost = cell->ghosts.count > 0 ? &cell->ghosts.items[0] : NULL;
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(&cell->eye.correction, &sphere_D, &cylinder_D, &axis_deg);
  const bool found = acuity->verdict == PLACIDO_ACUITY_FOUND;
  const struct figure all[] = {
      {"logmar", acuity->logmar},
      {"sigma_logmar", acuity->sigma},
      {"low_logmar", acuity->low_logmar},
      {"high_logmar", acuity->high_logmar},
      {"bound_logmar", acuity->bound_logmar},
      {"snellen_20", found ? placido_acuity_snellen(acuity->logmar, 20) : (double)NAN},
      {"bars_logmar", cell->bars_logmar},
      {"bars_20", placido_acuity_snellen(cell->bars_logmar, 20)},
      {"strehl_g", cell->strehl_g},
      {"sphere_D", sphere_D},
      {"cylinder_D", cylinder_D},
      {"axis_deg", axis_deg},
      {"retina_mm", cell->eye.retina_mm},
      {"outside", cell->outside},
      {"rays_entered", (double)cell->rays_entered},
      {"rays_missed", (double)cell->rays_missed},
      {"ghosts", cell->ghosts.count},
      {"ghost_arcmin", ghost ? ghost->separation_arcmin : (double)NAN},
      {"ghost_deg", ghost ? ghost->direction_deg : (double)NAN},
      {"ghost_share", ghost ? ghost->share : (double)NAN},
      {"diplopia", cell->ghosts.diplopia},
  };
  const size_t count = sizeof all / sizeof all[0];
  memcpy(figures, all, sizeof all);
  for (size_t i = 0; i < count && cell->failure[0] != '\0'; i++) {
    figures[i].value = (double)NAN;
  }
  return count;
}

static void write_row(FILE *stream, const placido_study_eye *eye, const placido_study_cell *cell) {
  struct figure figures[FIGURES_MAX];
  const size_t count = list_figures(figures, cell);
  placido_text_quote(stream, eye->name);
  fputc(',', stream);
  placido_text_quote(stream, eye->group);
  fprintf(stream, ",%.17g,%s", cell->pupil_mm, verdict_name(cell));
  for (size_t i = 0; i < count; i++) {
    if (isfinite(figures[i].value)) {
      fprintf(stream, ",%.17g", figures[i].value);
    } else {
      fputc(',', stream);
    }
  }
  fputc(',', stream);
  placido_text_quote(stream, cell->failure);
  fputc('\n', stream);
}

int study_save_csv(const placido_study *page, const char *path, placido_error *err) {
  placido_file file = {0};
  const int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  struct figure figures[FIGURES_MAX];
  const placido_study_cell none = {.failure = "none"};
  const size_t count = list_figures(figures, &none);
  fputs("eye,group,pupil_mm,verdict", file.stream);
  for (size_t i = 0; i < count; i++) {
    fprintf(file.stream, ",%s", figures[i].name);
  }
  fputs(",failure\n", file.stream);
  for (size_t i = 0; i < page->eye_count; i++) {
    for (size_t k = 0; k < page->pupil_count && page->eyes[i].failure[0] == '\0'; k++) {
      write_row(file.stream, &page->eyes[i], &page->eyes[i].cells[k]);
    }
  }
  return placido_file_commit(&file, err);
}

static json_t *text_or_null(const char *text) {
  return text[0] != '\0' ? record_text(text) : json_null();
}

/* Further images than the brightest. */
static json_t *ghosts_array(const placido_ghosts *ghosts) {
  json_t *list = json_array();
  for (int k = 0; k < ghosts->count; k++) {
    const placido_ghost *g = &ghosts->items[k];
    json_array_append_new(list, json_pack("{s:f, s:f, s:f}", "arcmin", g->separation_arcmin, "deg",
                                          g->direction_deg, "share", g->share));
  }
  return list;
}

static json_t *pictures_array(const placido_study *page, const placido_study_eye *eye,
                              const placido_study_cell *cell) {
  json_t *list = json_array();
  for (size_t k = 0; k < page->scene_count; k++) {
    if (cell->scenes[k]) {
      json_array_append_new(list, json_sprintf("%s/pupil-%gmm/%s.png", eye->folder, cell->pupil_mm,
                                               page->scene_stems[k]));
    }
  }
  return list;
}

static json_t *cell_object(const placido_study *page, const placido_study_eye *eye,
                           const placido_study_cell *cell) {
  struct figure figures[FIGURES_MAX];
  const size_t count = list_figures(figures, cell);
  json_t *root = json_object();
  json_object_set_new(root, "pupil_mm", json_real(cell->pupil_mm));
  json_object_set_new(root, "verdict", json_string(verdict_name(cell)));
  for (size_t i = 0; i < count; i++) {
    json_object_set_new(root, figures[i].name, placido_json_real(figures[i].value));
  }
  json_object_set_new(root, "images", ghosts_array(&cell->ghosts));
  json_object_set_new(root, "pictures", pictures_array(page, eye, cell));
  json_object_set_new(root, "failure", text_or_null(cell->failure));
  return root;
}

static json_t *eye_object(const placido_study *page, const placido_study_eye *eye) {
  json_t *cells = json_array();
  const bool failed = eye->failure[0] != '\0';
  for (size_t k = 0; k < page->pupil_count && !failed; k++) {
    json_array_append_new(cells, cell_object(page, eye, &eye->cells[k]));
  }
  return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "eye", record_text(eye->name),
                   "group", text_or_null(eye->group), "note", text_or_null(eye->note), "source",
                   text_or_null(eye->source), "failure", text_or_null(eye->failure), "higher_um",
                   placido_json_real(eye->higher_um), "coma_like_um",
                   placido_json_real(eye->coma_like_um), "cells", cells);
}

static json_t *finding_object(const placido_study_finding *f) {
  return json_pack("{s:s, s:s, s:f, s:f, s:o, s:I, s:I, s:o, s:o, s:o, s:o}", "group", f->group, "claim",
                   f->claim, "least_pupil_mm", f->least_pupil_mm, "low_20", f->low, "high_20",
                   placido_json_real(f->high), "cells", (json_int_t)f->cells, "met",
                   (json_int_t)f->met, "best_20", placido_json_real(f->best), "worst_20",
                   placido_json_real(f->worst), "observer_best_20",
                   placido_json_real(f->observer_best), "observer_worst_20",
                   placido_json_real(f->observer_worst));
}

json_t *study_json(const placido_study *page) {
  json_t *eyes = json_array(), *findings = json_array(), *pupils = json_array();
  json_t *scenes = json_array();
  for (size_t i = 0; i < page->eye_count; i++) {
    json_array_append_new(eyes, eye_object(page, &page->eyes[i]));
  }
  for (size_t i = 0; i < page->finding_count; i++) {
    json_array_append_new(findings, finding_object(&page->findings[i]));
  }
  for (size_t i = 0; i < page->pupil_count; i++) {
    json_array_append_new(pupils, json_real(page->pupils_mm[i]));
  }
  for (size_t i = 0; i < page->scene_count; i++) {
    json_array_append_new(scenes, record_text(page->scene_names[i]));
  }
  return json_pack("{s:s, s:s, s:s, s:o, s:s, s:o, s:o, s:o, s:o}", "format", "placido-study/1",
                   "software", page->software, "created", page->created, "source",
                   record_text(page->source), "acuity", page->test, "pupils_mm", pupils, "scenes",
                   scenes, "findings", findings, "eyes", eyes);
}

int study_save_json(const placido_study *page, const char *path, placido_error *err) {
  json_t *root = study_json(page);
  const int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}

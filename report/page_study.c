/* study.html: what every cornea of a study sees, and how well, on one page. */
#include "report/study.h"

#include "base/file.h"
#include "report/correction.h"
#include "report/html.h"
#include "report/number.h"
#include "report/page.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Rows of pictures that belong together stay together on paper; as many columns as pupils. */
static const char style[] =
    "<style>\n"
    ".eye { break-inside: avoid; margin: 1rem 0 1.6rem }\n"
    ".eye h3 { font-size: 1.08rem; margin: 0 0 .2rem }\n"
    ".grid { display: grid; gap: .35rem .5rem; align-items: center }\n"
    ".grid figcaption { margin: 0; font-size: .76em }\n"
    ".grid .seen img { border: 1px solid #bbb }\n"
    ".grid img { width: 100% }\n"
    ".grid .head { font-weight: 600; border-bottom: 1px solid #bbb; align-self: start;\n"
    "  font-size: .9em }\n"
    ".grid .head small { font-weight: 400; display: block }\n"
    ".grid .row { font-size: .86em }\n"
    ".grid .psf img { max-width: 13rem; margin: 0 auto }\n"
    "@media print {\n"
    "  .grid img { max-height: 46mm; width: auto; max-width: 100%; margin: 0 auto }\n"
    "  .grid .psf img { max-height: 58mm }\n"
    "}\n"
    "</style>\n";

static void write_head(FILE *stream, const placido_study *study) {
  placido_page_begin(stream, "Study of corneas", study->source);
  placido_html_row(stream, "Corneas", study->source);
  placido_html_row(stream, "Acuity", study->test);
  placido_html_row(stream, "Date", study->created);
  placido_html_row(stream, "Software", study->software);
  fputs("</tbody>\n</table>\n", stream);
  fputs("<p class=\"small\">Each cornea is corrected for the best focus at each pupil (cylinder and "
        "distance of the retina); light comes from afar along the axis. The model has the cornea "
        "alone: no lens, no colour. Two acuities: what the picture shows, the finest bars that "
        "keep a tenth of their contrast; and what an ideal observer reads who knows how letters "
        "look through this eye.</p>\n</header>\n<main>\n", stream);
  fputs(style, stream);
}

static void write_findings(FILE *stream, const placido_study *study) {
  if (study->finding_count == 0) {
    return;
  }
  fputs("<section>\n<h2>Against the seed's findings</h2>\n<table>\n<thead><tr>"
        "<th scope=\"col\">Corneas</th><th scope=\"col\">The seed (CWhatUC, 2000)</th>"
        "<th scope=\"col\">Pictures</th><th scope=\"col\" class=\"number\">Agree</th>"
        "<th scope=\"col\">Ideal observer</th></tr></thead>\n<tbody>\n", stream);
  for (size_t k = 0; k < study->finding_count; k++) {
    const placido_study_finding *f = &study->findings[k];
    fputs("<tr><th scope=\"row\">", stream);
    placido_html_text(stream, f->group);
    fputs("</th><td>", stream);
    placido_html_text(stream, f->claim);
    fputs("</td><td class=\"unit\">", stream);
    placido_html_print(stream, "20/%.0f to 20/%.0f", f->best, f->worst);
    fprintf(stream, "</td><td class=\"number\">%zu of %zu</td><td class=\"unit\">", f->met, f->cells);
    placido_html_print(stream, "20/%.0f to 20/%.0f", f->observer_best, f->observer_worst);
    fputs("</td></tr>\n", stream);
  }
  fputs("</tbody>\n</table>\n<p class=\"small\">About 20/80: from 20/50 to 20/127, two lines of a "
        "chart either way. Agree: so many of the pupils that the finding is about. The seed's author "
        "read pictures, as the pictures' acuity does; docs/study.md says why the observer's is "
        "better.</p>\n</section>\n", stream);
}

static void write_acuity_cell(FILE *stream, const placido_study_cell *cell) {
  char text[64], spread[PLACIDO_NUMBER_SIZE];
  if (cell->failure[0] != '\0') {
    fputs("<td class=\"number\">–</td>", stream);
    return;
  }
  fputs("<td class=\"number\"><strong>", stream);
  placido_html_text(stream, cell->bars_text);
  fputs("</strong><br><span class=\"small\">", stream);
  placido_html_text(stream, cell->acuity_text);
  if (cell->acuity.verdict == PLACIDO_ACUITY_FOUND) {
    placido_number_write(text, sizeof text, cell->acuity.logmar, 2);
    placido_number_write(spread, sizeof spread, cell->acuity.sigma, 2);
    placido_html_print(stream, " (%s ± %s)", text, spread);
  }
  fputs("</span></td>", stream);
}

static void write_eye_row(FILE *stream, const placido_study *study, const placido_study_eye *eye) {
  char number[PLACIDO_NUMBER_SIZE];
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, eye->name);
  fputs("</th>", stream);
  if (eye->failure[0] != '\0') {
    fprintf(stream, "<td colspan=\"%zu\">left out: ", study->pupil_count + 1);
    placido_html_text(stream, eye->failure);
    fputs("</td></tr>\n", stream);
    return;
  }
  for (size_t k = 0; k < study->pupil_count; k++) {
    write_acuity_cell(stream, &eye->cells[k]);
  }
  placido_number_write(number, sizeof number, eye->higher_um, 2);
  fputs("<td class=\"number\">", stream);
  placido_html_text(stream, number);
  fputs("</td></tr>\n", stream);
}

static void write_acuities(FILE *stream, const placido_study *study) {
  fputs("<section>\n<h2>Acuities</h2>\n<table>\n<thead><tr><th scope=\"col\">Cornea</th>", stream);
  for (size_t k = 0; k < study->pupil_count; k++) {
    fprintf(stream, "<th scope=\"col\" class=\"number\">%g mm</th>", study->pupils_mm[k]);
  }
  fputs("<th scope=\"col\" class=\"number\">Higher orders, µm rms</th></tr></thead>\n", stream);
  const char *group = "";
  for (size_t i = 0; i < study->eye_count; i++) {
    const placido_study_eye *eye = &study->eyes[i];
    if (i == 0 || strcmp(group, eye->group) != 0) {
      group = eye->group;
      fputs(i == 0 ? "<tbody>\n" : "</tbody>\n<tbody>\n", stream);
      if (*group != '\0') {
        fprintf(stream, "<tr class=\"group\"><th scope=\"rowgroup\" colspan=\"%zu\">",
                study->pupil_count + 2);
        placido_html_text(stream, group);
        fputs("</th></tr>\n", stream);
      }
    }
    write_eye_row(stream, study, eye);
  }
  fputs("</tbody>\n</table>\n<p class=\"small\">Above, what the pictures show; below, the ideal "
        "observer: Snellen fraction and, in brackets, logarithm of the stroke in minutes of arc "
        "(logMAR) ± one standard deviation. Higher orders: corneal wavefront over 6 mm, "
        "orders 3 to 8.</p>\n</section>\n", stream);
}

static void write_column_head(FILE *stream, const placido_study_cell *cell) {
  char text[256];
  fprintf(stream, "<div class=\"head\">pupil %g mm", cell->pupil_mm);
  if (cell->failure[0] == '\0') {
    fputs(": ", stream);
    placido_html_text(stream, cell->bars_text);
    fputs("<small>observer ", stream);
    placido_html_text(stream, cell->acuity_text);
    fputs(". ", stream);
    placido_ghosts_write(text, sizeof text, &cell->ghosts);
    placido_html_text(stream, text);
    fputs("</small>", stream);
  }
  fputs("</div>\n", stream);
}

/* A picture of the eye's folder as a cell of its grid. */
static int write_picture(FILE *stream, const char *folder, const placido_study_eye *eye,
                         const char *name, const char *kind, const char *alternative,
                         placido_error *err) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", eye->folder, name);
  fprintf(stream, "<figure class=\"%s\">", kind);
  const int status = placido_html_picture(stream, NULL, folder, path, alternative, err);
  return status;
}

static void write_lens(FILE *stream, const placido_study_cell *cell) {
  char text[PLACIDO_CORRECTION_SIZE], share[PLACIDO_NUMBER_SIZE];
  placido_correction_write(text, &cell->eye.correction);
  placido_number_significant(share, sizeof share, 100 * cell->outside, 2);
  fputs("<figcaption>", stream);
  placido_html_text(stream, text);
  placido_html_print(stream, "; retina at %.2f mm; Strehl ratio %.2g", cell->eye.retina_mm,
                     cell->strehl_g);
  if (cell->outside > 0.001) {
    placido_html_print(stream, "; %s %% of the light outside", share);
  }
  fputs("</figcaption>", stream);
}

static int write_map(FILE *stream, const placido_study_eye *eye, const char *folder,
                     placido_error *err) {
  const int status = write_picture(stream, folder, eye, "axial.png", "map",
                                   "Axial power of the cornea with the pupils", err);
  fputs("<figcaption>axial power; right: a point of light</figcaption></figure>\n", stream);
  return status;
}

static int write_psfs(FILE *stream, const placido_study *study, const placido_study_eye *eye,
                      const char *folder, placido_error *err) {
  char name[64], alternative[160];
  int status = write_map(stream, eye, folder, err);
  for (size_t k = 0; k < study->pupil_count && status == PLACIDO_OK; k++) {
    const placido_study_cell *cell = &eye->cells[k];
    if (cell->failure[0] != '\0') {
      fputs("<div class=\"small\">", stream);
      placido_html_text(stream, cell->failure);
      fputs("</div>\n", stream);
      continue;
    }
    snprintf(name, sizeof name, "pupil-%gmm/psf-small.png", cell->pupil_mm);
    snprintf(alternative, sizeof alternative, "Point spread function, pupil %g mm", cell->pupil_mm);
    status = write_picture(stream, folder, eye, name, "psf", alternative, err);
    write_lens(stream, cell);
    fputs("</figure>\n", stream);
  }
  return status;
}

static int write_scene(FILE *stream, const placido_study *study, const placido_study_eye *eye,
                       size_t scene, const char *folder, placido_error *err) {
  char name[128], alternative[256];
  int status = PLACIDO_OK;
  fputs("<div class=\"row\">", stream);
  placido_html_text(stream, study->scene_names[scene]);
  fputs("</div>\n", stream);
  for (size_t k = 0; k < study->pupil_count && status == PLACIDO_OK; k++) {
    const placido_study_cell *cell = &eye->cells[k];
    if (!cell->scenes[scene]) {
      fputs("<div></div>\n", stream);
      continue;
    }
    snprintf(name, sizeof name, "pupil-%gmm/%s.png", cell->pupil_mm, study->scene_stems[scene]);
    snprintf(alternative, sizeof alternative, "%s through a pupil of %g mm",
             study->scene_names[scene], cell->pupil_mm);
    status = write_picture(stream, folder, eye, name, "seen", alternative, err);
    fputs("</figure>\n", stream);
  }
  return status;
}

static int write_eye(FILE *stream, const placido_study *study, const placido_study_eye *eye,
                     const char *folder, placido_error *err) {
  fputs("<article class=\"eye\">\n<h3>", stream);
  placido_html_text(stream, eye->name);
  fputs("</h3>\n<p class=\"small\">", stream);
  placido_html_text(stream, eye->note);
  fprintf(stream, "</p>\n<div class=\"grid\" style=\"grid-template-columns: minmax(0, .8fr) "
          "repeat(%zu, minmax(0, 1fr))\">\n", study->pupil_count);
  fputs("<div></div>\n", stream);
  for (size_t k = 0; k < study->pupil_count; k++) {
    write_column_head(stream, &eye->cells[k]);
  }
  int status = write_psfs(stream, study, eye, folder, err);
  for (size_t k = 0; k < study->scene_count && status == PLACIDO_OK; k++) {
    status = write_scene(stream, study, eye, k, folder, err);
  }
  fputs("</div>\n</article>\n", stream);
  return status;
}

static int write_eyes(FILE *stream, const placido_study *study, const char *folder,
                      placido_error *err) {
  int status = PLACIDO_OK;
  fputs("<section>\n<h2>What they see</h2>\n<p class=\"small\">Map: axial power, dioptres, the "
        "pupils dashed. Point of light: height and, below, logarithm of the light, as the patient "
        "sees it.</p>\n", stream);
  for (size_t i = 0; i < study->eye_count && status == PLACIDO_OK; i++) {
    if (study->eyes[i].failure[0] == '\0') {
      status = write_eye(stream, study, &study->eyes[i], folder, err);
    }
  }
  fputs("</section>\n", stream);
  return status;
}

int placido_report_study_write(const placido_study *study, const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  int status = placido_path_join(path, folder, "study.html", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  write_head(file.stream, study);
  const placido_report warned = {.notes = study->notes};
  placido_page_warnings(file.stream, &warned);
  write_findings(file.stream, study);
  write_acuities(file.stream, study);
  status = write_eyes(file.stream, study, folder, err);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  placido_page_end(file.stream);
  return placido_file_commit(&file, err);
}

/* compare.html: what changed between two exams, how sure that is, and how they were brought
 * together. */
#include "report/compare.h"

#include "base/file.h"
#include "report/html.h"
#include "report/number.h"
#include "report/page.h"

#include <math.h>
#include <stdio.h>

static const double degrees = 57.29577951308232;

static void write_cell(FILE *stream, const char *text) {
  fputs("<td class=\"number\">", stream);
  placido_html_text(stream, text);
  fputs("</td>", stream);
}

static void write_measure(FILE *stream, double value, double sigma) {
  char text[2 * PLACIDO_NUMBER_SIZE + 8];
  placido_number_measure(text, sizeof text, value, sigma);
  write_cell(stream, text);
}

static void write_number(FILE *stream, double value, int decimals) {
  char text[PLACIDO_NUMBER_SIZE];
  placido_number_write(text, sizeof text, value, decimals);
  write_cell(stream, text);
}

static void write_exam(FILE *stream, const placido_report_comparison *report, int k) {
  char text[1024];
  snprintf(text, sizeof text, "%.600s%s%s%s%s", report->names[k], report->eyes[k][0] ? ", " : "",
           report->eyes[k], report->created[k][0] ? ", " : "", report->created[k]);
  placido_html_row(stream, k == 0 ? "First exam" : "Second exam", text);
}

static void write_head(FILE *stream, const placido_report_comparison *report) {
  placido_page_begin(stream, "Comparison", report->names[1]);
  write_exam(stream, report, 0);
  write_exam(stream, report, 1);
  placido_html_row(stream, "Shown", "second less first, on the first's axes");
  if (report->mirrored) {
    placido_html_row(stream, "Mirrored", "the second exam's x counts the other way");
  }
  placido_html_row(stream, "Date", report->today);
  placido_html_row(stream, "Software", report->software);
  fputs("</tbody>\n</table>\n</header>\n<main>\n", stream);
}

static int write_maps(FILE *stream, const char *folder, placido_error *err) {
  int status = PLACIDO_OK;
  fputs("<section>\n<h2>Differences</h2>\n<div class=\"pair maps\">\n", stream);
  for (int k = 0; k < PLACIDO_DIFFERENCES && status == PLACIDO_OK; k++) {
    enum placido_difference_kind kind = (enum placido_difference_kind)k;
    char name[64];
    snprintf(name, sizeof name, "maps/%s.png", placido_difference_name(kind));
    fputs("<figure>\n", stream);
    status = placido_html_picture(stream, NULL, folder, name, placido_difference_title(kind), err);
    fputs("<figcaption>", stream);
    placido_html_print(stream, "%s (%s). Hatched: less than twice its error bar.",
                       placido_difference_title(kind), placido_difference_unit(kind));
    fputs("</figcaption>\n</figure>\n", stream);
  }
  fputs("</div>\n</section>\n", stream);
  return status;
}

static void write_zone(FILE *stream, const placido_difference *difference, int k, int z) {
  enum placido_difference_kind kind = (enum placido_difference_kind)k;
  const double *bounds = placido_difference_zone_mm(z);
  placido_difference_zone zone =
      placido_difference_zone_find(difference, kind, bounds[0], bounds[1]);
  int decimals = kind == PLACIDO_DIFFERENCE_ELEVATION ? 2 : 3;
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, z == 0 ? placido_difference_name(kind) : "");
  fputs("</th><td>", stream);
  placido_html_print(stream, "%g to %g mm", bounds[0], bounds[1]);
  fputs("</td>", stream);
  write_number(stream, zone.mean, decimals);
  write_number(stream, 2 * zone.deviation, decimals);
  write_number(stream, zone.largest, decimals);
  write_number(stream, 100 * zone.significant, 0);
  fputs("<td class=\"unit\">", stream);
  placido_html_text(stream, placido_difference_unit(kind));
  fputs("</td></tr>\n", stream);
}

static void write_zones(FILE *stream, const placido_difference *difference) {
  fputs("<section>\n<h2>By zone</h2>\n<p class=\"small\">Rings about the first exam's axis "
        "(diameters), weighted by area. Significant: over twice the error bar.</p>\n<table>\n"
        "<thead><tr><th scope=\"col\">Map</th><th scope=\"col\">Zone</th><th scope=\"col\" "
        "class=\"number\">Mean</th><th scope=\"col\" class=\"number\">2 SD</th><th scope=\"col\" "
        "class=\"number\">Largest</th><th scope=\"col\" class=\"number\">% significant</th>"
        "<th scope=\"col\">Unit</th></tr></thead>\n<tbody>\n",
        stream);
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    for (int z = 0; z < PLACIDO_DIFFERENCE_ZONES; z++) {
      write_zone(stream, difference, k, z);
    }
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static void write_change(FILE *stream, const placido_report_change *change) {
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, change->name);
  fputs("</th>", stream);
  write_number(stream, change->first, 3);
  write_number(stream, change->second, 3);
  write_measure(stream, change->difference, change->sigma);
  fputs("<td class=\"unit\">", stream);
  placido_html_text(stream, placido_unit_text(change->unit));
  bool known = isfinite(change->difference) && isfinite(change->sigma);
  bool significant = known && fabs(change->difference) > 2 * change->sigma;
  fprintf(stream, "</td><td>%s</td></tr>\n",
          significant ? "<strong>changed</strong>"
          : known     ? "within 2 σ"
                      : "");
}

static void write_changes(FILE *stream, const placido_report_comparison *report) {
  fputs("<section>\n<h2>Indices</h2>\n<table>\n<thead><tr><th scope=\"col\">Index</th>"
        "<th scope=\"col\" class=\"number\">First</th><th scope=\"col\" class=\"number\">Second"
        "</th><th scope=\"col\" class=\"number\">Difference ± 1 σ</th><th scope=\"col\">Unit</th>"
        "<th scope=\"col\"></th></tr></thead>\n<tbody>\n",
        stream);
  for (size_t k = 0; k < report->change_count; k++) {
    write_change(stream, &report->changes[k]);
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static void write_term(FILE *stream, const char *name, double value, double sigma,
                       const char *unit) {
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, name);
  fputs("</th>", stream);
  write_measure(stream, value, sigma);
  fputs("<td class=\"unit\">", stream);
  placido_html_text(stream, unit);
  fputs("</td></tr>\n", stream);
}

static void write_alignment(FILE *stream, const placido_alignment *a) {
  fputs("<section>\n<h2>Alignment</h2>\n", stream);
  if (!a->aligned) {
    fputs("<p>None was asked for: both exams stand as they were measured.</p>\n</section>\n",
          stream);
    return;
  }
  placido_html_print(stream,
                     "The second exam was moved onto the first at %zu points: from %.2f to "
                     "%.2f µm rms. What the shapes leave open is held by how far eyes usually "
                     "move.",
                     a->points, a->rms_before_um, a->rms_um);
  fputs("\n<table>\n<tbody>\n", stream);
  write_term(stream, "Shift x", a->terms[PLACIDO_SHIFT_X], a->sigmas[PLACIDO_SHIFT_X], "mm");
  write_term(stream, "Shift y", a->terms[PLACIDO_SHIFT_Y], a->sigmas[PLACIDO_SHIFT_Y], "mm");
  write_term(stream, "Along the axis", 1e3 * a->terms[PLACIDO_PISTON],
             1e3 * a->sigmas[PLACIDO_PISTON], "µm");
  write_term(stream, "Tilt about x", degrees * a->terms[PLACIDO_TILT_X],
             degrees * a->sigmas[PLACIDO_TILT_X], "°");
  write_term(stream, "Tilt about y", degrees * a->terms[PLACIDO_TILT_Y],
             degrees * a->sigmas[PLACIDO_TILT_Y], "°");
  write_term(stream, "Cyclotorsion", degrees * a->terms[PLACIDO_TORSION],
             degrees * a->sigmas[PLACIDO_TORSION], "°");
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static int write_page(FILE *stream, const placido_report_comparison *report, const char *folder,
                      placido_error *err) {
  write_head(stream, report);
  const placido_report of_notes = {.notes = report->notes};
  placido_page_warnings(stream, &of_notes);
  int status = write_maps(stream, folder, err);
  write_zones(stream, report->difference);
  write_changes(stream, report);
  write_alignment(stream, report->alignment);
  placido_page_end(stream);
  return status;
}

int placido_report_comparison_write(const placido_report_comparison *report, const char *folder,
                                    placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  int status = placido_path_join(path, folder, "compare.html", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = write_page(file.stream, report, folder, err);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}

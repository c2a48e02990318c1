/* iso-check.html: the accuracy test on one page. */
#include "report/iso.h"

#include "base/file.h"
#include "report/html.h"
#include "report/number.h"
#include "report/page.h"

#include <math.h>
#include <stdio.h>

static void write_number(FILE *stream, double value, int decimals) {
  char text[PLACIDO_NUMBER_SIZE];
  placido_number_write(text, sizeof text, value, decimals);
  fputs("<td class=\"number\">", stream);
  placido_html_text(stream, text);
  fputs("</td>", stream);
}

static void write_zone(FILE *stream, const placido_iso_result *result, int k) {
  const placido_iso_zone *zone = &result->zones[k];
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, k == 0 ? result->object : "");
  fputs("</th><td>", stream);
  if (isfinite(zone->outer_mm)) {
    placido_html_print(stream, "%g to %g mm", zone->inner_mm, zone->outer_mm);
  } else {
    placido_html_print(stream, "over %g mm", zone->inner_mm);
  }
  fprintf(stream, "</td><td class=\"number\">%ld</td>", zone->points);
  write_number(stream, 100 * zone->covered, 0);
  write_number(stream, zone->axial_mean_D, 4);
  write_number(stream, zone->axial_2sd_D, 4);
  write_number(stream, zone->elevation_mean_um, 3);
  write_number(stream, zone->elevation_2sd_um, 3);
  fputs("</tr>\n", stream);
}

static void write_zones(FILE *stream, const placido_iso_report *report) {
  fputs("<section>\n<h2>Differences by zone</h2>\n<p class=\"small\">Measured less known, over "
        "rings about the instrument's axis (diameters), weighted by area.</p>\n"
        "<table>\n<thead><tr><th scope=\"col\">Object</th><th scope=\"col\">Zone</th>"
        "<th scope=\"col\" class=\"number\">Points</th><th scope=\"col\" class=\"number\">% seen"
        "</th><th scope=\"col\" class=\"number\">Axial, mean D</th><th scope=\"col\" "
        "class=\"number\">2 SD D</th><th scope=\"col\" class=\"number\">Height, mean µm</th>"
        "<th scope=\"col\" class=\"number\">2 SD µm</th></tr></thead>\n<tbody>\n", stream);
  for (size_t i = 0; i < report->count; i++) {
    const placido_iso_result *result = &report->results[i];
    for (int k = 0; k < PLACIDO_ISO_ZONES && result->failure[0] == '\0'; k++) {
      write_zone(stream, result, k);
    }
    if (result->failure[0] != '\0') {
      fputs("<tr><th scope=\"row\">", stream);
      placido_html_text(stream, result->object);
      fputs("</th><td colspan=\"7\">not measured: ", stream);
      placido_html_text(stream, result->failure);
      fputs("</td></tr>\n", stream);
    }
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static void write_check(FILE *stream, const char *object, const placido_iso_check *check) {
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, object);
  fputs("</th><td>", stream);
  placido_html_text(stream, check->name);
  fputs("</td>", stream);
  write_number(stream, check->value, 4);
  fprintf(stream, "<td class=\"number\">%g</td><td class=\"unit\">", check->limit);
  placido_html_text(stream, placido_unit_text(check->unit));
  fprintf(stream, "</td><td>%s</td></tr>\n", check->passed ? "met" : "<strong>missed</strong>");
}

static void write_checks(FILE *stream, const placido_iso_report *report) {
  fputs("<section>\n<h2>Targets</h2>\n<p>", stream);
  placido_html_text(stream, report->note);
  fputs(" Axial power: |mean| + 2 SD. Elevation: rms about its mean.</p>\n<table>\n<thead><tr>"
        "<th scope=\"col\">Object</th><th scope=\"col\">Target</th><th scope=\"col\" "
        "class=\"number\">Found</th><th scope=\"col\" class=\"number\">At most</th>"
        "<th scope=\"col\">Unit</th><th scope=\"col\">Verdict</th></tr></thead>\n<tbody>\n", stream);
  for (size_t i = 0; i < report->count; i++) {
    for (size_t k = 0; k < report->results[i].check_count; k++) {
      write_check(stream, k == 0 ? report->results[i].object : "", &report->results[i].checks[k]);
    }
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static int write_page(FILE *stream, const placido_iso_report *report, const char *folder,
                      const char *picture, placido_error *err) {
  placido_page_begin(stream, "Accuracy test", report->instrument);
  placido_html_row(stream, "Instrument", report->instrument);
  placido_html_row(stream, "Date", report->created);
  placido_html_row(stream, "Software", report->software);
  fputs("</tbody>\n</table>\n</header>\n<main>\n<figure>\n", stream);
  int status = placido_html_picture(stream, NULL, folder, picture,
                                    "Differences of axial power and elevation by object and zone",
                                    err);
  fputs("</figure>\n", stream);
  write_checks(stream, report);
  write_zones(stream, report);
  placido_page_end(stream);
  return status;
}

int placido_report_iso_write(const placido_iso_report *report, const char *folder,
                             const char *picture, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  int status = placido_path_join(path, folder, "iso-check.html", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = write_page(file.stream, report, folder, picture, err);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}

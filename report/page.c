/* report.html as a whole: what it begins and ends with, and the order of its sections. */
#include "report/page.h"

#include "base/file.h"
#include "report/html.h"
#include "report/number.h"

#include <math.h>

/* Nothing but the page itself may be loaded or run, whatever a string managed to smuggle in. */
static const char policy[] =
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
    "img-src data:; style-src 'unsafe-inline'\">\n";

static void write_geometry(FILE *stream, const placido_report *report) {
  if (report->instrument_name == NULL) {
    return;
  }
  placido_html_row(stream, "Instrument", report->instrument_name);
  placido_html_row(stream, "Geometry",
                   report->calibrated ? "calibrated" : "nominal, not calibrated");
}

static void write_distance(FILE *stream, const placido_report *report) {
  if ((report->fit == NULL && report->mires == NULL) || !isfinite(report->axis_z_mm)) {
    return;
  }
  char number[2 * PLACIDO_NUMBER_SIZE + 8], text[2 * PLACIDO_NUMBER_SIZE + 16];
  if (report->axis_z_sigma_mm > 0) {
    placido_number_measure(number, sizeof number, report->axis_z_mm, report->axis_z_sigma_mm);
  } else {
    placido_number_write(number, sizeof number, report->axis_z_mm, 3);
  }
  snprintf(text, sizeof text, "%s mm", number);
  placido_html_row(stream, "Cornea on the axis, z", text);
}

static void write_banner(FILE *stream, const placido_report *report) {
  if (report->instrument_name == NULL || report->calibrated) {
    return;
  }
  fputs(
      "<p class=\"banner\"><strong>NOMINAL GEOMETRY.</strong> This instrument was not "
      "calibrated: its camera and mires are taken to stand where its design says. All values "
      "carry the error of that assumption, which the standard deviations on this page do not "
      "contain.</p>\n",
      stream);
}

void placido_page_begin(FILE *stream, const char *title, const char *name) {
  fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n", stream);
  fputs(policy, stream);
  fputs("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
        stream);
  placido_html_print(stream, "%s: %s", title, name != NULL ? name : "report");
  fputs("</title>\n<style>\n", stream);
  fputs(placido_page_style, stream);
  fputs("</style>\n</head>\n<body>\n<header>\n<h1>", stream);
  placido_html_text(stream, title);
  fputs("</h1>\n<table>\n<tbody>\n", stream);
}

void placido_page_end(FILE *stream) {
  fputs(
      "</main>\n<footer>\n<p><strong>Not a medical device.</strong> For research and teaching: "
      "nothing on this page may be used to diagnose or treat.</p>\n</footer>\n</body>\n</html>\n",
      stream);
}

void placido_page_head(FILE *stream, const placido_report *report) {
  placido_page_begin(stream, "Corneal topography", report->input);
  placido_html_row(stream, "Input", report->input);
  placido_html_row(stream, "Eye", report->eye);
  placido_html_row(stream, "Date", report->created);
  write_geometry(stream, report);
  write_distance(stream, report);
  placido_html_row(stream, "Software", report->software);
  fputs("</tbody>\n</table>\n", stream);
  write_banner(stream, report);
  fputs("</header>\n<main>\n", stream);
}

void placido_page_warnings(FILE *stream, const placido_report *report) {
  if (report->notes == NULL || report->notes->count == 0) {
    return;
  }
  fputs("<section class=\"warnings\">\n<h2>Warnings</h2>\n<ul>\n", stream);
  for (size_t k = 0; k < report->notes->count; k++) {
    fputs("<li>", stream);
    placido_html_text(stream, report->notes->lines[k]);
    fputs("</li>\n", stream);
  }
  fputs("</ul>\n</section>\n", stream);
}

void placido_page_stages(FILE *stream, const placido_report *report) {
  if (report->stage_count == 0) {
    return;
  }
  double total = 0;
  fputs(
      "<section>\n<h2>Time</h2>\n<table>\n<thead><tr><th scope=\"col\">Stage</th>"
      "<th scope=\"col\" class=\"number\">Seconds</th></tr></thead>\n<tbody>\n",
      stream);
  for (size_t k = 0; k < report->stage_count; k++) {
    fputs("<tr><th scope=\"row\">", stream);
    placido_html_text(stream, report->stages[k].name);
    fprintf(stream, "</th><td class=\"number\">%.3f</td></tr>\n", report->stages[k].seconds);
    total += report->stages[k].seconds;
  }
  fprintf(stream,
          "</tbody>\n<tfoot><tr><th scope=\"row\">All</th><td class=\"number\">%.3f</td></tr>"
          "</tfoot>\n</table>\n</section>\n",
          total);
}

static int write_sections(FILE *stream, const placido_report *report, placido_error *err) {
  placido_page_head(stream, report);
  placido_page_warnings(stream, report);
  placido_page_indices(stream, report, true);
  int status = placido_page_maps(stream, report, true, err);
  placido_page_accuracy(stream, report);
  placido_page_budget(stream, report);
  placido_page_indices(stream, report, false);
  if (status == PLACIDO_OK) {
    status = placido_page_maps(stream, report, false, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_page_wavefront(stream, report, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_page_capture(stream, report, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_page_pupils(stream, report, err);
  }
  placido_page_stages(stream, report);
  placido_page_end(stream);
  return status;
}

int placido_report_write(const placido_report *report, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  int status = placido_path_join(path, report->directory, "report.html", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = write_sections(file.stream, report, err);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}

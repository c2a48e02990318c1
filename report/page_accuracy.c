/* The section of report.html on what was promised of accuracy and time, and what came out. */
#include "report/page.h"

#include "report/html.h"
#include "report/number.h"

#include <math.h>

static void write_cell(FILE *stream, double value) {
  char number[PLACIDO_NUMBER_SIZE];
  placido_number_significant(number, sizeof number, value, 2);
  fprintf(stream, "<td class=\"number\">%s</td>", number);
}

static void write_row(FILE *stream, const char *name, const placido_report_limit *limit,
                      const char *meaning) {
  if (!isfinite(limit->asked) && !isfinite(limit->promised)) {
    return;
  }
  fputs("<tr><th scope=\"row\">", stream);
  placido_html_text(stream, name);
  fputs("</th>", stream);
  write_cell(stream, limit->asked);
  write_cell(stream, limit->promised);
  write_cell(stream, limit->found);
  fputs("<td>", stream);
  placido_html_text(stream, meaning);
  fputs("</td></tr>\n", stream);
}

void placido_page_accuracy(FILE *stream, const placido_report *report) {
  const placido_report_accuracy *accuracy = report->accuracy;
  if (accuracy == NULL) {
    return;
  }
  fputs("<section>\n<h2>Accuracy</h2>\n<table>\n<thead><tr><th scope=\"col\">Largest error or "
        "time</th><th scope=\"col\" class=\"number\">Asked</th><th scope=\"col\" class=\"number\">"
        "Promised</th><th scope=\"col\" class=\"number\">Found</th><th scope=\"col\">What was "
        "found</th></tr></thead>\n<tbody>\n", stream);
  write_row(stream, "Elevation, µm", &accuracy->elevation_um,
            "The error bars of this measurement, which come on top: edges, distance, geometry; "
            "rms over the central 6 mm.");
  write_row(stream, "Transfer function", &accuracy->psf,
            "Cannot be told without the true eye.");
  write_row(stream, "Time, ms", &accuracy->time_ms,
            "Processor time from the frame to the results; reading and writing files apart.");
  fputs("</tbody>\n</table>\n<p class=\"small\">", stream);
  placido_html_text(stream, accuracy->settings);
  fputs("</p>\n<p class=\"small\">", stream);
  placido_html_text(stream, accuracy->table);
  fputs("</p>\n</section>\n", stream);
}

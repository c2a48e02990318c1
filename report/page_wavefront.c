/* The section of report.html about the corneal wavefront. */
#include "report/page.h"

#include "report/html.h"
#include "report/number.h"

#include <math.h>

static void write_heads(FILE *stream, const placido_report *report) {
  fputs("<table class=\"figures\">\n<thead><tr><th scope=\"col\">Figure</th>", stream);
  for (size_t i = 0; i < report->wavefront_count; i++) {
    fputs("<th scope=\"col\" class=\"number\">", stream);
    placido_html_print(stream, "%g mm ± 1 σ", report->wavefronts[i].front->eye.pupil_mm);
    fputs("</th>", stream);
  }
  fputs("<th scope=\"col\">Unit</th><th scope=\"col\">What it tells</th></tr></thead>\n<tbody>\n",
        stream);
}

static void write_row(FILE *stream, const placido_report *report, size_t k) {
  size_t count;
  const placido_wavefront_figure *figure = &placido_wavefront_figures(&count)[k];
  fputs("<tr><th scope=\"row\">", stream);
  placido_page_name(stream, figure->name, figure->unit);
  fputs("</th>", stream);
  for (size_t i = 0; i < report->wavefront_count; i++) {
    char text[2 * PLACIDO_NUMBER_SIZE + 8];
    const placido_report_wavefront *w = &report->wavefronts[i];
    placido_number_measure(text, sizeof text, w->figures[k],
                           w->sigmas != NULL ? w->sigmas[k] : (double)NAN);
    fputs("<td class=\"number\">", stream);
    placido_html_text(stream, text);
    fputs("</td>", stream);
  }
  fputs("<td class=\"unit\">", stream);
  placido_html_text(stream, placido_unit_text(figure->unit));
  fputs("</td><td class=\"small\">", stream);
  placido_html_text(stream, figure->help);
  fputs("</td></tr>\n", stream);
}

static int write_pictures(FILE *stream, const placido_report *report, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < report->wavefront_count && status == PLACIDO_OK; i++) {
    const placido_report_wavefront *w = &report->wavefronts[i];
    if (w->picture != NULL) {
      fputs("<figure>\n", stream);
      status = placido_html_picture(stream, NULL, report->directory, w->picture,
                                    "The wavefront over the pupil, and its Zernike terms", err);
      fputs("</figure>\n", stream);
    }
  }
  return status;
}

int placido_page_wavefront(FILE *stream, const placido_report *report, placido_error *err) {
  if (report->wavefront_count == 0) {
    return PLACIDO_OK;
  }
  size_t count;
  placido_wavefront_figures(&count);
  fputs("<section>\n<h2>Corneal wavefront</h2>\n", stream);
  write_heads(stream, report);
  for (size_t k = 0; k < count; k++) {
    write_row(stream, report, k);
  }
  fputs("</tbody>\n</table>\n", stream);
  int status = write_pictures(stream, report, err);
  fputs("</section>\n", stream);
  return status;
}

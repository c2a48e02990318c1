/* The sections of report.html about the cornea: indices, capture and maps. */
#include "report/page.h"

#include "report/html.h"
#include "report/number.h"

#include <ctype.h>
#include <string.h>

/* A name of indices.json as words: "simk_flat_D" in D becomes "SimK flat", as the field
 * spells it. */
static void write_index_name(FILE *stream, const placido_index_value *index) {
  char words[128], *last;
  snprintf(words, sizeof words, "%s", index->name);
  last = strrchr(words, '_');
  if (last != NULL && index->unit != NULL &&
      strcmp(placido_unit_text(last + 1), placido_unit_text(index->unit)) == 0) {
    *last = '\0';
  }
  for (char *at = words; *at != '\0'; at++) {
    *at = *at == '_' ? ' ' : *at;
  }
  words[0] = (char)toupper((unsigned char)words[0]);
  if (strncmp(words, "Simk", 4) == 0) {
    words[3] = 'K';
  }
  placido_html_text(stream, words);
}

static void write_index(FILE *stream, const placido_index_value *index) {
  char value[2 * PLACIDO_NUMBER_SIZE + 8];
  placido_number_measure(value, sizeof value, index->value, index->sigma);
  fputs("<tr><th scope=\"row\">", stream);
  write_index_name(stream, index);
  fputs("</th><td class=\"number\">", stream);
  placido_html_text(stream, value);
  fputs("</td><td class=\"unit\">", stream);
  placido_html_text(stream, index->unit != NULL ? placido_unit_text(index->unit) : NULL);
  fputs("</td><td class=\"small\">", stream);
  placido_html_text(stream, index->help);
  fputs("</td></tr>\n", stream);
}

void placido_page_indices(FILE *stream, const placido_report *report) {
  if (report->index_count == 0) {
    return;
  }
  fputs(
      "<section>\n<h2>Key figures</h2>\n<table>\n<thead><tr><th scope=\"col\">Index</th>"
      "<th scope=\"col\" class=\"number\">Value ± 1 σ</th><th scope=\"col\">Unit</th>"
      "<th scope=\"col\">What it tells</th></tr></thead>\n<tbody>\n",
      stream);
  for (size_t k = 0; k < report->index_count; k++) {
    write_index(stream, &report->indices[k]);
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

static void write_detection(FILE *stream, const placido_mires *mires) {
  char text[128];
  snprintf(text, sizeof text, "%zu, %.1f %% of %d edges on %d meridians", mires->count,
           100 * mires->coverage, mires->edge_count, mires->meridian_count);
  placido_html_row(stream, "Edge points found", text);
  snprintf(text, sizeof text, "%.0f %% of the full range", 100 * mires->contrast);
  placido_html_row(stream, "Contrast of the mires", text);
}

static void write_fit(FILE *stream, const placido_fit_summary *fit) {
  char text[192], rms[PLACIDO_NUMBER_SIZE], sigma[PLACIDO_NUMBER_SIZE];
  snprintf(text, sizeof text, "%zu of %zu", fit->points_used, fit->points);
  placido_html_row(stream, "Points used by the fit", text);
  placido_number_significant(rms, sizeof rms, fit->rms_px, 2);
  placido_number_significant(sigma, sizeof sigma, fit->sigma_px, 2);
  snprintf(text, sizeof text, "%s px rms, %s px of a single edge point (1 σ)", rms, sigma);
  placido_html_row(stream, "Residuals", text);
  snprintf(text, sizeof text, "radius %.2f mm, knots every %.2f mm, %d steps", fit->radius_mm,
           fit->knot_mm, fit->steps);
  placido_html_row(stream, "Fitted surface", text);
}

static int write_figure(FILE *stream, const placido_report *report, const char *picture,
                        const char *alternative, const char *caption, placido_error *err) {
  if (picture == NULL) {
    return PLACIDO_OK;
  }
  fputs("<figure>\n", stream);
  int status = placido_html_picture(stream, NULL, report->directory, picture, alternative, err);
  if (caption != NULL) {
    fputs("<figcaption>", stream);
    placido_html_text(stream, caption);
    fputs("</figcaption>\n", stream);
  }
  fputs("</figure>\n", stream);
  return status;
}

static int write_captures(FILE *stream, const placido_report *report, placido_error *err) {
  if (report->capture_picture == NULL && report->mires_picture == NULL) {
    return PLACIDO_OK;
  }
  bool both = report->capture_picture != NULL && report->mires_picture != NULL;
  fputs(both ? "<div class=\"pair captures\">\n" : "<div>\n", stream);
  int status = write_figure(stream, report, report->capture_picture, "The frame that was measured",
                            "The frame that was measured.", err);
  if (status == PLACIDO_OK) {
    status = write_figure(stream, report, report->mires_picture,
                          "The frame with the edge points that were found, coloured by edge number",
                          "The mires' edges as found and numbered, 0 the innermost.", err);
  }
  fputs("</div>\n", stream);
  return status;
}

int placido_page_capture(FILE *stream, const placido_report *report, placido_error *err) {
  bool figures = report->mires != NULL || report->fit != NULL;
  if (!figures && report->capture_picture == NULL && report->mires_picture == NULL) {
    return PLACIDO_OK;
  }
  fputs("<section>\n<h2>Capture</h2>\n", stream);
  if (figures) {
    fputs("<table>\n<tbody>\n", stream);
    if (report->mires != NULL) {
      write_detection(stream, report->mires);
    }
    if (report->fit != NULL) {
      write_fit(stream, report->fit);
    }
    fputs("</tbody>\n</table>\n", stream);
  }
  int status = write_captures(stream, report, err);
  fputs("</section>\n", stream);
  return status;
}

int placido_page_maps(FILE *stream, const placido_report *report, placido_error *err) {
  if (report->map_pictures == NULL || report->map_pictures[0] == NULL) {
    return PLACIDO_OK;
  }
  int status = PLACIDO_OK;
  fputs("<section>\n<h2>Maps</h2>\n<div class=\"pair maps\">\n", stream);
  for (size_t k = 0; status == PLACIDO_OK && report->map_pictures[k] != NULL; k++) {
    const char *caption = report->map_captions != NULL ? report->map_captions[k] : NULL;
    const char *alternative = caption != NULL ? caption : report->map_pictures[k];
    status = write_figure(stream, report, report->map_pictures[k], alternative, caption, err);
  }
  fputs("</div>\n</section>\n", stream);
  return status;
}

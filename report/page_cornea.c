/* The sections of report.html about the cornea: capture and maps. */
#include "report/page.h"

#include "report/html.h"
#include "report/number.h"

#include <stdio.h>

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

static int write_place(FILE *stream, const placido_report *report,
                       enum placido_report_place place, placido_error *err) {
  static const struct {
    const char *heading, *columns;
  } places[PLACIDO_PLACES] = {
      [PLACIDO_PLACE_MAIN] = {"Maps", "pair"},
      [PLACIDO_PLACE_FURTHER] = {"Further maps", "triple"},
      [PLACIDO_PLACE_UNCERTAINTY] = {"Uncertainty (1 σ)", "triple"},
  };
  int status = PLACIDO_OK;
  bool begun = false;
  for (size_t k = 0; status == PLACIDO_OK && k < report->map_count; k++) {
    const placido_report_map *map = &report->maps[k];
    if (map->place != place) {
      continue;
    }
    if (!begun) {
      fprintf(stream, "<section>\n<h2>%s</h2>\n<div class=\"%s maps\">\n",
              places[place].heading, places[place].columns);
      begun = true;
    }
    const char *alternative = map->caption != NULL ? map->caption : map->picture;
    status = write_figure(stream, report, map->picture, alternative, map->caption, err);
  }
  fputs(begun ? "</div>\n</section>\n" : "", stream);
  return status;
}

int placido_page_maps(FILE *stream, const placido_report *report, bool main_ones,
                      placido_error *err) {
  int status = PLACIDO_OK, first = main_ones ? PLACIDO_PLACE_MAIN : PLACIDO_PLACE_FURTHER;
  int end = main_ones ? PLACIDO_PLACE_FURTHER : PLACIDO_PLACES;
  for (int place = first; place < end && status == PLACIDO_OK; place++) {
    status = write_place(stream, report, (enum placido_report_place)place, err);
  }
  return status;
}

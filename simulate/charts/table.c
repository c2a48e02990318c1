/* The generated charts: one row each. */
#include "simulate/charts/chart.h"
#include "simulate/charts/logmar.h"
#include "simulate/charts/pictures.h"

#include <placido/scene.h>

#include <math.h>
#include <string.h>

/* ISO 8596: 80 to 320 cd/m². Pictures in colour are made of a display's primaries. */
enum { CHART_CD_M2 = 160 };

static const placido_chart charts[] = {
  {"tumbling-e", "tumbling E from 20/160 to 20/10 with an astigmatic fan", 280, 210, 1,
   PLACIDO_OPTOTYPE_E, placido_draw_tumbling_e, CHART_CD_M2, 0, PLACIDO_SPECTRUM_DAYLIGHT, NULL},
  {"fan", "astigmatic fan of 24 radial lines, 15 degrees apart", 210, 210, 1, PLACIDO_OPTOTYPE_E,
   placido_draw_fan, CHART_CD_M2, 0, PLACIDO_SPECTRUM_DAYLIGHT, NULL},
  {"sloan", "Sloan letters in ETDRS lines, 1.0 to -0.3 logMAR", 0, 0, 1, PLACIDO_OPTOTYPE_SLOAN,
   placido_logmar_draw, CHART_CD_M2, 0, PLACIDO_SPECTRUM_DAYLIGHT, NULL},
  {"landolt", "Landolt rings in ETDRS lines", 0, 0, 1, PLACIDO_OPTOTYPE_LANDOLT,
   placido_logmar_draw, CHART_CD_M2, 0, PLACIDO_SPECTRUM_DAYLIGHT, NULL},
  {"e-lines", "tumbling E in ETDRS lines", 0, 0, 1, PLACIDO_OPTOTYPE_E, placido_logmar_draw,
   CHART_CD_M2, 0, PLACIDO_SPECTRUM_DAYLIGHT, NULL},
  {"building", "a brick house by day", 360, 270, 3, PLACIDO_OPTOTYPE_E, placido_draw_building,
   5000, 0, PLACIDO_SPECTRUM_DISPLAY_SRGB, NULL},
  {"street", "a street at night, with headlights", 360, 270, 3, PLACIDO_OPTOTYPE_E,
   placido_draw_street, 3, 0, PLACIDO_SPECTRUM_DISPLAY_SRGB, NULL},
  {"monitor", "windows with text on a screen at 60 cm", 600, 420, 3, PLACIDO_OPTOTYPE_E,
   placido_draw_monitor, 200, 0.6, PLACIDO_SPECTRUM_DISPLAY_SRGB, NULL},
  {"page", "a page at 33 cm, and houses far behind it through a window", 480, 360, 3,
   PLACIDO_OPTOTYPE_E, placido_draw_page, 300, 0.33, PLACIDO_SPECTRUM_DISPLAY_SRGB,
   placido_page_vergence_D},
  {"stars", "a field of stars", 240, 180, 3, PLACIDO_OPTOTYPE_E, placido_draw_stars, 0.005, 0,
   PLACIDO_SPECTRUM_DISPLAY_SRGB, NULL},
  {"colours", "patches, letters and bars in colours", 240, 190, 3, PLACIDO_OPTOTYPE_E,
   placido_draw_colours, 200, 0, PLACIDO_SPECTRUM_DISPLAY_SRGB, NULL},
};

const placido_chart *placido_chart_table(size_t *count) {
  *count = sizeof charts / sizeof *charts;
  return charts;
}

const placido_chart *placido_chart_find(const char *name) {
  for (size_t i = 0; i < sizeof charts / sizeof *charts; i++) {
    if (strcmp(charts[i].name, name) == 0) {
      return &charts[i];
    }
  }
  return NULL;
}

void placido_chart_list(void (*each)(void *user, const char *name, const char *help), void *user) {
  for (size_t i = 0; i < sizeof charts / sizeof *charts; i++) {
    each(user, charts[i].name, charts[i].help);
  }
}

/* The size that is drawn, and the lines, of which `lines` may be none. */
static int settle(double size_arcmin[2], placido_chart_lines *settled, const placido_chart *chart,
                  const placido_chart_lines *lines, placido_error *err) {
  bool in_lines = chart->draw == placido_logmar_draw;
  *settled = lines != NULL ? *lines : placido_logmar_usual();
  size_arcmin[0] = chart->width_arcmin;
  size_arcmin[1] = chart->height_arcmin;
  if (lines != NULL && !in_lines) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "chart %s: its lines are its own (sloan, landolt and e-lines take "
                             "others)", chart->name);
  }
  int status = placido_logmar_check(settled, err);
  if (status == PLACIDO_OK && in_lines) {
    placido_logmar_measure(settled, &size_arcmin[0], &size_arcmin[1]);
  }
  return status;
}

int placido_chart_new(placido_image *image, const placido_chart *chart,
                      const placido_chart_lines *lines, double arcmin_per_px, placido_error *err) {
  const double side_max_px = 16000;
  double size_arcmin[2];
  placido_chart_lines settled;
  *image = (placido_image){0};
  if (!(arcmin_per_px >= 0.05 && arcmin_per_px <= 4)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "chart %s: %g arcmin per pixel, expected 0.05 to 4", chart->name,
                             arcmin_per_px);
  }
  int status = settle(size_arcmin, &settled, chart, lines, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double width = ceil(size_arcmin[0] / arcmin_per_px);
  double height = ceil(size_arcmin[1] / arcmin_per_px);
  if (width > side_max_px || height > side_max_px) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "chart %s: %.0f by %.0f pixels of %g' are too many, %g a side are "
                             "possible (larger pixels, or a first line of smaller letters)",
                             chart->name, width, height, arcmin_per_px, side_max_px);
  }
  status = placido_image_new(image, (int)width, (int)height, chart->planes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t samples = (size_t)image->width_px * (size_t)image->height_px * (size_t)image->planes;
  for (size_t i = 0; i < samples; i++) {
    image->data[i] = 1;
  }
  chart->draw(image, arcmin_per_px, chart, &settled);
  return PLACIDO_OK;
}

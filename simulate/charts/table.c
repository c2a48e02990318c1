/* The generated charts: one row each. */
#include "simulate/charts/chart.h"

#include <placido/simulate.h>

#include <math.h>
#include <string.h>

static const placido_chart charts[] = {
  {"tumbling-e", "tumbling E from 20/160 to 20/10 with an astigmatic fan", 280, 210,
   placido_draw_tumbling_e},
  {"fan", "astigmatic fan of 24 radial lines, 15 degrees apart", 210, 210, placido_draw_fan},
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

int placido_chart_new(placido_image *image, const placido_chart *chart, double arcmin_per_px,
                      placido_error *err) {
  *image = (placido_image){0};
  if (!(arcmin_per_px >= 0.05 && arcmin_per_px <= 4)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "chart %s: %g arcmin per pixel, expected 0.05 to 4", chart->name,
                             arcmin_per_px);
  }
  int status = placido_image_new(image, (int)ceil(chart->width_arcmin / arcmin_per_px),
                                 (int)ceil(chart->height_arcmin / arcmin_per_px), 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t pixels = (size_t)image->width_px * (size_t)image->height_px;
  for (size_t i = 0; i < pixels; i++) {
    image->data[i] = 1;
  }
  chart->draw(image, arcmin_per_px);
  return PLACIDO_OK;
}

/* Astigmatic fan: radial lines, of which astigmatism leaves those along one meridian sharp. */
#include "simulate/charts/chart.h"
#include "simulate/charts/paint.h"

#include <math.h>

void placido_draw_spokes(placido_image *image, double arcmin_per_px, double x_arcmin,
                         double y_arcmin, double radius_arcmin) {
  const int spokes = 24;
  const double inner = 5, half_width = 0.5; /* the stroke of 20/20; spokes do not touch at 5' */
  for (int i = 0; i < spokes; i++) {
    double angle = 2 * acos(-1) * i / spokes, c = cos(angle), s = sin(angle);
    placido_corner corners[4];
    for (int k = 0; k < 4; k++) {
      double along = k == 1 || k == 2 ? radius_arcmin : inner;
      double across = k < 2 ? -half_width : half_width;
      corners[k] = (placido_corner){x_arcmin + along * c - across * s,
                                    y_arcmin + along * s + across * c};
    }
    placido_paint_polygon(image, arcmin_per_px, corners, 4);
  }
}

void placido_draw_fan(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                      const placido_chart_lines *lines) {
  (void)chart;
  (void)lines;
  placido_draw_spokes(image, arcmin_per_px, 105, 105, 90);
}

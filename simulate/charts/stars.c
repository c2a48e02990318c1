/* A field of stars on a dark sky: points, whose light and not whose size is given.
 *
 * White is 0.005 cd/m²; a star of magnitude 0 gives 2.54e-6 lx (Allen's Astrophysical Quantities),
 * each magnitude 10^0.4 less. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

#include <math.h>

static const double white_cd_m2 = 5e-3, magnitude_0_lx = 2.54e-6;
static const placido_colour sky = {0.030f, 0.032f, 0.040f};

/* Light of a star in white's times square minutes of arc. */
static double light_of(double magnitude) {
  const double arcmin = acos(-1) / 10800;
  return magnitude_0_lx * pow(10, -0.4 * magnitude) / (white_cd_m2 * arcmin * arcmin);
}

/* Smaller than anything that an eye resolves; the area of the disc is made up for. */
static void set_star(const placido_brush *brush, double x, double y, double magnitude,
                     placido_colour tint) {
  const double radius = 0.05;
  double level = light_of(magnitude) / (acos(-1) * radius * radius);
  placido_brush_disc(brush, x, y, radius, placido_colour_times(tint, level));
}

void placido_draw_stars(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                        const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  const placido_colour tints[3] = {{0.85f, 1, 1.3f}, {1, 1, 1}, {1.3f, 0.95f, 0.6f}};
  (void)lines;
  placido_brush_rectangle(&brush, 0, 0, chart->width_arcmin + 4, chart->height_arcmin + 4, sky);
  for (unsigned i = 0; i < 70; i++) {
    double x = 8 + (chart->width_arcmin - 16) * placido_brush_chance(21, i);
    double y = 8 + (chart->height_arcmin - 16) * placido_brush_chance(22, i);
    /* As in the sky: three times as many for each magnitude fainter. */
    double magnitude = 6 + log(placido_brush_chance(23, i) + 1e-3) / log(3);
    set_star(&brush, x, y, magnitude, tints[i % 3]);
  }
  set_star(&brush, 150, 110, 0.5, tints[0]);
  set_star(&brush, 70, 60, 4.5, tints[1]); /* a pair 3.5' apart: who sees two has a good eye */
  set_star(&brush, 73.5, 60, 4.7, tints[1]);
}

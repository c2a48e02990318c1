/* Tumbling-E chart: 20/160 to 20/10 in four directions, with an astigmatic fan.
 *
 * The E is five units high and wide, its stroke and gaps one unit; 20/20 is 5' high (Snellen). */
#include "simulate/charts/chart.h"
#include "simulate/charts/paint.h"

#include <stdio.h>
#include <string.h>

/* Heights double from line to line, 26' apart; all of it falls on whole pixels at half a minute.
 * The picture is 280' by 210' with margins of 14'. */
static const placido_e_line lines[] = {
  {160, 40, 58, 14, 56, "rdlu"}, {80, 20, 58, 80, 30, "ulrd"},   {40, 10, 58, 126, 18, "dlur"},
  {20, 5, 58, 162, 12, "lrdu"},  {10, 2.5, 58, 193, 8, "udrl"},
};

const placido_e_line *placido_e_lines(size_t *count) {
  *count = sizeof lines / sizeof *lines;
  return lines;
}

/* Which optotype points there. */
static int direction_of(char direction) {
  const char *all = "ruld";
  return (int)(strchr(all, direction) - all);
}

static void draw_line(placido_image *image, double arcmin_per_px, const placido_e_line *line) {
  const double cell_arcmin = 1.5, label_left = 14;
  char label[16];
  snprintf(label, sizeof label, "20/%d", line->denominator);
  placido_paint_text(image, arcmin_per_px, label_left,
                     line->top_arcmin + line->height_arcmin / 2 - 2.5 * cell_arcmin, cell_arcmin,
                     label);
  for (int i = 0; line->directions[i] != '\0'; i++) {
    double half = line->height_arcmin / 2;
    placido_optotype_draw(image, PLACIDO_OPTOTYPE_E, direction_of(line->directions[i]),
                          line->height_arcmin, line->left_arcmin + half + i * line->pitch_arcmin,
                          line->top_arcmin + half, arcmin_per_px);
  }
}

void placido_draw_tumbling_e(placido_image *image, double arcmin_per_px,
                             const placido_chart *chart, const placido_chart_lines *lines_asked) {
  (void)chart;
  (void)lines_asked;
  for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
    draw_line(image, arcmin_per_px, &lines[i]);
  }
  placido_draw_spokes(image, arcmin_per_px, 214, 142, 52);
}

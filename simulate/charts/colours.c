/* Colours side by side: patches, letters on a ground of another colour, bars in colours that focus
 * at different depths. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

static const placido_colour red = {0.70f, 0.03f, 0.03f}, green = {0.05f, 0.40f, 0.06f},
                            blue = {0.03f, 0.05f, 0.70f}, yellow = {0.80f, 0.62f, 0.02f},
                            cyan = {0.02f, 0.40f, 0.55f}, magenta = {0.55f, 0.04f, 0.40f},
                            white = {1, 1, 1}, black = {0, 0, 0}, grey = {0.18f, 0.18f, 0.18f};

/* Hues above, the same at a quarter of their light, then greys of equal ratio. */
static void paint_patches(const placido_brush *brush) {
  const placido_colour hues[6] = {red, yellow, green, cyan, blue, magenta};
  const double side = 30, pitch = 36;
  double light = 1;
  for (int i = 0; i < 6; i++, light *= 0.5) {
    double left = 15 + i * pitch;
    placido_brush_rectangle(brush, left, 15, side, side, hues[i]);
    placido_brush_rectangle(brush, left, 15 + pitch, side, side,
                            placido_colour_times(hues[i], 0.25));
    placido_brush_rectangle(brush, left, 15 + 2 * pitch, side, side,
                            placido_colour_times(white, light));
  }
}

/* Letters of 20/40 (10'): red on green of like brightness, blue on black, yellow on white. */
static void paint_letters(const placido_brush *brush) {
  const struct {
    placido_colour ground, letters;
  } rows[] = {{green, red}, {black, blue}, {white, yellow}};
  for (int i = 0; i < 3; i++) {
    double left = 15 + i * 72.0;
    placido_brush_rectangle(brush, left, 125, 66, 20, rows[i].ground);
    placido_brush_write(brush, left + 5, 130, 10, "ZKRO", rows[i].letters);
  }
}

/* Pairs of bars, each half as wide as the one before: 4' to 0.5'. */
static void paint_bars(const placido_brush *brush) {
  const placido_colour pairs[3][2] = {{red, blue}, {green, magenta}, {white, black}};
  for (int i = 0; i < 3; i++) {
    double left = 15 + i * 72.0, at = left, width = 4;
    for (int k = 0; k < 4; k++, width /= 2) {
      for (; at + 2 * width <= left + 16.5 * (k + 1); at += 2 * width) {
        placido_brush_rectangle(brush, at, 155, width, 20, pairs[i][0]);
        placido_brush_rectangle(brush, at + width, 155, width, 20, pairs[i][1]);
      }
    }
  }
}

void placido_draw_colours(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                          const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  (void)lines;
  placido_brush_rectangle(&brush, 0, 0, chart->width_arcmin + 4, chart->height_arcmin + 4, grey);
  paint_patches(&brush);
  paint_letters(&brush);
  paint_bars(&brush);
}

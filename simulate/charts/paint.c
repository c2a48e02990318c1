/* Rectangles, polygons and small digits, black on white. */
#include "simulate/charts/paint.h"

#include <stddef.h>

void placido_paint_polygon(placido_image *image, double arcmin_per_px,
                           const placido_corner *corners, int count) {
  placido_outline outline = placido_outline_new(0, 0, 1 / arcmin_per_px, 0);
  placido_outline_polygon(&outline, corners, count);
  placido_outline_blacken(image, &outline);
}

void placido_paint_rectangle(placido_image *image, double arcmin_per_px, double left, double top,
                             double width, double height) {
  placido_corner corners[4] = {
    {left, top}, {left + width, top}, {left + width, top + height}, {left, top + height}};
  placido_paint_polygon(image, arcmin_per_px, corners, 4);
}

static const struct {
  char character;
  const char *cells; /* rows of three */
} glyphs[] = {
  {'0', "#### ## ## ####"}, {'1', " # ##  #  # ###"}, {'2', "###  #####  ###"},
  {'3', "###  ####  ####"}, {'4', "# ## ####  #  #"}, {'5', "####  ###  ####"},
  {'6', "####  #### ####"}, {'7', "###  #  #  #  #"}, {'8', "#### ##### ####"},
  {'9', "#### ####  ####"}, {'/', "  #  # # #  #  "}, {'.', "             # "},
  {'-', "      ###      "},
};

static void paint_glyph(placido_image *image, double arcmin_per_px, double left, double top,
                        double cell, const char *cells) {
  for (int i = 0; i < 15; i++) {
    if (cells[i] == '#') {
      placido_paint_rectangle(image, arcmin_per_px, left + i % 3 * cell, top + i / 3 * cell, cell,
                              cell);
    }
  }
}

void placido_paint_text(placido_image *image, double arcmin_per_px, double left, double top,
                        double cell_arcmin, const char *text) {
  for (; *text != '\0'; text++, left += 4 * cell_arcmin) {
    for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++) {
      if (glyphs[i].character == *text) {
        paint_glyph(image, arcmin_per_px, left, top, cell_arcmin, glyphs[i].cells);
      }
    }
  }
}

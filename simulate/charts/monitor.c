/* A computer's screen: lines of small letters, dark on light and light on dark, and coloured
 * buttons. Letters of 12.5' are 2.2 mm at 60 cm. */
#include "simulate/charts/brush.h"
#include "simulate/charts/pictures.h"

static const placido_colour desk = {0.05f, 0.14f, 0.30f}, paper = {0.92f, 0.92f, 0.92f},
                            ink = {0.02f, 0.02f, 0.02f}, bar = {0.55f, 0.57f, 0.60f},
                            dark = {0.012f, 0.013f, 0.016f}, lime = {0.25f, 0.70f, 0.20f},
                            amber = {0.80f, 0.45f, 0.04f}, rose = {0.70f, 0.06f, 0.10f};

/* Words of letters that chance picks. */
static void write_line(const placido_brush *brush, double left, double top, double height,
                       int letters, unsigned seed, placido_colour colour) {
  char text[64];
  int count = letters < (int)sizeof text - 1 ? letters : (int)sizeof text - 1;
  for (int i = 0; i < count; i++) {
    double chance = placido_brush_chance(seed, (unsigned)i);
    text[i] = chance < 0.16 ? ' ' : "CDHKNORSVZ"[(int)((chance - 0.16) / 0.84 * 10)];
  }
  text[count] = '\0';
  placido_brush_write(brush, left, top, height, text, colour);
}

static void open_window(const placido_brush *brush, double left, double top, double width,
                        double height, placido_colour ground) {
  const placido_colour buttons[3] = {rose, amber, lime};
  placido_brush_rectangle(brush, left, top, width, 18, bar);
  placido_brush_rectangle(brush, left, top + 18, width, height - 18, ground);
  for (int i = 0; i < 3; i++) {
    placido_brush_disc(brush, left + 10 + 14 * i, top + 9, 4.5, buttons[i]);
  }
}

void placido_draw_monitor(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                          const placido_chart_lines *lines) {
  const placido_brush brush = {image, arcmin_per_px};
  const double height = 12.5;
  (void)lines;
  placido_brush_rectangle(&brush, 0, 0, chart->width_arcmin + 4, chart->height_arcmin + 4, desk);
  open_window(&brush, 30, 24, 330, 200, paper);
  open_window(&brush, 250, 190, 330, 200, dark);
  for (unsigned i = 0; i < 6; i++) {
    write_line(&brush, 42, 54 + i * 24.0, height, i == 5 ? 10 : 16, 31 + i, ink);
    write_line(&brush, 262, 220 + i * 24.0, height, 16, 41 + i, i % 3 == 0 ? amber : lime);
  }
  placido_brush_rectangle(&brush, 262, 366, height, height, paper); /* the cursor */
}

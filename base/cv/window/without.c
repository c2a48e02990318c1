/* Takes the place of the window in a build without one: it cannot be opened. */
#include "base/cv/window/window.h"

int placido_window_open(placido_window **window, const char *title, placido_error *err) {
  (void)title;
  *window = NULL;
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "no window can be opened: this build has none (PLACIDO_WINDOW)");
}

void placido_window_close(placido_window *window) {
  (void)window;
}

int placido_window_frame(placido_window *window, const placido_frame *frame, placido_error *err) {
  (void)window;
  (void)frame;
  (void)err;
  return PLACIDO_OK;
}

void placido_window_dot(placido_window *window, double u_px, double v_px,
                        placido_window_ink ink) {
  (void)window;
  (void)u_px;
  (void)v_px;
  (void)ink;
}

void placido_window_line(placido_window *window, const double from_px[2], const double to_px[2],
                         placido_window_ink ink) {
  (void)window;
  (void)from_px;
  (void)to_px;
  (void)ink;
}

void placido_window_box(placido_window *window, const double corner_px[2], double width_px,
                        double height_px, placido_window_ink ink) {
  (void)window;
  (void)corner_px;
  (void)width_px;
  (void)height_px;
  (void)ink;
}

void placido_window_text(placido_window *window, const double place_px[2], double height_px,
                         const char *text, placido_window_ink ink) {
  (void)window;
  (void)place_px;
  (void)height_px;
  (void)text;
  (void)ink;
}

int placido_window_show(placido_window *window, int *key, placido_error *err) {
  (void)window;
  (void)err;
  *key = 0;
  return PLACIDO_OK;
}

/* A window that shows a camera's picture with lines and words drawn over it. */
#ifndef PLACIDO_BASE_WINDOW_H
#define PLACIDO_BASE_WINDOW_H

#include <placido/frame.h>
#include <placido/status.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct placido_window placido_window;

/* Red, green and blue, 0 to 255. */
typedef struct placido_window_ink {
  int red, green, blue;
} placido_window_ink;

/* Opens a window, empty until it shows something. One a program, from one thread. Close with
 * placido_window_close. Returns PLACIDO_OK, PLACIDO_UNSUPPORTED (this build has no windows, or
 * there is no display: the message says which), PLACIDO_MEMORY. */
int placido_window_open(placido_window **window, const char *title, placido_error *err);
void placido_window_close(placido_window *window);

/* Begins a new picture with a frame; a large one is shown smaller. Returns PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_window_frame(placido_window *window, const placido_frame *frame, placido_error *err);

/* Drawing, over the frame that was given: all places and sizes are in the frame's pixels. */
void placido_window_dot(placido_window *window, double u_px, double v_px,
                        placido_window_ink ink);
void placido_window_line(placido_window *window, const double from_px[2], const double to_px[2],
                         placido_window_ink ink);
/* A filled box; `corner` is its upper left one. */
void placido_window_box(placido_window *window, const double corner_px[2], double width_px,
                        double height_px, placido_window_ink ink);
/* `place` is where the line of text begins, at its foot; `height_px` that of a capital. */
void placido_window_text(placido_window *window, const double place_px[2], double height_px,
                         const char *text, placido_window_ink ink);

/* Shows what was drawn and takes one key, 0 where none was pressed. Returns PLACIDO_OK, PLACIDO_END
 * (the person closed the window), PLACIDO_INPUT. */
int placido_window_show(placido_window *window, int *key, placido_error *err);

#ifdef __cplusplus
}
#endif
#endif

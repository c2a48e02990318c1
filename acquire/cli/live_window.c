/* The live view in a window: the frame, the mires' edges as they were seen, a cross at their
 * centre and one on the instrument's axis, bars, the instruction, and the axial map. */
#include "acquire/cli/live.h"
#include "base/cv/window/window.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>

#define KEY_ESCAPE 27
#define BARS 3

struct live_window {
  placido_window *window;
};

static const placido_window_ink white = {255, 255, 255}, green = {90, 230, 110},
                                amber = {255, 190, 60}, blue = {90, 190, 255}, grey = {70, 70, 70};

int live_window_open(struct live_window **window, placido_error *err) {
  *window = placido_memory_new(1, sizeof **window, err);
  if (!*window) {
    return PLACIDO_MEMORY;
  }
  const int status = placido_window_open(&(*window)->window, "placido live", err);
  if (status != PLACIDO_OK) {
    placido_memory_free(*window);
    *window = NULL;
  }
  return status;
}

void live_window_close(struct live_window *window) {
  if (window) {
    placido_window_close(window->window);
    placido_memory_free(window);
  }
}

static void draw_cross(placido_window *window, const double place_px[2], double arm_px,
                       placido_window_ink ink) {
  for (int i = 0; i < 2; i++) {
    double from[2] = {place_px[0], place_px[1]}, to[2] = {place_px[0], place_px[1]};
    from[i] -= arm_px;
    to[i] += arm_px;
    placido_window_line(window, from, to, ink);
  }
}

static void draw_mires(placido_window *window, const placido_guide *guide,
                       const struct live_moment *moment, double unit_px) {
  size_t count;
  const placido_guide_point *points = placido_guide_points(guide, &count);
  const bool is_ready = moment->guidance.state == PLACIDO_GUIDE_READY;
  for (size_t i = 0; i < count; i++) {
    placido_window_dot(window, (double)points[i].u_px, (double)points[i].v_px,
                       is_ready ? green : amber);
  }
  if (!isnan(moment->guidance.u_px)) {
    const double centre_px[2] = {moment->guidance.u_px, moment->guidance.v_px};
    draw_cross(window, centre_px, unit_px, is_ready ? green : amber);
  }
}

static void draw_bars(placido_window *window, const struct live_moment *moment, double bottom_px,
                      double unit_px) {
  const placido_guidance *g = &moment->guidance;
  const struct {
    const char *name;
    double share;
  } bars[BARS] = {{"sharp", isnan(g->blur_px) ? 0 : 1 / (1 + g->blur_px)},
                  {"mires", g->coverage},
                  {"score", g->score}};
  for (int i = 0; i < BARS; i++) {
    const double top = bottom_px - (BARS - i) * 1.6 * unit_px;
    const double corner[2] = {6 * unit_px, top}, foot[2] = {unit_px, top + unit_px};
    placido_window_text(window, foot, 0.7 * unit_px, bars[i].name, white);
    placido_window_box(window, corner, 12 * unit_px, unit_px, grey);
    placido_window_box(window, corner, 12 * unit_px * bars[i].share, unit_px, green);
  }
}

/* Blue is flat and red steep, in steps of 1.5 D about 43.5 D (ISO 19980 has steps of 0.5, 1.0 and
 * 1.5 D). */
static placido_window_ink ink_of(double power_D) {
  static const placido_window_ink steps[] = {{30, 40, 130},  {40, 90, 190},  {60, 160, 220},
                                             {90, 200, 170}, {110, 200, 90}, {220, 210, 70},
                                             {240, 150, 50}, {220, 70, 50},  {150, 30, 60}};
  const int count = sizeof steps / sizeof steps[0];
  const int step = (int)floor((power_D - 43.5) / 1.5 + 0.5 * count);
  return steps[step < 0 ? 0 : step < count ? step : count - 1];
}

static void draw_map(placido_window *window, const struct live_cornea *cornea, double right_px,
                     double unit_px) {
  const double cell_px = 14 * unit_px / LIVE_MAP_SIDE;
  const double left_px = right_px - 15 * unit_px, bottom_px = 15 * unit_px;
  for (int k = 0; k < LIVE_MAP_SIDE * LIVE_MAP_SIDE; k++) {
    const double corner[2] = {left_px + k % LIVE_MAP_SIDE * cell_px,
                              bottom_px - (k / LIVE_MAP_SIDE + 1) * cell_px};
    if (!isnan(cornea->axial_D[k])) {
      placido_window_box(window, corner, cell_px, cell_px, ink_of((double)cornea->axial_D[k]));
    }
  }
}

static void draw_cornea(placido_window *window, const struct live_cornea *cornea, double right_px,
                        double unit_px) {
  char text[128];
  const double foot[2] = {unit_px, 5.2 * unit_px};
  live_describe_cornea(cornea, text, sizeof text);
  placido_window_text(window, foot, 0.7 * unit_px, text, white);
  draw_map(window, cornea, right_px, unit_px);
}

static void draw_words(placido_window *window, const struct live_moment *moment, double unit_px) {
  char text[128];
  const double head[2] = {unit_px, 2.4 * unit_px}, below[2] = {unit_px, 4 * unit_px};
  const bool is_ready = moment->guidance.state == PLACIDO_GUIDE_READY;
  placido_window_text(window, head, 1.4 * unit_px, moment->guidance.instruction,
                      is_ready ? green : amber);
  snprintf(text, sizeof text, "frame %ld, %ld skipped, %.1f ms", moment->judged - 1,
           moment->skipped, moment->look_ms);
  placido_window_text(window, below, 0.6 * unit_px, text, white);
}

int live_window_show(struct live_window *window, const placido_frame *frame,
                     const placido_instrument *instrument, const placido_guide *guide,
                     const struct live_moment *moment, placido_error *err) {
  const double unit_px = frame->height_px / 50.0;
  int status = placido_window_frame(window->window, frame, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  draw_cross(window->window, instrument->principal_px, 2 * unit_px, blue);
  draw_mires(window->window, guide, moment, unit_px);
  draw_bars(window->window, moment, frame->height_px - unit_px, unit_px);
  draw_words(window->window, moment, unit_px);
  if (moment->cornea) {
    draw_cornea(window->window, moment->cornea, frame->width_px, unit_px);
  }
  int key;
  status = placido_window_show(window->window, &key, err);
  return status == PLACIDO_OK && (key == 'q' || key == KEY_ESCAPE) ? PLACIDO_END : status;
}

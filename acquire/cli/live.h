/* What `placido live` shows of a frame, and the ways to show it. */
#ifndef PLACIDO_CLI_LIVE_H
#define PLACIDO_CLI_LIVE_H

#include "acquire/cli/live_topography.h"
#include "acquire/guide.h"

#include <jansson.h>
#include <placido/status.h>
#include <stdbool.h>

/* One judged frame and the counts so far. */
struct live_moment {
  placido_guidance guidance;
  uint64_t seq;
  int64_t t_ns;
  long judged;  /* with this one */
  long skipped; /* came while another one was shown, or were lost before */
  long damaged; /* could not be decoded */
  double look_ms; /* what judging this one took */
  const struct live_cornea *cornea; /* what was measured last; NULL: nothing is */
};

const char *live_state_name(enum placido_guide_state state);

/* What was measured last in one line: keratometry, or why there is none. */
void live_describe_cornea(const struct live_cornea *cornea, char *text, size_t size);

/* The figures as JSON, NaN as null. A new reference. */
json_t *live_json(const struct live_moment *moment);

/* One line of text. */
void live_print_line(const struct live_moment *moment);

/* Bars on a terminal, drawn where they stood before; `is_first` draws them below what is there. */
void live_print_bars(const struct live_moment *moment, const char *title, bool is_first);

struct live_window;

/* Returns what placido_window_open returns. Close with live_window_close. */
int live_window_open(struct live_window **window, placido_error *err);
void live_window_close(struct live_window *window);
/* The frame with its mires, centre and figures, and the map of what was measured last. Returns
 * PLACIDO_END where the person has enough: closed it, or pressed q or Escape. */
int live_window_show(struct live_window *window, const placido_frame *frame,
                     const placido_instrument *instrument, const placido_guide *guide,
                     const struct live_moment *moment, placido_error *err);

#endif

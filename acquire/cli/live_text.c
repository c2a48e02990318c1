/* The live view as text: JSON lines for programs, lines for a file, bars for a terminal. */
#include "acquire/cli/live.h"
#include "base/json.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define BAR_WIDTH 31 /* odd, for a middle */

/* A figure of the guidance. */
struct figure {
  const char *name;
  const char *key;   /* in JSON */
  const char *unit;
  size_t offset;
  double full;       /* where the bar is full */
  bool is_signed;    /* the bar starts in its middle */
};

static const struct figure figures[] = {
    {"across", "x_mm", "mm", offsetof(placido_guidance, x_mm), 1, true},
    {"up", "y_mm", "mm", offsetof(placido_guidance, y_mm), 1, true},
    {"focus", "focus_mm", "mm", offsetof(placido_guidance, focus_mm), 1, true},
    {"blur", "blur_px", "px", offsetof(placido_guidance, blur_px), 5, false},
    {"motion", "motion_px", "px", offsetof(placido_guidance, motion_px), 10, false},
    {"coverage", "coverage", "", offsetof(placido_guidance, coverage), 1, false},
    {"clipped", "clipped", "", offsetof(placido_guidance, clipped), 0.2, false},
    {"break-up", "break_up", "", offsetof(placido_guidance, break_up), 0.5, false},
    {"score", "score", "", offsetof(placido_guidance, score), 1, false},
};
#define FIGURE_COUNT (sizeof figures / sizeof figures[0])

static double value_of(const struct live_moment *moment, const struct figure *figure) {
  double value;
  memcpy(&value, (const char *)&moment->guidance + figure->offset, sizeof value);
  return value;
}

const char *live_state_name(enum placido_guide_state state) {
  static const char *const names[] = {[PLACIDO_GUIDE_NO_EYE] = "no-eye",
                                      [PLACIDO_GUIDE_BLINK] = "blink",
                                      [PLACIDO_GUIDE_ALIGN] = "align",
                                      [PLACIDO_GUIDE_READY] = "ready"};
  return names[state];
}

json_t *live_json(const struct live_moment *moment) {
  json_t *row = json_object();
  json_object_set_new(row, "frame", json_integer(moment->judged - 1));
  json_object_set_new(row, "sequence", json_integer((json_int_t)moment->seq));
  json_object_set_new(row, "timestamp_ns", json_integer(moment->t_ns));
  json_object_set_new(row, "state", json_string(live_state_name(moment->guidance.state)));
  json_object_set_new(row, "instruction", json_string(moment->guidance.instruction));
  for (size_t i = 0; i < FIGURE_COUNT; i++) {
    json_object_set_new(row, figures[i].key, placido_json_real(value_of(moment, &figures[i])));
  }
  json_object_set_new(row, "u_px", placido_json_real(moment->guidance.u_px));
  json_object_set_new(row, "v_px", placido_json_real(moment->guidance.v_px));
  json_object_set_new(row, "skipped", json_integer(moment->skipped));
  json_object_set_new(row, "look_ms", placido_json_real(moment->look_ms));
  return row;
}

static void print_value(double value, bool is_signed) {
  if (isnan(value)) {
    printf("%6s", "-");
  } else {
    printf(is_signed ? "%+6.2f" : "%6.2f", value);
  }
}

void live_print_line(const struct live_moment *moment) {
  printf("%6ld %-6s", moment->judged - 1, live_state_name(moment->guidance.state));
  for (size_t i = 0; i < FIGURE_COUNT; i++) {
    printf(" %s ", figures[i].name);
    print_value(value_of(moment, &figures[i]), figures[i].is_signed);
  }
  printf("  %s\n", moment->guidance.instruction);
}

/* "[        |##      ]" or "[####     ]"; nothing in it where the value is not known. */
static void print_bar(double value, const struct figure *figure) {
  char bar[BAR_WIDTH + 1];
  const int middle = BAR_WIDTH / 2;
  const double share = isnan(value) ? 0 : fmax(-1, fmin(1, value / figure->full));
  const int length = (int)lround(share * (figure->is_signed ? middle : BAR_WIDTH));
  memset(bar, ' ', BAR_WIDTH);
  bar[BAR_WIDTH] = '\0';
  if (figure->is_signed) {
    memset(bar + middle + (length < 0 ? length : 0), '#', (size_t)(length < 0 ? -length : length));
    bar[middle] = '|';
  } else {
    memset(bar, '#', (size_t)(length > 0 ? length : 0));
  }
  printf("[%s]", bar);
}

void live_print_bars(const struct live_moment *moment, const char *title, bool is_first) {
  if (!is_first) {
    printf("\033[%zuA", FIGURE_COUNT + 3);
  }
  printf("\r\033[K%.60s\n", title);
  printf("\033[K%-8s \033[1m%s\033[0m\n", live_state_name(moment->guidance.state),
         moment->guidance.instruction);
  for (size_t i = 0; i < FIGURE_COUNT; i++) {
    const double value = value_of(moment, &figures[i]);
    printf("\033[K%-8s ", figures[i].name);
    print_bar(value, &figures[i]);
    putchar(' ');
    print_value(value, figures[i].is_signed);
    printf(" %s\n", figures[i].unit);
  }
  printf("\033[Kframe %ld, %ld skipped, %.1f ms   (q ends)\n", moment->judged - 1, moment->skipped,
         moment->look_ms);
}

/* The live view as text: JSON lines for programs, lines for a file, bars for a terminal. */
#include "acquire/cli/live.h"
#include "base/json.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define BAR_WIDTH 31 /* odd, for a middle */
#define BARS_WIDTH 76 /* of what stands among the bars: a terminal's line */
#define LINE_BYTES 600

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

void live_describe_cornea(const struct live_cornea *cornea, char *text, size_t size) {
  if (cornea->count == 0) {
    snprintf(text, size, "not measured yet");
  } else if (cornea->reason[0] != '\0') {
    snprintf(text, size, "no topography: %s", cornea->reason);
  } else if (isnan(cornea->flat_D)) {
    snprintf(text, size, "no keratometry: too little of the middle is seen");
  } else if (isnan(cornea->flat_axis_deg)) {
    snprintf(text, size, "K %.2f D", cornea->flat_D);
  } else {
    snprintf(text, size, "K %.2f D @ %.0f, %.2f D @ %.0f, cylinder %.2f D", cornea->flat_D,
             cornea->flat_axis_deg, cornea->steep_D, cornea->steep_axis_deg, cornea->cylinder_D);
  }
}

static json_t *cornea_json(const struct live_cornea *cornea) {
  json_t *object = json_object();
  json_object_set_new(object, "measured", json_integer(cornea->count));
  json_object_set_new(object, "sequence",
                      cornea->count > 0 ? json_integer((json_int_t)cornea->seq) : json_null());
  json_object_set_new(object, "simk_flat_D", placido_json_real(cornea->flat_D));
  json_object_set_new(object, "simk_flat_axis_deg", placido_json_real(cornea->flat_axis_deg));
  json_object_set_new(object, "simk_steep_D", placido_json_real(cornea->steep_D));
  json_object_set_new(object, "simk_steep_axis_deg", placido_json_real(cornea->steep_axis_deg));
  json_object_set_new(object, "simk_cylinder_D", placido_json_real(cornea->cylinder_D));
  json_object_set_new(object, "refusal",
                      cornea->reason[0] != '\0' ? json_string(cornea->reason) : json_null());
  json_object_set_new(object, "measure_ms",
                      placido_json_real(cornea->count > 0 ? cornea->measure_ms : (double)NAN));
  return object;
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
  if (moment->cornea) {
    json_object_set_new(row, "topography", cornea_json(moment->cornea));
  }
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
  printf("  %s", moment->guidance.instruction);
  if (moment->cornea) {
    char text[LINE_BYTES];
    live_describe_cornea(moment->cornea, text, sizeof text);
    printf("  %s", text);
  }
  putchar('\n');
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
    printf("\033[%zuA", FIGURE_COUNT + (moment->cornea ? 4 : 3));
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
  if (moment->cornea) {
    char text[LINE_BYTES];
    live_describe_cornea(moment->cornea, text, sizeof text);
    printf("\033[K%.*s\n", BARS_WIDTH, text);
  }
  printf("\033[Kframe %ld, %ld skipped, %.1f ms   (q ends)\n", moment->judged - 1, moment->skipped,
         moment->look_ms);
}

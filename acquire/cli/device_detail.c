/* One device in detail: who it is, the pictures that it can give, and its controls. */
#include "acquire/cli/device_detail.h"

#include "acquire/cli/record.h"
#include "base/json.h"

#include <placido/device.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LINE_SIZE 200

static void put_text(json_t *object, const char *key, const char *text) {
  json_object_set_new(object, key, text[0] ? record_text(text) : json_null());
}

static json_t *describe_info(const struct settings *settings, const placido_device_info *info) {
  const struct {
    const char *key, *text;
  } rows[] = {{"uri", info->uri},
              {"vendor", info->vendor},
              {"model", info->model},
              {"serial", info->serial},
              {"firmware", info->firmware}};
  json_t *object = json_object();
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    put_text(object, rows[i].key, rows[i].text);
    if (rows[i].text[0]) {
      say(settings, "%-10s %s", rows[i].key, rows[i].text);
    }
  }
  return object;
}

/* "640 x 480", or "2 x 2 to 1920 x 1080" for a range. */
static void print_size(char text[64], const placido_device_mode *mode) {
  if (mode->width_min_px == mode->width_max_px && mode->height_min_px == mode->height_max_px) {
    snprintf(text, 64, "%d x %d", mode->width_max_px, mode->height_max_px);
  } else {
    snprintf(text, 64, "%d x %d to %d x %d", mode->width_min_px, mode->height_min_px,
             mode->width_max_px, mode->height_max_px);
  }
}

static void print_rates(char text[LINE_SIZE], const placido_device_mode *mode) {
  const char *between = mode->any_rate ? " to " : ", ";
  size_t length = 0;
  text[0] = '\0';
  for (int i = 0; i < mode->rate_count && length < LINE_SIZE - 24; i++) {
    length += (size_t)snprintf(text + length, LINE_SIZE - length, "%s%.4g", i ? between : "",
                               mode->rates_hz[i]);
  }
}

static json_t *range(int min, int max, int step) {
  json_t *array = json_array();
  json_array_append_new(array, json_integer(min));
  json_array_append_new(array, json_integer(max));
  json_array_append_new(array, json_integer(step));
  return array;
}

/* The modes as JSON; people get the same printed. */
struct modes {
  const struct settings *settings;
  json_t *array;
};

static int list_mode(void *user, const placido_device_mode *mode) {
  struct modes *modes = user;
  json_t *row = json_object(), *rates = json_array();
  put_text(row, "format", mode->format);
  json_object_set_new(row, "readable", json_boolean(mode->is_readable));
  json_object_set_new(row, "width_px",
                      range(mode->width_min_px, mode->width_max_px, mode->width_step_px));
  json_object_set_new(row, "height_px",
                      range(mode->height_min_px, mode->height_max_px, mode->height_step_px));
  for (int i = 0; i < mode->rate_count; i++) {
    json_array_append_new(rates, placido_json_real(mode->rates_hz[i]));
  }
  json_object_set_new(row, "rates_hz", rates);
  json_object_set_new(row, "any_rate", json_boolean(mode->any_rate));
  char size[64], text[LINE_SIZE];
  print_size(size, mode);
  print_rates(text, mode);
  if (json_array_size(modes->array) == 0) {
    say(modes->settings, "\n%-16s %-28s frames per second", "format", "pixels");
  }
  say(modes->settings, "%-16s %-28s %s%s", mode->format, size, text,
      mode->is_readable ? "" : "  (this build cannot read it)");
  json_array_append_new(modes->array, row);
  return PLACIDO_OK;
}

static json_t *describe_control(const struct settings *settings, const placido_control *control,
                                double value) {
  json_t *row = json_object();
  put_text(row, "name", control->name);
  put_text(row, "unit", control->unit);
  put_text(row, "help", control->help);
  json_object_set_new(row, "min", placido_json_real(control->min));
  json_object_set_new(row, "max", placido_json_real(control->max));
  json_object_set_new(row, "step", placido_json_real(control->step));
  json_object_set_new(row, "value", placido_json_real(value));
  char limits[64], now[32] = "-";
  snprintf(limits, sizeof limits, "%.7g to %.7g", control->min, control->max);
  if (!isnan(value)) {
    snprintf(now, sizeof now, "%.7g", value);
  }
  say(settings, "%-24s %-10s %-24s %s%s%s", control->name, now, limits, control->unit,
      control->unit[0] && control->help[0] ? "; " : "", control->help);
  return row;
}

static json_t *list_controls(const struct settings *settings, placido_device *device) {
  size_t count;
  const placido_control *controls = placido_device_controls(device, &count);
  json_t *array = json_array();
  if (count > 0) {
    say(settings, "\n%-24s %-10s %-24s unit; meaning", "control", "value", "range");
  }
  for (size_t i = 0; i < count; i++) {
    double value;
    if (placido_device_get(device, controls[i].name, &value, NULL)) {
      value = NAN;
    }
    json_array_append_new(array, describe_control(settings, &controls[i], value));
  }
  return array;
}

int device_detail(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  placido_device *device;
  int status = placido_device_open(&device, settings->input, &outcome->notes, err);
  if (status) {
    return status;
  }
  struct modes modes = {.settings = settings, .array = json_array()};
  outcome->result = json_object();
  json_object_set_new(outcome->result, "device",
                      describe_info(settings, placido_device_info_get(device)));
  status = placido_device_modes(device, list_mode, &modes, err);
  status = status == PLACIDO_UNSUPPORTED ? PLACIDO_OK : status; /* a session has one format */
  json_object_set_new(outcome->result, "modes", modes.array);
  json_object_set_new(outcome->result, "controls", list_controls(settings, device));
  placido_device_close(device);
  return status;
}

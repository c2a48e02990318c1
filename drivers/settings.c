/* The settings of a device's address: "ADDRESS?size=1280x1024&fps=30". */
#include "drivers/settings.h"

#include <stdlib.h>
#include <string.h>

int placido_settings_split(char *address, size_t size, const char **query, const char *text,
                           const char *device, placido_error *err) {
  const char *mark = strrchr(text, '?');
  const size_t length = mark ? (size_t)(mark - text) : strlen(text);
  *query = mark ? mark + 1 : NULL;
  address[0] = '\0';
  if (length >= size) {
    return placido_error_set(err, PLACIDO_INPUT, "the address of the %s is too long", device);
  }
  memcpy(address, text, length);
  address[length] = '\0';
  return PLACIDO_OK;
}

/* One "NAME=VALUE" of `length` characters. */
static int read_setting(const placido_settings *settings, void *target, const char *setting,
                        size_t length, placido_error *err) {
  const char *equals = memchr(setting, '=', length);
  const size_t name = equals ? (size_t)(equals - setting) : 0;
  size_t i = 0;
  while (settings->names[i] && (strlen(settings->names[i]) != name ||
                                strncmp(setting, settings->names[i], name) != 0)) {
    i++;
  }
  if (!equals || !settings->names[i]) {
    return PLACIDO_OK;
  }
  char value[PLACIDO_SETTING_MAX + 1] = "";
  if (length - name - 1 > settings->longest) {
    return placido_error_set(err, PLACIDO_INPUT, "\"%.60s...\" in the address is too long",
                             setting);
  }
  memcpy(value, equals + 1, length - name - 1);
  return settings->read(target, i, value, err);
}

int placido_settings_read(const placido_settings *settings, void *target, const char *query,
                          placido_error *err) {
  int status = PLACIDO_OK;
  while (!status && query && *query) {
    const size_t length = strcspn(query, "&");
    status = read_setting(settings, target, query, length, err);
    query += length + (query[length] == '&');
  }
  return status;
}

bool placido_setting_read_number(double *number, const char *value) {
  char *end;
  *number = strtod(value, &end);
  return end != value && *end == '\0';
}

/* The digits of a whole number of at most five, up to `stop`; NULL where there is none. */
static const char *read_digits(int *whole, const char *value, char stop) {
  const size_t digits = strspn(value, "0123456789");
  *whole = digits >= 1 && digits <= 5 ? atoi(value) : -1;
  return *whole >= 0 && value[digits] == stop ? value + digits : NULL;
}

bool placido_setting_read_pair(int pair[2], const char *value, char between) {
  const char *middle = read_digits(&pair[0], value, between);
  return middle && read_digits(&pair[1], middle + 1, '\0');
}

int placido_setting_read_size(int *width_px, int *height_px, int side_max_px, const char *value,
                              placido_error *err) {
  int sides_px[2];
  if (!placido_setting_read_pair(sides_px, value, 'x') || sides_px[0] < 1 || sides_px[1] < 1 ||
      sides_px[0] > side_max_px || sides_px[1] > side_max_px) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "size=%s is not WIDTHxHEIGHT in pixels, such as size=1280x1024",
                             value);
  }
  *width_px = sides_px[0];
  *height_px = sides_px[1];
  return PLACIDO_OK;
}

int placido_setting_read_rate(double *rate_hz, const char *value, placido_error *err) {
  if (!placido_setting_read_number(rate_hz, value) ||
      !(*rate_hz > 0 && *rate_hz <= PLACIDO_RATE_MAX_HZ)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "fps=%s is not a number of frames per second up to %d", value,
                             PLACIDO_RATE_MAX_HZ);
  }
  return PLACIDO_OK;
}

int placido_setting_read_whole(int *whole, const char *name, int min, int max, const char *value,
                               placido_error *err) {
  if (!read_digits(whole, value, '\0') || *whole < min || *whole > max) {
    return placido_error_set(err, PLACIDO_INPUT, "%s=%s is not a number from %d to %d", name,
                             value, min, max);
  }
  return PLACIDO_OK;
}

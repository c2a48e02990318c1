/* What a device's address asks of a camera: one row for each setting. */
#include "drivers/u3v/request.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BUFFERS_USUAL 4
#define RATE_MAX_HZ 10000

const char *const placido_u3v_options[] = {"size", "offset", "format", "fps", "buffers", NULL};

/* Two whole numbers of at most five digits with `between` between them, and nothing else. */
static bool read_pair(int pair[2], const char *text, char between) {
  for (int i = 0; i < 2; i++) {
    const size_t digits = strspn(text, "0123456789");
    if (digits < 1 || digits > 5 || text[digits] != (i == 0 ? between : '\0')) {
      return false;
    }
    pair[i] = atoi(text);
    text += digits + 1;
  }
  return true;
}

static int read_size(placido_u3v_request *request, const char *value, placido_error *err) {
  int pair[2];
  if (!read_pair(pair, value, 'x') || pair[0] < 1 || pair[1] < 1 ||
      pair[0] > PLACIDO_U3V_SIDE_MAX_PX || pair[1] > PLACIDO_U3V_SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "size=%s is not WIDTHxHEIGHT in pixels, such as size=1280x1024",
                             value);
  }
  request->width_px = pair[0];
  request->height_px = pair[1];
  return PLACIDO_OK;
}

static int read_offset(placido_u3v_request *request, const char *value, placido_error *err) {
  int pair[2];
  if (!read_pair(pair, value, ',')) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "offset=%s is not X,Y in pixels, such as offset=320,272", value);
  }
  request->offset_x_px = pair[0];
  request->offset_y_px = pair[1];
  return PLACIDO_OK;
}

static int read_format(placido_u3v_request *request, const char *value, placido_error *err) {
  request->format = placido_pixel_by_name(value);
  if (request->format) {
    return PLACIDO_OK;
  }
  char names[400] = "";
  size_t count, length = 0;
  const placido_pixel_format *formats = placido_pixel_table(&count);
  for (size_t i = 0; i < count && length < sizeof names - 32; i++) {
    length += (size_t)snprintf(names + length, sizeof names - length, " %s", formats[i].name);
  }
  return placido_error_set(err, PLACIDO_INPUT, "format=%s is not one of%s", value, names);
}

static int read_rate(placido_u3v_request *request, const char *value, placido_error *err) {
  char *end;
  request->rate_hz = strtod(value, &end);
  if (end == value || *end || !(request->rate_hz > 0 && request->rate_hz <= RATE_MAX_HZ)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "fps=%s is not a number of frames per second up to %d", value,
                             RATE_MAX_HZ);
  }
  return PLACIDO_OK;
}

static int read_buffers(placido_u3v_request *request, const char *value, placido_error *err) {
  const size_t digits = strspn(value, "0123456789");
  request->buffers = digits >= 1 && digits <= 2 && !value[digits] ? atoi(value) : 0;
  if (request->buffers < 2 || request->buffers > PLACIDO_U3V_BUFFERS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "buffers=%s is not a number from 2 to %d", value,
                             PLACIDO_U3V_BUFFERS_MAX);
  }
  return PLACIDO_OK;
}

/* In the order of placido_u3v_options. */
static int (*const readers[])(placido_u3v_request *request, const char *value,
                              placido_error *err) = {read_size, read_offset, read_format,
                                                     read_rate, read_buffers};

/* One "NAME=VALUE" of `length` characters. */
static int read_setting(placido_u3v_request *request, const char *setting, size_t length,
                        placido_error *err) {
  char text[64] = "";
  const char *equals = memchr(setting, '=', length);
  const size_t name = equals ? (size_t)(equals - setting) : 0;
  for (size_t i = 0; equals && placido_u3v_options[i]; i++) {
    if (name != strlen(placido_u3v_options[i]) ||
        strncmp(setting, placido_u3v_options[i], name) != 0) {
      continue;
    }
    if (length - name - 1 >= sizeof text) {
      return placido_error_set(err, PLACIDO_INPUT, "\"%.60s...\" in the address is too long",
                               setting);
    }
    memcpy(text, equals + 1, length - name - 1);
    return readers[i](request, text, err);
  }
  return PLACIDO_OK;
}

int placido_u3v_request_read(placido_u3v_request *request, const char *query,
                             placido_error *err) {
  *request =
      (placido_u3v_request){.offset_x_px = -1, .offset_y_px = -1, .buffers = BUFFERS_USUAL};
  int status = PLACIDO_OK;
  while (!status && query && *query) {
    const size_t length = strcspn(query, "&");
    status = read_setting(request, query, length, err);
    query += length + (query[length] == '&');
  }
  return status;
}

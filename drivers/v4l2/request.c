/* What a device's address asks of a camera: one row for each setting. */
#include "drivers/v4l2/request.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BUFFERS_USUAL 4

const char *const placido_v4l2_options[] = {"size", "format", "fps", "buffers", NULL};

/* A whole number of at most five digits, and nothing else up to `stop`. */
static const char *read_whole(int *value, const char *text, char stop) {
  const size_t digits = strspn(text, "0123456789");
  *value = digits >= 1 && digits <= 5 ? atoi(text) : 0;
  return *value > 0 && text[digits] == stop ? text + digits : NULL;
}

static int read_size(placido_v4l2_request *request, const char *value, placido_error *err) {
  int width_px, height_px;
  const char *times = read_whole(&width_px, value, 'x');
  if (!times || !read_whole(&height_px, times + 1, '\0') ||
      width_px > PLACIDO_V4L2_SIDE_MAX_PX || height_px > PLACIDO_V4L2_SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "size=%s is not WIDTHxHEIGHT in pixels, such as size=1280x1024",
                             value);
  }
  request->width_px = width_px;
  request->height_px = height_px;
  return PLACIDO_OK;
}

static int read_format(placido_v4l2_request *request, const char *value, placido_error *err) {
  request->format = placido_v4l2_format_named(value);
  if (request->format) {
    return PLACIDO_OK;
  }
  char names[400] = "";
  size_t count, length = 0;
  const placido_v4l2_format *formats = placido_v4l2_formats(&count);
  for (size_t i = 0; i < count && length < sizeof names - 16; i++) {
    length += (size_t)snprintf(names + length, sizeof names - length, " %s", formats[i].name);
  }
  return placido_error_set(err, PLACIDO_INPUT, "format=%s is not one of%s", value, names);
}

static int read_rate(placido_v4l2_request *request, const char *value, placido_error *err) {
  char *end;
  request->rate_hz = strtod(value, &end);
  if (end == value || *end ||
      !(request->rate_hz > 0 && request->rate_hz <= PLACIDO_V4L2_RATE_MAX_HZ)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "fps=%s is not a number of frames per second up to %d", value,
                             PLACIDO_V4L2_RATE_MAX_HZ);
  }
  return PLACIDO_OK;
}

static int read_buffers(placido_v4l2_request *request, const char *value, placido_error *err) {
  if (!read_whole(&request->buffers, value, '\0') || request->buffers < 2 ||
      request->buffers > PLACIDO_V4L2_BUFFERS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "buffers=%s is not a number from 2 to %d", value,
                             PLACIDO_V4L2_BUFFERS_MAX);
  }
  return PLACIDO_OK;
}

/* In the order of placido_v4l2_options. */
static int (*const readers[])(placido_v4l2_request *request, const char *value,
                              placido_error *err) = {read_size, read_format, read_rate,
                                                     read_buffers};

/* One "NAME=VALUE". */
static int read_setting(placido_v4l2_request *request, const char *setting, size_t length,
                        placido_error *err) {
  char text[64] = "";
  const char *equals = memchr(setting, '=', length);
  for (size_t i = 0; equals && placido_v4l2_options[i]; i++) {
    const size_t name = strlen(placido_v4l2_options[i]);
    if (name != (size_t)(equals - setting) ||
        strncmp(setting, placido_v4l2_options[i], name) != 0) {
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

int placido_v4l2_request_read(placido_v4l2_request *request, const char *query,
                              placido_error *err) {
  *request = (placido_v4l2_request){.buffers = BUFFERS_USUAL};
  int status = PLACIDO_OK;
  while (!status && query && *query) {
    const size_t length = strcspn(query, "&");
    status = read_setting(request, query, length, err);
    query += length + (query[length] == '&');
  }
  return status;
}

/* What a device's address asks of a camera: one row for each setting. */
#include "drivers/v4l2/request.h"

#include "drivers/settings.h"

#include <stdio.h>

#define BUFFERS_USUAL 4

const char *const placido_v4l2_options[] = {"size", "format", "fps", "buffers", NULL};

static int read_size(placido_v4l2_request *request, const char *value, placido_error *err) {
  return placido_setting_read_size(&request->width_px, &request->height_px,
                                   PLACIDO_V4L2_SIDE_MAX_PX, value, err);
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
  return placido_setting_read_rate(&request->rate_hz, value, err);
}

static int read_buffers(placido_v4l2_request *request, const char *value, placido_error *err) {
  return placido_setting_read_whole(&request->buffers, "buffers", 2, PLACIDO_V4L2_BUFFERS_MAX,
                                    value, err);
}

/* In the order of placido_v4l2_options. */
static int (*const readers[])(placido_v4l2_request *request, const char *value,
                              placido_error *err) = {read_size, read_format, read_rate,
                                                     read_buffers};

static int read_option(void *target, size_t option, const char *value, placido_error *err) {
  return readers[option](target, value, err);
}

int placido_v4l2_request_read(placido_v4l2_request *request, const char *query,
                              placido_error *err) {
  *request = (placido_v4l2_request){.buffers = BUFFERS_USUAL};
  const placido_settings settings = {
      .names = placido_v4l2_options, .longest = 63, .read = read_option};
  return placido_settings_read(&settings, request, query, err);
}

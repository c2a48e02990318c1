/* What a device's address asks of a camera: one row for each setting. */
#include "drivers/u3v/request.h"

#include "drivers/settings.h"

#include <stdio.h>

#define BUFFERS_USUAL 4

const char *const placido_u3v_options[] = {"size", "offset", "format", "fps", "buffers", NULL};

static int read_size(placido_u3v_request *request, const char *value, placido_error *err) {
  return placido_setting_read_size(&request->width_px, &request->height_px,
                                   PLACIDO_U3V_SIDE_MAX_PX, value, err);
}

static int read_offset(placido_u3v_request *request, const char *value, placido_error *err) {
  int pair[2];
  if (!placido_setting_read_pair(pair, value, ',')) {
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
  return placido_setting_read_rate(&request->rate_hz, value, err);
}

static int read_buffers(placido_u3v_request *request, const char *value, placido_error *err) {
  return placido_setting_read_whole(&request->buffers, "buffers", 2, PLACIDO_U3V_BUFFERS_MAX, value,
                                    err);
}

/* In the order of placido_u3v_options. */
static int (*const readers[])(placido_u3v_request *request, const char *value,
                              placido_error *err) = {read_size, read_offset, read_format,
                                                     read_rate, read_buffers};

static int read_option(void *target, size_t option, const char *value, placido_error *err) {
  return readers[option](target, value, err);
}

int placido_u3v_request_read(placido_u3v_request *request, const char *query,
                             placido_error *err) {
  *request =
      (placido_u3v_request){.offset_x_px = -1, .offset_y_px = -1, .buffers = BUFFERS_USUAL};
  const placido_settings settings = {
      .names = placido_u3v_options, .longest = 63, .read = read_option};
  return placido_settings_read(&settings, request, query, err);
}

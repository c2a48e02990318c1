/* Size and pixel format: the choice among what a camera offers.
 *
 * A camera's limits move with its other settings, so the offsets go to 0 before the size is set,
 * and every value is read back. */
#include "drivers/u3v/mode.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a camera's list of pixel formats comes to. */
struct choice {
  const placido_pixel_format *wanted, *best;
  bool has_wanted;
  char offered[300]; /* for the sentence that none of them will do */
};

/* An entry's format: by its value, which is the code, or by its name. */
static const placido_pixel_format *format_of(const char *entry, int64_t value) {
  const placido_pixel_format *format =
      value > 0 && value <= UINT32_MAX ? placido_pixel_by_code((uint32_t)value) : NULL;
  return format ? format : placido_pixel_by_name(entry);
}

static int weigh_format(void *user, const char *entry, int64_t value) {
  struct choice *choice = user;
  const placido_pixel_format *format = format_of(entry, value);
  const size_t length = strlen(choice->offered);
  snprintf(choice->offered + length, sizeof choice->offered - length, " %.40s", entry);
  choice->has_wanted = choice->has_wanted || (format && format == choice->wanted);
  /* Rows of one table: the earlier is the better. */
  if (format && (!choice->best || format < choice->best)) {
    choice->best = format;
  }
  return 0;
}

struct name_of {
  const placido_pixel_format *format;
  char name[64];
};

static int keep_name(void *user, const char *entry, int64_t value) {
  struct name_of *search = user;
  if (format_of(entry, value) != search->format) {
    return 0;
  }
  snprintf(search->name, sizeof search->name, "%s", entry);
  return 1;
}

/* Sets the format by the name that this camera has for it. */
static int apply_format(placido_genicam *features, const placido_pixel_format *format,
                        placido_error *err) {
  struct name_of search = {.format = format};
  const int status = placido_genicam_entries(features, "PixelFormat", keep_name, &search, err);
  return status < 0 ? status
                    : placido_genicam_set_text(features, "PixelFormat", search.name, err);
}

/* What the camera is set to now. */
static int read_format(const placido_pixel_format **format, placido_genicam *features,
                       placido_error *err) {
  int64_t code;
  char name[64];
  int status = placido_genicam_get_integer(features, "PixelFormat", &code, err);
  if (!status) {
    status = placido_genicam_get_text(features, "PixelFormat", name, sizeof name, err);
  }
  *format = status ? NULL : format_of(name, code);
  if (!status && !*format) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the camera gives %.40s, which cannot be made into frames", name);
  }
  return status;
}

static int set_format(placido_u3v_mode *mode, placido_genicam *features,
                      const placido_u3v_request *request, placido_notes *notes,
                      placido_error *err) {
  struct choice choice = {.wanted = request->format};
  placido_feature feature;
  int status = placido_genicam_describe(features, "PixelFormat", &feature, err);
  if (!status) {
    status = placido_genicam_entries(features, "PixelFormat", weigh_format, &choice, err);
  }
  if (status) {
    return status;
  }
  if (feature.can_write) {
    if (!choice.best) {
      return placido_error_set(err, PLACIDO_UNSUPPORTED,
                               "none of the camera's formats can be made into frames:%s",
                               choice.offered);
    }
    status = apply_format(features, choice.has_wanted ? choice.wanted : choice.best, err);
  }
  if (!status) {
    status = read_format(&mode->format, features, err);
  }
  if (!status && request->format && mode->format != request->format) {
    placido_notes_add(notes, "the camera gives %s, not %s as asked", mode->format->name,
                      request->format->name);
  }
  return status;
}

/* Sets a whole number as near to `wanted` as the camera can, where it can be set at all. */
static int set_near(placido_genicam *features, const char *name, double wanted,
                    placido_error *err) {
  placido_feature feature;
  const int status = placido_genicam_describe(features, name, &feature, err);
  if (status || !feature.can_write) {
    return status;
  }
  const double step = feature.step >= 1 ? feature.step : 1;
  double value = feature.min + round((wanted - feature.min) / step) * step;
  value = value > feature.max ? value - step * ceil((value - feature.max) / step) : value;
  value = value < feature.min ? feature.min : value;
  if (!(fabs(value) < 1e9)) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera's limits of %s are absurd", name);
  }
  return placido_genicam_set_integer(features, name, (int64_t)value, err);
}

/* A whole number from `min` to PLACIDO_U3V_SIDE_MAX_PX; `min` where the camera lacks it. */
static int read_px(int *value, placido_genicam *features, const char *name, int min,
                   placido_error *err) {
  placido_feature feature;
  int64_t said;
  *value = min;
  int status = placido_genicam_describe(features, name, &feature, err);
  if (status || (feature.kind == PLACIDO_FEATURE_NONE && min == 0)) {
    return status;
  }
  status = placido_genicam_get_integer(features, name, &said, err);
  if (!status && (said < min || said > PLACIDO_U3V_SIDE_MAX_PX)) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera says its %s is %lld pixels", name,
                             (long long)said);
  }
  *value = status ? min : (int)said;
  return status;
}

static int read_size(placido_u3v_mode *mode, placido_genicam *features, placido_error *err) {
  const struct {
    const char *name;
    int *value, min;
  } sides[] = {{"Width", &mode->width_px, 1},
               {"Height", &mode->height_px, 1},
               {"OffsetX", &mode->offset_x_px, 0},
               {"OffsetY", &mode->offset_y_px, 0}};
  int status = PLACIDO_OK;
  for (size_t i = 0; !status && i < sizeof sides / sizeof *sides; i++) {
    status = read_px(sides[i].value, features, sides[i].name, sides[i].min, err);
  }
  return status;
}

/* Sets an offset, or the middle of the room that the size leaves where `wanted` is -1. */
static int set_offset(placido_genicam *features, const char *name, int wanted,
                      placido_error *err) {
  placido_feature feature;
  const int status = placido_genicam_describe(features, name, &feature, err);
  if (status || feature.kind == PLACIDO_FEATURE_NONE) {
    return status;
  }
  /* Half the room, down to a whole step, so that a mosaic keeps its order of colours. */
  const double step = feature.step >= 1 ? feature.step : 1;
  return set_near(features, name, wanted >= 0 ? wanted : floor(feature.max / 2 / step) * step,
                  err);
}

static int set_size(placido_genicam *features, const placido_u3v_request *request,
                    placido_error *err) {
  int status = PLACIDO_OK;
  if (request->width_px > 0) {
    status = set_near(features, "OffsetX", 0, err);
    status = status ? status : set_near(features, "OffsetY", 0, err);
    status = status ? status : set_near(features, "Width", request->width_px, err);
    status = status ? status : set_near(features, "Height", request->height_px, err);
  }
  if (!status && (request->width_px > 0 || request->offset_x_px >= 0)) {
    status = set_offset(features, "OffsetX", request->offset_x_px, err);
    status = status ? status : set_offset(features, "OffsetY", request->offset_y_px, err);
  }
  return status;
}

static void note_size(const placido_u3v_mode *mode, const placido_u3v_request *request,
                      placido_notes *notes) {
  if (request->width_px > 0 &&
      (mode->width_px != request->width_px || mode->height_px != request->height_px)) {
    placido_notes_add(notes, "the camera gives %d x %d pixels, not %d x %d as asked",
                      mode->width_px, mode->height_px, request->width_px, request->height_px);
  }
  if (request->offset_x_px >= 0 && (mode->offset_x_px != request->offset_x_px ||
                                    mode->offset_y_px != request->offset_y_px)) {
    placido_notes_add(notes, "the camera's pictures begin at pixel %d, %d, not %d, %d as asked",
                      mode->offset_x_px, mode->offset_y_px, request->offset_x_px,
                      request->offset_y_px);
  }
}

/* Pictures without end, where the camera knows other ways too. */
static int set_continuous(placido_genicam *features, placido_error *err) {
  placido_feature feature;
  const int status = placido_genicam_describe(features, "AcquisitionMode", &feature, err);
  if (status || !feature.can_write || feature.kind != PLACIDO_FEATURE_ENUMERATION) {
    return status;
  }
  return placido_genicam_set_text(features, "AcquisitionMode", "Continuous", err);
}

int placido_u3v_mode_set(placido_u3v_mode *mode, placido_genicam *features,
                         const placido_u3v_request *request, placido_notes *notes,
                         placido_error *err) {
  *mode = (placido_u3v_mode){0};
  int status = set_format(mode, features, request, notes, err);
  status = status ? status : set_size(features, request, err);
  status = status ? status : read_size(mode, features, err);
  status = status ? status : set_continuous(features, err);
  if (status) {
    return status;
  }
  note_size(mode, request, notes);
  const int row_bits = mode->format->bits_per_pixel * mode->width_px;
  if (mode->format->packing != PLACIDO_PIXEL_PLAIN && row_bits % 8 != 0) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "%d pixels of %s do not end at a byte: choose another width",
                             mode->width_px, mode->format->name);
  }
  return PLACIDO_OK;
}

/* Who wants to hear of modes; what all have in common. */
struct chooser {
  int (*each)(void *user, const placido_device_mode *mode);
  void *user;
  placido_device_mode mode;
};

static int tell_format(void *user, const char *entry, int64_t value) {
  struct chooser *chooser = user;
  snprintf(chooser->mode.format, sizeof chooser->mode.format, "%s", entry);
  chooser->mode.is_readable = format_of(entry, value) != NULL;
  return chooser->each(chooser->user, &chooser->mode);
}

/* The range of a side. The offset, as it is set now, takes from the most. */
static int read_range(int range[3], placido_genicam *features, const char *side,
                      const char *offset, placido_error *err) {
  placido_feature feature;
  int now_px, offset_px;
  int status = placido_genicam_describe(features, side, &feature, err);
  status = status ? status : read_px(&now_px, features, side, 1, err);
  status = status ? status : read_px(&offset_px, features, offset, 0, err);
  if (status) {
    return status;
  }
  const bool is_range = feature.min >= 1 && feature.max <= PLACIDO_U3V_SIDE_MAX_PX &&
                        feature.min < feature.max;
  range[0] = is_range ? (int)feature.min : now_px;
  range[1] = is_range ? (int)feature.max + offset_px : now_px;
  range[2] = is_range ? (int)fmin(fmax(feature.step, 1), feature.max) : 0;
  return PLACIDO_OK;
}

int placido_u3v_modes(placido_genicam *features, const double rates_hz[2],
                      int (*each)(void *user, const placido_device_mode *mode), void *user,
                      placido_error *err) {
  struct chooser chooser = {.each = each, .user = user};
  placido_device_mode *mode = &chooser.mode;
  int width[3], height[3];
  int status = read_range(width, features, "Width", "OffsetX", err);
  status = status ? status : read_range(height, features, "Height", "OffsetY", err);
  if (status) {
    return status;
  }
  *mode = (placido_device_mode){.width_min_px = width[0],
                                .width_max_px = width[1],
                                .width_step_px = width[2],
                                .height_min_px = height[0],
                                .height_max_px = height[1],
                                .height_step_px = height[2],
                                .rate_count = rates_hz[1] > 0 ? 2 : 0,
                                .rates_hz = {rates_hz[0], rates_hz[1]},
                                .any_rate = true};
  return placido_genicam_entries(features, "PixelFormat", tell_format, &chooser, err);
}

size_t placido_u3v_mode_row_bytes(const placido_u3v_mode *mode) {
  return placido_pixel_row_bytes(mode->format, mode->width_px);
}

size_t placido_u3v_mode_bytes(const placido_u3v_mode *mode) {
  return placido_u3v_mode_row_bytes(mode) * (size_t)mode->height_px;
}

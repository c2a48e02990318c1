/* Requests to the simulated UVC camera (UVC 1.1, chapter 4): its units' controls, probe and commit,
 * and why a request was refused. */
#include "gadget/uvc_controls.h"

#include "drivers/u3v/wire/bytes.h"

#include <linux/usb/video.h>
#include <string.h>

#define CLASS_SET 0x21 /* request types: to an interface, from one */
#define CLASS_GET 0xa1

#define VALUE_BYTES_MAX 4
#define PROBE_BYTES 34

/* Reasons of a refusal (section 4.2.1.2). */
enum refusal {
  NO_REFUSAL = 0,
  OUT_OF_RANGE = 4,
  INVALID_UNIT = 5,
  INVALID_CONTROL = 6,
  INVALID_REQUEST = 7,
  INVALID_VALUE = 8,
};

/* The auto exposure modes are bits; a camera that measures has one of them. */
#define MANUAL 1

/* In the order of enum placido_uvc_value. A bit map has no range; its resolution is the bits that
 * may be set, one at a time. */
static const struct value {
  uint8_t unit, selector, size;
  bool is_bitmap;
  int32_t min, max, resolution, usual;
} table[PLACIDO_UVC_VALUES] = {
    {PLACIDO_UVC_CAMERA, UVC_CT_AE_MODE_CONTROL, 1, true, 0, 0, MANUAL, MANUAL},
    {PLACIDO_UVC_CAMERA, UVC_CT_EXPOSURE_TIME_ABSOLUTE_CONTROL, 4, false, 1, 10000, 1,
     PLACIDO_UVC_EXPOSURE_USUAL},
    {PLACIDO_UVC_PROCESSING, UVC_PU_BRIGHTNESS_CONTROL, 2, false, -128, 127, 1, 0},
    {PLACIDO_UVC_PROCESSING, UVC_PU_GAIN_CONTROL, 2, false, 0, 255, 1, 16},
};

/* A request with what answers it. */
struct request {
  const placido_gadget_setup *setup;
  uint8_t *data;
  size_t *size; /* sent, or room for the answer */
};

static bool is_set(const struct request *request) {
  return request->setup->request == UVC_SET_CUR;
}

/* As much of an answer as was asked for: a longer one is cut (section 4.1.2). */
static enum refusal give(const struct request *request, const uint8_t *bytes, size_t size) {
  *request->size = size < *request->size ? size : *request->size;
  memcpy(request->data, bytes, *request->size);
  return NO_REFUSAL;
}

static enum refusal give_number(const struct request *request, uint32_t number, size_t size) {
  uint8_t bytes[VALUE_BYTES_MAX];
  placido_write_u32(bytes, number);
  return give(request, bytes, size);
}

static bool has_length(const struct request *request, size_t size) {
  return *request->size == size && request->setup->length == size;
}

/* A number of two bytes has a sign; one of four, the exposure, has none, but its range ends far
 * below where that would matter. */
static int32_t number_of(const uint8_t *data, size_t size) {
  if (size == 1) {
    return data[0];
  }
  if (size == 2) {
    return (int16_t)placido_read_u16(data);
  }
  const uint32_t number = placido_read_u32(data);
  return number > INT32_MAX ? INT32_MAX : (int32_t)number;
}

static enum refusal set_value(placido_uvc_controls *controls, enum placido_uvc_value which,
                              const struct request *request) {
  const struct value *value = &table[which];
  if (!has_length(request, value->size)) {
    return INVALID_REQUEST;
  }
  const int32_t number = number_of(request->data, value->size);
  if (value->is_bitmap && (!number || (number & (number - 1)) || (number & ~value->resolution))) {
    return INVALID_VALUE;
  }
  if (!value->is_bitmap && (number < value->min || number > value->max)) {
    return OUT_OF_RANGE;
  }
  controls->values[which] = number;
  return NO_REFUSAL;
}

static enum refusal give_value(const placido_uvc_controls *controls, enum placido_uvc_value which,
                               const struct request *request) {
  const struct value *value = &table[which];
  const struct {
    uint8_t request;
    uint32_t number;
    size_t size;
  } answers[] = {
      {UVC_GET_CUR, (uint32_t)controls->values[which], value->size},
      {UVC_GET_MIN, (uint32_t)value->min, value->size},
      {UVC_GET_MAX, (uint32_t)value->max, value->size},
      {UVC_GET_RES, (uint32_t)value->resolution, value->size},
      {UVC_GET_DEF, (uint32_t)value->usual, value->size},
      {UVC_GET_LEN, value->size, 2},
      {UVC_GET_INFO, UVC_CONTROL_CAP_GET | UVC_CONTROL_CAP_SET, 1},
  };
  const uint8_t asked = request->setup->request;
  for (size_t i = 0; i < sizeof answers / sizeof answers[0]; i++) {
    const bool is_end = answers[i].request == UVC_GET_MIN || answers[i].request == UVC_GET_MAX;
    if (answers[i].request == asked && !(is_end && value->is_bitmap)) {
      return give_number(request, answers[i].number, answers[i].size);
    }
  }
  return INVALID_REQUEST;
}

/* A number that is only read: its value, length (1) and abilities. */
static enum refusal give_reason(const struct request *request, uint8_t reason) {
  switch (request->setup->request) {
  case UVC_GET_CUR:
    return give_number(request, reason, 1);
  case UVC_GET_LEN:
    return give_number(request, 1, 2);
  case UVC_GET_INFO:
    return give_number(request, UVC_CONTROL_CAP_GET, 1);
  default:
    return INVALID_REQUEST;
  }
}

static enum refusal ask_unit(placido_uvc_controls *controls, const struct request *request) {
  const uint8_t unit = (uint8_t)(request->setup->index >> 8);
  const uint8_t selector = (uint8_t)(request->setup->value >> 8);
  if (unit == 0) {
    return selector == UVC_VC_REQUEST_ERROR_CODE_CONTROL
               ? give_reason(request, controls->request_error)
               : INVALID_CONTROL;
  }
  for (int i = 0; i < PLACIDO_UVC_VALUES; i++) {
    const enum placido_uvc_value which = (enum placido_uvc_value)i;
    if (table[i].unit == unit && table[i].selector == selector) {
      return is_set(request) ? set_value(controls, which, request)
                             : give_value(controls, which, request);
    }
  }
  return unit <= PLACIDO_UVC_OUTPUT ? INVALID_CONTROL : INVALID_UNIT;
}

/* The probe and commit block (section 4.3.1.1). What compressed formats need stays 0, as do the
 * versions of payloads, which uncompressed ones have none of. */
static void encode(uint8_t block[PROBE_BYTES], const placido_uvc_modes *modes,
                   const placido_uvc_choice *choice) {
  memset(block, 0, PROBE_BYTES);
  placido_write_u16(block, choice->hint);
  block[2] = (uint8_t)(choice->format + 1);
  block[3] = (uint8_t)(choice->size + 1);
  placido_write_u32(block + 4, choice->interval);
  placido_write_u32(block + 18,
                    placido_uvc_picture_bytes(modes, choice->format, choice->size));
  placido_write_u32(block + 22, modes->payload_bytes);
  placido_write_u32(block + 26, PLACIDO_UVC_CLOCK_HZ);
  block[30] = 3; /* headers tell the pictures apart, and where each ends */
}

static uint32_t usual_interval(const placido_uvc_intervals *intervals) {
  return intervals->at[intervals->usual];
}

/* 0 stands for the usual one. */
static uint32_t nearest_interval(const placido_uvc_intervals *intervals, uint32_t wanted) {
  uint32_t nearest = usual_interval(intervals);
  for (int i = 0; wanted && i < intervals->count; i++) {
    const int64_t off = (int64_t)intervals->at[i] - wanted, least = (int64_t)nearest - wanted;
    if ((off < 0 ? -off : off) < (least < 0 ? -least : least)) {
      nearest = intervals->at[i];
    }
  }
  return nearest;
}

/* What the camera can do of what is wanted: the first format or size for one that it does not
 * have, the nearest interval. */
static placido_uvc_choice correct(const placido_uvc_modes *modes,
                                  const uint8_t block[PROBE_BYTES]) {
  const uint32_t format = block[2] - 1u, size = block[3] - 1u;
  placido_uvc_choice choice = {
      .format = format < PLACIDO_UVC_FORMATS ? (enum placido_uvc_format)format : PLACIDO_UVC_GREY,
      .size = size < (uint32_t)modes->size_count ? (int)size : 0,
      .hint = (uint16_t)(placido_read_u16(block) & 0x1f)};
  choice.interval = nearest_interval(&modes->intervals[choice.format][choice.size],
                                     placido_read_u32(block + 4));
  return choice;
}

/* The least, the most, and what the camera begins with. */
static placido_uvc_choice bound(const placido_uvc_modes *modes, uint8_t request) {
  placido_uvc_choice choice = {.format = PLACIDO_UVC_GREY};
  if (request == UVC_GET_MAX) {
    choice.format = PLACIDO_UVC_YUY2;
    choice.size = modes->size_count - 1;
  }
  const placido_uvc_intervals *intervals = &modes->intervals[choice.format][choice.size];
  choice.interval = request == UVC_GET_DEF   ? usual_interval(intervals)
                    : request == UVC_GET_MIN ? intervals->at[0]
                                             : intervals->at[intervals->count - 1];
  return choice;
}

static enum refusal give_choice(const placido_uvc_controls *controls,
                                const struct request *request,
                                const placido_uvc_choice *choice) {
  uint8_t block[PROBE_BYTES];
  encode(block, controls->modes, choice);
  return give(request, block, sizeof block);
}

/* A commit must be what a probe said; nothing is corrected any more. */
static enum refusal commit(placido_uvc_controls *controls, const uint8_t wanted[PROBE_BYTES]) {
  const placido_uvc_choice choice = correct(controls->modes, wanted);
  uint8_t able[PROBE_BYTES];
  encode(able, controls->modes, &choice);
  if (memcmp(able + 2, wanted + 2, 6) != 0 || memcmp(able + 18, wanted + 18, 8) != 0) {
    return OUT_OF_RANGE;
  }
  controls->committed = choice;
  controls->is_commit_new = true;
  return NO_REFUSAL;
}

static enum refusal ask_probe(placido_uvc_controls *controls, const struct request *request,
                              bool is_commit) {
  static const uint8_t changeable[PROBE_BYTES] = {[2] = 1, [3] = 1}; /* in steps of one */
  const uint8_t asked = request->setup->request;
  if (asked == UVC_SET_CUR) {
    if (!has_length(request, PROBE_BYTES)) {
      return INVALID_REQUEST;
    }
    if (is_commit) {
      return commit(controls, request->data);
    }
    controls->probed = correct(controls->modes, request->data);
    return NO_REFUSAL;
  }
  if (asked == UVC_GET_CUR) {
    return give_choice(controls, request, is_commit ? &controls->committed : &controls->probed);
  }
  if (asked == UVC_GET_LEN) {
    return give_number(request, PROBE_BYTES, 2);
  }
  if (asked == UVC_GET_INFO) {
    return give_number(request, UVC_CONTROL_CAP_GET | UVC_CONTROL_CAP_SET, 1);
  }
  if (asked == UVC_GET_RES && !is_commit) {
    return give(request, changeable, sizeof changeable);
  }
  if ((asked == UVC_GET_MIN || asked == UVC_GET_MAX || asked == UVC_GET_DEF) && !is_commit) {
    const placido_uvc_choice choice = bound(controls->modes, asked);
    return give_choice(controls, request, &choice);
  }
  return INVALID_REQUEST;
}

static enum refusal ask_stream(placido_uvc_controls *controls, const struct request *request) {
  const uint8_t selector = (uint8_t)(request->setup->value >> 8);
  if (request->setup->index >> 8) {
    return INVALID_UNIT; /* a streaming interface has none */
  }
  switch (selector) {
  case UVC_VS_PROBE_CONTROL:
  case UVC_VS_COMMIT_CONTROL:
    return ask_probe(controls, request, selector == UVC_VS_COMMIT_CONTROL);
  case UVC_VS_STREAM_ERROR_CODE_CONTROL:
    return give_reason(request, controls->stream_error);
  default:
    return INVALID_CONTROL;
  }
}

static enum refusal ask(placido_uvc_controls *controls, const struct request *request) {
  const placido_gadget_setup *setup = request->setup;
  if (setup->request_type != (is_set(request) ? CLASS_SET : CLASS_GET)) {
    return INVALID_REQUEST;
  }
  switch (setup->index & 0xff) {
  case PLACIDO_UVC_CONTROL_INTERFACE:
    return ask_unit(controls, request);
  case PLACIDO_UVC_STREAM_INTERFACE:
    return ask_stream(controls, request);
  default:
    return INVALID_UNIT;
  }
}

/* Who asks for the reason of a refusal must not wipe it out by asking. */
static bool asks_for_reason(const placido_gadget_setup *setup) {
  return setup->request_type == CLASS_GET && setup->index == PLACIDO_UVC_CONTROL_INTERFACE &&
         setup->value >> 8 == UVC_VC_REQUEST_ERROR_CODE_CONTROL;
}

enum placido_gadget_answer placido_uvc_control(placido_uvc_controls *controls,
                                               const placido_gadget_setup *setup, uint8_t *data,
                                               size_t *size) {
  const struct request request = {setup, data, size};
  const enum refusal refusal = ask(controls, &request);
  if (refusal || !asks_for_reason(setup)) {
    controls->request_error = (uint8_t)refusal;
  }
  if (refusal) {
    *size = 0;
    return PLACIDO_GADGET_STALL;
  }
  return PLACIDO_GADGET_DONE;
}

void placido_uvc_controls_make(placido_uvc_controls *controls, const placido_uvc_modes *modes) {
  const placido_uvc_choice usual = bound(modes, UVC_GET_DEF);
  *controls = (placido_uvc_controls){.modes = modes, .probed = usual, .committed = usual};
  for (int i = 0; i < PLACIDO_UVC_VALUES; i++) {
    controls->values[i] = table[i].usual;
  }
}

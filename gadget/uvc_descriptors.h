/* What the simulated UVC camera offers, and how it says so in descriptors. */
#ifndef PLACIDO_GADGET_UVC_DESCRIPTORS_H
#define PLACIDO_GADGET_UVC_DESCRIPTORS_H

#include "gadget/function.h"
#include "gadget/strings.h"

#include <stdbool.h>

enum placido_uvc_format { PLACIDO_UVC_GREY, PLACIDO_UVC_YUY2, PLACIDO_UVC_FORMATS };

/* Numbers of interfaces, and of the terminals and units within the first. */
enum { PLACIDO_UVC_CONTROL_INTERFACE, PLACIDO_UVC_STREAM_INTERFACE };
enum { PLACIDO_UVC_CAMERA = 1, PLACIDO_UVC_PROCESSING, PLACIDO_UVC_OUTPUT };

#define PLACIDO_UVC_SIZES_MAX 3
#define PLACIDO_UVC_INTERVALS_MAX 7
#define PLACIDO_UVC_CLOCK_HZ 1000000u

typedef struct placido_uvc_size {
  int width_px, height_px;
  bool is_binned; /* 2×2 pixels in one; else one to one, out of the middle */
} placido_uvc_size;

/* Units of 100 ns, ascending; `usual` is the place of the one the camera begins with. */
typedef struct placido_uvc_intervals {
  uint32_t at[PLACIDO_UVC_INTERVALS_MAX];
  int count, usual;
} placido_uvc_intervals;

/* Descriptors count formats and sizes from 1; here they count from 0. */
typedef struct placido_uvc_modes {
  placido_uvc_size sizes[PLACIDO_UVC_SIZES_MAX];
  int size_count;
  placido_uvc_intervals intervals[PLACIDO_UVC_FORMATS][PLACIDO_UVC_SIZES_MAX];
  uint32_t payload_bytes; /* the most of one payload with its header */
} placido_uvc_modes;

#define PLACIDO_UVC_STRINGS 4
#define PLACIDO_UVC_CONFIGURATION_MAX 640

typedef struct placido_uvc_descriptors {
  uint8_t device[18];
  uint8_t bos[22]; /* SuperSpeed only */
  bool has_bos;
  uint8_t strings[PLACIDO_UVC_STRINGS][PLACIDO_GADGET_STRING_BYTES_MAX];
  uint8_t configuration[PLACIDO_UVC_CONFIGURATION_MAX];
  size_t configuration_size;
} placido_uvc_descriptors;

#define PLACIDO_UVC_VENDOR_ID 0x1209 /* pid.codes, and of its test products one */
#define PLACIDO_UVC_PRODUCT_ID 0x0003

/* The modes of a camera that sees width × height pixels at rate_hz. */
void placido_uvc_modes_make(placido_uvc_modes *modes, int width_px, int height_px, double rate_hz,
                            enum placido_gadget_speed speed);

/* Bytes of one picture. */
uint32_t placido_uvc_picture_bytes(const placido_uvc_modes *modes, enum placido_uvc_format format,
                                   int size);

void placido_uvc_descriptors_make(placido_uvc_descriptors *descriptors,
                                  const placido_uvc_modes *modes, enum placido_gadget_speed speed,
                                  const char *serial);

/* As the table of gadget/function.h wants it. */
const uint8_t *placido_uvc_descriptor_get(const placido_uvc_descriptors *descriptors, uint8_t type,
                                          uint8_t index, size_t *size);

#endif

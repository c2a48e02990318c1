/* The modes of the simulated UVC camera and its descriptors: USB 3.2 chapter 9; UVC 1.1 chapter 3
 * and "Uncompressed Payload" chapter 3. */
#include "gadget/uvc_descriptors.h"

#include "gadget/uvc.h"

#include <linux/usb/ch9.h>
#include <linux/usb/video.h>
#include <math.h>
#include <string.h>

/* What bulk transfers carry in practice. */
#define HIGH_BYTES_PER_S 40e6
#define SUPER_BYTES_PER_S 400e6
/* The kernel's uvcvideo takes 32 packets in one transfer: so a payload is one transfer. */
#define PAYLOAD_PACKETS 32u

static const int bits_of_pixel[PLACIDO_UVC_FORMATS] = {8, 16};

static uint16_t packet_bytes(enum placido_gadget_speed speed) {
  return speed == PLACIDO_GADGET_SUPER ? 1024 : 512;
}

uint32_t placido_uvc_picture_bytes(const placido_uvc_modes *modes, enum placido_uvc_format format,
                                   int size) {
  const placido_uvc_size *of = &modes->sizes[size];
  return (uint32_t)(of->width_px * of->height_px * (bits_of_pixel[format] / 8));
}

/* Adds a size unless it is there. YUY2 takes pixels in pairs. */
static void add_size(placido_uvc_modes *modes, int width_px, int height_px, bool is_binned) {
  width_px &= ~1;
  for (int i = 0; i < modes->size_count; i++) {
    if (modes->sizes[i].width_px == width_px && modes->sizes[i].height_px == height_px) {
      return;
    }
  }
  modes->sizes[modes->size_count++] = (placido_uvc_size){width_px, height_px, is_binned};
}

/* Adds an interval in its place unless it is there. */
static void add_interval(placido_uvc_intervals *intervals, uint32_t interval) {
  int place = 0;
  while (place < intervals->count && intervals->at[place] < interval) {
    place++;
  }
  if (place < intervals->count && intervals->at[place] == interval) {
    return;
  }
  for (int i = intervals->count; i > place; i--) {
    intervals->at[i] = intervals->at[i - 1];
  }
  intervals->at[place] = interval;
  intervals->count++;
}

static void make_intervals(placido_uvc_intervals *intervals, uint32_t picture_bytes,
                           double rate_hz, double bytes_per_s) {
  const double rates_hz[PLACIDO_UVC_INTERVALS_MAX] = {rate_hz, 60, 30, 20, 15, 10, 5};
  *intervals = (placido_uvc_intervals){0};
  for (int i = 0; i < PLACIDO_UVC_INTERVALS_MAX; i++) {
    if (picture_bytes * rates_hz[i] <= bytes_per_s) {
      add_interval(intervals, (uint32_t)lround(1e7 / rates_hz[i]));
    }
  }
  if (intervals->count == 0) {
    add_interval(intervals, (uint32_t)ceil(picture_bytes * 1e7 / bytes_per_s));
  }
  while (intervals->usual + 1 < intervals->count &&
         intervals->at[intervals->usual] < lround(1e7 / rate_hz)) {
    intervals->usual++;
  }
}

void placido_uvc_modes_make(placido_uvc_modes *modes, int width_px, int height_px, double rate_hz,
                            enum placido_gadget_speed speed) {
  *modes = (placido_uvc_modes){.payload_bytes = PAYLOAD_PACKETS * packet_bytes(speed)};
  add_size(modes, width_px, height_px, false);
  add_size(modes, width_px / 2, height_px / 2, true);
  if (width_px >= 640 && height_px >= 480) {
    add_size(modes, 640, 480, false);
  }
  const double bytes_per_s = speed == PLACIDO_GADGET_SUPER ? SUPER_BYTES_PER_S : HIGH_BYTES_PER_S;
  for (int format = 0; format < PLACIDO_UVC_FORMATS; format++) {
    for (int size = 0; size < modes->size_count; size++) {
      make_intervals(&modes->intervals[format][size],
                     placido_uvc_picture_bytes(modes, (enum placido_uvc_format)format, size),
                     rate_hz, bytes_per_s);
    }
  }
}

/* Bytes being written one after the other. The longest configuration fits by the maxima above,
 * which a test shows. */
struct writer {
  uint8_t *bytes;
  size_t size;
};

static void put(struct writer *to, int count, uint32_t value) {
  for (int i = 0; i < count; i++) {
    to->bytes[to->size++] = (uint8_t)(value >> 8 * i);
  }
}

static void put_bytes(struct writer *to, const uint8_t *bytes, size_t size) {
  memcpy(to->bytes + to->size, bytes, size);
  to->size += size;
}

/* Fills in the total length two bytes long, of everything since `start`, at `place`. */
static void close_length(struct writer *to, size_t start, size_t place) {
  const size_t length = to->size - start;
  to->bytes[place] = (uint8_t)length;
  to->bytes[place + 1] = (uint8_t)(length >> 8);
}

static void put_control_interface(struct writer *to) {
  static const uint8_t interface[] = {
      9, USB_DT_INTERFACE, PLACIDO_UVC_CONTROL_INTERFACE, 0, 0, USB_CLASS_VIDEO,
      UVC_SC_VIDEOCONTROL, UVC_PC_PROTOCOL_UNDEFINED, 2};
  static const uint8_t units[] = {
      /* auto exposure mode (bit 1), exposure time absolute (bit 3) */
      18, USB_DT_CS_INTERFACE, UVC_VC_INPUT_TERMINAL, PLACIDO_UVC_CAMERA, UVC_ITT_CAMERA & 0xff,
      UVC_ITT_CAMERA >> 8, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0x0a, 0, 0,
      /* brightness (bit 0), gain (bit 9) */
      12, USB_DT_CS_INTERFACE, UVC_VC_PROCESSING_UNIT, PLACIDO_UVC_PROCESSING, PLACIDO_UVC_CAMERA,
      0, 0, 2, 0x01, 0x02, 0, 0,
      9, USB_DT_CS_INTERFACE, UVC_VC_OUTPUT_TERMINAL, PLACIDO_UVC_OUTPUT, UVC_TT_STREAMING & 0xff,
      UVC_TT_STREAMING >> 8, 0, PLACIDO_UVC_PROCESSING, 0};
  put_bytes(to, interface, sizeof interface);
  const size_t header = to->size;
  put(to, 1, 13);
  put(to, 1, USB_DT_CS_INTERFACE);
  put(to, 1, UVC_VC_HEADER);
  put(to, 2, 0x0110); /* UVC 1.1 */
  put(to, 2, 0);      /* total length: below */
  put(to, 4, PLACIDO_UVC_CLOCK_HZ);
  put(to, 1, 1); /* streaming interfaces, and which */
  put(to, 1, PLACIDO_UVC_STREAM_INTERFACE);
  put_bytes(to, units, sizeof units);
  close_length(to, header, header + 5);
}

static void put_frame(struct writer *to, const placido_uvc_modes *modes,
                      enum placido_uvc_format format, int size) {
  const placido_uvc_intervals *intervals = &modes->intervals[format][size];
  const uint32_t bytes = placido_uvc_picture_bytes(modes, format, size);
  const uint32_t slowest = intervals->at[intervals->count - 1];
  put(to, 1, 26u + 4u * (uint32_t)intervals->count);
  put(to, 1, USB_DT_CS_INTERFACE);
  put(to, 1, UVC_VS_FRAME_UNCOMPRESSED);
  put(to, 1, (uint32_t)size + 1);
  put(to, 1, 0); /* no still pictures */
  put(to, 2, (uint32_t)modes->sizes[size].width_px);
  put(to, 2, (uint32_t)modes->sizes[size].height_px);
  put(to, 4, (uint32_t)(bytes * 8.0 * 1e7 / slowest)); /* bit rates: least, most */
  put(to, 4, (uint32_t)(bytes * 8.0 * 1e7 / intervals->at[0]));
  put(to, 4, bytes);
  put(to, 4, intervals->at[intervals->usual]);
  put(to, 1, (uint32_t)intervals->count);
  for (int i = 0; i < intervals->count; i++) {
    put(to, 4, intervals->at[i]);
  }
}

static void put_format(struct writer *to, const placido_uvc_modes *modes,
                       enum placido_uvc_format format) {
  static const uint8_t guids[PLACIDO_UVC_FORMATS][16] = {
      {'Y', '8', '0', '0', 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71},
      {'Y', 'U', 'Y', '2', 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71}};
  /* sRGB's primaries, its transfer (that of BT.709), the luma of BT.601 */
  static const uint8_t colours[] = {6, USB_DT_CS_INTERFACE, UVC_VS_COLORFORMAT, 1, 1, 4};
  put(to, 1, 27);
  put(to, 1, USB_DT_CS_INTERFACE);
  put(to, 1, UVC_VS_FORMAT_UNCOMPRESSED);
  put(to, 1, (uint32_t)format + 1);
  put(to, 1, (uint32_t)modes->size_count);
  put_bytes(to, guids[format], sizeof guids[format]);
  put(to, 1, (uint32_t)bits_of_pixel[format]);
  put(to, 1, 1); /* the first size is the usual one */
  put(to, 4, 0); /* aspect ratio x, y; not interlaced; not copy-protected */
  for (int size = 0; size < modes->size_count; size++) {
    put_frame(to, modes, format, size);
  }
  put_bytes(to, colours, sizeof colours);
}

static void put_stream_interface(struct writer *to, const placido_uvc_modes *modes,
                                 enum placido_gadget_speed speed) {
  static const uint8_t interface[] = {
      9, USB_DT_INTERFACE, PLACIDO_UVC_STREAM_INTERFACE, 0, 1, USB_CLASS_VIDEO,
      UVC_SC_VIDEOSTREAMING, UVC_PC_PROTOCOL_UNDEFINED, 0};
  static const uint8_t companion[] = {6, USB_DT_SS_ENDPOINT_COMP, 15, 0, 0, 0}; /* bursts of 16 */
  put_bytes(to, interface, sizeof interface);
  const size_t header = to->size;
  put(to, 1, 13 + PLACIDO_UVC_FORMATS);
  put(to, 1, USB_DT_CS_INTERFACE);
  put(to, 1, UVC_VS_INPUT_HEADER);
  put(to, 1, PLACIDO_UVC_FORMATS);
  put(to, 2, 0); /* total length: below */
  put(to, 1, PLACIDO_UVC_STREAM_ENDPOINT);
  put(to, 1, 0); /* the format does not change by itself */
  put(to, 1, PLACIDO_UVC_OUTPUT);
  put(to, 3, 0); /* no still pictures, no trigger */
  put(to, 1, 1); /* a byte of controls for each format: none */
  put(to, PLACIDO_UVC_FORMATS, 0);
  for (int format = 0; format < PLACIDO_UVC_FORMATS; format++) {
    put_format(to, modes, (enum placido_uvc_format)format);
  }
  close_length(to, header, header + 4);
  put(to, 1, 7);
  put(to, 1, USB_DT_ENDPOINT);
  put(to, 1, PLACIDO_UVC_STREAM_ENDPOINT);
  put(to, 1, USB_ENDPOINT_XFER_BULK);
  put(to, 2, packet_bytes(speed));
  put(to, 1, 0);
  if (speed == PLACIDO_GADGET_SUPER) {
    put_bytes(to, companion, sizeof companion);
  }
}

static size_t make_configuration(uint8_t *bytes, const placido_uvc_modes *modes,
                                 enum placido_gadget_speed speed) {
  /* half an ampere, in units of 8 or 2 mA */
  const uint8_t configuration[] = {
      9, USB_DT_CONFIG, 0, 0, 2, 1, 0, USB_CONFIG_ATT_ONE,
      speed == PLACIDO_GADGET_SUPER ? 500 / 8 : 500 / 2};
  static const uint8_t association[] = {
      8, USB_DT_INTERFACE_ASSOCIATION, PLACIDO_UVC_CONTROL_INTERFACE, 2, USB_CLASS_VIDEO,
      UVC_SC_VIDEO_INTERFACE_COLLECTION, UVC_PC_PROTOCOL_UNDEFINED, 2};
  struct writer to = {bytes, 0};
  put_bytes(&to, configuration, sizeof configuration);
  put_bytes(&to, association, sizeof association);
  put_control_interface(&to);
  put_stream_interface(&to, modes, speed);
  close_length(&to, 0, 2);
  return to.size;
}

static void make_device(uint8_t bytes[18], enum placido_gadget_speed speed) {
  const bool is_super = speed == PLACIDO_GADGET_SUPER;
  struct writer to = {bytes, 0};
  put(&to, 1, 18);
  put(&to, 1, USB_DT_DEVICE);
  put(&to, 2, is_super ? 0x0300 : 0x0200);
  put(&to, 1, USB_CLASS_MISC); /* these three: interfaces are associated */
  put(&to, 1, 2);
  put(&to, 1, 1);
  put(&to, 1, is_super ? 9 : 64); /* packets of endpoint 0; an exponent with SuperSpeed */
  put(&to, 2, PLACIDO_UVC_VENDOR_ID);
  put(&to, 2, PLACIDO_UVC_PRODUCT_ID);
  put(&to, 2, 0x0100);
  put(&to, 3, 0x030201); /* strings: maker, product, serial number */
  put(&to, 1, 1);        /* configurations */
}

/* Capabilities: USB 2.0 extension (LPM), SuperSpeed (high and super, complete from high on). */
static const uint8_t bos[22] = {5, USB_DT_BOS, 22, 0, 2,
                                7, USB_DT_DEVICE_CAPABILITY, USB_CAP_TYPE_EXT, 2, 0, 0, 0,
                                10, USB_DT_DEVICE_CAPABILITY, USB_SS_CAP_TYPE, 0, 0x0c, 0, 2,
                                10, 100, 0};

void placido_uvc_descriptors_make(placido_uvc_descriptors *descriptors,
                                  const placido_uvc_modes *modes, enum placido_gadget_speed speed,
                                  const char *serial) {
  *descriptors = (placido_uvc_descriptors){.has_bos = speed == PLACIDO_GADGET_SUPER};
  make_device(descriptors->device, speed);
  memcpy(descriptors->bos, bos, sizeof bos);
  placido_gadget_languages(descriptors->strings[0]);
  placido_gadget_string(descriptors->strings[1], "Placido");
  placido_gadget_string(descriptors->strings[2], "Simulated topographer (UVC)");
  placido_gadget_string(descriptors->strings[3], serial);
  descriptors->configuration_size =
      make_configuration(descriptors->configuration, modes, speed);
}

const uint8_t *placido_uvc_descriptor_get(const placido_uvc_descriptors *descriptors, uint8_t type,
                                          uint8_t index, size_t *size) {
  const uint8_t *bytes = NULL;
  *size = 0;
  if (type == USB_DT_STRING && index < PLACIDO_UVC_STRINGS) {
    bytes = descriptors->strings[index];
    *size = bytes[0];
  } else if (type == USB_DT_DEVICE && index == 0) {
    bytes = descriptors->device;
    *size = sizeof descriptors->device;
  } else if (type == USB_DT_CONFIG && index == 0) {
    bytes = descriptors->configuration;
    *size = descriptors->configuration_size;
  } else if (type == USB_DT_BOS && index == 0 && descriptors->has_bos) {
    bytes = descriptors->bos;
    *size = sizeof descriptors->bos;
  }
  return bytes;
}

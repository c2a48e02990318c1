/* The simulated USB3 Vision camera from inside: its registers, its sensor, and the two pipes that
 * it talks through. */
#ifndef PLACIDO_GADGET_U3V_CAMERA_H
#define PLACIDO_GADGET_U3V_CAMERA_H

#include "drivers/u3v/wire/packet.h"
#include "drivers/u3v/wire/pixel.h"
#include "drivers/u3v/wire/registers.h"
#include "gadget/face.h"

/* USB addresses of the endpoints. */
#define PLACIDO_U3V_GADGET_COMMAND 0x01
#define PLACIDO_U3V_GADGET_ANSWER 0x81
#define PLACIDO_U3V_GADGET_STREAM 0x82

#define PLACIDO_U3V_GADGET_CONTROL_BYTES 65536 /* of a command or an answer */
#define PLACIDO_U3V_GADGET_ANSWERS 4           /* that wait to be fetched */
#define PLACIDO_U3V_GADGET_PICTURES 4          /* that wait to be fetched */
#define PLACIDO_U3V_GADGET_DESCRIPTOR_BYTES_MAX 256

/* Where the address space has what. */
#define PLACIDO_U3V_GADGET_SBRM 0x10000
#define PLACIDO_U3V_GADGET_SIRM 0x20000
#define PLACIDO_U3V_GADGET_MANIFEST 0x40000
#define PLACIDO_U3V_GADGET_FEATURES 0x80000
#define PLACIDO_U3V_GADGET_DESCRIPTION 0x100000

/* The camera's own registers behind PLACIDO_U3V_GADGET_FEATURES, as camera.xml names them; 4 bytes
 * but for the rate. */
enum placido_u3v_feature_register {
  PLACIDO_U3V_WIDTH_MAX = 0x00,
  PLACIDO_U3V_HEIGHT_MAX = 0x04,
  PLACIDO_U3V_WIDTH = 0x08,
  PLACIDO_U3V_HEIGHT = 0x0C,
  PLACIDO_U3V_OFFSET_X = 0x10,
  PLACIDO_U3V_OFFSET_Y = 0x14,
  PLACIDO_U3V_PIXEL_FORMAT = 0x18,
  PLACIDO_U3V_PAYLOAD_SIZE = 0x1C,
  PLACIDO_U3V_ACQUISITION_MODE = 0x20,
  PLACIDO_U3V_ACQUISITION_START = 0x24,
  PLACIDO_U3V_ACQUISITION_STOP = 0x28,
  PLACIDO_U3V_ACQUISITION_STATUS = 0x2C,
  PLACIDO_U3V_EXPOSURE = 0x30,  /* in steps of the time base */
  PLACIDO_U3V_TIME_BASE = 0x34, /* ns */
  PLACIDO_U3V_GAIN = 0x38,      /* dB, a float */
  PLACIDO_U3V_BLACK_LEVEL = 0x3C, /* grey levels of 8 bits */
  PLACIDO_U3V_FRAME_RATE = 0x40,  /* Hz, a double */
  PLACIDO_U3V_FRAME_RATE_ENABLE = 0x48,
  PLACIDO_U3V_TRIGGER = 0x4C, /* bit 0 mode, bit 1 source, bit 2 activation */
  PLACIDO_U3V_TRIGGER_SOFTWARE = 0x50,
  PLACIDO_U3V_TL_PARAMS_LOCKED = 0x54,
  PLACIDO_U3V_RESET = 0x58,
  PLACIDO_U3V_TEMPERATURE = 0x5C, /* sixteenths of a degree, 12 bits with sign */
  PLACIDO_U3V_FEATURE_BYTES = 0x60,
};

#define PLACIDO_U3V_TRIGGER_ON 1u
#define PLACIDO_U3V_TRIGGER_LINE 2u  /* by a line, on which nothing ever comes; else by software */
#define PLACIDO_U3V_SINGLE_FRAME 1u  /* acquisition mode */
#define PLACIDO_U3V_READOUT_US 200.0 /* between two exposures */
#define PLACIDO_U3V_RATE_MAX_HZ 500.0

/* Bytes at an address. */
typedef struct placido_u3v_region {
  uint64_t address;
  uint8_t *bytes;
  size_t size;
} placido_u3v_region;

#define PLACIDO_U3V_GADGET_REGIONS 6

/* What a command was answered with; fetched in order, each when it is time. */
typedef struct placido_u3v_answer {
  uint8_t *bytes;
  size_t size, sent;
  int64_t ready_ns;
} placido_u3v_answer;

/* A picture that waits to be fetched. */
typedef struct placido_u3v_picture {
  placido_u3v_leader leader;
  placido_u3v_trailer trailer;
  uint8_t *samples;
  size_t size;
  bool has_leader, has_trailer, stalls;
  int64_t ready_ns;
} placido_u3v_picture;

enum placido_u3v_part {
  PLACIDO_U3V_PART_LEADER,
  PLACIDO_U3V_PART_PAYLOAD,
  PLACIDO_U3V_PART_TRAILER,
};

typedef struct placido_u3v_camera {
  placido_gadget_view view;
  placido_gadget_faults *faults;
  placido_gadget_faults no_faults; /* where there are none to be had */
  enum placido_gadget_speed speed;
  placido_gadget_statistics statistics;
  int64_t now_ns, power_up_ns;
  int64_t reset_ns; /* when it unplugs itself; 0: not */

  /* The last one given of each kind: device, configuration, capabilities, string. */
  uint8_t descriptors[4][PLACIDO_U3V_GADGET_DESCRIPTOR_BYTES_MAX];

  uint8_t abrm[PLACIDO_ABRM_BYTES], sbrm[PLACIDO_SBRM_BYTES], sirm[PLACIDO_SIRM_BYTES];
  uint8_t manifest[8 + PLACIDO_MANIFEST_ENTRY_BYTES], features[PLACIDO_U3V_FEATURE_BYTES];
  uint8_t *description;
  size_t description_size;
  placido_u3v_region regions[PLACIDO_U3V_GADGET_REGIONS];

  placido_u3v_answer answers[PLACIDO_U3V_GADGET_ANSWERS]; /* the oldest first */
  size_t answer_count;
  uint8_t *data; /* read for an answer */

  /* the sensor */
  double rate_hz;             /* asked for */
  double nominal_exposure_us; /* at which the view is seen as it is */
  bool is_acquiring, is_exposing;
  int64_t exposure_start_ns, exposure_end_ns, next_ns;
  double exposure_us; /* of the picture being exposed */
  uint64_t next_id;
  placido_frame exposed; /* a view through gain and exposure */
  uint16_t *curve;       /* grey level to grey level */
  double curve_gain, curve_black;

  /* the stream */
  placido_u3v_picture pictures[PLACIDO_U3V_GADGET_PICTURES]; /* a ring */
  size_t picture_first, picture_count;
  enum placido_u3v_part part;
  size_t part_sent;     /* bytes of it */
  size_t transfer_left; /* bytes of the payload transfer being sent; 0: the next one begins */
  size_t transfer_number;
} placido_u3v_camera;

/* u3v_registers.c: the address space. Statuses are those of GenCP. */
void placido_u3v_registers_reset(placido_u3v_camera *camera);
void placido_u3v_registers_set_up(placido_u3v_camera *camera, const char *serial, bool is_zip);
uint16_t placido_u3v_registers_read(placido_u3v_camera *camera, uint64_t address, uint8_t *bytes,
                                    size_t size);
uint16_t placido_u3v_registers_write(placido_u3v_camera *camera, uint64_t address,
                                     const uint8_t *bytes, size_t size);
bool placido_u3v_is_streaming(const placido_u3v_camera *camera);

/* u3v_features.c: the registers behind PLACIDO_U3V_GADGET_FEATURES. */
void placido_u3v_features_reset(placido_u3v_camera *camera);
/* Brings those up to date that follow from others or from the time. */
void placido_u3v_features_refresh(placido_u3v_camera *camera);
uint16_t placido_u3v_features_write(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                    size_t size);
uint32_t placido_u3v_feature(const placido_u3v_camera *camera,
                             enum placido_u3v_feature_register at);
double placido_u3v_exposure_us(const placido_u3v_camera *camera);
/* The rate at which pictures come: what was asked for, as far as exposure allows it. */
double placido_u3v_rate_hz(const placido_u3v_camera *camera);
double placido_u3v_gain_db(const placido_u3v_camera *camera);
const placido_pixel_format *placido_u3v_format(const placido_u3v_camera *camera);
size_t placido_u3v_payload_bytes(const placido_u3v_camera *camera);

/* u3v_sensor.c: pictures are taken. */
void placido_u3v_sensor_start(placido_u3v_camera *camera);
void placido_u3v_sensor_stop(placido_u3v_camera *camera);
/* A trigger that comes where none is waited for is lost. */
void placido_u3v_sensor_trigger(placido_u3v_camera *camera);
/* Takes what is due; returns when the next is. */
int64_t placido_u3v_sensor_tick(placido_u3v_camera *camera);

/* u3v_stream.c: pictures are sent. */
/* Where the next one may be put; NULL: the host is behind. */
placido_u3v_picture *placido_u3v_stream_room(placido_u3v_camera *camera);
void placido_u3v_stream_push(placido_u3v_camera *camera);
void placido_u3v_stream_flush(placido_u3v_camera *camera);
enum placido_gadget_answer placido_u3v_stream_send(placido_u3v_camera *camera, uint8_t *bytes,
                                                   size_t size, size_t *sent);
/* When the first one may be sent. */
int64_t placido_u3v_stream_due_ns(const placido_u3v_camera *camera);

/* u3v_control.c: commands are answered. */
void placido_u3v_control_take(placido_u3v_camera *camera, const uint8_t *bytes, size_t size);
enum placido_gadget_answer placido_u3v_control_send(placido_u3v_camera *camera, uint8_t *bytes,
                                                    size_t size, size_t *sent);
int64_t placido_u3v_control_due_ns(const placido_u3v_camera *camera);

/* u3v_descriptors.c: borrowed until the next call for the same type; NULL: there is none. */
const uint8_t *placido_u3v_descriptor(placido_u3v_camera *camera, uint8_t type, uint8_t index,
                                      size_t *size);

/* u3v_xml.c: the description file, as it is or in a zip; caller frees with placido_memory_free. */
int placido_u3v_description_new(uint8_t **bytes, size_t *size, bool is_zip, placido_error *err);

/* Counts a fault down; false where none is left. */
static inline bool placido_u3v_fault(placido_u3v_camera *camera, enum placido_gadget_fault fault) {
  if (camera->faults->left[fault] == 0) {
    return false;
  }
  camera->faults->left[fault]--;
  return true;
}

#endif

/* What tests do with a simulated UVC camera: a scene, a clock, requests and pictures. */
#ifndef PLACIDO_TESTS_GADGET_UVC_USE_H
#define PLACIDO_TESTS_GADGET_UVC_USE_H

#include "gadget/uvc.h"
#include "gadget/uvc_descriptors.h"

#include <stdbool.h>

#define MS INT64_C(1000000)
#define WIDTH 256
#define HEIGHT 192
#define PROBE 34
#define TRANSFER 32768u /* of uvcvideo at SuperSpeed */

/* Entities as wIndex has them. */
#define VS PLACIDO_UVC_STREAM_INTERFACE
#define CAMERA (PLACIDO_UVC_CAMERA << 8)
#define PROCESSING (PLACIDO_UVC_PROCESSING << 8)

extern placido_frame scene;
extern bool is_dark; /* the view has nothing to show */
extern int looks;    /* how often the camera looked */
extern placido_gadget_faults faults;
extern placido_gadget gadget;
extern int64_t now_ns;

const placido_frame *look(void *user, int64_t t_ns);
void plug_in(int width_px, int height_px, enum placido_format format, double rate_hz,
             enum placido_gadget_speed speed);
int plug_in_usual(void **state); /* WIDTH × HEIGHT, 20 Hz, SuperSpeed */
int unplug(void **state);
void pass(int64_t time_ns);

uint32_t number(const uint8_t *at, int size);

/* Requests of the class. */
enum placido_gadget_answer ask(uint8_t request, uint8_t selector, uint16_t entity, uint8_t *data,
                               size_t *size);
uint32_t get(uint8_t request, uint8_t selector, uint16_t entity, size_t length);
enum placido_gadget_answer set(uint8_t selector, uint16_t entity, uint32_t value, size_t size);
uint32_t reason(void); /* why the last one was refused */
void get_block(uint8_t request, uint8_t selector, uint8_t block[PROBE]);
enum placido_gadget_answer set_block(uint8_t selector, uint8_t block[PROBE]);

/* Probes format and size (from 1) at the usual rate, and commits to what the camera makes of it. */
void agree(uint8_t format, uint8_t size);

enum placido_gadget_answer fetch(uint8_t *bytes, size_t *size);

/* Payloads as a host gathers them until the picture ends, or nothing more comes. */
struct picture {
  uint8_t bytes[1 << 20];
  size_t size;
  int payloads;
  uint8_t first_flags, last_flags, all_flags;
  uint8_t headers[64][12];
  bool is_stalled;
};

extern struct picture picture;

const struct picture *receive(void);

#endif

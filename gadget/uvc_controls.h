/* The simulated UVC camera's controls, and the dialogue by which a mode is agreed on. */
#ifndef PLACIDO_GADGET_UVC_CONTROLS_H
#define PLACIDO_GADGET_UVC_CONTROLS_H

#include "gadget/uvc_descriptors.h"

enum placido_uvc_value {
  PLACIDO_UVC_AUTO_EXPOSURE,
  PLACIDO_UVC_EXPOSURE, /* in 100 us */
  PLACIDO_UVC_BRIGHTNESS,
  PLACIDO_UVC_GAIN, /* 16 is one */
  PLACIDO_UVC_VALUES,
};

#define PLACIDO_UVC_EXPOSURE_USUAL 100

/* What probe and commit are about. */
typedef struct placido_uvc_choice {
  enum placido_uvc_format format;
  int size;
  uint32_t interval; /* 100 ns */
  uint16_t hint;     /* the host's, as it sent it */
} placido_uvc_choice;

typedef struct placido_uvc_controls {
  const placido_uvc_modes *modes; /* borrowed */
  int32_t values[PLACIDO_UVC_VALUES];
  placido_uvc_choice probed, committed;
  bool is_commit_new;    /* set with a commit; cleared by who acts on it */
  uint8_t request_error; /* why the last request was refused; 0: it was not */
  uint8_t stream_error;  /* why the last picture was marked as damaged; 0: none was */
} placido_uvc_controls;

/* Everything as delivered. */
void placido_uvc_controls_make(placido_uvc_controls *controls, const placido_uvc_modes *modes);

/* Answers a request on endpoint 0; `data` and `*size` as gadget/function.h has them for control. */
enum placido_gadget_answer placido_uvc_control(placido_uvc_controls *controls,
                                               const placido_gadget_setup *setup, uint8_t *data,
                                               size_t *size);

#endif

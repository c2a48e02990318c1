/* What a simulated camera looks at, and what goes wrong with it on command. */
#ifndef PLACIDO_GADGET_PICTURE_H
#define PLACIDO_GADGET_PICTURE_H

#include <placido/frame.h>
#include <placido/status.h>
#include <stdint.h>

/* Where pictures come from. `look` lends the MONO8 or MONO16 picture that is seen at t_ns, of
 * always the same size and format; it stays until the next call. */
typedef struct placido_gadget_view {
  const placido_frame *(*look)(void *user, int64_t t_ns);
  void *user;
  int width_px, height_px;
  double rate_hz; /* at which the camera runs until it is told otherwise */
} placido_gadget_view;

/* Faults, each as many as still to come; whoever makes one counts it down. */
enum placido_gadget_fault {
  PLACIDO_GADGET_FAULT_STALL,      /* the stream endpoint halts in mid-picture */
  PLACIDO_GADGET_FAULT_DROP,       /* a picture is skipped: its number is missing */
  PLACIDO_GADGET_FAULT_CORRUPT,    /* the device says that the picture's data are damaged */
  PLACIDO_GADGET_FAULT_TRUNCATE,   /* a picture ends after half its bytes */
  PLACIDO_GADGET_FAULT_MISNUMBER,  /* begin and end of a picture disagree on its number */
  PLACIDO_GADGET_FAULT_LOST_START, /* a picture without its beginning (leader, first header) */
  PLACIDO_GADGET_FAULT_LOST_END,
  PLACIDO_GADGET_FAULT_PENDING,    /* a register read answers only after asking for time */
  PLACIDO_GADGET_FAULT_SILENT,     /* a command is not answered */
  PLACIDO_GADGET_FAULT_REFUSE,     /* a command is answered with an error */
  PLACIDO_GADGET_FAULT_GARBLE,     /* an answer is bytes without sense */
  PLACIDO_GADGET_FAULTS,
};

typedef struct placido_gadget_faults {
  uint32_t left[PLACIDO_GADGET_FAULTS];
  int slow_ms; /* every answer and picture comes later by this */
} placido_gadget_faults;

/* By name ("stall", "drop" ... as above, lower case, "lost-start"); -1: there is none. */
int placido_gadget_fault_by_name(const char *name);
const char *placido_gadget_fault_name(enum placido_gadget_fault fault);

#endif

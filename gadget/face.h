/* A face: the kind of USB device as which a simulated camera shows itself. A row of a table; what
 * speaks to the host is its function. */
#ifndef PLACIDO_GADGET_FACE_H
#define PLACIDO_GADGET_FACE_H

#include "gadget/function.h"
#include "gadget/picture.h"

#include <placido/status.h>
#include <stdbool.h>

/* What is simulated. */
typedef struct placido_gadget_options {
  placido_gadget_view view;
  placido_gadget_faults *faults; /* borrowed; counted down by the camera */
  enum placido_gadget_speed speed;
  const char *serial;            /* borrowed; printable ASCII, at most 63 characters */
  bool zip;                      /* u3v: the description file comes in a zip */
} placido_gadget_options;

/* Since the device was opened. */
typedef struct placido_gadget_statistics {
  uint64_t pictures; /* sent whole, as far as faults let them be */
  uint64_t dropped;  /* taken, and thrown away because the host did not fetch them, or by a fault */
  uint64_t commands; /* register accesses or control requests answered */
} placido_gadget_statistics;

typedef struct placido_gadget_face {
  const char *name;    /* "u3v" */
  const char *summary; /* one line */
  const placido_gadget_function *function;
  /* `*state` is what the function works on; NULL where it fails. Close with close. Returns
   * PLACIDO_OK, PLACIDO_INPUT (a picture or serial number that such a camera cannot have),
   * PLACIDO_MEMORY. */
  int (*open)(void **state, const placido_gadget_options *options, placido_error *err);
  void (*close)(void *state); /* NULL is legal */
  void (*statistics)(const void *state, placido_gadget_statistics *statistics);
} placido_gadget_face;

/* The table, `*count` rows. */
const placido_gadget_face *const *placido_gadget_face_table(size_t *count);
/* NULL: there is none of that name. */
const placido_gadget_face *placido_gadget_face_by_name(const char *name);

#endif

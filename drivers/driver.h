/* A driver: one row of the table that devices are opened from. */
#ifndef PLACIDO_DRIVERS_DRIVER_H
#define PLACIDO_DRIVERS_DRIVER_H

#include <placido/device.h>
#include <stddef.h>

/* What udev knows such a device by; the rules for permissions and names are made from it. */
typedef struct placido_match {
  const char *subsystem;        /* "usb", "video4linux", "gpio" */
  int usb_class, usb_subclass;  /* of an interface; -1: any */
  const char *only;             /* a further condition in udev's words; NULL: none */
  const char *link;             /* udev's name for /dev/placido/: "camera-$env{ID_SERIAL_SHORT}";
                                 * made where all that stands behind a $ is known, and unique by
                                 * that. Not $attr of text that a device sends: it is not
                                 * cleaned */
  const char *group;            /* who may open it beside the one at the seat; NULL: nobody */
} placido_match;

/* `state` is what open made. Functions that may be NULL say what that means. */
typedef struct placido_driver {
  const char *scheme;  /* what stands before the colon of a URI */
  const char *summary; /* one line for the list of drivers */

  /* Settings of an address ("?size=...") that open reads itself, ended by NULL: open gets the
   * address with its query then, and the other settings are controls as always. NULL: every
   * setting is a control, and open gets the address alone. */
  const char *const *options;

  /* Calls `found` for every device that can be seen, and stops with its value where that is not
   * 0. Must not disturb a device in use. NULL: devices of this kind cannot be looked for. */
  int (*scan)(int (*found)(void *user, const char *uri, const char *description), void *user,
              placido_error *err);

  /* Opens what stands behind the colon. May block for as long as a device needs to wake up.
   * `*state` is NULL where it fails. */
  int (*open)(void **state, const char *address, placido_notes *notes, placido_error *err);
  /* Called once for each successful open, stopped or not. */
  void (*close)(void *state);

  /* Borrowed until close; the same for the life of the state. */
  const placido_device_info *(*info)(const void *state);
  /* Borrowed until close. NULL: there are no controls, and get and set are never called. */
  const placido_control *(*controls)(const void *state, size_t *count);
  /* `control` counts in the order of `controls`; the value has been checked against its range. */
  int (*get)(void *state, size_t control, double *value, placido_error *err);
  int (*set)(void *state, size_t control, double value, placido_error *err);

  /* Calls `each` for every format and size, and stops with its value where that is not 0. Never
   * changes the device; may be called while started. NULL: there is nothing to choose from. */
  int (*modes)(void *state, int (*each)(void *user, const placido_device_mode *mode), void *user,
               placido_error *err);

  /* How udev tells such devices, ended by a row without subsystem. NULL: they are no devices of
   * the kernel's. */
  const placido_match *matches;

  /* Never called while started. */
  int (*start)(void *state, placido_error *err);
  /* Called between start and stop only; blocks for at most timeout_ms (0 or more). PLACIDO_GONE
   * where the device was unplugged: start finds it again, or says PLACIDO_GONE once more. NULL: it
   * gives no pictures. */
  int (*next)(void *state, placido_frame *frame, int timeout_ms, placido_error *err);
  /* As next. NULL: there are no events. */
  int (*event)(void *state, placido_event *event, int timeout_ms, placido_error *err);
  /* Called once for each successful start. NULL: nothing is to be done. */
  int (*stop)(void *state, placido_error *err);

  /* NULL: nothing is counted. */
  void (*statistics)(const void *state, placido_device_statistics *statistics);
} placido_driver;

/* The drivers of this build, `*count` of them. */
const placido_driver *const *placido_driver_table(size_t *count);

#endif

/* What the two files over libusb share: the list of cameras, and the open pipe to one. */
#ifndef PLACIDO_DRIVERS_U3V_USB_H
#define PLACIDO_DRIVERS_U3V_USB_H

#include "drivers/u3v/pipe.h"

#include <libusb.h>

/* As placido_u3v_calls.each. A machine without USB has no cameras. */
int placido_u3v_usb_each(void *context,
                         int (*found)(void *user, const placido_u3v_found *device), void *user,
                         placido_error *err);

/* The device that is plugged in at a place; NULL: there is none. Give back with
 * libusb_unref_device. */
libusb_device *placido_u3v_usb_at(libusb_context *usb, const char *place);

#endif

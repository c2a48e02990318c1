/* Cameras that speak USB3 Vision. */
#ifndef PLACIDO_DRIVERS_U3V_U3V_H
#define PLACIDO_DRIVERS_U3V_U3V_H

#include "drivers/driver.h"
#include "drivers/u3v/pipe.h"

extern const placido_driver placido_u3v_driver;

/* The driver's open and scan over other calls than libusb's; `calls` must outlive the state. */
int placido_u3v_open(void **state, const char *address, const placido_u3v_calls *calls,
                     placido_notes *notes, placido_error *err);
int placido_u3v_scan(const placido_u3v_calls *calls,
                     int (*found)(void *user, const char *uri, const char *description),
                     void *user, placido_error *err);

#endif

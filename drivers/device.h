/* Opening a device of any driver by any clock: the seam of tests below placido_device_open. */
#ifndef PLACIDO_DRIVERS_DEVICE_H
#define PLACIDO_DRIVERS_DEVICE_H

#include "base/clock.h"
#include "drivers/driver.h"

/* As placido_device_open, of what stands behind the colon of a URI; the driver need not be in the
 * table. Driver and clock must outlive the device. */
int placido_device_open_with(placido_device **device, const placido_driver *driver,
                             const placido_clock *clock, const char *address,
                             placido_notes *notes, placido_error *err);

#endif

/* Devices that come and go while a program runs. */
#ifndef PLACIDO_HOTPLUG_H
#define PLACIDO_HOTPLUG_H

#include <placido/status.h>
#include <stdbool.h>

typedef struct placido_watch placido_watch;

/* A device that came or went, as placido_device_scan tells of it. */
typedef struct placido_change {
  bool is_added; /* false: removed */
  char uri[1024];
  char description[512];
} placido_change;

/* Watches the devices of every driver. Close with placido_watch_close. Where the system tells of
 * changes (udev) they are noticed within a fraction of a second; else the watch looks every second.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_watch_open(placido_watch **watch, placido_error *err);
void placido_watch_close(placido_watch *watch);

/* The next change, waited for until timeout_ms have passed. What is there from the beginning comes
 * first, as added. A device that is away for less than half a second may be passed over. Returns
 * PLACIDO_OK, PLACIDO_TIMEOUT, PLACIDO_MEMORY, or what a driver's looking returned: a further call
 * looks again. */
int placido_watch_next(placido_watch *watch, placido_change *change, int timeout_ms,
                       placido_error *err);

#endif

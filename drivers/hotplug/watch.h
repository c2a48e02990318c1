/* What a watch is made of: an alarm that something may have changed, and a look at what there
 * is. */
#ifndef PLACIDO_DRIVERS_HOTPLUG_WATCH_H
#define PLACIDO_DRIVERS_HOTPLUG_WATCH_H

#include "base/clock.h"

#include <placido/hotplug.h>
#include <placido/status.h>
#include <stdbool.h>

/* Rings where a device may have come or gone; which one is for the look to find out. */
typedef struct placido_alarm {
  /* Waits for it until timeout_ms have passed; true: it rang, and is quiet again. NULL: nothing
   * rings, and the watch looks every second. */
  bool (*wait)(void *state, int timeout_ms);
  void (*close)(void *state);
  void *state;
} placido_alarm;

/* The system's alarm for the devices of the drivers' tables (udev.c, without_udev.c). */
placido_alarm placido_alarm_open(void);

/* As placido_device_scan. */
typedef int placido_look(const char *scheme,
                         int (*found)(void *user, const char *uri, const char *description),
                         void *user, placido_error *err);

/* As placido_watch_open. The alarm is taken, also where this fails. */
int placido_watch_open_with(placido_watch **watch, placido_alarm alarm, placido_look *look,
                            const placido_clock *clock, placido_error *err);

#endif

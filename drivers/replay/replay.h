/* A recorded session, or one image file, as a device. */
#ifndef PLACIDO_DRIVERS_REPLAY_REPLAY_H
#define PLACIDO_DRIVERS_REPLAY_REPLAY_H

#include "drivers/driver.h"

extern const placido_driver placido_replay_driver;

#endif

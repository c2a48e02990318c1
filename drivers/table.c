/* The list of drivers; a new one is a row here. */
#include "drivers/driver.h"
#include "drivers/replay/replay.h"
#include "drivers/v4l2/v4l2.h"

static const placido_driver *const drivers[] = {
    &placido_replay_driver,
    &placido_v4l2_driver,
};

const placido_driver *const *placido_driver_table(size_t *count) {
  *count = sizeof drivers / sizeof *drivers;
  return drivers;
}

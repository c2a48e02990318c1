/* The list of drivers; a new one is a row here. */
#include "drivers/driver.h"
#ifdef PLACIDO_GPIO
#include "drivers/gpio/gpio.h"
#endif
#include "drivers/replay/replay.h"
#ifdef PLACIDO_USB
#include "drivers/u3v/u3v.h"
#endif
#include "drivers/v4l2/v4l2.h"

static const placido_driver *const drivers[] = {
    &placido_replay_driver,
    &placido_v4l2_driver,
#ifdef PLACIDO_USB
    &placido_u3v_driver,
#endif
#ifdef PLACIDO_GPIO
    &placido_gpio_driver,
#endif
};

const placido_driver *const *placido_driver_table(size_t *count) {
  *count = sizeof drivers / sizeof *drivers;
  return drivers;
}

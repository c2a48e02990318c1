/* The lights, the pedal and the trigger of an instrument, on the lines of a GPIO chip:
 * `gpio:/dev/gpiochipN?light=5&fixation=6&pedal=!7&trigger=4`, or by the chip's label and the
 * lines' names: `gpio:LABEL?light=RINGLIGHT`.
 *
 *   light     output: the ring light              control light: 1 shines, 0 is dark
 *   fixation  output: the light the eye looks at  control fixation
 *   strobe    output: a signal for other devices  control strobe
 *   trigger   input: an event "trigger" (value 1) for every edge to active, the camera's exposure;
 *             its end is not told, so that pulses shorter than the kernel's reaction count right
 *   pedal     input: debounced events "pedal", 1 pressed and 0 released
 *   bias      of the inputs: pull-up, pull-down, none, as-is (the default)
 *   debounce_ms  0 to 1000 (20): so long must the pedal stand still before a change counts
 *
 * A ! or - before a line makes it active low. Every setting but the lines' is optional, and so is
 * every line.
 *
 * Events carry the kernel's CLOCK_MONOTONIC time of the edge (Linux 5.7 or newer); the pedal's
 * that of its first edge, though it is told only when the pedal has stood still, and may come after
 * later triggers. Take events while the device is started: with libgpiod 1.6 the kernel keeps 16
 * edges a line. A gap in `seq` is edges it had no room for (libgpiod 1.6 does not count them: 1
 * where the queue was full).
 *
 * A chip that was unplugged may get another number when it comes back; its label finds it again.
 *
 * Eye safety: lines are requested dark, nothing but `set` lights them, and stop, close and every
 * start after an unplugging leave them dark. A program that is killed (SIGKILL) cannot do that: the
 * kernel frees its lines, and what they do then is the hardware's. The kernel's simulated chips
 * return to their pull; the documentation of its interface promises nothing, and controllers of
 * computers commonly hold the last level, so that a light goes on shining until the next open. A
 * light's circuit must therefore be dark where its line is not driven, and limit its own power or
 * time to what is safe for an eye. */
#ifndef PLACIDO_DRIVERS_GPIO_GPIO_H
#define PLACIDO_DRIVERS_GPIO_GPIO_H

#include "drivers/driver.h"
#include "drivers/gpio/lines.h"

extern const placido_driver placido_gpio_driver;

/* The driver's open and scan over other lines than the kernel's, for tests. */
int placido_gpio_open(void **state, const char *address, const placido_gpio_lines *lines,
                      placido_notes *notes, placido_error *err);
int placido_gpio_scan(const placido_gpio_lines *lines,
                      int (*found)(void *user, const char *uri, const char *description),
                      void *user, placido_error *err);

#endif

/* What udev is told of the drivers' devices, as text. */
#ifndef PLACIDO_UDEV_RULES_H
#define PLACIDO_UDEV_RULES_H

#include "drivers/driver.h"

#include <placido/status.h>
#include <stdio.h>

/* Writes the rules for a table of drivers: access, names, power. Returns PLACIDO_OK, PLACIDO_INPUT
 * (a row that does not fit into a rule), PLACIDO_SYSTEM. */
int placido_udev_rules(FILE *file, const placido_driver *const *drivers, size_t count,
                       placido_error *err);

/* The hardware database: which USB interfaces are which driver's. */
int placido_udev_hwdb(FILE *file, const placido_driver *const *drivers, size_t count,
                      placido_error *err);

/* The groups that the rules name, for systemd-sysusers. */
int placido_udev_groups(FILE *file, const placido_driver *const *drivers, size_t count,
                        placido_error *err);

#endif

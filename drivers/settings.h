/* The settings of a device's address: "ADDRESS?size=1280x1024&fps=30". */
#ifndef PLACIDO_DRIVERS_SETTINGS_H
#define PLACIDO_DRIVERS_SETTINGS_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* Characters of a value at most. */
#define PLACIDO_SETTING_MAX 127

/* No camera is faster. */
#define PLACIDO_RATE_MAX_HZ 10000

/* The settings that a driver reads itself. */
typedef struct placido_settings {
  const char *const *names; /* ended by NULL */
  size_t longest;           /* value, in characters: at most PLACIDO_SETTING_MAX */
  /* Reads the value of the setting `name`, counted as in `names`. */
  int (*read)(void *target, size_t name, const char *value, placido_error *err);
} placido_settings;

/* Copies what stands before the query of `text` to the `size` bytes of `address`; `*query` points
 * to what stands behind the '?', or is NULL. Returns PLACIDO_OK, or PLACIDO_INPUT where it is too
 * long; `device` names what the address is of, such as "camera". */
int placido_settings_split(char *address, size_t size, const char **query, const char *text,
                           const char *device, placido_error *err);

/* Reads the settings that are known from a query ("size=...&fps=...", may be NULL) and skips the
 * others: they are controls. Returns PLACIDO_OK, PLACIDO_INPUT where a value is too long, or what
 * a reader returns. */
int placido_settings_read(const placido_settings *settings, void *target, const char *query,
                          placido_error *err);

/* Whether the whole text is a number, or two whole numbers of 0 to 99999 with a character between
 * them. What they are set to counts only then. */
bool placido_setting_read_number(double *number, const char *value);
bool placido_setting_read_pair(int pair[2], const char *value, char between);

/* Each returns PLACIDO_OK or PLACIDO_INPUT: "WIDTHxHEIGHT" with sides of 1 to `side_max_px`;
 * frames per second, more than 0; a whole number from `min` (0 or more) to `max` for the setting
 * `name`. */
int placido_setting_read_size(int *width_px, int *height_px, int side_max_px, const char *value,
                              placido_error *err);
int placido_setting_read_rate(double *rate_hz, const char *value, placido_error *err);
int placido_setting_read_whole(int *whole, const char *name, int min, int max, const char *value,
                               placido_error *err);

#endif

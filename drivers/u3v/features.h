/* A camera's features as controls: by the name, in the unit, that every camera of ours has. */
#ifndef PLACIDO_DRIVERS_U3V_FEATURES_H
#define PLACIDO_DRIVERS_U3V_FEATURES_H

#include "drivers/genicam/genicam.h"

#include <placido/device.h>

#define PLACIDO_U3V_CONTROLS_MAX 16

/* What stands behind one row of the list. */
typedef struct placido_u3v_control {
  const struct placido_u3v_known *known; /* of the table of features */
  const char *feature;                   /* the camera's name */
  double factor;                         /* our unit per the camera's */
  bool is_read_only, is_write_only;
  char help[200];
} placido_u3v_control;

typedef struct placido_u3v_controls {
  size_t count;
  placido_control rows[PLACIDO_U3V_CONTROLS_MAX]; /* help borrowed from `behind` */
  placido_u3v_control behind[PLACIDO_U3V_CONTROLS_MAX];
} placido_u3v_controls;

/* Lists the features that the camera has; what it lacks, or describes wrongly, is left out. The
 * struct must not be moved afterwards. Returns PLACIDO_OK, PLACIDO_GONE, PLACIDO_TIMEOUT,
 * PLACIDO_MEMORY. */
int placido_u3v_controls_list(placido_u3v_controls *controls, placido_genicam *features,
                              placido_error *err);

/* As placido_driver's. Where the camera regulates a value by itself, setting it switches that off
 * first. Limits that move with what was set are put into the rows. Return PLACIDO_OK,
 * PLACIDO_UNSUPPORTED (read only, or not now), PLACIDO_INPUT (out of range), or the port's. */
int placido_u3v_control_get(const placido_u3v_controls *controls, placido_genicam *features,
                            size_t control, double *value, placido_error *err);
int placido_u3v_control_set(placido_u3v_controls *controls, placido_genicam *features,
                            size_t control, double value, placido_error *err);

/* Where the control of that name stands; the count of controls where there is none. */
size_t placido_u3v_control_find(const placido_u3v_controls *controls, const char *name);

#endif

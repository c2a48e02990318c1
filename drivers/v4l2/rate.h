/* How many pictures a second: what a camera lists, what it is set to, and what it is asked for. */
#ifndef PLACIDO_DRIVERS_V4L2_RATE_H
#define PLACIDO_DRIVERS_V4L2_RATE_H

#include "drivers/v4l2/mode.h"

/* Fills in the rates of an offer's format, at its largest size. A list that does not end is cut
 * off. */
void placido_v4l2_rates_list(placido_v4l2_offer *offer, const placido_v4l2_camera *camera,
                             uint32_t fourcc);

/* The lowest and highest rate of a mode; NaN where none can be set. */
void placido_v4l2_rate_range(double rates_hz[2], const placido_v4l2_camera *camera,
                             const placido_v4l2_mode *mode);

/* The rate that the camera is set to, NaN where it does not tell; and a new one, after which it is
 * asked again. Setting returns 0 or errno. */
double placido_v4l2_rate(const placido_v4l2_camera *camera);
int placido_v4l2_rate_set(const placido_v4l2_camera *camera, double rate_hz);

/* Asks for the rate of the request; without one, for the fastest that is listed: what whoever used
 * the camera last has left it at is no wish. What came of it is to be asked. */
void placido_v4l2_rate_choose(const placido_v4l2_camera *camera, const placido_v4l2_mode *mode,
                              const placido_v4l2_request *request);

#endif

/* What optics and sensor do to a picture: defocus, motion, noise, quantisation. */
#ifndef PLACIDO_PHANTOM_SENSOR_H
#define PLACIDO_PHANTOM_SENSOR_H

#include <placido/frame.h>
#include <placido/image.h>
#include <stdint.h>

/* Blurs by a straight motion of length_px along deg (+x towards +y): a kernel of unit sum,
 * symmetric about 0, so that it moves no edge. Borders are repeated. */
int placido_phantom_sensor_move(placido_image *picture, double length_px, double deg, int threads,
                                placido_error *err);

/* Exposes `frame` to a picture in grey levels of 8 bits: adds noise of that standard deviation,
 * keyed by seed, frame_number and pixel, and rounds to `bits`. */
int placido_phantom_sensor_expose(placido_frame *frame, const placido_image *picture, double noise,
                                  int bits, uint64_t seed, uint64_t frame_number, int threads,
                                  placido_error *err);

#endif

/* The readers of others' heights: one a format. */
#ifndef PLACIDO_EXCHANGE_ELEVATION_H
#define PLACIDO_EXCHANGE_ELEVATION_H

#include "exchange/text.h"

#include <placido/elevation.h>

#define PLACIDO_ELEVATION_POINTS_MAX 2000000

/* Whether the file's beginning is that of a CSO export. */
bool placido_cso_recognise(const char *text);

/* Reads what `reader` holds; as placido_elevation_load, without sign and duplicates. */
int placido_cso_read(placido_elevation *elevation, placido_reader *reader, placido_error *err);
int placido_points_read(placido_elevation *elevation, placido_reader *reader,
                        placido_elevation_options *options, placido_error *err);

/* Makes room for one more point and appends it; `room` is the caller's, 0 at first. */
int placido_elevation_add(placido_elevation *elevation, size_t *room, placido_height height,
                          int line, placido_error *err);

#endif

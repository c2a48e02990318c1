/* An instrument as the JSON object of its file. */
#ifndef PLACIDO_BASE_INSTRUMENT_JSON_H
#define PLACIDO_BASE_INSTRUMENT_JSON_H

#include <jansson.h>
#include <placido/instrument.h>

#define PLACIDO_INSTRUMENT_FORMAT "placido-instrument/1"

/* A new reference; NULL with the error set when memory is out. */
json_t *placido_instrument_json(const placido_instrument *instrument, placido_error *err);

/* A new array of numbers; NULL when memory is out. */
json_t *placido_json_array(const double *values, int count);

#endif

/* Padded tiles in double precision. */
#define SAMPLE double
#define FFTW(name) fftw_##name
#define TABLE placido_precision_double
#define PRECISION "double"
#include "simulate/convolve/tile_body.h"

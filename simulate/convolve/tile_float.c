/* Padded tiles in single precision. */
#define SAMPLE float
#define FFTW(name) fftwf_##name
#define TABLE placido_precision_float
#define PRECISION "float"
#include "simulate/convolve/tile_body.h"

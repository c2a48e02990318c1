/* The two colour ramps of the figures, made in CIELAB so that lightness tells classes apart where
 * hue cannot. */
#ifndef PLACIDO_REPORT_PALETTE_H
#define PLACIDO_REPORT_PALETTE_H

#include "report/canvas.h"

/* Cool and dark at -1, nearly white at 0, warm and dark at +1; values outside are clamped.
 * Lightness falls evenly on both sides; blue and orange-red stay apart in every common deficiency
 * of colour vision. */
placido_rgb placido_palette_diverging(double position);

/* From light (0) to dark (1), lightness falling evenly. */
placido_rgb placido_palette_sequential(double position);

#endif

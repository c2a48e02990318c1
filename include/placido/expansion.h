/* The cornea's height over a disc as OSA/ANSI Zernike terms. */
#ifndef PLACIDO_EXPANSION_H
#define PLACIDO_EXPANSION_H

#include <placido/reconstruct.h>

/* Sag = Σ coefficient · term over the disc about the instrument's axis: the numbers of a part
 * `zernike` of a surface (docs/formats.md). */
typedef struct placido_expansion {
  double radius_mm, vertex_z_mm; /* z = vertex_z_mm - sag */
  int order, count;              /* terms 0 to count - 1 */
  double coefficients_um[PLACIDO_ZERNIKE_TERMS];
  double sigma_um[PLACIDO_ZERNIKE_TERMS]; /* 1 standard deviation; NaN where it is not known */
  double covered;                /* share of the disc that data support */
  double rms_um, worst_um;       /* of what the terms leave of the sag, where supported */
} placido_expansion;

/* Least squares over the supported part of the disc, all of its area alike. `order` is 1 to 15;
 * radius_mm 0 means 3 mm, or as far as every point is supported where that is less. `fit` is the
 * surface's own and may be NULL; it gives the standard deviations, by its variants.
 * Returns PLACIDO_OK, PLACIDO_INPUT (order or radius out of range), PLACIDO_QUALITY (less than 90 %
 * of the disc is supported), PLACIDO_MEMORY. */
int placido_expansion_find(placido_expansion *expansion, const placido_surface *surface,
                           const placido_fit *fit, double radius_mm, int order,
                           placido_error *err);

/* Writes `placido-zernike/1`, or a CSV where the path ends in .csv, by way of a temporary name. */
int placido_expansion_save(const placido_expansion *expansion, const char *path,
                           placido_error *err);

#endif

/* Convolution of planes of light with point spread functions: the transforms are planned once for
 * planes of a size, a PSF is transformed once, and both are applied to any number of planes. */
#ifndef PLACIDO_CONVOLUTION_H
#define PLACIDO_CONVOLUTION_H

#include <placido/notes.h>
#include <placido/psf.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* How it is computed; zero means the default in brackets. */
typedef struct placido_convolution {
  bool doubles;              /* transforms in double precision, for twice the time and memory */
  double memory_MB;          /* most memory for one padded tile, above 0 [1024], though no tile is
                                less than a 64th of a plane's side. A thread takes one tile (two for
                                sums), a PSF's transform another */
  int size_px;               /* transforms have at least so many samples a side, 0 to 16,384,
                                whatever that needs of memory [what takes the least time] */
  const char *wisdom_folder; /* transforms measured for this machine, and what was measured kept in
                                this folder: faster, but rounding then depends on it; [NULL: plans
                                are estimated, and results are the same bits each time] */
  int threads;               /* 1 to 256 [1]: one a plane or tile; no result depends on it */
} placido_convolution;

/* Plans and tiles for planes of one size. Any number of threads may use one at the same time. */
typedef struct placido_convolver placido_convolver;

/* A PSF's transform for one convolver. Any number of threads may use it at the same time. */
typedef struct placido_transfer placido_transfer;

/* A plane and what spreads it: width_px * height_px samples, rows outer. */
typedef struct placido_convolution_term {
  const float *source;              /* borrowed during the call */
  const placido_transfer *transfer; /* of the same convolver */
} placido_convolution_term;

/* The sum over terms of their sources spread: layers in depth, wavelengths, parts of a field. */
typedef struct placido_superposition {
  float *target; /* apart from every source */
  const placido_convolution_term *terms;
  size_t count; /* 0: dark */
} placido_superposition;

/* The distance of the farthest bucket with light from the PSF's middle, in buckets along a row or a
 * column: 0 to psf->n / 2. */
int placido_psf_reach(const placido_psf *psf);

/* For planes of width_px × height_px (1 to 65,536) and PSFs up to that reach, in pixels: 0 to
 * 65,536. `how` may be NULL. `notes` (may be NULL) gets a sentence where wisdom cannot be read or
 * kept. Free with placido_convolver_free, after its transfers. Returns PLACIDO_OK, PLACIDO_INPUT,
 * PLACIDO_MEMORY. */
int placido_convolver_new(placido_convolver **convolver, int width_px, int height_px, int reach_px,
                          const placido_convolution *how, placido_notes *notes, placido_error *err);
void placido_convolver_free(placido_convolver *convolver);

/* The PSF's values are copied; a bucket is a pixel. A PSF with all its light in one bucket needs no
 * transform: it shifts a plane, exactly. Returns PLACIDO_OK, PLACIDO_INPUT (it reaches farther than
 * the convolver, or has buckets that are not finite), PLACIDO_MEMORY. */
int placido_transfer_new(placido_transfer **transfer, const placido_convolver *convolver,
                         const placido_psf *psf, placido_error *err);
void placido_transfer_free(placido_transfer *transfer);

/* Each target(x, y) = sum over terms and buckets of psf(column, row) × source(x - (column - h),
 * y - (row - h)), h the PSF's middle bucket; sources are 0 beyond their rim. The PSF is as the
 * patient sees it: light in a bucket above the middle makes a ghost above. Samples that are not
 * finite spoil the whole tile. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_convolver_run(const placido_convolver *convolver, const placido_superposition *planes,
                          size_t count, placido_error *err);

/* Where the user's programs keep what they can make again: $XDG_CACHE_HOME/placido, else
 * ~/.cache/placido. `folder` has room for `size` bytes. Returns PLACIDO_OK, or PLACIDO_SYSTEM where
 * the environment names neither or the name is too long. */
int placido_wisdom_folder(char *folder, size_t size, placido_error *err);

#endif

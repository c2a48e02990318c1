/* Convolution of a picture in linear light: one transfer function for all colours. */
#include "simulate/convolve.h"

#include <placido/convolution.h>

#include <string.h>

#define COLOURS_MAX 3

static int spread(placido_image *target, const placido_image *source,
                  const placido_convolver *convolver, const placido_transfer *transfer,
                  placido_error *err) {
  placido_convolution_term terms[COLOURS_MAX];
  placido_superposition planes[COLOURS_MAX];
  int colours = source->planes < COLOURS_MAX ? source->planes : COLOURS_MAX;
  for (int i = 0; i < colours; i++) {
    terms[i] = (placido_convolution_term){placido_image_plane(source, i), transfer};
    planes[i] = (placido_superposition){placido_image_plane(target, i), &terms[i], 1};
  }
  return placido_convolver_run(convolver, planes, (size_t)colours, err);
}

int placido_convolve_as(placido_image *target, const placido_image *source, const placido_psf *psf,
                        const placido_convolution *how, placido_notes *notes, placido_error *err) {
  placido_convolver *convolver;
  placido_transfer *transfer = NULL;
  if (source->planes == 4) {
    memcpy(placido_image_plane(target, 3), placido_image_plane(source, 3),
           (size_t)source->width_px * (size_t)source->height_px * sizeof *source->data);
  }
  int status = placido_convolver_new(&convolver, source->width_px, source->height_px,
                                     placido_psf_reach(psf), how, notes, err);
  if (status == PLACIDO_OK) {
    status = placido_transfer_new(&transfer, convolver, psf, err);
  }
  if (status == PLACIDO_OK) {
    status = spread(target, source, convolver, transfer, err);
  }
  placido_transfer_free(transfer);
  placido_convolver_free(convolver);
  return status;
}

int placido_convolve(placido_image *target, const placido_image *source, const placido_psf *psf,
                     int threads, placido_error *err) {
  const placido_convolution how = {.threads = threads};
  return placido_convolve_as(target, source, psf, &how, NULL, err);
}

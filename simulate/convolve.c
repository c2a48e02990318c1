/* Convolution in linear light through one padded transfer function for all colours.
 *
 * The PSF is stored as the patient sees it, so a point of the scene spreads by it as it stands, not
 * turned. The padding is zero and as wide as half the PSF: what wraps around falls into it. */
#include "simulate/convolve.h"

#include "base/memory.h"
#include "simulate/fft.h"

#include <stdbool.h>
#include <string.h>

static int colour_planes(const placido_image *image) {
  return image->planes == 1 ? 1 : 3;
}

/* Whether all light is in one bucket, and in which. */
static bool find_only_bucket(const placido_psf *psf, int *column, int *row) {
  int found = 0;
  for (int y = 0; y < psf->n; y++) {
    for (int x = 0; x < psf->n; x++) {
      if (psf->values[(size_t)y * (size_t)psf->n + (size_t)x] != 0) {
        *column = x;
        *row = y;
        found++;
      }
    }
  }
  return found == 1;
}

static void shift_plane(float *target, const float *source, int width, int height, int dx, int dy,
                        float scale) {
  for (int y = 0; y < height; y++) {
    for (int x = 0; x < width; x++) {
      int from_x = x - dx, from_y = y - dy;
      bool inside = from_x >= 0 && from_x < width && from_y >= 0 && from_y < height;
      *target++ = inside ? scale * source[(size_t)from_y * (size_t)width + (size_t)from_x] : 0;
    }
  }
}

static void shift_image(placido_image *target, const placido_image *source,
                        const placido_psf *psf, int column, int row) {
  double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
  for (int plane = 0; plane < colour_planes(source); plane++) {
    shift_plane(placido_image_plane(target, plane), placido_image_plane(source, plane),
                source->width_px, source->height_px, column - psf->n / 2, row - psf->n / 2,
                (float)value);
  }
}

/* The PSF with its middle at (0, 0) and the negative side wrapped to the far end; scaled so that
 * the pair of transforms comes out even. */
static void place_psf(const placido_fft *fft, float *plane, const placido_psf *psf) {
  int half = psf->n / 2;
  double scale = 1.0 / ((double)fft->columns * fft->rows);
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      int x = (column - half + fft->columns) % fft->columns;
      int y = (row - half + fft->rows) % fft->rows;
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      plane[(size_t)y * fft->stride + (size_t)x] = (float)(value * scale);
    }
  }
}

static void place_image(const placido_fft *fft, float *plane, const float *source, int width,
                        int height) {
  for (int y = 0; y < height; y++) {
    memcpy(&plane[(size_t)y * fft->stride], &source[(size_t)y * (size_t)width],
           (size_t)width * sizeof *source);
  }
}

static void take_image(const placido_fft *fft, float *target, const float *plane, int width,
                       int height) {
  for (int y = 0; y < height; y++) {
    memcpy(&target[(size_t)y * (size_t)width], &plane[(size_t)y * fft->stride],
           (size_t)width * sizeof *target);
  }
}

/* spectrum *= transfer, complex numbers in pairs. */
static void multiply(float *spectrum, const float *transfer, size_t floats) {
  for (size_t i = 0; i < floats; i += 2) {
    float re = spectrum[i] * transfer[i] - spectrum[i + 1] * transfer[i + 1];
    float im = spectrum[i] * transfer[i + 1] + spectrum[i + 1] * transfer[i];
    spectrum[i] = re;
    spectrum[i + 1] = im;
  }
}

static void spread_plane(const placido_fft *fft, float *work, const float *transfer,
                         float *target, const float *source, int width, int height) {
  place_image(fft, work, source, width, height);
  placido_fft_forward(fft, work);
  multiply(work, transfer, fft->stride * (size_t)fft->rows);
  placido_fft_backward(fft, work);
  take_image(fft, target, work, width, height);
}

/* Planes of `work`: the transfer function, then one a colour. */
static int spread_image(placido_image *target, const placido_image *source,
                        const placido_psf *psf, int threads, placido_error *err) {
  int planes = colour_planes(source), half = psf->n / 2;
  int width = source->width_px, height = source->height_px;
  int wide = width + half < psf->n ? psf->n : width + half;
  int high = height + half < psf->n ? psf->n : height + half;
  placido_fft fft = placido_fft_shape(wide, high);
  float *work = placido_memory_new((size_t)planes + 1, fft.plane * sizeof *work, err);
  if (work == NULL) {
    return PLACIDO_MEMORY;
  }
  int status = placido_fft_new(&fft, work, err);
  if (status != PLACIDO_OK) {
    goto done;
  }
  place_psf(&fft, work, psf);
  placido_fft_forward(&fft, work);
#pragma omp parallel for num_threads(threads)
  for (int plane = 0; plane < planes; plane++) {
    spread_plane(&fft, work + (size_t)(plane + 1) * fft.plane, work,
                 placido_image_plane(target, plane), placido_image_plane(source, plane), width,
                 height);
  }
done:
  placido_fft_free(&fft);
  placido_memory_free(work);
  return status;
}

int placido_convolve(placido_image *target, const placido_image *source, const placido_psf *psf,
                     int threads, placido_error *err) {
  int column = 0, row = 0;
  if (source->planes == 4) {
    memcpy(placido_image_plane(target, 3), placido_image_plane(source, 3),
           (size_t)source->width_px * (size_t)source->height_px * sizeof *source->data);
  }
  if (find_only_bucket(psf, &column, &row)) {
    shift_image(target, source, psf, column, row);
    return PLACIDO_OK;
  }
  return spread_image(target, source, psf, threads, err);
}

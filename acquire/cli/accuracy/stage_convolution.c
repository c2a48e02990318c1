/* Convolution: what transforms in single precision and small tiles do to the seen chart, against
 * sums in double precision without any transform at some pixels. How much memory a tile may take
 * decides its size, and with it that of the transforms. */
#include "acquire/cli/accuracy/stage.h"
#include "base/memory.h"

#include <placido/convolution.h>

#include <math.h>

#define PIXELS 4000u
#define QUICK_PIXELS 100u

static const char *const settings[] = {
    "doubles=0 memory_MB=0.125", "doubles=0 memory_MB=0.25", "doubles=0 memory_MB=0.5",
    "doubles=0 memory_MB=1", "doubles=0 memory_MB=2", "doubles=0", "doubles=0 size_px=1024",
    "doubles=0 size_px=2048", "doubles=1 memory_MB=0.25", "doubles=1 memory_MB=0.5",
    "doubles=1 memory_MB=1", "doubles=1 memory_MB=2", "doubles=1 memory_MB=4", "doubles=1",
    "doubles=1 size_px=2048", NULL};
static const char *const quick[] = {"doubles=0", "doubles=1", NULL};

struct pixel {
  int x, y;
  double expected;
};

struct prepared {
  size_t count;
  struct pixel *pixels;
};

static void release(void *state) {
  struct prepared *prepared = state;
  if (prepared) {
    placido_memory_free(prepared->pixels);
    placido_memory_free(prepared);
  }
}

/* The sum of a row of buckets: the PSF's mirrored over the source. */
static double sum_row(const placido_psf *psf, int row, const placido_image *image,
                      const struct pixel *pixel) {
  const int half = psf->n / 2, y = pixel->y - (row - half);
  double sum = 0;
  if (y < 0 || y >= image->height_px) {
    return 0;
  }
  for (int column = 0; column < psf->n; column++) {
    const int x = pixel->x - (column - half);
    if (x >= 0 && x < image->width_px) {
      sum += psf->values[(size_t)row * (size_t)psf->n + (size_t)column] *
             (double)image->data[(size_t)y * (size_t)image->width_px + (size_t)x];
    }
  }
  return sum;
}

/* Spread over the picture by a step that has no common divisor with anything. */
static int prepare(void **state, const struct accuracy_bench *bench,
                   const struct accuracy_eye *eye, placido_error *err) {
  const placido_image *image = &bench->chart.scene.image;
  const placido_psf *psf = &eye->seen.psf;
  const size_t samples = (size_t)image->width_px * (size_t)image->height_px;
  struct prepared *prepared = *state = placido_memory_new(1, sizeof *prepared, err);
  if (!prepared) {
    return PLACIDO_MEMORY;
  }
  prepared->count = bench->quick ? QUICK_PIXELS : PIXELS;
  prepared->pixels = placido_memory_new(prepared->count, sizeof *prepared->pixels, err);
  if (!prepared->pixels) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < prepared->count; i++) {
    const size_t at = i * 611953u % samples;
    struct pixel *pixel = &prepared->pixels[i];
    *pixel = (struct pixel){.x = (int)(at % (size_t)image->width_px),
                            .y = (int)(at / (size_t)image->width_px)};
    for (int row = 0; row < psf->n; row++) {
      pixel->expected += sum_row(psf, row, image, pixel);
    }
  }
  return PLACIDO_OK;
}

/* The chart's first plane; the PSF's transform is made each time, as an examination makes it. */
static int convolve(float *seen, const placido_image *image, const placido_psf *psf,
                    const placido_convolution *how, placido_error *err) {
  placido_convolver *convolver = NULL;
  placido_transfer *transfer = NULL;
  int status = placido_convolver_new(&convolver, image->width_px, image->height_px,
                                     placido_psf_reach(psf), how, NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_transfer_new(&transfer, convolver, psf, err);
  }
  if (status == PLACIDO_OK) {
    const placido_convolution_term term = {.source = image->data, .transfer = transfer};
    const placido_superposition plane = {.target = seen, .terms = &term, .count = 1};
    status = placido_convolver_run(convolver, &plane, 1, err);
  }
  placido_transfer_free(transfer);
  placido_convolver_free(convolver);
  return status;
}

static double largest_error(const struct prepared *prepared, const placido_image *seen) {
  double most = 0;
  for (size_t i = 0; i < prepared->count; i++) {
    const struct pixel *pixel = &prepared->pixels[i];
    const size_t at = (size_t)pixel->y * (size_t)seen->width_px + (size_t)pixel->x;
    most = fmax(most, fabs((double)seen->data[at] - pixel->expected));
  }
  return most;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  const placido_image *image = &trial->bench->chart.scene.image;
  const placido_convolution how = {.doubles = trial->knobs.doubles != 0,
                                   .memory_MB = trial->knobs.memory_MB,
                                   .size_px = trial->knobs.size_px};
  struct accuracy_watch watch = {0};
  placido_image seen;
  int status = placido_image_new(&seen, image->width_px, image->height_px, 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  do {
    accuracy_watch_begin(&watch);
    status = convolve(seen.data, image, &trial->eye->seen.psf, &how, err);
    accuracy_watch_end(&watch);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, trial->bench));
  row->ms = watch.least_ms;
  row->error[ACCURACY_IMAGE] = largest_error(trial->prepared, &seen);
  placido_image_free(&seen);
  return status;
}

const struct accuracy_measure accuracy_measure_convolution = {.stage = ACCURACY_CONVOLUTION,
                                                              .settings = settings,
                                                              .quick = quick,
                                                              .prepare = prepare,
                                                              .run = run,
                                                              .release = release};

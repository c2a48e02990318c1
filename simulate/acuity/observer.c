/* Makes an observer: draws the letters once, correlates them, and draws the noise.
 *
 * Letters of another size are the same letters: their correlations only stretch. So everything that
 * costs time is done here, and a size afterwards takes a sum over shifts. */
#include "simulate/acuity/observer.h"

#include "base/memory.h"
#include "base/random.h"
#include "simulate/acuity/table.h"
#include "simulate/fft.h"

#include <math.h>
#include <string.h>

/* Both kinds of noise from two demands: eyes with the mean aberrations of their pupil (0.045, 0.07
 * and 0.10 µm rms at 3, 3.5 and 4 mm) read E and Sloan letters of logMAR -0.1, and defocus b of 0
 * to 3 D costs them what people lose, a factor of 1 + b² (Blendowske
 * 2015), to within 0.15. Without proportional noise the loss is 0.25 too small at 3 D.
 * observer_spread: the spread of contrast sensitivity among healthy young people. */
static const placido_acuity_options defaults = {.noise = 0.76,
                                                .proportional_noise = 0.16,
                                                .observer_spread = 0.1,
                                                .smallest_logmar = -0.5,
                                                .largest_logmar = 1.7,
                                                .trials = 4096,
                                                .seed = 1};

static double or_default(double value, double otherwise) {
  return value != 0 ? value : otherwise;
}

static int check(const placido_acuity_options *o, const placido_acuity_test *test,
                 placido_error *err) {
  const char *wrong = NULL;
  if (!(o->criterion > 1.0 / test->choices && o->criterion < 1)) {
    wrong = "the criterion lies between chance and 1";
  } else if (!(o->noise > 0) || !isfinite(o->noise)) {
    wrong = "the noise is above 0";
  } else if (!(o->proportional_noise >= 0 && o->proportional_noise <= 10)) {
    wrong = "the proportional noise is at most 10";
  } else if (!(o->observer_spread >= 0 && o->observer_spread <= 1)) {
    wrong = "the spread of observers is 0 to 1 decades";
  } else if (!(o->smallest_logmar >= -1 && o->largest_logmar <= 2.5 &&
               o->largest_logmar - o->smallest_logmar >= 0.1)) {
    wrong = "sizes range from logMAR -1 to 2.5, at least a tenth";
  } else if (o->trials < 64 || o->trials > 1000000) {
    wrong = "there are 64 to 1,000,000 trials";
  }
  return wrong == NULL ? PLACIDO_OK : placido_error_set(err, PLACIDO_INPUT, "acuity: %s", wrong);
}

static int settle(placido_acuity_options *settled, const placido_acuity_options *options,
                  const placido_acuity_test *test, placido_error *err) {
  const placido_acuity_options asked = options != NULL ? *options : (placido_acuity_options){0};
  *settled = asked;
  settled->criterion = or_default(asked.criterion, test->criterion);
  settled->noise = or_default(asked.noise, defaults.noise);
  settled->proportional_noise =
    fmax(or_default(asked.proportional_noise, defaults.proportional_noise), 0);
  settled->observer_spread = or_default(asked.observer_spread, defaults.observer_spread);
  if (asked.smallest_logmar == 0 && asked.largest_logmar == 0) {
    settled->smallest_logmar = defaults.smallest_logmar;
    settled->largest_logmar = defaults.largest_logmar;
  }
  settled->trials = asked.trials != 0 ? asked.trials : defaults.trials;
  return check(settled, test, err);
}

static int draw_letter(placido_image *letter, const placido_acuity_letters *letters, int which,
                       placido_error *err) {
  int status = placido_image_new(letter, PLACIDO_LETTER_PX, PLACIDO_LETTER_PX, 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int i = 0; i < PLACIDO_LETTER_PX * PLACIDO_LETTER_PX; i++) {
    letter->data[i] = 1;
  }
  placido_optotype_draw(letter, letters->kind, which * letters->every, PLACIDO_LETTER_PX,
                        PLACIDO_LETTER_PX / 2.0, PLACIDO_LETTER_PX / 2.0, 1);
  return PLACIDO_OK;
}

/* Its spectrum; ink counts 1. */
static int transform_letter(const placido_fft *fft, float *plane,
                            const placido_acuity_letters *letters, int which, placido_error *err) {
  placido_image letter = {0};
  int status = draw_letter(&letter, letters, which, err);
  if (status == PLACIDO_OK) {
    for (int y = 0; y < PLACIDO_LETTER_PX; y++) {
      for (int x = 0; x < PLACIDO_LETTER_PX; x++) {
        plane[(size_t)y * fft->stride + (size_t)x] = 1 - letter.data[y * PLACIDO_LETTER_PX + x];
      }
    }
    placido_fft_forward(fft, plane);
  }
  placido_image_free(&letter);
  return status;
}

/* The real part alone: the mean of a shift and its opposite, all that a symmetric autocorrelation
 * of the optics asks for. */
static void multiply(const placido_fft *fft, float *product, const float *a, const float *b) {
  double scale = 1 / ((double)fft->columns * fft->rows);
  for (size_t i = 0; i < fft->stride * (size_t)fft->rows; i += 2) {
    product[i] = (float)(scale * ((double)a[i] * b[i] + (double)a[i + 1] * b[i + 1]));
    product[i + 1] = 0;
  }
}

static void store(placido_observer *observer, int pair, const placido_fft *fft,
                  const float *plane) {
  for (int dy = 0; dy <= PLACIDO_LETTER_PX; dy++) {
    for (int dx = -PLACIDO_LETTER_PX; dx <= PLACIDO_LETTER_PX; dx++) {
      size_t node = (size_t)dy * PLACIDO_SHIFTS + (size_t)(dx + PLACIDO_LETTER_PX);
      int x = (dx + fft->columns) % fft->columns;
      observer->correlations[node * (size_t)observer->pairs + (size_t)pair] =
        plane[(size_t)dy * fft->stride + (size_t)x];
    }
  }
}

static void correlate(placido_observer *observer, const placido_fft *fft, float *planes) {
  float *product = planes + (size_t)observer->choices * fft->plane;
  int pair = 0;
  for (int i = 0; i < observer->choices; i++) {
    for (int j = 0; j <= i; j++) {
      multiply(fft, product, planes + (size_t)i * fft->plane, planes + (size_t)j * fft->plane);
      placido_fft_backward(fft, product);
      store(observer, pair++, fft, product);
    }
  }
}

/* Planes: every letter's, and one to work in. One more row and column than twice the letter, so
 * that the largest shift either way is itself. */
static int fill_correlations(placido_observer *observer, placido_error *err) {
  const placido_acuity_letters letters = placido_acuity_letters_of(observer->test);
  placido_fft fft = placido_fft_shape(PLACIDO_SHIFTS, PLACIDO_SHIFTS);
  size_t floats = ((size_t)observer->choices + 1) * fft.plane;
  int status = PLACIDO_MEMORY;
  float *planes = placido_memory_new_aligned(floats * sizeof *planes, err);
  if (planes == NULL) {
    return status;
  }
  memset(planes, 0, floats * sizeof *planes);
  status = placido_fft_new(&fft, planes, err);
  for (int i = 0; i < observer->choices && status == PLACIDO_OK; i++) {
    status = transform_letter(&fft, planes + (size_t)i * fft.plane, &letters, i, err);
  }
  if (status == PLACIDO_OK) {
    correlate(observer, &fft, planes);
  }
  placido_fft_free(&fft);
  placido_memory_free(planes);
  return status;
}

static int allocate(placido_observer *observer, placido_error *err) {
  size_t nodes = (size_t)(PLACIDO_LETTER_PX + 1) * PLACIDO_SHIFTS;
  size_t choices = (size_t)observer->choices;
  observer->correlations =
    placido_memory_new(nodes * (size_t)observer->pairs, sizeof *observer->correlations, err);
  if (observer->correlations == NULL) {
    return PLACIDO_MEMORY;
  }
  observer->draws =
    placido_memory_new((size_t)observer->options.trials * choices, sizeof *observer->draws, err);
  return observer->draws == NULL ? PLACIDO_MEMORY : PLACIDO_OK;
}

static void fill_draws(placido_observer *observer) {
  for (int trial = 0; trial < observer->options.trials; trial++) {
    for (int i = 0; i < observer->choices; i++) {
      observer->draws[(size_t)trial * (size_t)observer->choices + (size_t)i] =
        placido_random_normal(observer->options.seed, (uint64_t)i, (uint64_t)trial);
    }
  }
}

int placido_observer_new(placido_observer **observer, const placido_acuity_test *test,
                         const placido_acuity_options *options, placido_error *err) {
  placido_acuity_options settled;
  *observer = NULL;
  int status = settle(&settled, options, test, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_observer *made = placido_memory_new(1, sizeof *made, err);
  if (made == NULL) {
    return PLACIDO_MEMORY;
  }
  made->test = test;
  made->options = settled;
  made->choices = test->choices;
  made->pairs = test->choices * (test->choices + 1) / 2;
  status = allocate(made, err);
  if (status == PLACIDO_OK) {
    status = fill_correlations(made, err);
  }
  if (status != PLACIDO_OK) {
    placido_observer_free(made);
    return status;
  }
  fill_draws(made);
  *observer = made;
  return PLACIDO_OK;
}

void placido_observer_free(placido_observer *observer) {
  if (observer != NULL) {
    placido_memory_free(observer->correlations);
    placido_memory_free(observer->draws);
    placido_memory_free(observer);
  }
}

/* Images of a point apart from the main one: maxima of the smoothed PSF and their watersheds.
 *
 * Pixels are flooded from the brightest down (L. Vincent, P. Soille, IEEE PAMI 13:583 (1991)): each
 * joins the basin that its neighbours belong to. Where two basins meet the fainter is dissolved in
 * the other unless the light has dipped by enough in between (persistence). */
#include "base/memory.h"
#include "simulate/acuity/lags.h"
#include "simulate/fft.h"

#include <placido/ghost.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double default_scale_arcmin = 2;
static const double dip = 0.7;       /* of the fainter maximum, under which two images are two */
static const double one_sided = 0.5; /* of the way to its maximum: where a ghost's middle lies */
static const double diplopia_scales = 2;

typedef struct basin {
  int parent; /* itself where it stands */
  int peak;   /* bucket */
  double light, x, y; /* sums over the raw PSF; x, y in buckets */
} basin;

typedef struct flood {
  int n;
  float *smooth;
  int *order;  /* buckets, the brightest first */
  int *labels; /* basin of a bucket, -1: not flooded yet */
  basin *basins;
  int count;
} flood;

typedef struct bright {
  float value;
  int bucket;
} bright;

/* Equal values in the order of their buckets, so that the result is the same everywhere. */
static int compare(const void *a, const void *b) {
  const bright *x = a, *y = b;
  if (x->value != y->value) {
    return x->value > y->value ? -1 : 1;
  }
  return (x->bucket > y->bucket) - (x->bucket < y->bucket);
}

static int sort(flood *f, placido_error *err) {
  size_t area = (size_t)f->n * (size_t)f->n;
  bright *all = placido_memory_new(area, sizeof *all, err);
  if (all == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < area; i++) {
    all[i] = (bright){f->smooth[i], (int)i};
  }
  qsort(all, area, sizeof *all, compare);
  for (size_t i = 0; i < area; i++) {
    f->order[i] = all[i].bucket;
  }
  placido_memory_free(all);
  return PLACIDO_OK;
}

static int root(flood *f, int label) {
  while (f->basins[label].parent != label) {
    f->basins[label].parent = f->basins[f->basins[label].parent].parent;
    label = f->basins[label].parent;
  }
  return label;
}

static float peak_value(const flood *f, int label) {
  return f->smooth[f->basins[label].peak];
}

/* Two basins meet at a light of `value`. The one that was found first is the brighter. */
static void meet(flood *f, int a, int b, float value) {
  int high = a < b ? a : b, low = a < b ? b : a;
  if (value > dip * peak_value(f, low)) {
    f->basins[low].parent = high;
    f->basins[high].light += f->basins[low].light;
    f->basins[high].x += f->basins[low].x;
    f->basins[high].y += f->basins[low].y;
  }
}

/* The basin of a bucket, of its flooded neighbours' the one with the brightest neighbour; a new one
 * where there is none. */
static int choose_basin(flood *f, int bucket) {
  int x = bucket % f->n, y = bucket / f->n, chosen = -1;
  float best = -INFINITY;
  for (int dy = -1; dy <= 1; dy++) {
    for (int dx = -1; dx <= 1; dx++) {
      int nx = x + dx, ny = y + dy, neighbour = ny * f->n + nx;
      if (nx < 0 || nx >= f->n || ny < 0 || ny >= f->n || f->labels[neighbour] < 0) {
        continue;
      }
      int label = root(f, f->labels[neighbour]);
      if (chosen >= 0 && label != root(f, chosen)) {
        meet(f, root(f, chosen), label, f->smooth[bucket]);
      }
      if (f->smooth[neighbour] > best) {
        best = f->smooth[neighbour];
        chosen = label;
      }
    }
  }
  if (chosen < 0) {
    chosen = f->count++;
    f->basins[chosen] = (basin){.parent = chosen, .peak = bucket};
  }
  return root(f, chosen);
}

static void run_flood(flood *f, const placido_psf *psf) {
  int area = f->n * f->n;
  for (int i = 0; i < area; i++) {
    f->labels[i] = -1;
  }
  for (int i = 0; i < area; i++) {
    int bucket = f->order[i], label = choose_basin(f, bucket);
    f->labels[bucket] = label;
    f->basins[label].light += psf->values[bucket];
    f->basins[label].x += psf->values[bucket] * (bucket % f->n);
    f->basins[label].y += psf->values[bucket] * (bucket / f->n);
  }
}

/* The transform of a Gaussian whose width at half height is scale_buckets. */
static double gaussian(double cycles_x, double cycles_y, double scale_buckets) {
  double sigma = scale_buckets / 2.354820;
  return exp(-2 * M_PI * M_PI * sigma * sigma * (cycles_x * cycles_x + cycles_y * cycles_y));
}

static void filter(float *plane, const placido_fft *fft, double scale_buckets) {
  double norm = 1 / ((double)fft->columns * fft->rows);
  for (int row = 0; row < fft->rows; row++) {
    int wave = row <= fft->rows / 2 ? row : fft->rows - row;
    for (int i = 0; i <= fft->columns / 2; i++) {
      float *value = &plane[(size_t)row * fft->stride + 2 * (size_t)i];
      double gain = norm * gaussian((double)i / fft->columns, (double)wave / fft->rows,
                                    scale_buckets);
      value[0] = (float)(gain * value[0]);
      value[1] = (float)(gain * value[1]);
    }
  }
}

/* The padding is wide enough that nothing comes round from the other side. */
static int smooth(flood *f, const placido_psf *psf, double scale_buckets, placido_error *err) {
  int wide = f->n + (int)ceil(3 * scale_buckets);
  placido_fft fft = placido_fft_shape(wide, wide);
  float *plane = placido_memory_new_aligned(fft.plane * sizeof *plane, err);
  if (plane == NULL) {
    return PLACIDO_MEMORY;
  }
  memset(plane, 0, fft.plane * sizeof *plane);
  int status = placido_fft_new(&fft, plane, err);
  if (status == PLACIDO_OK) {
    for (int i = 0; i < f->n * f->n; i++) {
      plane[(size_t)(i / f->n) * fft.stride + (size_t)(i % f->n)] = (float)psf->values[i];
    }
    placido_fft_forward(&fft, plane);
    filter(plane, &fft, scale_buckets);
    placido_fft_backward(&fft, plane);
    for (int i = 0; i < f->n * f->n; i++) {
      f->smooth[i] = plane[(size_t)(i / f->n) * fft.stride + (size_t)(i % f->n)];
    }
  }
  placido_fft_free(&fft);
  placido_memory_free(plane);
  return status;
}

static int flood_new(flood *f, const placido_psf *psf, double scale_buckets, placido_error *err) {
  size_t area = (size_t)psf->n * (size_t)psf->n;
  *f = (flood){.n = psf->n};
  if ((f->smooth = placido_memory_new(area, sizeof *f->smooth, err)) == NULL ||
      (f->order = placido_memory_new(area, sizeof *f->order, err)) == NULL ||
      (f->labels = placido_memory_new(area, sizeof *f->labels, err)) == NULL ||
      (f->basins = placido_memory_new(area, sizeof *f->basins, err)) == NULL) {
    return PLACIDO_MEMORY;
  }
  int status = smooth(f, psf, scale_buckets, err);
  return status == PLACIDO_OK ? sort(f, err) : status;
}

static void flood_free(flood *f) {
  placido_memory_free(f->smooth);
  placido_memory_free(f->order);
  placido_memory_free(f->labels);
  placido_memory_free(f->basins);
}

static double wrap(double value, double period) {
  return value - period * floor(value / period);
}

/* Where the image's light has its middle, against the main image's maximum. A halo's lies far
 * nearer than its maximum; false then. */
static bool measure(placido_ghost *ghost, const flood *f, const basin *image, const basin *main,
                    double bucket_arcmin) {
  double x0 = main->peak % f->n, y0 = main->peak / f->n;
  double peak = hypot(image->peak % f->n - x0, image->peak / f->n - y0);
  double x = image->x / image->light - x0, y = y0 - image->y / image->light;
  double apart = hypot(x, y);
  double direction = wrap(atan2(y, x) * 180 / M_PI, 360), clock = wrap((90 - direction) / 30, 12);
  *ghost = (placido_ghost){.separation_arcmin = apart * bucket_arcmin,
                           .direction_deg = direction,
                           .clock_h = clock > 0 ? clock : 12,
                           .share = image->light / main->light};
  return apart >= one_sided * peak;
}

/* Keeps the brightest, in order. */
static void insert(placido_ghosts *ghosts, const placido_ghost *ghost) {
  int at = ghosts->count;
  while (at > 0 && ghosts->items[at - 1].share < ghost->share) {
    at--;
  }
  if (at >= PLACIDO_GHOSTS_MAX) {
    return;
  }
  int moved = (ghosts->count < PLACIDO_GHOSTS_MAX ? ghosts->count : PLACIDO_GHOSTS_MAX - 1) - at;
  memmove(&ghosts->items[at + 1], &ghosts->items[at], (size_t)moved * sizeof *ghost);
  ghosts->items[at] = *ghost;
  ghosts->count += ghosts->count < PLACIDO_GHOSTS_MAX;
}

/* The first bucket to be flooded is the main image's maximum. */
static void list(placido_ghosts *ghosts, const flood *f, double bucket_arcmin) {
  const basin *main = &f->basins[0];
  double all = 0;
  for (int i = 0; i < f->count; i++) {
    const basin *image = &f->basins[i];
    placido_ghost ghost;
    if (image->parent != i) {
      continue;
    }
    all += image->light;
    if (i > 0 && image->light >= PLACIDO_GHOST_LISTED * main->light &&
        measure(&ghost, f, image, main, bucket_arcmin)) {
      insert(ghosts, &ghost);
    }
  }
  ghosts->main_share = main->light / all;
  for (int i = 0; i < ghosts->count; i++) {
    const placido_ghost *ghost = &ghosts->items[i];
    ghosts->diplopia = ghosts->diplopia ||
                       (ghost->share >= PLACIDO_GHOST_DIPLOPIA &&
                        ghost->separation_arcmin >= diplopia_scales * ghosts->scale_arcmin);
  }
}

int placido_ghosts_find(placido_ghosts *ghosts, const placido_psf *psf, double scale_arcmin,
                        placido_error *err) {
  *ghosts = (placido_ghosts){0};
  int status = placido_psf_check(psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double widest = psf->n * psf->bucket_arcmin / 4;
  double scale = scale_arcmin != 0 ? scale_arcmin : fmin(default_scale_arcmin, widest);
  if (!(scale > 0 && scale <= widest)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "ghosts: a scale of %g' is not within 0 to %g', a quarter of the PSF",
                             scale, widest);
  }
  flood f;
  status = flood_new(&f, psf, scale / psf->bucket_arcmin, err);
  if (status == PLACIDO_OK) {
    run_flood(&f, psf);
    ghosts->scale_arcmin = scale;
    list(ghosts, &f, psf->bucket_arcmin);
  }
  flood_free(&f);
  return status;
}

void placido_ghosts_write(char *text, size_t size, const placido_ghosts *ghosts) {
  const placido_ghost *first = &ghosts->items[0];
  if (ghosts->count == 0) {
    snprintf(text, size, "No ghost image.");
    return;
  }
  int hour = (int)floor(first->clock_h + 0.5);
  char number[64] = "A ghost image";
  if (ghosts->count > 1) {
    snprintf(number, sizeof number, "%d ghost images, the brightest", ghosts->count);
  }
  snprintf(text, size, "%s %.3g' from the main one towards %d o'clock, with %.0f %% of its "
           "light%s.", number, first->separation_arcmin, hour == 0 ? 12 : hour, 100 * first->share,
           ghosts->diplopia ? ": seen double" : "");
}

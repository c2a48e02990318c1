/* Sampling along meridians, one pixel a step along the nearer axis of the image. */
#include "reconstruct/mires/polar.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>

#define SIDE_MOST (1.0 / 3) /* shares of the pixels beside a meridian: the more, the less noise */
#define PASSES_MOST 24      /* for the widest filter */
#define TAPS_USUAL 6
#define TAPS_MOST (TAPS_USUAL + 2 * (PASSES_MOST - 1))
#define ASLANT 0.82 /* the narrow one where the meridian's cosine to the nearer axis is less */
#define PHASES 256
#define BEYOND_PX 8     /* how far samples reach beyond the centre */
#define SATURATED 0.998F /* of the full range */

/* Weights of the pixels from `passes` + 1 before to `passes` + 2 after the one at or before the
 * meridian, by how far that one lies before it. */
typedef struct kernel {
  double variance_px2;
  int passes, taps;
  float weight[(PHASES + 1) * TAPS_MOST]; /* rows of `taps` */
} kernel;

/* The cubic B-spline at x. */
static double cubic(double x) {
  double a = fabs(x), b = 1 - a, c = 2 - a;
  return ((c > 0 ? c * c * c : 0) - (b > 0 ? 4 * b * b * b : 0)) / 6;
}

/* The weights of B-splines 1 px apart, from -passes to passes: `side`, 1 - 2 side, `side`, folded
 * with itself so often. */
static void fold(double share[2 * PASSES_MOST + 1], int passes, double side) {
  for (int i = 0; i < 2 * PASSES_MOST + 1; i++) {
    share[i] = i == 0;
  }
  for (int pass = 1; pass <= passes; pass++) {
    for (int i = 2 * pass; i >= 0; i--) {
      share[i] = side * share[i] + (i > 0 ? (1 - 2 * side) * share[i - 1] : 0) +
                 (i > 1 ? side * share[i - 2] : 0);
    }
  }
}

/* Cubic B-splines 1 px apart, weighed with `side`, 1 - 2 side, `side` so many times over. */
static void kernel_fill(kernel *k, int passes, double side) {
  double share[2 * PASSES_MOST + 1];
  fold(share, passes, side);
  k->passes = passes;
  k->taps = 4 + 2 * passes;
  k->variance_px2 = 1.0 / 3 + 2 * side * passes;
  for (int p = 0; p <= PHASES; p++) {
    for (int t = 0; t < k->taps; t++) {
      double x = (double)p / PHASES - (t - 1 - passes), sides = 0;
      for (int i = 0; i < passes; i++) {
        sides += share[i] * (cubic(x - (passes - i)) + cubic(x + (passes - i)));
      }
      k->weight[p * k->taps + t] = (float)(sides + share[passes] * cubic(x));
    }
  }
}

/* The kernel whose standard deviation is filter_px, and one of half as much beside the B-spline
 * itself: aslant to the rows the pixels beside a meridian blur along it, too. */
static void kernels_fill(kernel *wide, kernel *narrow, double filter_px) {
  double more = (filter_px * filter_px - 1.0 / 3) / 2; /* than the B-spline's own */
  int passes = (int)ceil(more / SIDE_MOST - 1e-9);
  passes = passes > 1 ? passes : 1;
  double side = fmin(SIDE_MOST, more / passes);
  kernel_fill(wide, passes, side);
  kernel_fill(narrow, passes, side / 2);
}

/* A meridian's way through the pixels: from sample to sample `main` pixels further in memory and
 * `drift` pixels across, taps `across` apart. */
typedef struct path {
  ptrdiff_t main, across, first; /* pixels; the first of its column or row */
  double at_main, at_across, drift; /* of sample 0 */
  bool narrow;
  int last_across;                  /* pixels run from 0 to this across the path */
} path;

/* Fits samples into the image and tells how the pixels lie. */
static path path_of(placido_meridian *along, const placido_image *plane, const double centre[2],
                    double angle, double radius, int passes) {
  double du = cos(angle), dv = -sin(angle); /* v runs down */
  bool rows = fabs(du) >= fabs(dv);
  double direction = rows ? du : dv, side = rows ? dv : du;
  double from_main = centre[rows ? 0 : 1], from_across = centre[rows ? 1 : 0];
  int last_main = (rows ? plane->width_px : plane->height_px) - 1;
  path way = {.last_across = (rows ? plane->height_px : plane->width_px) - 1};
  double cosine = fabs(direction);
  along->step_px = 1 / cosine;
  /* the first sample is the first pixel inwards of BEYOND_PX before the centre */
  double first = from_main - copysign(BEYOND_PX * cosine, direction);
  way.at_main = direction > 0 ? ceil(first) : floor(first);
  way.at_main = fmax(0, fmin(last_main, way.at_main));
  along->start_px = (way.at_main - from_main) / direction;
  way.at_across = from_across + along->start_px * side;
  way.drift = side / cosine;
  double room = direction > 0 ? last_main - way.at_main : way.at_main;
  if (way.drift > 0) {
    room = fmin(room, (way.last_across - passes - 2.01 - way.at_across) / way.drift);
  } else if (way.drift < 0) {
    room = fmin(room, (way.at_across - passes - 1.01) / -way.drift);
  }
  room = fmin(room, (radius - along->start_px) / along->step_px);
  bool inside = way.at_across >= passes + 1 && way.at_across < way.last_across - passes - 2;
  along->count = inside && room >= 0 ? (int)room + 1 : 0;
  way.narrow = cosine < ASLANT;
  ptrdiff_t width = plane->width_px;
  way.main = (rows ? 1 : width) * (direction > 0 ? 1 : -1);
  way.across = rows ? width : 1;
  way.first = (ptrdiff_t)way.at_main * (rows ? 1 : width);
  return way;
}

/* The pixels about a place, the first of them p, apart by a; the usual number is written out. */
static float gather(const float *p, ptrdiff_t a, const float *w, int taps) {
  if (taps == TAPS_USUAL) {
    return (w[0] * p[0] + w[1] * p[a] + w[2] * p[2 * a]) +
           (w[3] * p[3 * a] + w[4] * p[4 * a] + w[5] * p[5 * a]);
  }
  float sum = 0;
  for (int t = 0; t < taps; t++) {
    sum += w[t] * p[t * a];
  }
  return sum;
}

/* Takes the samples of one meridian; returns the brightest pixel met. */
static float sample(float *row, int count, const placido_image *plane, const path *way,
                    const kernel *k) {
  ptrdiff_t a = way->across;
  const float *line = plane->data + way->first;
  float most = 0;
  for (int i = 0; i < count; i++, line += way->main) {
    double across = way->at_across + i * way->drift;
    int base = (int)across;
    const float *w = k->weight + (int)((across - base) * PHASES + 0.5) * k->taps;
    row[i] = gather(line + (base - k->passes - 1) * a, a, w, k->taps);
    most = line[base * a] > most ? line[base * a] : most;
  }
  return most;
}

/* Marks the samples of one meridian that took a saturated pixel. */
static void mark(unsigned char *row, int count, const placido_image *plane, const path *way,
                 int passes) {
  ptrdiff_t a = way->across;
  const float *line = plane->data + way->first;
  for (int i = 0; i < count; i++, line += way->main) {
    const float *p = line + (int)(way->at_across + i * way->drift) * a;
    row[i] = 0;
    for (int t = -passes; t <= passes + 1; t++) {
      row[i] |= p[t * a] > SATURATED;
    }
  }
}

/* Marks in all meridians. */
static int mark_clipped(placido_polar *polar, const placido_image *plane, double radius_px,
                        int passes, int threads, placido_error *err) {
  size_t samples = (size_t)polar->samples;
  polar->clipped = placido_memory_new((size_t)polar->meridians * samples, 1, err);
  if (!polar->clipped) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for num_threads(threads)
  for (int m = 0; m < polar->meridians; m++) {
    placido_meridian *along = &polar->along[m];
    path way =
        path_of(along, plane, polar->centre_px, 2 * M_PI * m / polar->meridians, radius_px, passes);
    mark(polar->clipped + (size_t)m * samples, along->count, plane, &way, passes);
  }
  return PLACIDO_OK;
}

/* Samples all meridians; returns the brightest pixel met. */
static float unroll(placido_polar *polar, const placido_image *plane, double radius_px,
                    const kernel *wide, const kernel *narrow, int threads) {
  float most = 0;
#pragma omp parallel for num_threads(threads) reduction(max : most)
  for (int m = 0; m < polar->meridians; m++) {
    placido_meridian *along = &polar->along[m];
    path way = path_of(along, plane, polar->centre_px, 2 * M_PI * m / polar->meridians, radius_px,
                       wide->passes);
    const kernel *k = way.narrow ? narrow : wide;
    along->tangential_px2 = k->variance_px2 / (along->step_px * along->step_px);
    along->radial_px2 = k->variance_px2 - along->tangential_px2;
    float *row = polar->data + (size_t)m * (size_t)polar->samples;
    float brightest = sample(row, along->count, plane, &way, k);
    most = brightest > most ? brightest : most;
  }
  return most;
}

int placido_polar_new(placido_polar *polar, const placido_image *plane, const double centre_px[2],
                      double radius_px, int meridians, double filter_px, int threads,
                      placido_error *err) {
  *polar = (placido_polar){.centre_px = {centre_px[0], centre_px[1]}, .meridians = meridians};
  kernel *kernels = placido_memory_new(2, sizeof *kernels, err);
  if (!kernels) {
    return PLACIDO_MEMORY;
  }
  kernels_fill(&kernels[0], &kernels[1], filter_px);
  int passes = kernels[0].passes, status = PLACIDO_OK;
  double least = passes + 2, most = passes + 4;
  double diagonal = hypot(plane->width_px, plane->height_px);
  polar->samples = (int)(fmin(radius_px, diagonal) + BEYOND_PX) + 2;
  size_t count = (size_t)meridians * (size_t)polar->samples;
  if (!(centre_px[0] >= least && centre_px[0] <= plane->width_px - most &&
        centre_px[1] >= least && centre_px[1] <= plane->height_px - most)) {
    status = placido_error_set(err, PLACIDO_QUALITY, "the mires' centre lies outside the image");
    goto done;
  }
  polar->along = placido_memory_new((size_t)meridians, sizeof *polar->along, err);
  polar->data = placido_memory_new(count, sizeof *polar->data, err);
  if (!polar->along || !polar->data) {
    status = PLACIDO_MEMORY;
    goto done;
  }
  if (unroll(polar, plane, radius_px, &kernels[0], &kernels[1], threads) > SATURATED) {
    status = mark_clipped(polar, plane, radius_px, passes, threads, err);
  }
done:
  placido_memory_free(kernels);
  if (status) {
    placido_polar_free(polar);
  }
  return status;
}

void placido_polar_free(placido_polar *polar) {
  placido_memory_free(polar->along);
  placido_memory_free(polar->data);
  placido_memory_free(polar->clipped);
  *polar = (placido_polar){0};
}

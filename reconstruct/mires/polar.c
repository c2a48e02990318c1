/* Sampling along meridians, one pixel a step along the nearer axis of the image. */
#include "reconstruct/mires/polar.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>

#define TAPS 6
#define SIDE_WIDE (1.0 / 3) /* shares of the pixels beside a meridian: the more, the less noise, */
#define SIDE_NARROW (1.0 / 6)  /* but aslant to the rows they blur along the meridian, too */
#define ASLANT 0.82 /* the narrow one where the meridian's cosine to the nearer axis is less */
#define PHASES 256
#define BEYOND_PX 8     /* how far samples reach beyond the centre */
#define SATURATED 0.998F /* of the full range */

/* Weights of the pixels from two before to three after the one at or before the meridian, by how
 * far that one lies before it. */
typedef struct kernel {
  double variance_px2;
  float weight[PHASES + 1][TAPS];
} kernel;

/* The cubic B-spline at x. */
static double cubic(double x) {
  double a = fabs(x), b = 1 - a, c = 2 - a;
  return ((c > 0 ? c * c * c : 0) - (b > 0 ? 4 * b * b * b : 0)) / 6;
}

/* Cubic B-splines 1 px apart, weighed `side`, 1 - 2 side, `side`. */
static void kernel_fill(kernel *k, double side) {
  k->variance_px2 = 1.0 / 3 + 2 * side;
  for (int p = 0; p <= PHASES; p++) {
    for (int t = 0; t < TAPS; t++) {
      double x = (double)p / PHASES - (t - 2);
      double sides = cubic(x - 1) + cubic(x + 1);
      k->weight[p][t] = (float)(side * sides + (1 - 2 * side) * cubic(x));
    }
  }
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
                    double angle, double radius) {
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
    room = fmin(room, (way.last_across - 3.01 - way.at_across) / way.drift);
  } else if (way.drift < 0) {
    room = fmin(room, (way.at_across - 2.01) / -way.drift);
  }
  room = fmin(room, (radius - along->start_px) / along->step_px);
  bool inside = way.at_across >= 2 && way.at_across < way.last_across - 3;
  along->count = inside && room >= 0 ? (int)room + 1 : 0;
  way.narrow = cosine < ASLANT;
  ptrdiff_t width = plane->width_px;
  way.main = (rows ? 1 : width) * (direction > 0 ? 1 : -1);
  way.across = rows ? width : 1;
  way.first = (ptrdiff_t)way.at_main * (rows ? 1 : width);
  return way;
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
    const float *w = k->weight[(int)((across - base) * PHASES + 0.5)];
    const float *p = line + (base - 2) * a;
    row[i] = (w[0] * p[0] + w[1] * p[a] + w[2] * p[2 * a]) +
             (w[3] * p[3 * a] + w[4] * p[4 * a] + w[5] * p[5 * a]);
    most = p[2 * a] > most ? p[2 * a] : most;
  }
  return most;
}

/* Marks the samples of one meridian that took a saturated pixel. */
static void mark(unsigned char *row, int count, const placido_image *plane, const path *way) {
  ptrdiff_t a = way->across;
  const float *line = plane->data + way->first;
  for (int i = 0; i < count; i++, line += way->main) {
    const float *p = line + (int)(way->at_across + i * way->drift) * a;
    row[i] = p[-a] > SATURATED || p[0] > SATURATED || p[a] > SATURATED || p[2 * a] > SATURATED;
  }
}

/* Marks in all meridians. */
static int mark_clipped(placido_polar *polar, const placido_image *plane, double radius_px,
                        int threads, placido_error *err) {
  size_t samples = (size_t)polar->samples;
  polar->clipped = placido_memory_new((size_t)polar->meridians * samples, 1, err);
  if (!polar->clipped) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for num_threads(threads)
  for (int m = 0; m < polar->meridians; m++) {
    placido_meridian *along = &polar->along[m];
    path way = path_of(along, plane, polar->centre_px, 2 * M_PI * m / polar->meridians, radius_px);
    mark(polar->clipped + (size_t)m * samples, along->count, plane, &way);
  }
  return PLACIDO_OK;
}

int placido_polar_new(placido_polar *polar, const placido_image *plane, const double centre_px[2],
                      double radius_px, int meridians, int threads, placido_error *err) {
  *polar = (placido_polar){.centre_px = {centre_px[0], centre_px[1]}, .meridians = meridians};
  if (!(centre_px[0] >= 3 && centre_px[0] <= plane->width_px - 5 && centre_px[1] >= 3 &&
        centre_px[1] <= plane->height_px - 5)) {
    return placido_error_set(err, PLACIDO_QUALITY, "the mires' centre lies outside the image");
  }
  double diagonal = hypot(plane->width_px, plane->height_px);
  polar->samples = (int)(fmin(radius_px, diagonal) + BEYOND_PX) + 2;
  size_t count = (size_t)meridians * (size_t)polar->samples;
  polar->along = placido_memory_new((size_t)meridians, sizeof *polar->along, err);
  polar->data = placido_memory_new(count, sizeof *polar->data, err);
  if (!polar->along || !polar->data) {
    placido_polar_free(polar);
    return PLACIDO_MEMORY;
  }
  kernel wide, narrow;
  kernel_fill(&wide, SIDE_WIDE);
  kernel_fill(&narrow, SIDE_NARROW);
  float most = 0;
#pragma omp parallel for num_threads(threads) reduction(max : most)
  for (int m = 0; m < meridians; m++) {
    placido_meridian *along = &polar->along[m];
    path way = path_of(along, plane, centre_px, 2 * M_PI * m / meridians, radius_px);
    const kernel *k = way.narrow ? &narrow : &wide;
    along->tangential_px2 = k->variance_px2 / (along->step_px * along->step_px);
    along->radial_px2 = k->variance_px2 - along->tangential_px2;
    float *row = polar->data + (size_t)m * (size_t)polar->samples;
    float brightest = sample(row, along->count, plane, &way, k);
    most = brightest > most ? brightest : most;
  }
  int status = most > SATURATED ? mark_clipped(polar, plane, radius_px, threads, err) : PLACIDO_OK;
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

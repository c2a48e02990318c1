/* Mire light by adaptive sampling: a ray through every corner of a pixel tells which pixels an edge
 * crosses, and only those get many rays. Rows are independent, so threads cannot change a bit. */
#include "phantom/light.h"

#include "base/memory.h"

#include <stdint.h>
#ifdef _OPENMP
#include <omp.h>
#endif

/* The work and its intermediate result. */
typedef struct job {
  const placido_phantom_rig *rig;
  int width, height, subsamples;
  int16_t *bands; /* (height + 1) rows of width + 1 corners */
  float *light;
} job;

int placido_phantom_threads(int threads) {
#ifdef _OPENMP
  return threads > 0 ? threads : omp_get_max_threads();
#else
  (void)threads;
  return 1;
#endif
}

static int16_t *corner(const job *j, int x, int y) {
  return j->bands + (size_t)y * (size_t)(j->width + 1) + x;
}

/* Traces the corners above pixel row y (y = height: below the last row). */
static int trace_corners(const job *j, int y) {
  size_t count = (size_t)j->width + 1;
  double *points = placido_memory_new(2 * count, sizeof *points, NULL);
  if (!points) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    points[2 * i] = (double)i - 0.5;
    points[2 * i + 1] = y - 0.5;
  }
  int status = placido_phantom_camera_normalise(points, points, count, j->rig->instrument, NULL);
  placido_phantom_hit hit = {0};
  for (size_t i = 0; i < count && status == PLACIDO_OK; i++) {
    placido_phantom_trace(j->rig, points + 2 * i, &hit);
    *corner(j, (int)i, y) = (int16_t)hit.band;
  }
  placido_memory_free(points);
  return status;
}

/* Range of the bands in a block of corners, cut at the image's border. */
static int band_range(const job *j, int x0, int x1, int y0, int y1) {
  int low = INT16_MAX, high = INT16_MIN;
  for (int y = y0 < 0 ? 0 : y0; y <= (y1 > j->height ? j->height : y1); y++) {
    for (int x = x0 < 0 ? 0 : x0; x <= (x1 > j->width ? j->width : x1); x++) {
      int band = *corner(j, x, y);
      low = band < low ? band : low;
      high = band > high ? band : high;
    }
  }
  return high - low;
}

/* Whether a pixel is not wholly in one band: its corners differ, or bands around it are so narrow
 * that one could pass between the corners. */
static bool is_mixed(const job *j, int x, int y) {
  const int16_t *above = corner(j, x, y), *below = corner(j, x, y + 1);
  if (above[0] != above[1] || above[0] != below[0] || above[0] != below[1]) {
    return true;
  }
  return band_range(j, x - 1, x + 2, y - 1, y + 2) >= 2;
}

/* Puts the sample points of a pixel at `points`. */
static void place_samples(const job *j, double *points, int x, int y) {
  int n = j->subsamples;
  for (int i = 0; i < n * n; i++) {
    points[2 * i] = x + (i % n + 0.5) / n - 0.5;
    points[2 * i + 1] = y + (i / n + 0.5) / n - 0.5;
  }
}

/* Share of a mixed pixel's rays that meet a lit band. */
static float lit_share(const job *j, const double *points, placido_phantom_hit *hit) {
  int rays = j->subsamples * j->subsamples, lit = 0;
  for (int i = 0; i < rays; i++) {
    placido_phantom_trace(j->rig, points + 2 * (size_t)i, hit);
    lit += placido_phantom_is_bright(j->rig->instrument, hit->band);
  }
  return (float)lit / (float)rays;
}

/* Lights the pixels of row y that lie in one band and lists the others. Returns how many. */
static size_t light_whole_pixels(const job *j, int y, int *mixed) {
  size_t count = 0;
  float *row = j->light + (size_t)y * (size_t)j->width;
  for (int x = 0; x < j->width; x++) {
    if (is_mixed(j, x, y)) {
      mixed[count++] = x;
    } else {
      row[x] = placido_phantom_is_bright(j->rig->instrument, *corner(j, x, y)) ? 1.0F : 0.0F;
    }
  }
  return count;
}

static int light_row(const job *j, int y) {
  int status = PLACIDO_MEMORY;
  size_t rays = (size_t)j->subsamples * (size_t)j->subsamples;
  double *points = NULL;
  int *mixed = placido_memory_new((size_t)j->width, sizeof *mixed, NULL);
  if (!mixed) {
    goto done;
  }
  size_t count = light_whole_pixels(j, y, mixed);
  points = placido_memory_new(2 * rays * count, sizeof *points, NULL);
  if (!points) {
    goto done;
  }
  for (size_t i = 0; i < count; i++) {
    place_samples(j, points + 2 * rays * i, mixed[i], y);
  }
  status = placido_phantom_camera_normalise(points, points, rays * count, j->rig->instrument, NULL);
  placido_phantom_hit hit = {0};
  float *row = j->light + (size_t)y * (size_t)j->width;
  for (size_t i = 0; i < count && status == PLACIDO_OK; i++) {
    row[mixed[i]] = lit_share(j, points + 2 * rays * i, &hit);
  }
done:
  placido_memory_free(points);
  placido_memory_free(mixed);
  return status;
}

/* Runs `each` over `rows` rows; the lowest of their statuses. */
static int over_rows(const job *j, int (*each)(const job *, int), int rows, int threads) {
  int status = PLACIDO_OK;
#pragma omp parallel for schedule(dynamic, 8) num_threads(threads) reduction(min : status)
  for (int y = 0; y < rows; y++) {
    int row_status = each(j, y);
    status = row_status < status ? row_status : status;
  }
  return status;
}

int placido_phantom_light(placido_image *light, const placido_phantom_rig *rig, int subsamples,
                          int threads, placido_error *err) {
  job j = {
      .rig = rig,
      .width = rig->instrument->width_px,
      .height = rig->instrument->height_px,
      .subsamples = subsamples,
      .light = placido_image_plane(light, 0),
  };
  size_t corners = ((size_t)j.width + 1) * ((size_t)j.height + 1);
  j.bands = placido_memory_new(corners, sizeof *j.bands, err);
  if (!j.bands) {
    return PLACIDO_MEMORY;
  }
  threads = placido_phantom_threads(threads);
  int status = over_rows(&j, trace_corners, j.height + 1, threads);
  if (status == PLACIDO_OK) {
    status = over_rows(&j, light_row, j.height, threads);
  }
  placido_memory_free(j.bands);
  if (status != PLACIDO_OK) {
    placido_error_set(err, status, "rendering of %d×%d pixels stopped: %s", j.width, j.height,
                      status == PLACIDO_MEMORY ? "out of memory" : "lens undistortion failed");
  }
  return status;
}

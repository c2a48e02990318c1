/* Cubic B-spline interpolation of the window about the mires along meridians. */
#include "reconstruct/mires/polar.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

/* The spline coefficients of a window of the plane. */
typedef struct window {
  int x0, y0, width, height;
  float *data;
} window;

static const float POLE = -0.26794919243112270647f; /* sqrt(3) - 2 */

/* Recursive prefilter along one line of `count` samples `stride` apart, several lines abreast. The
 * mirror boundary's sum has died out to float rounding after 16 terms. */
static void prefilter(float *data, int count, size_t stride, int abreast) {
  const float gain = 6;
  int horizon = count < 16 ? count : 16;
  for (int b = 0; b < abreast; b++) {
    float sum = 0, power = 1;
    for (int i = 0; i < horizon; i++) {
      sum += power * data[(size_t)i * stride + (size_t)b];
      power *= POLE;
    }
    data[b] = gain * sum;
  }
  for (int i = 1; i < count; i++) {
    float *here = data + (size_t)i * stride, *before = here - stride;
    for (int b = 0; b < abreast; b++) {
      here[b] = gain * here[b] + POLE * before[b];
    }
  }
  float *last = data + (size_t)(count - 1) * stride, *second = count > 1 ? last - stride : last;
  for (int b = 0; b < abreast; b++) {
    last[b] = POLE / (POLE * POLE - 1) * (last[b] + POLE * second[b]);
  }
  for (int i = count - 2; i >= 0; i--) {
    float *here = data + (size_t)i * stride, *after = here + stride;
    for (int b = 0; b < abreast; b++) {
      here[b] = POLE * (after[b] - here[b]);
    }
  }
}

static int window_new(window *out, const placido_image *plane, const double centre[2],
                      double radius, int threads, placido_error *err) {
  out->x0 = (int)fmax(0, floor(centre[0] - radius - 4));
  out->y0 = (int)fmax(0, floor(centre[1] - radius - 4));
  out->width = (int)fmin(plane->width_px - 1, ceil(centre[0] + radius + 4)) - out->x0 + 1;
  out->height = (int)fmin(plane->height_px - 1, ceil(centre[1] + radius + 4)) - out->y0 + 1;
  out->data = NULL;
  if (out->width < 8 || out->height < 8) {
    return placido_error_set(err, PLACIDO_QUALITY, "the mires' centre lies outside the image");
  }
  size_t width = (size_t)out->width;
  out->data = placido_memory_new(width * (size_t)out->height, sizeof *out->data, err);
  if (!out->data) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for num_threads(threads)
  for (int y = 0; y < out->height; y++) {
    float *row = out->data + (size_t)y * width;
    memcpy(row, plane->data + (size_t)(y + out->y0) * (size_t)plane->width_px + out->x0,
           width * sizeof *row);
    prefilter(row, out->width, 1, 1);
  }
#pragma omp parallel for num_threads(threads)
  for (int x = 0; x < out->width; x += 64) {
    prefilter(out->data + x, out->height, width, out->width - x < 64 ? out->width - x : 64);
  }
  return PLACIDO_OK;
}

static void weights(float t, float w[4]) {
  float s = 1 - t;
  w[0] = s * s * s / 6;
  w[1] = 2.0f / 3 - t * t * (2 - t) / 2;
  w[2] = 2.0f / 3 - s * s * (2 - s) / 2;
  w[3] = t * t * t / 6;
}

/* The spline at image point (u, v); NaN within 2 px of the window's border. */
static float spline_at(const window *w, double u, double v) {
  double x = u - w->x0, y = v - w->y0;
  int i = (int)x, j = (int)y;
  if (!(x >= 1 && y >= 1) || i > w->width - 3 || j > w->height - 3) {
    return NAN;
  }
  float wx[4], wy[4], sum = 0;
  weights((float)(x - i), wx);
  weights((float)(y - j), wy);
  const float *p = w->data + (size_t)(j - 1) * (size_t)w->width + (size_t)(i - 1);
  for (int r = 0; r < 4; r++, p += w->width) {
    sum += wy[r] * (wx[0] * p[0] + wx[1] * p[1] + wx[2] * p[2] + wx[3] * p[3]);
  }
  return sum;
}

static void unroll(placido_polar *polar, const window *w, int meridian) {
  double angle = 2 * M_PI * meridian / polar->meridians;
  double du = cos(angle), dv = -sin(angle); /* v runs down */
  float *row = polar->data + (size_t)meridian * (size_t)polar->samples;
  for (int i = 0; i < polar->samples; i++) {
    double r = i * PLACIDO_POLAR_STEP_PX;
    double u = polar->centre_px[0] + r * du, v = polar->centre_px[1] + r * dv;
    row[i] = 0.5f * spline_at(w, u, v) +
             0.25f * (spline_at(w, u - dv, v + du) + spline_at(w, u + dv, v - du));
  }
}

int placido_polar_new(placido_polar *polar, const placido_image *plane, const double centre_px[2],
                      double radius_px, int meridians, int threads, placido_error *err) {
  *polar = (placido_polar){.centre_px = {centre_px[0], centre_px[1]},
                           .meridians = meridians,
                           .samples = (int)(radius_px / PLACIDO_POLAR_STEP_PX) + 1};
  window w;
  int status = window_new(&w, plane, centre_px, radius_px, threads, err);
  if (!status) {
    polar->data = placido_memory_new((size_t)meridians * (size_t)polar->samples,
                                     sizeof *polar->data, err);
    status = polar->data ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (!status) {
#pragma omp parallel for num_threads(threads)
    for (int m = 0; m < meridians; m++) {
      unroll(polar, &w, m);
    }
  }
  placido_memory_free(w.data);
  return status;
}

void placido_polar_free(placido_polar *polar) {
  placido_memory_free(polar->data);
  *polar = (placido_polar){0};
}

/* Conicoid by Levenberg-Marquardt over four parameters; the derivatives of its jet by central
 * differences, which are good to nine digits here. */
#include "reconstruct/solve/conic.h"

#include <math.h>

#define PARAMETERS 4 /* radius, asphericity, cx, cy */
#define STEPS_MAX 8 /* a scale: it need not be the best conicoid, the spline takes up the rest */
#define SURFACE_RADIUS_MM 9

static const double RANGES[PARAMETERS][2] = {{4, 16}, {-2.5, 2}, {-3, 3}, {-3, 3}};
static const double STARTS[PARAMETERS] = {7.8, 0, 0, 0};

static placido_part part_of(const double v[PARAMETERS]) {
  return (placido_part){.kind = PLACIDO_PART_BICONIC,
                        .as.biconic = {v[0], v[1], v[0], v[1], 0, v[2], v[3]}};
}

int placido_conic_surface(placido_surface **surface, const placido_part *part, double vertex_z_mm,
                          placido_error *err) {
  return placido_surface_new(surface, vertex_z_mm, SURFACE_RADIUS_MM, part, 1, NULL, err);
}

/* The conicoid through (0, 0, axis_z): its vertex lies above that by its own sag there. */
static int through_axis(placido_surface **surface, const double v[PARAMETERS], double axis_z_mm,
                        double *vertex_z_mm, placido_error *err) {
  placido_part part = part_of(v);
  placido_jet jet;
  int status = placido_conic_surface(surface, &part, 0, err);
  if (!status) {
    placido_surface_at(*surface, 0, 0, &jet);
    placido_surface_free(*surface);
    *vertex_z_mm = axis_z_mm + jet.sag;
    status = placido_conic_surface(surface, &part, *vertex_z_mm, err);
  }
  return status;
}

/* Sum of the robust losses log(1 + (r/scale)²), and the share of rays that meet the conicoid. */
static double loss(placido_sample *samples, size_t count, const placido_surface *base,
                   double scale, int threads, double *share) {
  placido_shape shape = {.base = base};
#pragma omp parallel for num_threads(threads)
  for (size_t i = 0; i < count; i++) {
    placido_sample_trace(&samples[i], &shape);
  }
  double sum = 0;
  size_t met = 0;
  for (size_t i = 0; i < count; i++) {
    double r = samples[i].residual_px / scale;
    met += !isnan(r);
    sum += isnan(r) ? 10 : log1p(r * r);
  }
  *share = (double)met / (double)count;
  return sum / (double)count;
}

/* The residual's derivative by each parameter, from the difference of the jets on either side. */
static void slopes(const placido_sample *s, placido_surface *sides[PARAMETERS][2],
                   const double steps[PARAMETERS], double out[PARAMETERS]) {
  for (int i = 0; i < PARAMETERS; i++) {
    placido_jet a, b;
    out[i] = 0;
    if (placido_surface_at(sides[i][0], s->hit.x, s->hit.y, &a) &&
        placido_surface_at(sides[i][1], s->hit.x, s->hit.y, &b)) {
      double dz = (placido_surface_vertex_z_mm(sides[i][1]) - b.sag) -
                  (placido_surface_vertex_z_mm(sides[i][0]) - a.sag);
      out[i] = (s->miss.by_z * dz - s->miss.by_p * (b.sx - a.sx) - s->miss.by_q * (b.sy - a.sy)) /
               (2 * steps[i] * s->slope);
    }
  }
}

/* Solves the damped 4×4 normal equations by Gauss-Jordan elimination; they are positive definite.
 */
static void solve(double a[PARAMETERS][PARAMETERS], double b[PARAMETERS], double damping) {
  for (int i = 0; i < PARAMETERS; i++) {
    a[i][i] = a[i][i] * (1 + damping) + 1e-12;
  }
  for (int k = 0; k < PARAMETERS; k++) {
    double pivot = a[k][k];
    for (int j = 0; j < PARAMETERS; j++) {
      a[k][j] /= pivot;
    }
    b[k] /= pivot;
    for (int i = 0; i < PARAMETERS; i++) {
      double factor = a[i][k];
      for (int j = 0; i != k && j < PARAMETERS; j++) {
        a[i][j] -= factor * a[k][j];
      }
      b[i] -= i != k ? factor * b[k] : 0;
    }
  }
}

static int gather(const placido_sample *samples, size_t count, const double v[PARAMETERS],
                  double axis_z_mm, double scale, double a[PARAMETERS][PARAMETERS],
                  double b[PARAMETERS], placido_error *err) {
  static const double steps[PARAMETERS] = {1e-4, 1e-4, 1e-4, 1e-4};
  placido_surface *sides[PARAMETERS][2] = {{NULL}};
  int status = PLACIDO_OK;
  for (int i = 0; i < PARAMETERS && !status; i++) {
    for (int side = 0; side < 2 && !status; side++) {
      double moved[PARAMETERS] = {v[0], v[1], v[2], v[3]}, vertex;
      moved[i] += side ? steps[i] : -steps[i];
      status = through_axis(&sides[i][side], moved, axis_z_mm, &vertex, err);
    }
  }
  for (size_t s = 0; s < count && !status; s++) {
    double r = samples[s].residual_px, by[PARAMETERS];
    if (isnan(r)) {
      continue;
    }
    slopes(&samples[s], sides, steps, by);
    double weight = 1 / (1 + r * r / (scale * scale));
    for (int i = 0; i < PARAMETERS; i++) {
      b[i] -= weight * by[i] * r;
      for (int j = 0; j < PARAMETERS; j++) {
        a[i][j] += weight * by[i] * by[j];
      }
    }
  }
  for (int i = 0; i < PARAMETERS; i++) {
    placido_surface_free(sides[i][0]);
    placido_surface_free(sides[i][1]);
  }
  return status;
}

/* One accepted step, or none where every damping fails. */
static int improve(double v[PARAMETERS], double *cost, placido_sample *samples, size_t count,
                   double axis_z_mm, double scale, int threads, bool *moved, placido_error *err) {
  double a[PARAMETERS][PARAMETERS] = {{0}}, b[PARAMETERS] = {0}, share;
  int status = gather(samples, count, v, axis_z_mm, scale, a, b, err);
  *moved = false;
  for (double damping = 1e-4; damping < 1e4 && !*moved && !status; damping *= 10) {
    double m[PARAMETERS][PARAMETERS], step[PARAMETERS], trial[PARAMETERS], vertex;
    for (int i = 0; i < PARAMETERS; i++) {
      step[i] = b[i];
      for (int j = 0; j < PARAMETERS; j++) {
        m[i][j] = a[i][j];
      }
    }
    solve(m, step, damping);
    for (int i = 0; i < PARAMETERS; i++) {
      trial[i] = fmax(RANGES[i][0], fmin(RANGES[i][1], v[i] + step[i]));
    }
    placido_surface *base = NULL;
    status = through_axis(&base, trial, axis_z_mm, &vertex, err);
    if (!status) {
      double now = loss(samples, count, base, scale, threads, &share);
      if (now < *cost) {
        *moved = *cost - now > 1e-3 * *cost;
        *cost = now;
        for (int i = 0; i < PARAMETERS; i++) {
          v[i] = trial[i];
        }
        placido_surface_free(base);
        break;
      }
    }
    placido_surface_free(base);
  }
  return status;
}

int placido_conic_fit(placido_part *part, double *vertex_z_mm, placido_sample *samples,
                      size_t count, double axis_z_mm, int threads, placido_error *err) {
  double v[PARAMETERS] = {STARTS[0], STARTS[1], STARTS[2], STARTS[3]}, share = 0;
  placido_surface *base = NULL;
  int status = PLACIDO_OK;
  /* from a generous scale, where no point is an outlier yet, down to that of a good conicoid */
  for (double scale = 20; scale > 1 && !status; scale /= 4) {
    bool moved = true;
    status = through_axis(&base, v, axis_z_mm, vertex_z_mm, err);
    if (status) {
      return status;
    }
    double cost = loss(samples, count, base, scale, threads, &share);
    placido_surface_free(base);
    for (int step = 0; step < STEPS_MAX && moved && !status; step++) {
      status = improve(v, &cost, samples, count, axis_z_mm, scale, threads, &moved, err);
    }
  }
  if (!status) {
    status = through_axis(&base, v, axis_z_mm, vertex_z_mm, err);
  }
  if (!status) {
    loss(samples, count, base, 1, threads, &share);
    placido_surface_free(base);
    *part = part_of(v);
    if (share < 0.8) {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "no cornea mirrors the mires to where they are seen: %.0f %% of "
                                 "the camera's rays miss the best conicoid",
                                 100 * (1 - share));
    }
  }
  return status;
}

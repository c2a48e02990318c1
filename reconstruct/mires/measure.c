/* Sub-pixel position of an edge: least squares fit of offset + height/2 · erf((r - r0)/(w √2)) to
 * the profile, four parameters by Gauss-Newton. */
#include "reconstruct/mires/edges.h"

#include <math.h>

#define WINDOW_MAX 40 /* samples */

/* The parameters, in the order of the normal equations. */
typedef struct step {
  double place, offset, height, width;
} step;

/* Solves the symmetric positive 4×4 system in place by Cholesky's method and leaves the first
 * diagonal element of the inverse in *inverse00. Returns false where it is singular. */
static bool solve4(double a[4][4], double b[4], double *inverse00) {
  double unit[4] = {1, 0, 0, 0};
  for (int j = 0; j < 4; j++) {
    for (int k = 0; k < j; k++) {
      a[j][j] -= a[j][k] * a[j][k];
    }
    if (!(a[j][j] > 0)) {
      return false;
    }
    a[j][j] = sqrt(a[j][j]);
    for (int i = j + 1; i < 4; i++) {
      for (int k = 0; k < j; k++) {
        a[i][j] -= a[i][k] * a[j][k];
      }
      a[i][j] /= a[j][j];
    }
  }
  double *sides[2] = {b, unit};
  for (int s = 0; s < 2; s++) {
    double *x = sides[s];
    for (int i = 0; i < 4; i++) {
      for (int k = 0; k < i; k++) {
        x[i] -= a[i][k] * x[k];
      }
      x[i] /= a[i][i];
    }
    for (int i = 3; i >= 0; i--) {
      for (int k = i + 1; k < 4; k++) {
        x[i] -= a[k][i] * x[k];
      }
      x[i] /= a[i][i];
    }
  }
  *inverse00 = unit[0];
  return true;
}

/* One fit to samples [from, to] of the profile. Returns false where it does not settle. */
static bool fit_step(step *s, double *sigma, const float *profile, int from, int to) {
  double rms = 0, inverse00 = 0;
  int count = to - from + 1;
  double start = s->place;
  for (int pass = 0; pass < 12; pass++) {
    double a[4][4] = {{0}}, b[4] = {0}, sum = 0;
    for (int i = from; i <= to; i++) {
      double x = (i * PLACIDO_POLAR_STEP_PX - s->place) / s->width;
      double bell = exp(-0.5 * x * x) / sqrt(2 * M_PI);
      double wave = 0.5 * erf(x * M_SQRT1_2);
      double error = profile[i] - (s->offset + s->height * wave);
      double by[4] = {-s->height * bell / s->width, 1, wave, -s->height * bell * x / s->width};
      sum += error * error;
      for (int j = 0; j < 4; j++) {
        b[j] += by[j] * error;
        for (int k = 0; k <= j; k++) {
          a[j][k] += by[j] * by[k];
        }
      }
    }
    a[3][3] *= 1 + 1e-9;
    if (!solve4(a, b, &inverse00)) {
      return false;
    }
    rms = sqrt(sum / (count - 4));
    double limit = 0.5 * s->width;
    s->place += fmax(-limit, fmin(limit, b[0]));
    s->offset += b[1];
    s->height += b[2];
    s->width = fmax(0.3, fmin(s->width * 1.5, s->width + b[3]));
    if (fabs(s->place - start) > 2 || isnan(s->place)) {
      return false;
    }
    if (fabs(b[0]) < 1e-5) {
      break;
    }
  }
  *sigma = rms * sqrt(inverse00);
  return isfinite(*sigma);
}

/* The window about candidate i: up to 0.55 of the way to its neighbours, at most `most` px. */
static void window_of(const placido_crossings *all, size_t i, int samples, int *from, int *to) {
  const placido_crossing *c = &all->list[i];
  double inward = c->radius_px, outward = samples * PLACIDO_POLAR_STEP_PX - c->radius_px;
  if (i > all->first[c->meridian]) {
    inward = 0.55 * (c->radius_px - all->list[i - 1].radius_px);
  }
  if (i + 1 < all->first[c->meridian + 1]) {
    outward = 0.55 * (all->list[i + 1].radius_px - c->radius_px);
  }
  /* half the distance to the neighbours is flat where the blur is small; more adds only texture */
  double most = fmax(3.25, 0.8 * fmin(inward, outward));
  double room = WINDOW_MAX / 2 * PLACIDO_POLAR_STEP_PX;
  most = fmin(most, room - 1);
  *from = (int)ceil((c->radius_px - fmin(inward, most)) / PLACIDO_POLAR_STEP_PX);
  *to = (int)floor((c->radius_px + fmin(outward, most)) / PLACIDO_POLAR_STEP_PX);
  *from = *from < 0 ? 0 : *from;
  *to = *to > samples - 1 ? samples - 1 : *to;
}

static bool measure(placido_crossings *all, size_t i, const placido_polar *polar) {
  placido_crossing *c = &all->list[i];
  const float *profile = polar->data + (size_t)c->meridian * (size_t)polar->samples;
  int from, to;
  window_of(all, i, polar->samples, &from, &to);
  if (to - from < 6 || isnan(profile[from]) || isnan(profile[to])) {
    return false;
  }
  step s = {.place = c->radius_px,
            .offset = 0.5 * (profile[from] + profile[to]),
            .height = (double)profile[to] - profile[from],
            .width = 1};
  double sigma;
  if (!fit_step(&s, &sigma, profile, from, to) || (s.height > 0) != (c->slope > 0)) {
    return false;
  }
  /* Blurring a curved edge across its own tangent pulls it inwards by variance / (2 radius). */
  double variance = s.width * s.width + PLACIDO_POLAR_ARC_VARIANCE;
  c->radius_px = s.place + variance / (2 * s.place);
  c->height = fabs(s.height);
  c->width_px = s.width;
  c->sigma_px = fmax(sigma, 0.002);
  return true;
}

void placido_crossings_measure(placido_crossings *crossings, const placido_polar *polar,
                               int threads) {
  /* neighbours' places are read while places are written: measure against the places before */
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int m = 0; m < crossings->meridians; m++) {
    double moved[1024];
    size_t first = crossings->first[m], last = crossings->first[m + 1];
    size_t count = last - first < 1024 ? last - first : 1024;
    for (size_t i = 0; i < count; i++) {
      placido_crossing *c = &crossings->list[first + i];
      double before = c->radius_px;
      if (c->edge >= 0 && !measure(crossings, first + i, polar)) {
        c->edge = -1;
      }
      moved[i] = c->radius_px;
      c->radius_px = before;
    }
    for (size_t i = 0; i < count; i++) {
      crossings->list[first + i].radius_px = moved[i];
    }
  }
}

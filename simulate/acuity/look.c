/* How alike letters of one size are when seen: the optics' autocorrelation at the shifts for which
 * the letters' correlations are known, times these.
 *
 * Letters have sharp edges, so that their correlations alias where they are sampled by coarse
 * buckets: where buckets are coarser than a letter's pixels the optics, which are smooth, are
 * interpolated to these, by sines cut off with Kaiser's window (J. F. Kaiser, in: Kuo and Kaiser,
 * System Analysis by Digital Computer, 1966). Where they are finer each bucket is shared out among
 * the pixels around it. */
#include "simulate/acuity/observer.h"

#include <math.h>
#include <string.h>

#define PAIRS_MAX (PLACIDO_CHOICES_MAX * (PLACIDO_CHOICES_MAX + 1) / 2)

static const double kaiser = 8; /* what the cut-off leaves is 80 dB down */

/* Modified Bessel function of the first kind, order 0, by its power series. */
static double bessel_i0(double x) {
  double term = 1, sum = 1;
  for (int k = 1; term > 1e-12 * sum; k++) {
    term *= (x / (2 * k)) * (x / (2 * k));
    sum += term;
  }
  return sum;
}

static double interpolation(double x) {
  double share = x / PLACIDO_TAPS;
  if (fabs(share) >= 1) {
    return 0;
  }
  double sine = x == 0 ? 1 : sin(M_PI * x) / (M_PI * x);
  return sine * bessel_i0(kaiser * sqrt(1 - share * share)) / bessel_i0(kaiser);
}

/* The row of weights of a node, of buckets -reach .. reach. */
static void fill_weights(placido_sight *sight, double px_in_steps, int reach) {
  for (int i = 0; i < PLACIDO_SHIFTS; i++) {
    double at = (i - PLACIDO_LETTER_PX) * px_in_steps;
    for (int k = -reach; k <= reach; k++) {
      sight->weights[i][k + reach] = interpolation(at - k);
    }
  }
}

static double sum_products(const double *a, const double *b, int count) {
  double sum = 0;
  for (int k = 0; k < count; k++) {
    sum += a[k] * b[k];
  }
  return sum;
}

/* Rows first, then columns. Beyond the grid there is next to nothing. */
static void interpolate(placido_sight *sight, const placido_lags *lags, double px_in_steps) {
  int wanted = (int)ceil(PLACIDO_LETTER_PX * px_in_steps) + PLACIDO_TAPS;
  int room = (lags->columns < lags->rows ? lags->columns : lags->rows) / 2 - 1;
  int reach = wanted < room ? wanted : room, known = 2 * reach + 1;
  fill_weights(sight, px_in_steps, reach);
  memset(sight->rows, 0, sizeof sight->rows);
  for (int y = 0; y <= PLACIDO_LETTER_PX; y++) {
    const double *weights = sight->weights[y + PLACIDO_LETTER_PX];
    for (int k = -reach; k <= reach; k++) {
      const float *row = &lags->values[(size_t)(k < 0 ? k + lags->rows : k) * lags->stride];
      double weight = weights[k + reach];
      for (int x = -reach; x <= reach && weight != 0; x++) {
        sight->rows[y][x + reach] += weight * row[x < 0 ? x + lags->columns : x];
      }
    }
    for (int x = 0; x < PLACIDO_SHIFTS; x++) {
      sight->nodes[y][x] = sum_products(sight->weights[x], sight->rows[y], known);
    }
  }
}

/* Adds `value` to the four nodes around a shift in pixels of the letter. */
static void share_out(placido_sight *sight, double x, double y, double value) {
  int column = (int)floor(x) + PLACIDO_LETTER_PX, row = (int)y;
  double right = x - floor(x), below = y - row;
  sight->nodes[row][column] += (1 - right) * (1 - below) * value;
  sight->nodes[row][column + 1] += right * (1 - below) * value;
  sight->nodes[row + 1][column] += (1 - right) * below * value;
  sight->nodes[row + 1][column + 1] += right * below * value;
}

/* Shifts of less than the letter; those upwards are as those downwards and count double. */
static void gather(placido_sight *sight, const placido_lags *lags, double step_in_px) {
  int reach = (int)ceil(PLACIDO_LETTER_PX / step_in_px) - 1;
  int across = reach < lags->columns / 2 ? reach : lags->columns / 2 - 1;
  int down = reach < lags->rows / 2 ? reach : lags->rows / 2 - 1;
  for (int dy = 0; dy <= down; dy++) {
    const float *row = &lags->values[(size_t)dy * lags->stride];
    for (int dx = -across; dx <= across; dx++) {
      double value = row[dx < 0 ? dx + lags->columns : dx];
      share_out(sight, dx * step_in_px, dy * step_in_px, dy > 0 ? 2 * value : value);
    }
  }
}

static void sum_nodes(double *sums, const placido_observer *observer, const double *nodes) {
  const int pairs = observer->pairs;
  const float *row = observer->correlations;
  for (size_t node = 0; node < (size_t)(PLACIDO_LETTER_PX + 1) * PLACIDO_SHIFTS; node++) {
    for (int pair = 0; pair < pairs; pair++) {
      sums[pair] += nodes[node] * row[pair];
    }
    row += pairs;
  }
}

void placido_observer_look(placido_gram *gram, const placido_observer *observer,
                           const placido_lags *lags, double stroke_arcmin, placido_sight *sight) {
  double sums[PAIRS_MAX] = {0};
  double px_arcmin = 5 * stroke_arcmin / PLACIDO_LETTER_PX;
  double px_deg = px_arcmin / 60, step_deg = lags->step_arcmin / 60;
  double area_deg2;
  memset(sight->nodes, 0, sizeof sight->nodes);
  if (px_arcmin < lags->step_arcmin) {
    interpolate(sight, lags, px_arcmin / lags->step_arcmin);
    for (int i = PLACIDO_SHIFTS; i < (PLACIDO_LETTER_PX + 1) * PLACIDO_SHIFTS; i++) {
      sight->nodes[i / PLACIDO_SHIFTS][i % PLACIDO_SHIFTS] *= 2; /* and the upward shifts */
    }
    area_deg2 = px_deg * px_deg;
  } else {
    gather(sight, lags, lags->step_arcmin / px_arcmin);
    area_deg2 = step_deg * step_deg;
  }
  sum_nodes(sums, observer, &sight->nodes[0][0]);
  int pair = 0;
  for (int i = 0; i < observer->choices; i++) {
    for (int j = 0; j <= i; j++) {
      gram->values[i][j] = gram->values[j][i] = area_deg2 * px_deg * px_deg * sums[pair++];
    }
  }
}

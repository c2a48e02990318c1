/* Tally: light into buckets, by points or by area.
 *
 * A ray stands for a cell of the pupil, which the cornea's refraction maps to a small
 * parallelogram on the retina; its light belongs to all of it. (The same idea carries density
 * fields between cosmology's particles: Abel, Hahn and Kaehler, MNRAS 427 (2012) 61.) A box with
 * the same variance along x and y stands in for it wherever it is smaller than a bucket and not
 * slanted; else the parallelogram is cut into pieces. */
#include "simulate/psf/tally.h"

#include "base/dispatch.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>

static const double slant_max = 0.2; /* covariance that a box may leave out, as slant_of has it */

enum {
  PIECES_MAX = 1024, /* along a side, each up to one bucket long */
  TOGETHER = 128     /* spots whose boxes are placed before their light is added */
};

int placido_tally_new(placido_tally *tally, int n, int rings, placido_error *err) {
  size_t area = (size_t)n * (size_t)n;
  *tally = (placido_tally){.n = n, .rings = rings};
  tally->buckets = placido_memory_new(area + (size_t)rings, sizeof *tally->buckets, err);
  if (tally->buckets == NULL) {
    return PLACIDO_MEMORY;
  }
  tally->outside = tally->buckets + area;
  return PLACIDO_OK;
}

void placido_tally_free(placido_tally *tally) {
  if (tally != NULL) {
    placido_memory_free(tally->buckets);
    *tally = (placido_tally){0};
  }
}

void placido_tally_merge(placido_tally *tally, const placido_tally *other) {
  size_t count = (size_t)tally->n * (size_t)tally->n + (size_t)tally->rings;
  for (size_t i = 0; i < count; i++) {
    tally->buckets[i] += other->buckets[i];
  }
}

static bool is_within(const placido_tally *tally, double x, double y) {
  return x >= 0 && x < tally->n && y >= 0 && y < tally->n;
}

static void add_outside(placido_tally *tally, double x, double y, int64_t light) {
  double middle = tally->n / 2.0;
  double ring = floor(fmax(fabs(x - middle), fabs(y - middle)) + 0.5);
  tally->outside[ring < tally->rings ? (int)ring : tally->rings - 1] += light;
}

static void add_point(placido_tally *tally, double x, double y, int64_t light) {
  if (is_within(tally, x, y)) {
    tally->buckets[(size_t)y * (size_t)tally->n + (size_t)x] += light;
  } else {
    add_outside(tally, x, y, light);
  }
}

long placido_tally_count(placido_tally *tally, const placido_spots *spots) {
  long within = 0;
  for (size_t i = 0; i < spots->count; i++) {
    if (isfinite(spots->x[i])) {
      add_point(tally, spots->x[i], spots->y[i], (int64_t)spots->light[i]);
      within += is_within(tally, spots->x[i], spots->y[i]);
    }
  }
  return within;
}

/* The share of [first, first + width] that lies before `end`. */
static double share_before(double end, double first, double width) {
  double share = (end - first) / width;
  return share > 0 ? fmin(share, 1) : 0; /* a width of nothing lies where it begins */
}

/* A box over any buckets, each piece's end rounded to whole units, so that their sum is `light`. */
static void add_box(placido_tally *tally, double x, double y, double width, double height,
                    double light) {
  const double left = x - width / 2, top = y - height / 2;
  const double last_column = floor(left + width), last_row = floor(top + height);
  double done = 0;
  for (double row = floor(top); row <= last_row; row++) {
    double until = row == last_row ? light : floor(light * share_before(row + 1, top, height));
    double rest = until - done, given = 0;
    done = until;
    for (double column = floor(left); column <= last_column; column++) {
      double to = column == last_column ? rest
                                        : floor(rest * share_before(column + 1, left, width));
      add_point(tally, column + 0.5, row + 0.5, (int64_t)(to - given));
      given = to;
    }
  }
}

/* A box no larger than a bucket and wholly within the buckets, so that it lies in at most four: its
 * left and top, and what share of it lies in the first column and row. */
typedef struct small_box {
  double left, top, across, down; /* left is -1 for any other box */
} small_box;

PLACIDO_INSIDE small_box find_small(double x, double y, double width, double height, double last) {
  small_box s = {.left = x - width / 2, .top = y - height / 2};
  double before = floor(s.left) + 1 - s.left, above = floor(s.top) + 1 - s.top;
  bool fits = (width <= 1) & (height <= 1) & (s.left >= 0) & (s.left < last) & (s.top >= 0) &
              (s.top < last);
  s.across = before < width ? before / width : 1;
  s.down = above < height ? above / height : 1;
  s.left = fits ? s.left : -1;
  return s;
}

/* Whole units to its four buckets, whose sum is `light`. */
PLACIDO_INSIDE void add_small(const placido_tally *tally, const small_box *s, double light) {
  const size_t column = (size_t)s->left, row = (size_t)s->top, n = (size_t)tally->n;
  double first = light * s->across;
  int64_t whole = (int64_t)first, first_above = (int64_t)(first * s->down);
  int64_t next = (int64_t)light - whole, next_above = (int64_t)((light - first) * s->down);
  int64_t *bucket = tally->buckets + row * n + column;
  bucket[0] += first_above;
  bucket[1] += next_above;
  bucket[n] += whole - first_above;
  bucket[n + 1] += next - next_above;
}

/* Pieces of a side so that each is no longer than a bucket; where boxes would leave out too much
 * covariance, so that each has little of it. */
static int pieces_of(double side_x, double side_y, bool slanted) {
  double square = side_x * side_x + side_y * side_y;
  double limit = slanted ? fmax(square, 2 * fabs(side_x * side_y) / slant_max) : square;
  return limit < (double)PIECES_MAX * PIECES_MAX ? (int)fmax(ceil(sqrt(limit)), 1) : PIECES_MAX;
}

/* Covariance of a parallelogram's light, in twelfths of a bucket squared. */
PLACIDO_INSIDE double slant_of(double ax, double ay, double bx, double by) {
  return fabs(ax * ay + bx * by);
}

/* The parallelogram cut into pieces along both sides. */
static void add_pieces(placido_tally *tally, const placido_spots *s, size_t i) {
  int na = pieces_of(s->ax[i], s->ay[i], false), nb = pieces_of(s->bx[i], s->by[i], false);
  if (na * nb == 1) { /* small, but too slanted for one box */
    na = pieces_of(s->ax[i], s->ay[i], true);
    nb = pieces_of(s->bx[i], s->by[i], true);
  }
  const double ax = s->ax[i] / na, ay = s->ay[i] / na, bx = s->bx[i] / nb, by = s->by[i] / nb;
  const double width = sqrt(ax * ax + bx * bx), height = sqrt(ay * ay + by * by);
  const double each = floor(s->light[i] / (na * nb));
  double light = s->light[i] - each * (na * nb - 1); /* the first takes what is left over */
  for (int k = 0; k < na; k++) {
    double a = k - (na - 1) / 2.0, x = s->x[i] + a * ax, y = s->y[i] + a * ay;
    for (int l = 0; l < nb; l++) {
      double b = l - (nb - 1) / 2.0, at_x = x + b * bx, at_y = y + b * by;
      small_box small = find_small(at_x, at_y, width, height, tally->n - 1);
      if (small.left >= 0) {
        add_small(tally, &small, light);
      } else {
        add_box(tally, at_x, at_y, width, height, light);
      }
      light = each;
    }
  }
}

/* Boxes that are large, or not wholly within the buckets; what would cover all of them several
 * times is a point. */
static void add_any(placido_tally *tally, const placido_spots *s, size_t i) {
  double reach_x = fabs(s->ax[i]) + fabs(s->bx[i]), reach_y = fabs(s->ay[i]) + fabs(s->by[i]);
  double middle = tally->n / 2.0, reach_max = 2.0 * tally->n;
  bool touches = fabs(s->x[i] - middle) < middle + reach_x &&
                 fabs(s->y[i] - middle) < middle + reach_y;
  if (!touches || !(reach_x < reach_max && reach_y < reach_max)) {
    add_point(tally, s->x[i], s->y[i], (int64_t)s->light[i]);
  } else if (s->width[i] <= 1 && s->height[i] <= 1) {
    add_box(tally, s->x[i], s->y[i], s->width[i], s->height[i], s->light[i]);
  } else {
    add_pieces(tally, s, i);
  }
}

PLACIDO_WIDE
static void find_boxes(double *restrict width, double *restrict height, const double *restrict ax,
                       const double *restrict ay, const double *restrict bx,
                       const double *restrict by, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double slant = slant_of(ax[i], ay[i], bx[i], by[i]);
    double box = sqrt(ax[i] * ax[i] + bx[i] * bx[i]);
    width[i] = slant <= slant_max ? box : INFINITY;
    height[i] = sqrt(ay[i] * ay[i] + by[i] * by[i]);
  }
}

PLACIDO_WIDE
static void find_smalls(double *restrict left, double *restrict top, double *restrict across,
                        double *restrict down, const double *restrict x, const double *restrict y,
                        const double *restrict width, const double *restrict height, double last,
                        size_t count) {
  for (size_t i = 0; i < count; i++) {
    small_box s = find_small(x[i], y[i], width[i], height[i], last);
    left[i] = s.left;
    top[i] = s.top;
    across[i] = s.across;
    down[i] = s.down;
  }
}

/* A piece of the spots that fits the processor's nearest memory. */
static long spread_some(placido_tally *tally, const placido_spots *s, size_t begin, size_t count) {
  double left[TOGETHER], top[TOGETHER], across[TOGETHER], down[TOGETHER];
  long within = 0;
  find_smalls(left, top, across, down, s->x + begin, s->y + begin, s->width + begin,
              s->height + begin, tally->n - 1, count);
  for (size_t i = 0; i < count; i++) {
    const size_t spot = begin + i;
    if (left[i] >= 0) {
      add_small(tally, &(small_box){left[i], top[i], across[i], down[i]}, s->light[spot]);
      within++;
    } else if (isfinite(s->x[spot])) {
      add_any(tally, s, spot);
      within += is_within(tally, s->x[spot], s->y[spot]);
    }
  }
  return within;
}

long placido_tally_spread(placido_tally *tally, const placido_spots *s) {
  long within = 0;
  find_boxes(s->width, s->height, s->ax, s->ay, s->bx, s->by, s->count);
  for (size_t begin = 0; begin < s->count; begin += TOGETHER) {
    size_t rest = s->count - begin;
    within += spread_some(tally, s, begin, rest < TOGETHER ? rest : TOGETHER);
  }
  return within;
}

/* A circle's gradients all point along lines through its centre: the point nearest to all lines, by
 * least squares whose weights fall for lines that pass it by at an angle (Cauchy), first of
 * everything, then of what lies ever nearer. */
#include "acquire/guide/centre.h"

#include <math.h>

#define PLACES_MAX (PLACIDO_GUIDE_SLOPES_MAX - 1) /* so many are enough */
#define STRONG 1.0F /* times the mean square */

/* Lines about a point. */
struct round {
  double reach; /* times the way from the inner to the outer radius: farther ones are left out */
  double angle; /* at which a line's weight is halved, as a sine */
};

static const struct round rounds[] = {{INFINITY, 3}, {1.1, 0.5}, {1, 0.3}, {0.5, 0.2},
                                      {0.2, 0.2}, {0, 0.2}, {0, 0.15}};

/* The part that is looked at, every `stride`-th place of it along each side, at least a pixel from
 * the border. Staggered, so that no direction is sampled more finely than another. */
struct window {
  int left, top, right, bottom, stride;
};

static struct window window_of(const placido_guide_small *small, double reach) {
  struct window w = {
      .left = (int)fmax(1, small->axis[0] - reach),
      .top = (int)fmax(1, small->axis[1] - reach),
      .right = (int)fmin(small->width - 2, small->axis[0] + reach),
      .bottom = (int)fmin(small->height - 2, small->axis[1] + reach),
  };
  const double area = fmax(0, w.right - w.left + 1.0) * fmax(0, w.bottom - w.top + 1.0);
  w.stride = (int)fmax(2, ceil(sqrt(area / (0.8 * PLACES_MAX))));
  return w;
}

static void slope_at(placido_guide_slope *slope, const placido_guide_small *small, int x, int y) {
  const float *here = small->grey + (size_t)y * (size_t)small->width + x;
  *slope = (placido_guide_slope){(float)x, (float)y, here[1] - here[-1],
                                 here[small->width] - here[-small->width]};
}

static float square_of(const placido_guide_slope *slope) {
  return slope->gx * slope->gx + slope->gy * slope->gy;
}

void placido_guide_slopes_find(placido_guide_small *small, double reach) {
  const struct window w = window_of(small, reach);
  double sum = 0;
  size_t places = 0, kept = 0;
  for (int y = w.top; y <= w.bottom; y += w.stride) {
    const int stagger = (y / w.stride & 1) * (w.stride / 2);
    for (int x = w.left + stagger; x <= w.right && places < PLACES_MAX; x += w.stride) {
      slope_at(&small->slopes[places], small, x, y);
      sum += (double)square_of(&small->slopes[places++]);
    }
  }
  const float least = places > 0 ? STRONG * (float)(sum / (double)places) : 0;
  for (size_t i = 0; i < places; i++) {
    if (square_of(&small->slopes[i]) > least) {
      small->slopes[kept++] = small->slopes[i];
    }
  }
  small->count = kept;
}

/* Normal equations of Σ w (t·(c - p))², t across the gradient. */
struct sums {
  double xx, xy, yy, x, y;
};

static struct sums add_lines(const placido_guide_small *small, const double centre[2],
                             double reach, double angle) {
  struct sums sums = {0};
  for (size_t i = 0; i < small->count; i++) {
    const placido_guide_slope *s = &small->slopes[i];
    const double dx = s->x - centre[0], dy = s->y - centre[1], square = dx * dx + dy * dy;
    if (square > reach * reach || square < 1) {
      continue;
    }
    const double across = s->gx * dy - s->gy * dx, strength = s->gx * s->gx + s->gy * s->gy;
    const double sine_square = across * across / (strength * square);
    const double robust = 1 / (1 + sine_square / (angle * angle));
    /* The strength's root: a few hard borders must not outweigh many mires. */
    const double weight = robust * robust / (square * sqrt(strength));
    const double tx = -s->gy, ty = s->gx, offset = tx * s->x + ty * s->y;
    sums.xx += weight * tx * tx;
    sums.xy += weight * tx * ty;
    sums.yy += weight * ty * ty;
    sums.x += weight * tx * offset;
    sums.y += weight * ty * offset;
  }
  return sums;
}

bool placido_guide_centre(double centre_px[2], const placido_guide_small *small, double inner_px,
                          double outer_px) {
  double centre[2] = {small->axis[0], small->axis[1]};
  for (size_t i = 0; i < sizeof rounds / sizeof rounds[0]; i++) {
    const double reach = isinf(rounds[i].reach)
                             ? (double)INFINITY
                             : inner_px + rounds[i].reach * (outer_px - inner_px);
    const struct sums s = add_lines(small, centre, reach / small->bin, rounds[i].angle);
    const double determinant = s.xx * s.yy - s.xy * s.xy;
    const double trace = s.xx + s.yy;
    if (!(determinant > 1e-3 * trace * trace)) {
      return false;
    }
    centre[0] = (s.yy * s.x - s.xy * s.y) / determinant;
    centre[1] = (s.xx * s.y - s.xy * s.x) / determinant;
    if (!(centre[0] > 0 && centre[1] > 0 && centre[0] < small->width &&
          centre[1] < small->height)) {
      return false;
    }
  }
  for (int i = 0; i < 2; i++) {
    centre_px[i] = (centre[i] + 0.5) * small->bin - 0.5;
  }
  return true;
}

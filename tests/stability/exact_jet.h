/* A function of x and y with its first and second derivatives, in extended precision: what a
 * formula for the value alone is enough for, by the rules of differentiation. */
#ifndef PLACIDO_TESTS_STABILITY_EXACT_JET_H
#define PLACIDO_TESTS_STABILITY_EXACT_JET_H

#include "tests/stability/exact.h"

typedef struct exact_jet {
  quad f, x, y, xx, xy, yy;
} exact_jet;

static inline exact_jet exact_sum(exact_jet a, exact_jet b) {
  return (exact_jet){a.f + b.f, a.x + b.x, a.y + b.y, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}

static inline exact_jet exact_scaled(exact_jet a, quad k) {
  return (exact_jet){k * a.f, k * a.x, k * a.y, k * a.xx, k * a.xy, k * a.yy};
}

/* a x + b y + c. */
static inline exact_jet exact_line(quad a, quad b, quad c, quad x, quad y) {
  return (exact_jet){.f = a * x + b * y + c, .x = a, .y = b};
}

static inline exact_jet exact_constant(quad value) {
  return (exact_jet){.f = value};
}

static inline exact_jet exact_product(exact_jet a, exact_jet b) {
  return (exact_jet){a.f * b.f,
                     a.x * b.f + a.f * b.x,
                     a.y * b.f + a.f * b.y,
                     a.xx * b.f + 2 * a.x * b.x + a.f * b.xx,
                     a.xy * b.f + a.x * b.y + a.y * b.x + a.f * b.xy,
                     a.yy * b.f + 2 * a.y * b.y + a.f * b.yy};
}

/* g(a), from g, g' and g'' there. */
static inline exact_jet exact_chain(exact_jet a, quad g, quad once, quad twice) {
  return (exact_jet){g,
                     once * a.x,
                     once * a.y,
                     twice * a.x * a.x + once * a.xx,
                     twice * a.x * a.y + once * a.xy,
                     twice * a.y * a.y + once * a.yy};
}

static inline exact_jet exact_inverse(exact_jet a) {
  return exact_chain(a, 1 / a.f, -1 / (a.f * a.f), 2 / (a.f * a.f * a.f));
}

static inline exact_jet exact_root(exact_jet a) {
  quad root = sqrtq(a.f);
  return exact_chain(a, root, 1 / (2 * root), -1 / (4 * root * a.f));
}

static inline exact_jet exact_exp(exact_jet a) {
  quad e = expq(a.f);
  return exact_chain(a, e, e, e);
}

static inline quad exact_of(const exact_jet *jet, int which) {
  const quad all[6] = {jet->f, jet->x, jet->y, jet->xx, jet->xy, jet->yy};
  return all[which];
}

#endif

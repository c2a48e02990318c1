/* Jets in turned coordinates. */
#ifndef PLACIDO_SURFACE_JET_H
#define PLACIDO_SURFACE_JET_H

#include <placido/surface.h>

#define PLACIDO_DEGREE (3.14159265358979323846 / 180.0)

/* A turn by the angle with this cosine and sine: u = c x + s y, v = -s x + c y. */
typedef struct placido_turn {
  double c, s;
} placido_turn;

/* Adds to `jet`, which is in (x, y), a jet given in the turned (u, v): the chain rule. */
static inline void placido_jet_add(placido_jet *jet, placido_turn turn, const placido_jet *uv) {
  double c = turn.c, s = turn.s;
  jet->sag += uv->sag;
  jet->sx += c * uv->sx - s * uv->sy;
  jet->sy += s * uv->sx + c * uv->sy;
  jet->sxx += c * c * uv->sxx - 2 * c * s * uv->sxy + s * s * uv->syy;
  jet->sxy += c * s * (uv->sxx - uv->syy) + (c * c - s * s) * uv->sxy;
  jet->syy += s * s * uv->sxx + 2 * c * s * uv->sxy + c * c * uv->syy;
}

#endif

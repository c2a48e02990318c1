/* Blur of variance s² pulls a curved edge inwards by s²/2 times its curvature. The mires are
 * corrected for that as circles about their centre. What stays open: a small part of it everywhere,
 * more of it where the blur is longer one way (motion, astigmatism), and all of it where an edge's
 * own curvature is another. */
#include "reconstruct/solve/errors/pull.h"

#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

/* Found on rendered pictures whose errors are alike over KIN_USUAL_PX. */
#define PULL_PX2 0.03
#define PULL_NOISE_PX 0.8 /* more per px of noise, which makes a width uncertain */
#define PULL_LONG_PX2 0.035
#define PULL_LONGER_PX2 2.0 /* more per unit of unevenness, log of standard deviations */
#define UNEVEN_SECTORS 6    /* of half a turn: opposite ones count together */
#define PULL_CURVED_PX2 0.8
#define BOW_DEG 6.0 /* an edge's curvature is that of a circle through points so far apart */
#define KIN_USUAL_PX 3.5

static bool counts(const placido_sample *s) {
  return s->used && !isnan(s->residual_px);
}

static double length(const double v[2]) {
  return sqrt(v[0] * v[0] + v[1] * v[1]);
}

/* The curvature of an edge about sample i, per px, from the points on both sides (Menger); 0 where
 * there is none. */
static double curvature_at(const placido_refinement *r, const placido_mires *mires, size_t i) {
  size_t bow = (size_t)fmax(1, mires->meridian_count * BOW_DEG / 360);
  if (i < bow || i + bow >= r->count || r->samples[i - bow].edge != r->samples[i].edge ||
      r->samples[i + bow].edge != r->samples[i].edge) {
    return 0;
  }
  const placido_mire_point *a = &mires->points[r->samples[i - bow].point];
  const placido_mire_point *b = &mires->points[r->samples[i].point];
  const placido_mire_point *c = &mires->points[r->samples[i + bow].point];
  if (c->meridian_deg - a->meridian_deg > 3 * BOW_DEG) {
    return 0;
  }
  double ab[2] = {b->u_px - a->u_px, b->v_px - a->v_px};
  double bc[2] = {c->u_px - b->u_px, c->v_px - b->v_px};
  double ac[2] = {c->u_px - a->u_px, c->v_px - a->v_px};
  /* meridians run against v: a circle about the centre has a negative cross product */
  return -2 * (ab[0] * bc[1] - ab[1] * bc[0]) / (length(ab) * length(bc) * length(ac));
}

/* How much longer the blur is one way: the second harmonic of the points' own standard deviations
 * about the centre, as a log; from sectors' medians, so that what hides mires does not show. `work`
 * has room for a number a sample. */
static double unevenness(const placido_refinement *r, const placido_mires *mires, double *work) {
  double along = 0, across = 0;
  for (int k = 0; k < UNEVEN_SECTORS; k++) {
    size_t n = 0;
    for (size_t i = 0; i < r->count; i++) {
      const placido_mire_point *point = &mires->points[r->samples[i].point];
      if (counts(&r->samples[i]) && point->sigma_px > 0 &&
          (int)(fmod(point->meridian_deg, 180) * UNEVEN_SECTORS / 180) == k) {
        work[n++] = point->sigma_px;
      }
    }
    if (!n) {
      return 0;
    }
    double turn = 2 * M_PI * (k + 0.5) / UNEVEN_SECTORS;
    double usual = log(placido_quantile(work, n, 0.5));
    along += 2 * usual * cos(turn) / UNEVEN_SECTORS;
    across += 2 * usual * sin(turn) / UNEVEN_SECTORS;
  }
  return hypot(along, across);
}

/* The pulls of the blur at a point, in sigmas of the point; `long_px2` that of a blur longer one
 * way, `share` how large the blur is against the usual one's. */
static void find_pulls(double pulls[PLACIDO_PULLS], const placido_refinement *r,
                       const placido_mires *mires, double share, double long_px2, size_t i) {
  const placido_sample *s = &r->samples[i];
  const placido_mire_point *point = &mires->points[s->point];
  double d[2] = {point->u_px - mires->centre_u_px, point->v_px - mires->centre_v_px};
  double square = fmax(d[0] * d[0] + d[1] * d[1], 1), round = 1 / sqrt(square);
  double bow = curvature_at(r, mires, i), unit = s->noise * r->sigma_px / share;
  /* cosine and sine of twice the meridian */
  double along = (d[0] * d[0] - d[1] * d[1]) / square, across = -2 * d[0] * d[1] / square;
  pulls[0] = (PULL_PX2 + PULL_NOISE_PX * r->sigma_px) * round / unit;
  pulls[1] = long_px2 * round * along / unit;
  pulls[2] = long_px2 * round * across / unit;
  pulls[3] = bow != 0 ? PULL_CURVED_PX2 * (bow - round) / unit : 0;
}

void placido_pulls_find(double *pulls, const placido_refinement *r, const placido_mires *mires,
                        double kin_px) {
  double long_px2 = PULL_LONG_PX2 + PULL_LONGER_PX2 * unevenness(r, mires, pulls);
  double share = kin_px * kin_px / (KIN_USUAL_PX * KIN_USUAL_PX);
  memset(pulls, 0, r->count * PLACIDO_PULLS * sizeof *pulls);
  for (size_t i = 0; i < r->count && share > 0; i++) {
    if (counts(&r->samples[i])) {
      find_pulls(pulls + i * PLACIDO_PULLS, r, mires, share, long_px2, i);
    }
  }
}

/* The scatter of arcs. Points of one edge within some degrees err alike: pixels that the edge runs
 * along, a tear film, a spline that cannot follow. So sums over arcs are held against what
 * independent points would give (cluster-robust covariance: Liang and Zeger, Biometrika 73:13,
 * 1986), each enlarged by what the fit has taken of it (its leverage: MacKinnon and White, J.
 * Econometrics 29:305, 1985, HC2). What whole edges have in common the arcs do not show: it is
 * estimated from the edges' means and sent through the solution, wave by wave over the edges. */
#include "reconstruct/solve/scatter.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <string.h>

#define ARC_DEG 10.0
#define LEVERAGE_MOST 0.7 /* beyond it a residual tells too little of the error */
#define PLACES 33         /* of the map of scatter, across the spline's square */
#define NEAR_MM 0.4       /* standard deviation of the window that a coefficient's factor sees */
#define PRIOR_ARCS 6      /* so many arcs of the usual scatter count everywhere */
#define WAVES_MOST 24
#define COMMON_EDGES 5    /* on either side tell of an edge's common error */
#define COMMON_MOST 4.0   /* of the usual edge's variance */
#define FOLLOWED_MOST 0.7 /* of the common errors by the surface */
/* Blur of variance s² pulls a curved edge inwards by s²/2 times its curvature. The mires are
 * corrected for that as circles about their centre. What stays open: a small part of it everywhere,
 * more of it where the blur is longer one way (motion, astigmatism), and all of it where an edge's
 * own curvature is another. */
#define PULL_PX2 0.03
#define PULL_NOISE_PX 0.4 /* more per px of noise, which makes a width uncertain */
#define PULL_LONG_PX2 0.05
#define PULL_LONGER_PX2 1.5 /* more per unit of unevenness, log of the points' standard deviation  \
                             */
#define UNEVEN_SECTORS 6    /* of half a turn: opposite ones count together */
#define PULL_CURVED_PX2 0.8
#define PULLS 4
#define BOW_DEG 6.0     /* an edge's curvature is that of a circle through points so far apart */
#define OFFSET_CLIP 2.0 /* of an edge's mean, in its standard deviations: the rest is local */

/* An arc of one edge, or a whole edge. */
typedef struct arc {
  double weight, pull; /* Σ w, Σ w · residual in sigmas */
  size_t count;
} arc;

static bool counts(const placido_sample *s) {
  return s->used && !isnan(s->residual_px);
}

/* Weights and means of whole edges. `edges` is zeroed. */
static void sum_edges(arc *edges, const placido_refinement *r, const placido_mires *mires,
                      const double *residual_px) {
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (counts(s)) {
      arc *edge = &edges[mires->points[s->point].edge];
      /* an offset of the edge is the same in px everywhere, in sigmas of the points it is not */
      double weight = placido_sample_weight(s, r->sigma_px) / s->noise;
      edge->weight += weight / s->noise;
      edge->pull += weight * residual_px[i] / r->sigma_px;
      edge->count++;
    }
  }
}

static double offset_of(const arc *edge) {
  return edge->weight > 0 ? edge->pull / edge->weight : 0;
}

/* The map of scatter: what the arcs show about a place, and what was to be expected. */
typedef struct map {
  double pitch_mm, half_mm;
  double shown[PLACES * PLACES], expected[PLACES * PLACES];
  double shown_all, expected_all;
  size_t arcs;
} map;

static void put(map *m, double x_mm, double y_mm, double shown, double expected) {
  int i = (int)lrint((x_mm + m->half_mm) / m->pitch_mm);
  int j = (int)lrint((y_mm + m->half_mm) / m->pitch_mm);
  if (i >= 0 && i < PLACES && j >= 0 && j < PLACES) {
    m->shown[j * PLACES + i] += shown;
    m->expected[j * PLACES + i] += expected;
  }
  m->shown_all += shown;
  m->expected_all += expected;
  m->arcs++;
}

/* Ends an arc: `middle` is one of its samples. */
static void close_arc(map *m, const arc *a, const placido_sample *middle,
                      const placido_refinement *r, const double *inverse) {
  double row[PLACIDO_SPLINE_CELL], weight = placido_sample_row(row, middle, r->sigma_px);
  double leverage = weight * placido_normal_variance(r->normal, inverse, middle->basis.column,
                                                     middle->basis.row, row);
  double left = 1 - fmin(LEVERAGE_MOST, leverage * (double)a->count);
  put(m, middle->hit.x, middle->hit.y, a->pull * a->pull / left, a->weight);
}

static long arc_of(const placido_mires *mires, const placido_sample *s) {
  const placido_mire_point *point = &mires->points[s->point];
  return lrint(floor((point->meridian_deg + ARC_DEG / 2) / ARC_DEG)) + 1000L * point->edge;
}

/* `offsets`: what is taken off an edge's residuals beforehand, in sigmas. */
static void map_arcs(map *m, const placido_refinement *r, const placido_mires *mires,
                     const double *residual_px, const double *offsets, const double *inverse) {
  *m = (map){.half_mm = r->shape.grid->half_mm,
             .pitch_mm = 2 * r->shape.grid->half_mm / (PLACES - 1)};
  arc here = {0};
  const placido_sample *middle = NULL;
  long now = -1;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (!counts(s)) {
      continue;
    }
    long arc_here = arc_of(mires, s);
    if (arc_here != now && here.count) {
      close_arc(m, &here, middle, r, inverse);
      here = (arc){0};
    }
    now = arc_here;
    double weight = placido_sample_weight(s, r->sigma_px);
    double offset = offsets[mires->points[s->point].edge] / s->noise;
    double residual = residual_px[i] / r->sigma_px - offset;
    here.weight += weight;
    here.pull += weight * residual;
    here.count++;
    middle = here.count <= 1 + (size_t)(mires->meridian_count * ARC_DEG / 720) ? s : middle;
  }
  if (here.count) {
    close_arc(m, &here, middle, r, inverse);
  }
}

/* One Gaussian window along one axis over the map's places. */
static void window_of(double window[PLACES], const map *m, double at_mm) {
  for (int i = 0; i < PLACES; i++) {
    double off = (i * m->pitch_mm - m->half_mm - at_mm) / NEAR_MM;
    window[i] = exp(-0.5 * off * off);
  }
}

/* The factor on the standard deviation at every coefficient: windows along y first, then along x.
 */
static void spread_out(double *spread, const map *m, const placido_grid *grid) {
  double usual = m->expected_all > 0 ? m->shown_all / m->expected_all : 1;
  double prior = m->arcs ? PRIOR_ARCS * m->expected_all / (double)m->arcs : 1;
  for (int j = 0; j < grid->side; j++) {
    double window[PLACES], shown_line[PLACES] = {0}, expected_line[PLACES] = {0};
    window_of(window, m, (j - 2) * grid->knot_mm - grid->half_mm);
    for (int k = 0; k < PLACES * PLACES; k++) {
      shown_line[k % PLACES] += window[k / PLACES] * m->shown[k];
      expected_line[k % PLACES] += window[k / PLACES] * m->expected[k];
    }
    for (int i = 0; i < grid->side; i++) {
      double shown = prior * usual, expected = prior;
      window_of(window, m, (i - 2) * grid->knot_mm - grid->half_mm);
      for (int k = 0; k < PLACES; k++) {
        shown += window[k] * shown_line[k];
        expected += window[k] * expected_line[k];
      }
      spread[j * grid->side + i] = sqrt(shown / expected);
    }
  }
}

/* Waves over the edges: cosines from the constant on, orthogonal and of unit square on average, as
 * many as a surface of this knot spacing can follow. */
static double wave(int number, int edge, int edges) {
  return (number ? M_SQRT2 : 1) * cos(M_PI * number * (edge + 0.5) / edges);
}

static int wave_count(int radial, int edges) {
  int most = 4 + radial * 3 / 2;
  most = most < WAVES_MOST ? most : WAVES_MOST;
  return most < edges ? most : edges;
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
 * way.
 */
static void find_pulls(double pulls[PULLS], const placido_refinement *r, const placido_mires *mires,
                       double long_px2, size_t i) {
  const placido_sample *s = &r->samples[i];
  const placido_mire_point *point = &mires->points[s->point];
  double d[2] = {point->u_px - mires->centre_u_px, point->v_px - mires->centre_v_px};
  double square = fmax(d[0] * d[0] + d[1] * d[1], 1), round = 1 / sqrt(square);
  double bow = curvature_at(r, mires, i), unit = s->noise * r->sigma_px;
  /* cosine and sine of twice the meridian */
  double along = (d[0] * d[0] - d[1] * d[1]) / square, across = -2 * d[0] * d[1] / square;
  pulls[0] = (PULL_PX2 + PULL_NOISE_PX * r->sigma_px) * round / unit;
  pulls[1] = long_px2 * round * along / unit;
  pulls[2] = long_px2 * round * across / unit;
  pulls[3] = bow != 0 ? PULL_CURVED_PX2 * (bow - round) / unit : 0;
}

/* The waves over the edges times their standard deviation, from what each edge does on its own. */
static void push_waves(double *rights, const double *by_edge, const double *variance, int edges,
                       int waves, size_t n) {
  for (int m = 0; m < waves; m++) {
    for (int k = 0; k < edges; k++) {
      const double *own = by_edge + (size_t)k * n;
      double amount = sqrt(variance[k]) * wave(m, k, edges), *right = rights + (size_t)m * n;
      for (size_t i = 0; i < n; i++) {
        right[i] += amount * own[i];
      }
    }
  }
}

/* JᵀW applied to what is common to whole edges: all right-hand sides. */
static int push(double *rights, const placido_refinement *r, const placido_mires *mires,
                const double *variance, int waves, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  size_t edges = (size_t)mires->edge_count;
  double *own = placido_memory_new((edges + PULLS) * n, sizeof *own, err);
  double *pulls = placido_memory_new(r->count, PULLS * sizeof *pulls, err);
  int status = own && pulls ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    double long_px2 = PULL_LONG_PX2 + PULL_LONGER_PX2 * unevenness(r, mires, pulls);
    memset(pulls, 0, r->count * sizeof *pulls);
    for (size_t i = 0; i < r->count; i++) {
      if (counts(&r->samples[i])) {
        find_pulls(pulls + i * PULLS, r, mires, long_px2, i);
      }
    }
    placido_refinement_push(own, r, mires, pulls, PULLS);
    push_waves(rights, own, variance, mires->edge_count, waves, n);
    memcpy(rights + (size_t)waves * n, own + edges * n, PULLS * n * sizeof *own);
  }
  placido_memory_free(own);
  placido_memory_free(pulls);
  return status;
}

/* The variance of the common error of each edge: what the means of the edges about it show, robust,
 * more by what the surface has followed of them and less by what points' noise makes of means. */
static void find_common(double *variance, const arc *edges, int edge_count, double followed) {
  double work[PLACIDO_EDGES_MAX];
  for (int k = 0; k < edge_count; k++) {
    double squares[2 * COMMON_EDGES + 1], noise = 0;
    size_t n = 0;
    for (int j = k - COMMON_EDGES; j <= k + COMMON_EDGES; j++) {
      if (j >= 0 && j < edge_count && edges[j].weight > 0) {
        double offset = offset_of(&edges[j]);
        squares[n++] = offset * offset;
        noise += 1 / edges[j].weight;
      }
    }
    /* the median of a chi square of one degree of freedom is 0.455 */
    double median = n ? placido_quantile(squares, n, 0.5) / 0.455 : 0;
    variance[k] = n ? fmax(0, median / (1 - followed) - noise / (double)n) : 0;
  }
  /* where a few edges are off by far more it is a spline that cannot follow, which is local */
  memcpy(work, variance, (size_t)edge_count * sizeof *work);
  double most = COMMON_MOST * placido_quantile(work, (size_t)edge_count, 0.5);
  for (int k = 0; k < edge_count; k++) {
    variance[k] = fmin(variance[k], most);
  }
}

static void take_off(double *offsets, const arc *edges, const double *variance, int edge_count) {
  for (int k = 0; k < edge_count; k++) {
    double most = OFFSET_CLIP * sqrt(variance[k]);
    offsets[k] = fmax(-most, fmin(most, offset_of(&edges[k])));
  }
}

int placido_scatter_find(placido_scatter *scatter, const placido_refinement *r,
                         const placido_mires *mires, const double *residual_px,
                         const double *inverse, placido_error *err) {
  const placido_grid *grid = r->shape.grid;
  size_t n = (size_t)grid->side * (size_t)grid->side;
  int edge_count = mires->edge_count, radial = (int)(grid->half_mm / grid->knot_mm) + 1;
  arc edges[PLACIDO_EDGES_MAX] = {{0}};
  double variance[PLACIDO_EDGES_MAX], offsets[PLACIDO_EDGES_MAX];
  *scatter = (placido_scatter){.steps = wave_count(radial, edge_count) + PULLS};
  size_t numbers = n * (size_t)scatter->steps;
  scatter->spread = placido_memory_new(n, sizeof *scatter->spread, err);
  scatter->step = placido_memory_new(numbers, sizeof *scatter->step, err);
  double *rights = placido_memory_new(numbers, sizeof *rights, err);
  map *m = placido_memory_new(1, sizeof *m, err);
  int status = scatter->spread && scatter->step && rights && m ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    sum_edges(edges, r, mires, residual_px);
    find_common(variance, edges, edge_count, fmin(FOLLOWED_MOST, (double)radial / edge_count));
    status = push(rights, r, mires, variance, scatter->steps - PULLS, err);
  }
  if (!status) {
    status = placido_normal_solve_more(r->normal, rights, scatter->steps, scatter->step, err);
  }
  if (!status) {
    take_off(offsets, edges, variance, edge_count);
    map_arcs(m, r, mires, residual_px, offsets, inverse);
    spread_out(scatter->spread, m, grid);
  }
  placido_memory_free(rights);
  placido_memory_free(m);
  if (status) {
    placido_scatter_free(scatter);
  }
  return status;
}

void placido_scatter_free(placido_scatter *scatter) {
  placido_memory_free(scatter->spread);
  placido_memory_free(scatter->step);
  *scatter = (placido_scatter){0};
}

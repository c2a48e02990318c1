/* The scatter of arcs. Points of one edge within some degrees err alike: pixels that the edge runs
 * along, a tear film, a spline that cannot follow. So sums over arcs are held against what
 * independent points would give (cluster-robust covariance: Liang and Zeger, Biometrika 73:13,
 * 1986), each enlarged by what the fit has taken of it (its leverage: MacKinnon and White, J.
 * Econometrics 29:305, 1985, HC2). What whole edges have in common the arcs do not show: it is
 * estimated from the edges' means, as far as these exceed the points' noise, and sent through the
 * solution, wave by wave over the edges. */
#include "reconstruct/solve/errors/scatter.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/errors/kinship.h"
#include "reconstruct/solve/errors/pull.h"

#include <math.h>
#include <string.h>

#define ARC_DEG 10.0
#define ARC_KIN 8.0 /* distances over which points err alike, at least */
#define ARC_MOST_DEG 120.0
#define LEVERAGE_MOST 0.7 /* beyond it a residual tells too little of the error */
#define PLACES 33         /* of the map of scatter, across the spline's square */
#define NEAR_MM 0.4       /* standard deviation of the window that a coefficient's factor sees */
#define PRIOR_ARCS 6      /* so many arcs of the usual scatter count everywhere */
#define WAVES_MOST 24
#define COMMON_EDGES 5    /* on either side tell of an edge's common error */
#define DOUBT 1.0         /* standard deviation of what they tell, over the noise */
#define COMMON_MOST 4.0   /* of the usual edge's variance */
#define FOLLOWED_MOST 0.7 /* of the common errors by the surface */
#define OFFSET_CLIP 2.0   /* of an edge's mean, in its standard deviations: the rest is local */

/* An arc of one edge, or a whole edge. */
typedef struct arc {
  double weight, pull; /* Σ w, Σ w · residual in sigmas */
  double yield;        /* Σ of the loss's second derivative */
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

/* Ends an arc: `middle` is one of its samples. The normal equations take Σ w for how the robust
 * loss bends; it bends less, so that errors do more (Huber, Robust Statistics, 1981, section 7.6).
 */
static void close_arc(map *m, const arc *a, const placido_sample *middle,
                      const placido_refinement *r, const double *inverse) {
  double row[PLACIDO_SPLINE_CELL], weight = placido_sample_row(row, middle, r->sigma_px);
  double leverage = weight * placido_normal_variance(r->normal, inverse, middle->basis.column,
                                                     middle->basis.row, row);
  double left = 1 - fmin(LEVERAGE_MOST, leverage * (double)a->count);
  double expected = a->yield * a->yield / a->weight;
  put(m, middle->hit.x, middle->hit.y, a->pull * a->pull / left, expected);
}

/* The length of a sample's arcs: ARC_DEG, or more where points of so many degrees share pixels; a
 * turn has a whole number of them. */
static double arc_deg(const placido_mires *mires, const placido_sample *s, double kin_px) {
  const placido_mire_point *point = &mires->points[s->point];
  double du = point->u_px - mires->centre_u_px, dv = point->v_px - mires->centre_v_px;
  double alone = ARC_KIN * kin_px / sqrt(fmax(1, du * du + dv * dv)) * 180 / M_PI;
  return 360 / floor(360 / fmax(ARC_DEG, fmin(ARC_MOST_DEG, alone)));
}

static long arc_of(const placido_mires *mires, const placido_sample *s, double deg) {
  const placido_mire_point *point = &mires->points[s->point];
  return lrint(floor((point->meridian_deg + deg / 2) / deg)) + 1000L * point->edge;
}

/* `offsets`: what is taken off an edge's residuals beforehand, in sigmas. */
static void map_arcs(map *m, const placido_refinement *r, const placido_mires *mires,
                     const double *residual_px, const double *offsets, double kin_px,
                     const double *inverse) {
  *m = (map){.half_mm = r->shape.grid->half_mm,
             .pitch_mm = 2 * r->shape.grid->half_mm / (PLACES - 1)};
  arc here = {0};
  const placido_sample *middle = NULL;
  const placido_edge *edge = NULL;
  double deg = ARC_DEG;
  long now = -1;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (!counts(s)) {
      continue;
    }
    deg = s->edge == edge ? deg : arc_deg(mires, s, kin_px);
    edge = s->edge;
    long arc_here = arc_of(mires, s, deg);
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
    here.yield += weight * weight * weight; /* of the pseudo-Huber loss */
    here.count++;
    middle = here.count <= 1 + (size_t)(mires->meridian_count * deg / 720) ? s : middle;
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
 * `across`: how much more edges do together. */
static void spread_out(double *spread, const map *m, const placido_grid *grid, double across) {
  double usual = m->expected_all > 0 ? m->shown_all / m->expected_all : 1;
  double prior = m->arcs ? PRIOR_ARCS * m->expected_all / (double)m->arcs : 1;
  double middle = grid->order / 2.0 - 1; /* of a coefficient's piece, in knots */
  for (int j = 0; j < grid->side; j++) {
    double window[PLACES], shown_line[PLACES] = {0}, expected_line[PLACES] = {0};
    window_of(window, m, (j - middle) * grid->knot_mm - grid->half_mm);
    for (int k = 0; k < PLACES * PLACES; k++) {
      shown_line[k % PLACES] += window[k / PLACES] * m->shown[k];
      expected_line[k % PLACES] += window[k / PLACES] * m->expected[k];
    }
    for (int i = 0; i < grid->side; i++) {
      double shown = prior * usual, expected = prior;
      window_of(window, m, (i - middle) * grid->knot_mm - grid->half_mm);
      for (int k = 0; k < PLACES; k++) {
        shown += window[k] * shown_line[k];
        expected += window[k] * expected_line[k];
      }
      spread[j * grid->side + i] = sqrt(across * shown / expected);
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
                const double *variance, double kin_px, int waves, placido_error *err) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  size_t edges = (size_t)mires->edge_count;
  double *own = placido_memory_new((edges + PLACIDO_PULLS) * n, sizeof *own, err);
  double *pulls = placido_memory_new(r->count, PLACIDO_PULLS * sizeof *pulls, err);
  int status = own && pulls ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    placido_pulls_find(pulls, r, mires, kin_px);
    placido_refinement_push(own, r, mires, pulls, PLACIDO_PULLS);
    push_waves(rights, own, variance, mires->edge_count, waves, n);
    memcpy(rights + (size_t)waves * n, own + edges * n, PLACIDO_PULLS * n * sizeof *own);
  }
  placido_memory_free(own);
  placido_memory_free(pulls);
  return status;
}

/* The part of a variance that noise does not explain, shrunk as far as that is in doubt. */
static double excess(double shown, double noise) {
  double more = fmax(0, shown - noise), doubt = DOUBT * noise;
  return more > 0 ? more * more * more / (more * more + doubt * doubt) : 0;
}

/* The variance of the common error of each edge: what the means of the edges about it show, robust,
 * more by what the surface has followed of them and less by what points' noise makes of means. */
static void find_common(double *variance, const arc *edges, int edge_count,
                        const placido_kinship *kinship, double followed) {
  double work[PLACIDO_EDGES_MAX];
  for (int k = 0; k < edge_count; k++) {
    double squares[2 * COMMON_EDGES + 1], noise = 0;
    size_t n = 0;
    for (int j = k - COMMON_EDGES; j <= k + COMMON_EDGES; j++) {
      if (j >= 0 && j < edge_count && edges[j].weight > 0) {
        double offset = offset_of(&edges[j]);
        squares[n++] = offset * offset;
        noise += kinship->arcs / edges[j].weight;
      }
    }
    /* the median of a chi square of one degree of freedom is 0.455 */
    double median = n ? placido_quantile(squares, n, 0.5) / 0.455 : 0;
    variance[k] = n ? kinship->across * excess(median / (1 - followed), noise / (double)n) : 0;
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
                         const placido_mires *mires, const double *residual_px, double kin_px,
                         const double *inverse, placido_error *err) {
  const placido_grid *grid = r->shape.grid;
  size_t n = (size_t)grid->side * (size_t)grid->side;
  int edge_count = mires->edge_count, radial = (int)(grid->half_mm / grid->knot_mm) + 1;
  arc edges[PLACIDO_EDGES_MAX] = {{0}};
  double variance[PLACIDO_EDGES_MAX], offsets[PLACIDO_EDGES_MAX];
  *scatter = (placido_scatter){.steps = wave_count(radial, edge_count) + PLACIDO_PULLS};
  size_t numbers = n * (size_t)scatter->steps;
  scatter->spread = placido_memory_new(n, sizeof *scatter->spread, err);
  scatter->step = placido_memory_new(numbers, sizeof *scatter->step, err);
  double *rights = placido_memory_new(numbers, sizeof *rights, err);
  map *m = placido_memory_new(1, sizeof *m, err);
  placido_kinship kinship;
  int status = scatter->spread && scatter->step && rights && m ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = placido_kinship_find(&kinship, r, mires, residual_px, err);
  }
  if (!status) {
    sum_edges(edges, r, mires, residual_px);
    find_common(variance, edges, edge_count, &kinship,
                fmin(FOLLOWED_MOST, (double)radial / edge_count));
    status = push(rights, r, mires, variance, kin_px, scatter->steps - PLACIDO_PULLS, err);
  }
  if (!status) {
    status = placido_normal_solve_more(r->normal, rights, scatter->steps, scatter->step, err);
  }
  if (!status) {
    take_off(offsets, edges, variance, edge_count);
    map_arcs(m, r, mires, residual_px, offsets, kin_px, inverse);
    spread_out(scatter->spread, m, grid, kinship.across);
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

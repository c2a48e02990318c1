/* The fit from mires to surface: conicoid, spline with as fine knots as the residuals ask for,
 * outliers cut, error bars. */
#include <placido/reconstruct.h>

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/solve/conic.h"
#include "reconstruct/solve/mask.h"
#include "reconstruct/solve/noise.h"
#include "reconstruct/solve/refine.h"

#include <math.h>
#include <string.h>

#define POINTS_MIN 200
#define MARGIN_MM 0.6   /* of spline beyond the outermost point */
#define RADIUS_MAX_MM 7
#define FAR_PX 20.0     /* a point this far from the conicoid says nothing of how far the data reach */
#define CUT 5.0         /* in robust standard deviations */
#define SPREAD_MIN_PX 0.01
#define ASTRAY 0.15     /* of the edges' distance: real eyes stay under a third of it */
#define DOUBTFUL 3.0    /* spread over rough noise from which on the user is warned */
#define CUT_SPREAD 2    /* neighbours along the edge that go with a cut point */
#define CUT_MOST 0.3    /* share of the points: more means that the model is wrong, not the points */
/* Relative fall of the cost at which an iteration ends. In the last one 2e-4 is a few units of chi
 * square, far less than the hundreds of unknowns scatter by. */
#define SETTLED 2e-4
#define SETTLED_ROUGHLY 1e-2
#define EXPLORE_STRIDE 3 /* meridians */
#define GAIN 0.85        /* finer knots must bring the spread below this share of what it was */
#define MISFIT 1.3      /* spread over rough noise at which finer knots are tried */

static const double KNOTS_MM[] = {0.5, 0.35, 0.25};
#define KNOT_CHOICES (int)(sizeof KNOTS_MM / sizeof KNOTS_MM[0])

struct placido_fit {
  placido_surface *surface;
  placido_grid grid;
  placido_normal *normal;
  double *inverse;      /* covariance of the coefficients at the normal matrix's pattern */
  double *by_distance;  /* d coefficients / d axis_z */
  double variance_scale, axis_z_sigma_mm;
  placido_fit_summary summary;
};

/* What the stages hand on. */
typedef struct progress {
  placido_mires *mires;
  placido_sample *samples;
  size_t count;
  placido_part conic;
  double vertex_z_mm, axis_z_mm, reach_mm;
  placido_surface *base;
  placido_refinement refinement;
  const placido_fit_options *options;
  int threads;
} progress;

/* The conicoid is found from every stride-th sample: it has four unknowns. */
static int fit_base(progress *p, placido_error *err) {
  size_t stride = p->count / 2500 + 1, few = 0;
  placido_sample *some = placido_memory_new(p->count / stride + 1, sizeof *some, err);
  if (!some) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < p->count; i += stride) {
    some[few++] = p->samples[i];
  }
  int status = placido_conic_fit(&p->conic, &p->vertex_z_mm, some, few, p->axis_z_mm, p->threads,
                                 err);
  placido_memory_free(some);
  if (!status) {
    status = placido_conic_surface(&p->base, &p->conic, p->vertex_z_mm, err);
  }
  if (status) {
    return status;
  }
  placido_shape shape = {.base = p->base};
  p->reach_mm = 0;
  for (size_t i = 0; i < p->count; i++) {
    placido_sample *s = &p->samples[i];
    placido_sample_trace(s, &shape);
    if (fabs(s->residual_px) < FAR_PX) {
      p->reach_mm = fmax(p->reach_mm, fmax(fabs(s->hit.x), fabs(s->hit.y)));
    }
  }
  if (!(p->reach_mm > 0.5) || p->reach_mm > RADIUS_MAX_MM) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the mires would lie within %.2f mm of the axis, 0.5 to %d mm are "
                             "possible: instrument, distance or numbering is wrong",
                             p->reach_mm, RADIUS_MAX_MM);
  }
  return PLACIDO_OK;
}

/* A fresh refinement of some samples on a grid. */
static int refinement_of(placido_refinement *r, const progress *p, const placido_grid *grid,
                         placido_sample *samples, size_t count, placido_error *err) {
  const placido_fit_options *o = p->options;
  return placido_refinement_new(r, p->base, grid, samples, count,
                                o && o->smoothing > 0 ? o->smoothing : 1e3,
                                o && o->steps_max > 0 ? o->steps_max : 40, p->threads, err);
}

/* The samples on every third meridian: enough to choose knots by, at a third of the cost. */
static size_t thin_out(placido_sample *some, const progress *p) {
  size_t few = 0;
  for (size_t i = 0; i < p->count; i++) {
    double meridian = p->mires->points[i].meridian_deg * p->mires->meridian_count / 360;
    if (lrint(meridian) % EXPLORE_STRIDE == 0) {
      some[few++] = p->samples[i];
    }
  }
  return few;
}

/* Chooses the grid: knots as fine as the samples ask for, or as the caller asked. Finer knots that do not
 * help are given up again: then it is the instrument's geometry that does not fit, not the spline.
 * Leaves the chosen grid's refinement, where the one of all samples starts. */
static int explore(placido_refinement *coarse, placido_grid *grid, const progress *p,
                   placido_sample *some, placido_error *err) {
  double asked = p->options ? p->options->knot_mm : 0;
  size_t few = thin_out(some, p);
  placido_refinement finer = {0};
  placido_grid finer_grid;
  int choices = asked > 0 ? 1 : KNOT_CHOICES, status = PLACIDO_OK;
  for (int choice = 0; choice < choices && !status; choice++) {
    finer_grid = placido_grid_covering(p->reach_mm + MARGIN_MM,
                                       asked > 0 ? asked : KNOTS_MM[choice]);
    status = refinement_of(&finer, p, &finer_grid, some, few, err);
    if (!status) {
      status = placido_refinement_run(&finer, SETTLED_ROUGHLY, err);
    }
    if (status || (choice && finer.sigma_px > GAIN * coarse->sigma_px)) {
      break;
    }
    placido_refinement_free(coarse);
    *coarse = finer;
    *grid = finer_grid;
    coarse->shape.grid = grid;
    finer = (placido_refinement){0};
    double rough = placido_noise_rough(some, few, p->mires, EXPLORE_STRIDE, coarse->work);
    if (coarse->sigma_px < MISFIT * rough) {
      break;
    }
  }
  placido_refinement_free(&finer);
  return status;
}

static int fit_spline(progress *p, placido_grid *grid, placido_error *err) {
  placido_refinement coarse = {0};
  placido_sample *some = placido_memory_new(p->count, sizeof *some, err);
  int status = some ? explore(&coarse, grid, p, some, err) : PLACIDO_MEMORY;
  if (!status) {
    status = refinement_of(&p->refinement, p, grid, p->samples, p->count, err);
  }
  if (!status) {
    memcpy(p->refinement.coefficients, coarse.coefficients,
           (size_t)grid->side * (size_t)grid->side * sizeof *coarse.coefficients);
    p->refinement.steps = coarse.steps;
    status = placido_refinement_run(&p->refinement, SETTLED_ROUGHLY, err);
  }
  placido_refinement_free(&coarse);
  placido_memory_free(some);
  return status;
}

/* Every sample's residual less what is usual on its edge, and the robust spread of the used ones'. A
 * mire that the instrument file puts in a slightly wrong place is off as a whole, which says
 * nothing against one of its points. Free with placido_memory_free. */
static int deviations_new(double **list, double *spread, const progress *p, placido_error *err) {
  double *work = p->refinement.work;
  double *deviation = *list = placido_memory_new(p->count, sizeof *deviation, err);
  if (!deviation) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < p->count;) {
    size_t first = i, n = 0;
    for (; i < p->count && p->samples[i].edge == p->samples[first].edge; i++) {
      deviation[i] = p->samples[i].residual_px;
      if (!isnan(deviation[i])) {
        work[n++] = deviation[i];
      }
    }
    double usual = placido_quantile(work, n, 0.5);
    for (size_t k = first; k < i; k++) {
      deviation[k] -= usual;
    }
  }
  size_t n = 0;
  for (size_t i = 0; i < p->count; i++) {
    if (p->samples[i].used && !isnan(deviation[i])) {
      work[n++] = fabs(deviation[i]);
    }
  }
  *spread = 1.4826 * placido_quantile(work, n, 0.5);
  return PLACIDO_OK;
}

/* Takes points that stray from their edge out of use, with their neighbours along it. Points that were
 * cut before come back where they fit now. */
static int cut_outliers(progress *p, size_t *cut, placido_error *err) {
  double *deviation, spread;
  int status = deviations_new(&deviation, &spread, p, err);
  if (status) {
    return status;
  }
  double limit = CUT * fmax(SPREAD_MIN_PX, spread);
  for (size_t i = 0; i < p->count; i++) {
    p->samples[i].used = true;
  }
  for (size_t i = 0; i < p->count; i++) {
    if (fabs(deviation[i]) < limit) {
      continue;
    }
    for (size_t j = i > CUT_SPREAD ? i - CUT_SPREAD : 0; j <= i + CUT_SPREAD && j < p->count; j++) {
      if (p->samples[j].edge == p->samples[i].edge) {
        p->samples[j].used = false;
      }
    }
  }
  *cut = 0;
  for (size_t i = 0; i < p->count; i++) {
    *cut += !p->samples[i].used;
  }
  placido_memory_free(deviation);
  return PLACIDO_OK;
}

/* The median distance of neighbouring edges along a meridian, in the image. */
static int edge_distance(double *distance_px, const progress *p, placido_error *err) {
  const placido_mires *mires = p->mires;
  size_t meridians = (size_t)mires->meridian_count, n = 0;
  size_t *last = placido_memory_new(meridians, sizeof *last, err);
  if (!last) {
    return PLACIDO_MEMORY;
  }
  double *gaps = p->refinement.work;
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *a = &mires->points[i];
    size_t m = (size_t)lrint(a->meridian_deg * (double)meridians / 360) % meridians;
    if (last[m]) {
      const placido_mire_point *b = &mires->points[last[m] - 1];
      if (a->edge == b->edge + 1) {
        gaps[n++] = hypot(a->u_px - b->u_px, a->v_px - b->v_px);
      }
    }
    last[m] = i + 1;
  }
  *distance_px = placido_quantile(gaps, n, 0.5);
  placido_memory_free(last);
  return PLACIDO_OK;
}

/* Says how well the mires agree with any smooth cornea under this instrument: refuses what is
 * absurd, warns of what noise cannot explain. */
static int judge(progress *p, placido_notes *notes, placido_error *err) {
  double distance, *deviation, astray;
  int status = edge_distance(&distance, p, err);
  if (!status) {
    status = deviations_new(&deviation, &astray, p, err);
  }
  if (status) {
    return status;
  }
  placido_memory_free(deviation);
  double spread = placido_samples_spread(p->samples, p->count, p->refinement.work);
  double rough = placido_noise_rough(p->samples, p->count, p->mires, 1, p->refinement.work);
  if (!(astray < ASTRAY * distance)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "no smooth cornea mirrors the mires to where they are seen: along "
                             "the edges points stray by %.1f px (limit %.1f px, %.0f %% of the "
                             "edges' distance)",
                             astray, ASTRAY * distance, 100 * ASTRAY);
  }
  if (spread > DOUBTFUL * fmax(rough, SPREAD_MIN_PX)) {
    placido_notes_add(notes,
                      "the mires lie %.2f px off the fitted surface, %.0f times their own noise: "
                      "the instrument's geometry, the distance or the numbering does not fit, and "
                      "the error bars do not know of it",
                      spread, spread / rough);
  }
  return PLACIDO_OK;
}

static int fit_robust(progress *p, placido_grid *grid, placido_notes *notes,
                      placido_error *err) {
  int status = fit_spline(p, grid, err);
  size_t cut = 0;
  for (int pass = 0; pass < 2 && !status; pass++) {
    status = cut_outliers(p, &cut, err);
    if (status) {
      return status;
    }
    if ((double)cut > CUT_MOST * (double)p->count) {
      return placido_error_set(err, PLACIDO_QUALITY,
                               "%.0f %% of the edge points do not lie on any smooth cornea "
                               "(limit %.0f %%)",
                               100.0 * (double)cut / (double)p->count, 100 * CUT_MOST);
    }
    status = placido_refinement_run(&p->refinement, pass ? SETTLED : SETTLED_ROUGHLY, err);
  }
  if (!status) {
    status = judge(p, notes, err);
  }
  if (!status) {
    status = placido_refinement_finish(&p->refinement, err);
  }
  if (!status && (double)cut > 0.1 * (double)p->count) {
    placido_notes_add(notes, "%.0f %% of the edge points were set aside as outliers",
                      100.0 * (double)cut / (double)p->count);
  }
  return status;
}

static int find_covariance(placido_fit *fit, progress *p, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  double *right = placido_memory_new(n, sizeof *right, err);
  fit->by_distance = placido_memory_new(n, sizeof *fit->by_distance, err);
  int status = right && fit->by_distance ? PLACIDO_OK : PLACIDO_MEMORY;
  placido_basis basis;
  if (!status) {
    /* the spring at the axis pulls to the distance: its push per millimetre is weight · B(0, 0) */
    placido_grid_basis(&fit->grid, 0, 0, &basis);
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      int j = i / PLACIDO_SPLINE_ORDER, k = i % PLACIDO_SPLINE_ORDER;
      right[(basis.row + j) * fit->grid.side + basis.column + k] =
          PLACIDO_DISTANCE_WEIGHT * basis.y[0][j] * basis.x[0][k];
    }
    status = placido_normal_solve_more(fit->normal, right, fit->by_distance, err);
  }
  if (!status) {
    status = placido_normal_inverse(fit->normal, &fit->inverse, err);
  }
  fit->variance_scale = placido_noise_inflation(p->samples, p->count, p->mires);
  placido_memory_free(right);
  return status;
}

/* Knots and coefficients as a part of the surface file. */
static int build_surface(placido_fit *fit, const progress *p, placido_error *err) {
  const placido_grid *g = &fit->grid;
  placido_coverage coverage;
  unsigned char *mask = NULL;
  size_t knots = (size_t)(g->side + PLACIDO_SPLINE_ORDER);
  double *places = placido_memory_new(knots, sizeof *places, err);
  int status = places ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    status = placido_mask_new(&coverage, &mask, &fit->summary.radius_mm, p->samples, p->count, err);
  }
  if (!status) {
    for (size_t i = 0; i < knots; i++) {
      places[i] = ((double)i - PLACIDO_SPLINE_DEGREE) * g->knot_mm - g->half_mm;
    }
    /* the spline was fitted to z, the file holds sags */
    size_t n = (size_t)g->side * (size_t)g->side;
    for (size_t i = 0; i < n; i++) {
      p->refinement.coefficients[i] = -p->refinement.coefficients[i];
    }
    placido_part parts[2] = {p->conic,
                             {.kind = PLACIDO_PART_BSPLINE,
                              .as.bspline = {PLACIDO_SPLINE_DEGREE, g->side, g->side, places,
                                             places, p->refinement.coefficients}}};
    status = placido_surface_new(&fit->surface, p->vertex_z_mm, fit->summary.radius_mm, parts, 2,
                                 &coverage, err);
  }
  placido_memory_free(places);
  placido_memory_free(mask);
  return status;
}

static void summarise(placido_fit *fit, const progress *p) {
  double sum = 0;
  for (size_t i = 0; i < p->count; i++) {
    const placido_sample *s = &p->samples[i];
    placido_mire_point *point = &p->mires->points[s->point];
    point->used = s->used && !isnan(s->residual_px);
    point->residual_px = s->residual_px;
    if (point->used) {
      sum += s->residual_px * s->residual_px;
      fit->summary.points_used++;
    }
  }
  fit->summary.points = p->count;
  fit->summary.rms_px = sqrt(sum / (double)fit->summary.points_used);
  fit->summary.sigma_px = p->refinement.sigma_px;
  fit->summary.steps = p->refinement.steps;
  fit->summary.knot_mm = fit->grid.knot_mm;
  fit->summary.condition = 1 / placido_normal_rcond(fit->normal);
}

int placido_fit_new(placido_fit **fit, placido_mires *mires,
                    const placido_instrument *instrument, const placido_fit_options *options,
                    placido_notes *notes, placido_error *err) {
  *fit = NULL;
  progress p = {.mires = mires,
                .count = mires->count,
                .axis_z_mm = options ? options->axis_z_mm : 0,
                .options = options,
                .threads = options && options->threads > 0 ? options->threads : 1};
  if (mires->count < POINTS_MIN) {
    return placido_error_set(err, PLACIDO_QUALITY, "only %zu edge points, at least %d are needed",
                             mires->count, POINTS_MIN);
  }
  placido_fit *f = placido_memory_new(1, sizeof *f, err);
  int status = f ? PLACIDO_OK : PLACIDO_MEMORY;
  if (status || (status = placido_samples_new(&p.samples, mires, instrument, p.axis_z_mm, err)) ||
      (status = fit_base(&p, err)) || (status = fit_robust(&p, &f->grid, notes, err))) {
    goto done;
  }
  f->axis_z_sigma_mm = options ? options->axis_z_sigma_mm : 0;
  f->normal = p.refinement.normal;
  p.refinement.normal = NULL;
  if ((status = find_covariance(f, &p, err)) || (status = build_surface(f, &p, err))) {
    goto done;
  }
  summarise(f, &p);
  *fit = f;
  f = NULL;
done:
  placido_fit_free(f);
  placido_refinement_free(&p.refinement);
  placido_surface_free(p.base);
  placido_memory_free(p.samples);
  return status;
}

void placido_fit_free(placido_fit *fit) {
  if (!fit) {
    return;
  }
  placido_surface_free(fit->surface);
  placido_normal_free(fit->normal);
  placido_memory_free(fit->inverse);
  placido_memory_free(fit->by_distance);
  placido_memory_free(fit);
}

const placido_surface *placido_fit_surface(const placido_fit *fit) {
  return fit->surface;
}

placido_fit_summary placido_fit_summary_get(const placido_fit *fit) {
  return fit->summary;
}

void placido_fit_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                          double *sigma_axial_D) {
  *sigma_z_um = *sigma_axial_D = NAN;
  placido_basis basis;
  placido_jet jet;
  if (!placido_surface_at(fit->surface, x_mm, y_mm, &jet) ||
      !placido_grid_basis(&fit->grid, x_mm, y_mm, &basis)) {
    return;
  }
  double r = hypot(x_mm, y_mm), slope, along[2] = {1, 0};
  /* what the distance lifts as a whole, itself included, is no error of the shape: lifted is what is
   * left at (x, y) beyond the lift on the axis. Axial curvature s/(r·sqrt(1+s²)) changes by ds/(r·(1+s²)^1.5); at the axis it is s', and the
   * slope's own row over a short radius stands for it */
  double radius = fmax(r, 0.05);
  if (r > 0) {
    along[0] = x_mm / r;
    along[1] = y_mm / r;
  }
  slope = jet.sx * along[0] + jet.sy * along[1];
  double power = 337.5 / (radius * pow(1 + slope * slope, 1.5));
  double height[PLACIDO_SPLINE_CELL], tilt[PLACIDO_SPLINE_CELL], lifted = -1, tilted = 0;
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    int j = k / PLACIDO_SPLINE_ORDER, i = k % PLACIDO_SPLINE_ORDER;
    height[k] = basis.y[0][j] * basis.x[0][i];
    tilt[k] = along[0] * basis.y[0][j] * basis.x[1][i] + along[1] * basis.y[1][j] * basis.x[0][i];
    double by = fit->by_distance[(basis.row + j) * fit->grid.side + basis.column + i];
    lifted += height[k] * by;
    tilted += tilt[k] * by;
  }
  double noise_z = placido_normal_variance(fit->normal, fit->inverse, basis.column, basis.row, height);
  double noise_tilt = placido_normal_variance(fit->normal, fit->inverse, basis.column, basis.row, tilt);
  double distance_z = lifted * fit->axis_z_sigma_mm, distance_tilt = tilted * fit->axis_z_sigma_mm;
  *sigma_z_um = 1e3 * sqrt(fit->variance_scale * noise_z + distance_z * distance_z);
  *sigma_axial_D = power * sqrt(fit->variance_scale * noise_tilt + distance_tilt * distance_tilt);
}

/* The step that finds condition numbers: what edge noise and geometry do to each result has been
 * found with its error bar; the derivative by the distance is that of the fit (implicit function
 * theorem), carried to each result by a difference. */
#include "acquire/cli/condition.h"

#include "acquire/cli/examination.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STEP_MM 1e-3   /* of the distance: results bend over it by some 1e-5 of the slope */
#define STREHL_STEP_MM 0.01 /* either way: at the best focus the ratio falls on both sides */
#define GRID_MM 0.25   /* as the error budget */
#define LEVEL_MM 3     /* the zone whose mean height is 0 */
#define STREHL_SAMPLES 100 /* rays a side, spread: as acuity.c sees other corneas */

/* The fitted surface, and that where z on the axis is a step more. */
struct moved {
  const placido_surface *middle;
  placido_surface *more; /* NULL: no distance */
};

static double slope_of(double before, double after) {
  return (after - before) / STEP_MM;
}

/* Adds a result: there is room for all that a record may have. */
static struct condition *add(struct conditions *all, const char *name, const char *unit,
                             double pupil_mm, double value, double sigma) {
  static const double unknown = NAN;
  struct condition *one = &all->items[all->count++];
  *one = (struct condition){.unit = unit,
                            .pupil_mm = pupil_mm,
                            .value = value,
                            .sigma = sigma,
                            .by_edges = unknown,
                            .by_geometry = unknown,
                            .per_mm = unknown};
  snprintf(one->name, sizeof one->name, "%s", name);
  return one;
}

/* Height in micrometres and axial power of a surface at a place. */
static bool shape_at(const placido_surface *surface, double x, double y, double out[2]) {
  placido_jet jet;
  const double r = hypot(x, y);
  if (!placido_surface_at(surface, x, y, &jet)) {
    return false;
  }
  const double slope = r > 0 ? (jet.sx * x + jet.sy * y) / r : 0;
  out[0] = 1e3 * (placido_surface_vertex_z_mm(surface) - jet.sag);
  out[1] = r > 0 ? 337.5 * slope / (r * sqrt(1 + slope * slope)) : (double)NAN;
  return true;
}

/* Root mean squares over the zone of heights against the inner zone's mean, and of axial power. */
struct zone {
  double level, squares[2];
  int inner, count[2];
};

/* What the surface has at a place, or its derivative by the distance. */
static bool look(const struct moved *moved, bool derivative, double x, double y, double out[2]) {
  double before[2], after[2];
  if (!placido_surface_covered(moved->middle, x, y) || !shape_at(moved->middle, x, y, before) ||
      (derivative && !shape_at(moved->more, x, y, after))) {
    return false;
  }
  for (int k = 0; k < 2; k++) {
    out[k] = derivative ? slope_of(before[k], after[k]) : before[k];
  }
  return true;
}

static void over_zone(double out[2], const struct moved *moved, bool derivative) {
  struct zone zone = {0};
  const int half = (int)(CONDITION_ZONE_MM / 2 / GRID_MM);
  for (int pass = 0; pass < 2; pass++) {
    for (int j = -half; j <= half; j++) {
      for (int i = -half; i <= half; i++) {
        const double x = i * GRID_MM, y = j * GRID_MM, r = hypot(x, y);
        double here[2];
        if (r > CONDITION_ZONE_MM / 2.0 || !look(moved, derivative, x, y, here)) {
          continue;
        }
        if (pass == 0 && r <= LEVEL_MM / 2.0) {
          zone.level += here[0];
          zone.inner++;
        }
        if (pass == 1) {
          zone.squares[0] += pow(here[0] - zone.level / zone.inner, 2);
          zone.count[0]++;
          zone.squares[1] += r > 0 ? here[1] * here[1] : 0;
          zone.count[1] += r > 0;
        }
      }
    }
  }
  out[0] = sqrt(zone.squares[0] / zone.count[0]); /* NaN where nothing is covered */
  out[1] = sqrt(zone.squares[1] / zone.count[1]);
}

static void add_shape(struct conditions *all, const struct examination *e,
                      const struct moved *moved) {
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  double value[2], per_mm[2] = {NAN, NAN}, sum[2] = {0};
  placido_fit_budget(e->fit, CONDITION_ZONE_MM, budget);
  over_zone(value, moved, false);
  if (moved->more) {
    over_zone(per_mm, moved, true);
  }
  for (int k = 0; k < PLACIDO_SIGMA_SOURCES; k++) {
    sum[0] += isnan(budget[k].z_um) ? 0 : budget[k].z_um * budget[k].z_um;
    sum[1] += isnan(budget[k].axial_D) ? 0 : budget[k].axial_D * budget[k].axial_D;
  }
  struct condition *one = add(all, "elevation", "um", NAN, value[0], sqrt(sum[0]));
  one->by_edges = budget[PLACIDO_SIGMA_NOISE].z_um;
  one->by_geometry = budget[PLACIDO_SIGMA_GEOMETRY].z_um;
  one->per_mm = per_mm[0];
  one = add(all, "axial", "D", NAN, value[1], sqrt(sum[1]));
  one->by_edges = budget[PLACIDO_SIGMA_NOISE].axial_D;
  one->by_geometry = budget[PLACIDO_SIGMA_GEOMETRY].axial_D;
  one->per_mm = per_mm[1];
}

/* Indices that are reported. */
static const char *const indices[] = {"simk_mean_D"};

static const placido_index_value *index_named(const placido_index_value *values, size_t count,
                                              const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return &values[i];
    }
  }
  return NULL;
}

static int add_indices(struct conditions *all, const struct examination *e,
                       const struct moved *moved, placido_error *err) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count = 0;
  const int status =
      moved->more ? placido_indices_find(values, &count, moved->more, NULL, err) : PLACIDO_OK;
  for (size_t i = 0; i < sizeof indices / sizeof *indices && status == PLACIDO_OK; i++) {
    const placido_index_value *index = index_named(e->indices, e->index_count, indices[i]);
    const placido_index_value *after = index_named(values, count, indices[i]);
    if (index) {
      struct condition *one =
          add(all, index->name, index->unit, NAN, index->value, index->sigma);
      one->by_edges = index->budget[PLACIDO_SIGMA_NOISE];
      one->by_geometry = index->budget[PLACIDO_SIGMA_GEOMETRY];
      one->per_mm = after ? slope_of(index->value, after->value) : (double)NAN;
    }
  }
  return status;
}

/* Zernike terms that are reported. */
static const struct {
  int n, m;
} terms[] = {{2, -2}, {2, 0}, {2, 2}, {3, -1}, {3, 1}, {4, 0}};

static void fill(struct condition *one, const struct spread *spread) {
  one->by_edges = spread->by[PLACIDO_SIGMA_NOISE];
  one->by_geometry = spread->by[PLACIDO_SIGMA_GEOMETRY];
}

/* `after`: the terms where z on the axis is a step more; NULL: not known. */
static void add_terms(struct conditions *all, const struct wavefront_view *view,
                      const double *after) {
  const double pupil_mm = view->front.eye.pupil_mm;
  for (size_t i = 0; i < sizeof terms / sizeof *terms; i++) {
    const int j = placido_zernike_index(terms[i].n, terms[i].m);
    char name[16];
    if (j >= 0 && j < view->front.term_count) {
      snprintf(name, sizeof name, "z_%d_%d", terms[i].n, terms[i].m);
      struct condition *one = add(all, name, "um", pupil_mm, view->front.coefficients_um[j],
                                  view->terms[j].sigma);
      fill(one, &view->terms[j]);
      one->per_mm = after ? slope_of(one->value, after[j]) : (double)NAN;
    }
  }
}

static void add_higher(struct conditions *all, const struct wavefront_view *view,
                       const double *after) {
  size_t count;
  const placido_wavefront_figure *figures = placido_wavefront_figures(&count);
  for (size_t i = 0; i < count && i < WAVEFRONT_FIGURES_MAX; i++) {
    if (strcmp(figures[i].name, "rms_hoa_um") == 0) {
      struct condition *one = add(all, figures[i].name, figures[i].unit,
                                  view->front.eye.pupil_mm, view->figures[i],
                                  view->figure_spreads[i].sigma);
      fill(one, &view->figure_spreads[i]);
      one->per_mm =
          after ? slope_of(one->value, figures[i].at(&view->front, after)) : (double)NAN;
    }
  }
}

static int add_wavefront(struct conditions *all, const struct wavefront_view *view,
                         const struct moved *moved, placido_error *err) {
  double after[PLACIDO_WAVEFRONT_TERMS];
  placido_error reason = {0};
  const int status = moved->more
                         ? placido_wavefront_again(after, &view->front, moved->more, &reason)
                         : PLACIDO_QUALITY;
  if (status != PLACIDO_OK && status != PLACIDO_QUALITY) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  add_terms(all, view, status == PLACIDO_OK ? after : NULL);
  add_higher(all, view, status == PLACIDO_OK ? after : NULL);
  return PLACIDO_OK;
}

/* The Strehl ratio through the same lens where z on the axis is another; NaN where that cannot be
 * told. */
static double strehl_of(const struct examination *e, const struct view *view, double step_mm) {
  const placido_optics optics = {.samples = STREHL_SAMPLES,
                                 .buckets = view->psf.n,
                                 .bucket_arcmin = view->psf.bucket_arcmin,
                                 .wavelength_nm = view->psf.wavelength_nm,
                                 .grow = 1,
                                 .cwhatuc = e->settings->cwhatuc,
                                 .threads = 1};
  placido_surface *surface;
  placido_psf psf = {0};
  double strehl = NAN;
  if (placido_fit_moved(&surface, e->fit, step_mm, NULL) == PLACIDO_OK &&
      placido_psf_new(&psf, NULL, surface, &view->eye, &optics, NULL, NULL) == PLACIDO_OK) {
    strehl = psf.strehl_g;
  }
  placido_psf_free(&psf);
  placido_surface_free(surface);
  return strehl;
}

static void add_view(struct conditions *all, const struct examination *e,
                     const struct view *view) {
  const double pupil_mm = view->psf.pupil_mm;
  struct condition *one =
      add(all, "strehl_g", "", pupil_mm, view->psf.strehl_g, view->strehl_g_sigma);
  if (e->frame.data) {
    one->per_mm = (strehl_of(e, view, STREHL_STEP_MM) - strehl_of(e, view, -STREHL_STEP_MM)) /
                  (2 * STREHL_STEP_MM);
  }
  for (size_t i = 0; i < view->acuity.count; i++) {
    const placido_acuity *acuity = &view->acuity.items[i];
    char name[32];
    snprintf(name, sizeof name, "logmar_%s", acuity->test->name);
    add(all, name, "logMAR", pupil_mm, acuity->logmar, acuity->sigma_optics);
  }
}

/* Root mean square distance of the used points from the mires' centre. */
static double scale_of(const placido_mires *mires) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < mires->count; i++) {
    if (mires->points[i].used) {
      const double r = hypot(mires->points[i].u_px - mires->centre_u_px,
                             mires->points[i].v_px - mires->centre_v_px);
      sum += r * r;
      count++;
    }
  }
  return sqrt(sum / (double)count);
}

int step_condition(struct examination *e, placido_error *err) {
  struct conditions *all = &e->conditions;
  struct moved moved = {.middle = e->surface};
  int status = PLACIDO_OK;
  if (!e->fit) {
    return PLACIDO_OK;
  }
  stages_next(&e->outcome->stages, "condition");
  const placido_fit_summary fit = placido_fit_summary_get(e->fit);
  *all = (struct conditions){.edge_sigma_px = NAN,
                             .edge_scale_px = NAN,
                             .distance_sigma_mm = NAN,
                             .distance_scale_mm = NAN,
                             .matrix = fit.condition};
  if (e->frame.data) {
    all->edge_sigma_px = fit.sigma_px;
    all->edge_scale_px = scale_of(&e->mires);
    all->distance_sigma_mm = fit.axis_z_sigma_mm;
    all->distance_scale_mm = e->instrument.position_mm[2] - fit.axis_z_mm;
    status = placido_fit_moved(&moved.more, e->fit, STEP_MM, err);
  }
  if (status == PLACIDO_OK) {
    add_shape(all, e, &moved);
    status = add_indices(all, e, &moved, err);
  }
  for (size_t i = 0; i < e->wavefronts.count && status == PLACIDO_OK; i++) {
    status = add_wavefront(all, &e->wavefronts.items[i], &moved, err);
  }
  for (size_t i = 0; i < e->views.count && status == PLACIDO_OK; i++) {
    add_view(all, e, &e->views.items[i]);
  }
  placido_surface_free(moved.more);
  return status;
}

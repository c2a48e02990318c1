/* Placido indices: irregularity from the mires' own shape, without a fit of power (Ramos-López et
 * al., Optom. Vis. Sci. 88, 1220-1231, 2011, and 90, 335-343, 2013; Castro-Luna,
 * Martínez-Finkelshtein & Ramos-López, Cont. Lens Anterior Eye 43, 366-372, 2020). Constants and
 * conventions as published with the R package rPACI, whose code was not copied: circles and
 * ellipses by linear least squares, figures scaled so that 0 to 100 is the usual range, and cut at
 * 0 and 150. */
#include "base/memory.h"
#include "reconstruct/indices/errors.h"
#include "reconstruct/indices/mirrored.h"
#include "reconstruct/maps/equations.h"

#include <math.h>

#define RINGS_MIN 5      /* AR_5 needs so many, and what is said of fewer is little */
#define TOP 150.0        /* of the scaled indices */
#define VARIANT_STRIDE 8 /* 32 directions tell a circle's error as well as 256 */
#define RADII 5
#define NO_LINE_MM 1e-9 /* centres that lie closer have no slope */

/* The raw figures of one ring. */
struct ring {
  double x_mm, y_mm, radius_mm; /* least-squares circle */
  double ratio;                 /* of the axes of the least-squares ellipse */
};

/* The indices of a set of rings, scaled. */
struct figures {
  int count;
  bool cso;
  double pi_1, pi_2, pi_3, sl, ar[RADII], glpi, nbi;
};

/* x² + y² = d x + e y + f (Kåsa, IEEE Trans. Instrum. Meas. 25, 8-14, 1976). */
static bool fit_circle(struct ring *ring, const double (*points)[2], int stride) {
  placido_equations equations = {.unknowns = 3};
  double u[PLACIDO_EQUATIONS_MAX];
  for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i += stride) {
    double x = points[i][0], y = points[i][1];
    const double row[3] = {x, y, 1};
    placido_equations_add(&equations, row, x * x + y * y);
  }
  if (!placido_equations_solve(&equations, u)) {
    return false;
  }
  ring->x_mm = u[0] / 2;
  ring->y_mm = u[1] / 2;
  ring->radius_mm = sqrt(u[2] + ring->x_mm * ring->x_mm + ring->y_mm * ring->y_mm);
  return true;
}

/* a x² + b xy + c y² + d x + e y = 1, the origin near the middle; the axes' ratio is the root of
 * that of the eigenvalues of (a, b/2; b/2, c). */
static bool fit_ellipse(struct ring *ring, const double (*points)[2], int stride) {
  placido_equations equations = {.unknowns = 5};
  double u[PLACIDO_EQUATIONS_MAX];
  for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i += stride) {
    double x = points[i][0], y = points[i][1];
    const double row[5] = {x * x, x * y, y * y, x, y};
    placido_equations_add(&equations, row, 1);
  }
  if (!placido_equations_solve(&equations, u)) {
    return false;
  }
  double middle = (u[0] + u[2]) / 2, half = hypot((u[0] - u[2]) / 2, u[1] / 2);
  ring->ratio = sqrt((middle + half) / (middle - half));
  return isfinite(ring->ratio);
}

static double scaled(double slope, double value, double offset) {
  double sum = slope * value + offset;
  return isnan(sum) ? NAN : fmax(0, fmin(TOP, sum));
}

/* Greatest distance between two centres, over the number of rings. */
static double spread(const struct ring *rings, int count) {
  double most = 0;
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < i; k++) {
      most = fmax(most, hypot(rings[i].x_mm - rings[k].x_mm, rings[i].y_mm - rings[k].y_mm));
    }
  }
  return most / count;
}

/* Mean distance from centre to centre outwards. */
static double drift(const struct ring *rings, int count) {
  double sum = 0;
  for (int i = 1; i < count; i++) {
    sum += hypot(rings[i].x_mm - rings[i - 1].x_mm, rings[i].y_mm - rings[i - 1].y_mm);
  }
  return sum / (count - 1);
}

/* Standard deviation of the axes' ratios, over count - 1. */
static double deviation(const struct ring *rings, int count) {
  double mean = 0, squares = 0;
  for (int i = 0; i < count; i++) {
    mean += rings[i].ratio / count;
  }
  for (int i = 0; i < count; i++) {
    squares += (rings[i].ratio - mean) * (rings[i].ratio - mean);
  }
  return sqrt(squares / (count - 1));
}

/* Of the centres' regression of y on x; NaN where they lie on one spot. */
static double slope(const struct ring *rings, int count) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (int i = 0; i < count; i++) {
    x += rings[i].x_mm / count;
    y += rings[i].y_mm / count;
  }
  for (int i = 0; i < count; i++) {
    xx += (rings[i].x_mm - x) * (rings[i].x_mm - x);
    xy += (rings[i].x_mm - x) * (rings[i].y_mm - y);
  }
  return xx > count * NO_LINE_MM * NO_LINE_MM ? fabs(xy / xx) : NAN;
}

/* Logistic combination of the general linear model, fitted to eyes seen by CSO's topographer. */
static double linear_index(const struct figures *figures) {
  double sum = -224.8951312 + 1.6878796 * figures->pi_1 + 1.2777558 * figures->pi_3 +
               1.8832870 * figures->ar[3] + 0.1938861 * figures->sl;
  return 50 * erfc(-sum / 20 / sqrt(2));
}

/* Logarithm of the ratio of two normal densities, of keratoconus over normal. */
struct evidence {
  double normal_mean, normal_sd, cone_mean, cone_sd;
};

static double weigh(double value, struct evidence e) {
  double normal = (value - e.normal_mean) / e.normal_sd, cone = (value - e.cone_mean) / e.cone_sd;
  return (normal * normal - cone * cone) / 2 + log(e.normal_sd / e.cone_sd);
}

/* Naive Bayes network with even odds before. A figure that is not given leaves its node out, which
 * is exact in such a network. */
static double bayes_index(const struct figures *figures) {
  double odds = weigh(figures->pi_1, (struct evidence){25.654, 12.111, 132.207, 34.626}) +
                weigh(figures->pi_2, (struct evidence){87.549, 19.664, 138.476, 21.044}) +
                weigh(figures->pi_3, (struct evidence){70.639, 26.971, 108.311, 41.317}) +
                weigh(figures->sl, (struct evidence){19.746, 12.587, 105.402, 45.196});
  if (figures->cso) {
    odds += weigh(figures->ar[0], (struct evidence){21.116, 10.378, 57.948, 27.489}) +
            weigh(figures->ar[3], (struct evidence){29.537, 4.982, 57.696, 17.566});
  }
  return 100 / (1 + exp(-odds));
}

/* The indices of the rings, of which every `stride`-th point is there. */
static struct figures measure(const placido_mire_rings *set, int stride) {
  static const double ar_scale[RADII][2] = {{-1961.923470, 444.770836},
                                            {-562.846591, 279.743072},
                                            {-486.921809, 331.313769},
                                            {-318.192614, 298.064078},
                                            {-288.403796, 321.418014}};
  struct figures f = {.count = set->count, .cso = set->cso};
  f.pi_1 = f.pi_2 = f.pi_3 = f.sl = f.glpi = f.nbi = NAN;
  for (int i = 0; i < RADII; i++) {
    f.ar[i] = NAN;
  }
  struct ring rings[PLACIDO_MIRE_RINGS_MAX];
  bool fitted = f.count >= RINGS_MIN;
  for (int i = 0; i < f.count && fitted; i++) {
    fitted = fit_circle(&rings[i], set->points_mm[i], stride) &&
             fit_ellipse(&rings[i], set->points_mm[i], stride);
  }
  if (!fitted) {
    return f;
  }
  f.pi_1 = scaled(12368.398072, spread(rings, f.count), -12.520056);
  f.pi_2 = scaled(9699.239153, drift(rings, f.count), -18.291661);
  f.pi_3 = scaled(5233.703995, deviation(rings, f.count), -13.737515);
  f.sl = scaled(50, slope(rings, f.count), 0);
  for (int i = 0; i < RADII && f.cso; i++) {
    f.ar[i] = scaled(ar_scale[i][0], rings[i].radius_mm, ar_scale[i][1]);
  }
  f.glpi = linear_index(&f);
  f.nbi = bayes_index(&f);
  return f;
}

/* One index: where it stands in the figures, and what it needs beside enough rings. */
struct row {
  const char *name, *unit, *help;
  size_t offset;
  double range;
  bool cso, line; /* needs CSO's mires; needs centres on a line */
};

#define AR_HELP(k)                                                                                 \
  "Scaled radius of ring " k " on the cornea, steeper is more; only for CSO's mires (rPACI)."

static const struct row rows[] = {
    {.name = "placido_pi_1",
     .help = "PI_1: greatest distance between two mires' centres over the number of mires, scaled "
             "to 0 to 150 (rPACI). Needs 5 complete mires, takes 15.",
     .offset = offsetof(struct figures, pi_1),
     .range = TOP},
    {.name = "placido_pi_2",
     .help = "PI_2: mean distance between the centres of neighbouring mires, scaled to 0 to 150 "
             "(rPACI).",
     .offset = offsetof(struct figures, pi_2),
     .range = TOP},
    {.name = "placido_pi_3",
     .help = "PI_3: standard deviation of the axes' ratio of the mires' ellipses, scaled to 0 to "
             "150 (rPACI).",
     .offset = offsetof(struct figures, pi_3),
     .range = TOP},
    {.name = "placido_sl",
     .help = "SL: slope of the line through the mires' centres, y on x, times 50, at most 150 "
             "(rPACI).",
     .offset = offsetof(struct figures, sl),
     .range = TOP,
     .line = true},
    {.name = "placido_ar_1",
     .help = AR_HELP("1"),
     .offset = offsetof(struct figures, ar[0]),
     .range = TOP,
     .cso = true},
    {.name = "placido_ar_2",
     .help = AR_HELP("2"),
     .offset = offsetof(struct figures, ar[1]),
     .range = TOP,
     .cso = true},
    {.name = "placido_ar_3",
     .help = AR_HELP("3"),
     .offset = offsetof(struct figures, ar[2]),
     .range = TOP,
     .cso = true},
    {.name = "placido_ar_4",
     .help = AR_HELP("4"),
     .offset = offsetof(struct figures, ar[3]),
     .range = TOP,
     .cso = true},
    {.name = "placido_ar_5",
     .help = AR_HELP("5"),
     .offset = offsetof(struct figures, ar[4]),
     .range = TOP,
     .cso = true},
    {.name = "placido_glpi",
     .unit = "%",
     .help = "GLPI: probability of an irregular cornea by a linear model of PI_1, PI_3, AR_4 and "
             "SL; only for CSO's mires. Below 30 normal, from 70 irregular (rPACI).",
     .offset = offsetof(struct figures, glpi),
     .range = 100,
     .cso = true,
     .line = true},
    {.name = "placido_nbi",
     .unit = "%",
     .help = "NBI: probability of keratoconus by a naive Bayes network of PI_1, PI_2, PI_3 and SL, "
             "with CSO's mires also AR_1 and AR_4 (rPACI; learnt from 60 eyes that CSO's saw).",
     .offset = offsetof(struct figures, nbi),
     .range = 100,
     .line = true},
};

#define ROWS (sizeof rows / sizeof rows[0])

static double value_of(const struct row *row, const struct figures *figures) {
  return *(const double *)(const void *)((const char *)figures + row->offset);
}

static const char *why_missing(const struct row *row, const struct figures *figures) {
  return figures->count < RINGS_MIN        ? "too_few_mires"
         : row->cso && !figures->cso       ? "other_mires"
         : row->line && isnan(figures->sl) ? "no_line"
                                           : "no_ellipse";
}

static void append(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                   const struct figures *figures) {
  for (size_t i = 0; i < ROWS && *count < PLACIDO_INDICES_MAX; i++) {
    double value = value_of(&rows[i], figures);
    values[(*count)++] =
        (placido_index_value){.name = rows[i].name,
                              .unit = rows[i].unit ? rows[i].unit : "",
                              .help = rows[i].help,
                              .value = value,
                              .sigma = NAN,
                              .budget = {NAN, NAN, NAN},
                              .covered = NAN,
                              .reason = isnan(value) ? why_missing(&rows[i], figures) : NULL};
  }
}

void placido_indices_of_rings(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                              const placido_mire_rings *rings) {
  struct figures figures = measure(rings, 1);
  append(values, count, &figures);
}

void placido_mire_rings_find(placido_mire_rings *rings, const placido_surface *surface,
                             const placido_mires *mires, const placido_instrument *instrument) {
  placido_mirrored mirrored;
  placido_mirrored_find(&mirrored, surface, mires, instrument);
  placido_mirrored_rings(rings, &mirrored, NULL, instrument, 1);
}

/* The figures of one variant. */
static int measure_variant(double changed[ROWS], const placido_mirrored *mirrored,
                           const placido_fit *fit, const placido_instrument *instrument,
                           int variant) {
  placido_mire_rings rings;
  placido_surface *surface = NULL;
  int status = placido_fit_variant(&surface, fit, variant, NULL);
  if (!status) {
    placido_mirrored_rings(&rings, mirrored, surface, instrument, VARIANT_STRIDE);
    struct figures figures = measure(&rings, VARIANT_STRIDE);
    for (size_t i = 0; i < ROWS; i++) {
      changed[i] = value_of(&rows[i], &figures);
    }
  }
  placido_surface_free(surface);
  return status;
}

/* What every variant gives, as against the fit's own value by 256 directions. */
static int measure_variants(double *changed, const placido_mirrored *mirrored,
                            const placido_mire_rings *rings, const placido_fit *fit,
                            const placido_instrument *instrument) {
  int variants = placido_fit_variant_count(fit), failed = PLACIDO_OK;
#pragma omp parallel for schedule(dynamic)
  for (int v = 0; v < variants; v++) {
    int status = measure_variant(changed + (size_t)v * ROWS, mirrored, fit, instrument, v);
    if (status) {
#pragma omp atomic write
      failed = status;
    }
  }
  struct figures all = measure(rings, 1), some = measure(rings, VARIANT_STRIDE);
  for (size_t i = 0; i < (size_t)variants * ROWS; i++) {
    changed[i] += value_of(&rows[i % ROWS], &all) - value_of(&rows[i % ROWS], &some);
  }
  return failed;
}

int placido_indices_of_mires(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                             const placido_fit *fit, const placido_mires *mires,
                             const placido_instrument *instrument, placido_error *err) {
  const size_t first = *count;
  placido_mire_rings rings;
  placido_mirrored *mirrored = placido_memory_new(1, sizeof *mirrored, err);
  double *changed =
      placido_memory_new((size_t)placido_fit_variant_count(fit) * ROWS, sizeof *changed, err);
  int status = mirrored && changed ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    placido_mirrored_find(mirrored, placido_fit_surface(fit), mires, instrument);
    placido_mirrored_rings(&rings, mirrored, NULL, instrument, 1);
    status = measure_variants(changed, mirrored, &rings, fit, instrument);
    if (status) {
      placido_error_set(err, status, "out of memory evaluating the Placido indices' errors");
    }
  }
  if (!status) {
    placido_indices_of_rings(values, count, &rings);
    for (size_t i = first; i < *count; i++) {
      placido_index_fill_sigma(&values[i], fit, changed + (i - first), ROWS, 0,
                               rows[i - first].range);
    }
  }
  placido_memory_free(changed);
  placido_memory_free(mirrored);
  return status;
}

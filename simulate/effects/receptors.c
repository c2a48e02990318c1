/* Receptors: the cones of the fovea catch the picture, a mosaic of hexagons half a minute apart.
 *
 * Each cone takes the mean of the light on its hexagon: foveal cones touch. Between cones the
 * picture is interpolated, in the triangles of neighbours. Hexagons of even light would be drawn
 * with edges that nobody sees, and would change light that just slopes; triangles do not. What is
 * finer than the mosaic carries comes out coarser, as it should.
 *
 * Spacing: C. A. Curcio et al., J. Comp. Neurol. 292 (1990) 497: 2.5 um amid the fovea. The means:
 * D. A. Dunavant, Int. J. Num. Meth. Eng. 21 (1985) 1129, six points a triangle, degree 4. */
#include "base/memory.h"
#include "simulate/effects/effect.h"
#include "simulate/plan/view.h"

#include <math.h>
#include <stdio.h>

enum { SIDES = 6, RULE = 6, POINTS = SIDES * RULE, PLANES = 4 };

static const double spacing_arcmin = 0.5;
static const double root_3 = 1.7320508075688772;

/* The rule's points: parts of the triangle's three corners, and weights. */
static const struct {
  double first, second, third, weight;
} rule[RULE] = {
  {0.108103018168070, 0.445948490915965, 0.445948490915965, 0.223381589678011},
  {0.445948490915965, 0.108103018168070, 0.445948490915965, 0.223381589678011},
  {0.445948490915965, 0.445948490915965, 0.108103018168070, 0.223381589678011},
  {0.816847572980459, 0.091576213509771, 0.091576213509771, 0.109951743655322},
  {0.091576213509771, 0.816847572980459, 0.091576213509771, 0.109951743655322},
  {0.091576213509771, 0.091576213509771, 0.816847572980459, 0.109951743655322},
};

/* The width of a square over which the mean of a picture changes as much as the mosaic changes it.
 * Of the second derivative of a smooth picture the mosaic takes at most half of 5/72 of the spacing
 * squared by its hexagons and an eighth by its triangles, in the middle between two cones; a square
 * a 24th of its width squared. For pictures with edges that is 5 % more. Buckets, between which
 * light is interpolated and over which it is averaged, add to it; both measured. */
static double blur_arcmin(double bucket_arcmin) {
  return sqrt(1.1 * (5.0 / 6 + 3) * spacing_arcmin * spacing_arcmin +
              1.5 * bucket_arcmin * bucket_arcmin);
}

/* Rows of cones along x; every other one is moved by half a cone. Lengths in pixels. A cone stands
 * in the middle of the picture. */
typedef struct mosaic {
  double spacing, pitch;   /* from cone to cone, and from row to row */
  double left, top;        /* the first cone of the first row */
  int columns, rows;
  int points;              /* at which a pixel's light is looked up, along a side */
  double x[POINTS], y[POINTS], weight[POINTS]; /* at which a cone's light is, from its middle */
} mosaic;

/* The triangles between the middle of a hexagon and its sides. */
static void set_points(mosaic *m) {
  const double corner = m->spacing / root_3, pi = 3.14159265358979323846;
  for (int i = 0; i < POINTS; i++) {
    double from = (i / RULE + 0.5) * pi / 3, to = (i / RULE + 1.5) * pi / 3;
    double first = rule[i % RULE].first * corner, second = rule[i % RULE].second * corner;
    m->x[i] = first * cos(from) + second * cos(to);
    m->y[i] = first * sin(from) + second * sin(to);
    m->weight[i] = rule[i % RULE].weight / SIDES;
  }
}

static mosaic mosaic_of(const placido_image *image, double bucket_arcmin) {
  const int rim = 2; /* cones around the picture, so that every place is in a triangle */
  const double points_per_cone = 4;
  mosaic m = {.spacing = spacing_arcmin / bucket_arcmin};
  m.pitch = m.spacing * root_3 / 2;
  m.points = (int)ceil(points_per_cone / m.spacing - 1e-9);
  int across = (int)ceil(image->width_px / 2.0 / m.spacing) + rim;
  int down = (int)ceil(image->height_px / 2.0 / m.pitch) + rim;
  down += down % 2; /* the middle row is not moved */
  m.left = image->width_px / 2.0 - across * m.spacing;
  m.top = image->height_px / 2.0 - down * m.pitch;
  m.columns = 2 * across + 1;
  m.rows = 2 * down + 1;
  set_points(&m);
  return m;
}

/* What the cones have caught: `cones` means a plane. */
typedef struct retina {
  mosaic mosaic;
  size_t cones;
  double *light;
} retina;

static int retina_new(retina *r, const placido_image *image, double bucket_arcmin,
                      placido_error *err) {
  r->mosaic = mosaic_of(image, bucket_arcmin);
  r->cones = (size_t)r->mosaic.columns * (size_t)r->mosaic.rows;
  r->light = placido_memory_new(r->cones * (size_t)image->planes, sizeof *r->light, err);
  return r->light != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* Where a point lies between the middles of two pixels in a line of `count`; beyond the rim the
 * last one goes on. */
typedef struct between {
  int first, second;
  double part; /* of the second */
} between;

static between between_of(double place, int count) {
  double at = place - 0.5;
  at = at < 0 ? 0 : at > count - 1 ? count - 1 : at;
  int first = (int)at, second = first < count - 1 ? first + 1 : first;
  return (between){first, second, at - first};
}

static double light_at(const float *plane, int width, between x, between y) {
  const float *above = plane + (size_t)y.first * (size_t)width;
  const float *below = plane + (size_t)y.second * (size_t)width;
  double up = (double)above[x.first], down = (double)below[x.first];
  up += x.part * ((double)above[x.second] - up);
  down += x.part * ((double)below[x.second] - down);
  return up + y.part * (down - up);
}

/* The means over the hexagons of a row of cones. */
static void catch_row(retina *r, int row, const placido_image *image) {
  const mosaic *m = &r->mosaic;
  for (int column = 0; column < m->columns; column++) {
    const double middle_x = m->left + (column + row % 2 / 2.0) * m->spacing;
    const double middle_y = m->top + row * m->pitch;
    const size_t cone = (size_t)row * (size_t)m->columns + (size_t)column;
    for (int i = 0; i < POINTS; i++) {
      const between x = between_of(middle_x + m->x[i], image->width_px);
      const between y = between_of(middle_y + m->y[i], image->height_px);
      for (int plane = 0; plane < image->planes; plane++) {
        const float *data = placido_image_plane(image, plane);
        r->light[(size_t)plane * r->cones + cone] +=
          m->weight[i] * light_at(data, image->width_px, x, y);
      }
    }
  }
}

/* A place of the mosaic: the triangle's cones, and how near it is to each; weights sum to 1. */
typedef struct place {
  size_t cones[3];
  double weights[3];
} place;

/* Along a row of cones and along slanted columns of them: a place's two fractions make it one of
 * the two triangles of a rhomb. */
static place place_at(const mosaic *m, double x, double y) {
  const double along = (x - m->left) / m->spacing, down = (y - m->top) / m->pitch;
  const int row = (int)down;
  const double slanted = along - down / 2 + m->rows; /* above 0: casts round down */
  const int first = (int)slanted;
  const double right = slanted - first, below = down - row;
  const int column = first - m->rows + row / 2;
  const size_t here = (size_t)row * (size_t)m->columns + (size_t)column;
  const size_t under = here + (size_t)(m->columns + row % 2);
  if (right + below < 1) {
    return (place){{here, here + 1, under}, {1 - right - below, right, below}};
  }
  return (place){{under + 1, under, here + 1}, {right + below - 1, 1 - right, 1 - below}};
}

/* A pixel of every plane: the mean of its points, each between the cones around it. */
static void show_pixel(placido_image *image, const retina *r, int x, int y) {
  const mosaic *m = &r->mosaic;
  const size_t pixel = (size_t)y * (size_t)image->width_px + (size_t)x;
  const double step = 1.0 / m->points;
  double sums[PLANES] = {0};
  for (int k = 0; k < m->points * m->points; k++) {
    place at = place_at(m, x + (k % m->points + 0.5) * step, y + (k / m->points + 0.5) * step);
    for (int plane = 0; plane < image->planes; plane++) {
      const double *light = r->light + (size_t)plane * r->cones;
      sums[plane] += at.weights[0] * light[at.cones[0]] + at.weights[1] * light[at.cones[1]] +
                     at.weights[2] * light[at.cones[2]];
    }
  }
  for (int plane = 0; plane < image->planes; plane++) {
    placido_image_plane(image, plane)[pixel] = (float)(sums[plane] * step * step);
  }
}

/* A cone's points, and a pixel's; measured. */
static double cost_ms(const placido_question *question) {
  const double cone_ms = 1.1e-3, pixel_ms = 0.2e-3;
  const placido_image *image = &question->scene->image;
  double side = question->scene->arcmin_per_px;
  double area_arcmin2 = side * image->width_px * side * image->height_px;
  double cones = area_arcmin2 / (spacing_arcmin * spacing_arcmin * root_3 / 2);
  return cones * cone_ms +
         pixel_ms * area_arcmin2 / (question->bucket_arcmin * question->bucket_arcmin);
}

/* The mosaic only matters where the picture is finer. */
static void ask(const placido_question *question, placido_answer *answer) {
  const double bucket_arcmin = question->bucket_arcmin, rounding = 1e-3;
  if (bucket_arcmin > spacing_arcmin * (1 - rounding)) {
    snprintf(answer->reason, sizeof answer->reason,
             "a bucket of the picture, %.3g', is a cone already: they are %.3g' apart",
             bucket_arcmin, spacing_arcmin);
    return;
  }
  answer->applies = true;
  answer->strokes->aperture_arcmin = blur_arcmin(bucket_arcmin);
  answer->cost_ms = cost_ms(question);
  snprintf(answer->reason, sizeof answer->reason,
           "the picture's buckets, %.3g', are finer than the cones, which are %.3g' apart",
           bucket_arcmin, spacing_arcmin);
}

/* Alpha only counts where it spreads. */
static int apply(void *state, placido_view *view, placido_error *err) {
  retina r;
  placido_image image = view->seen;
  (void)state;
  image.planes = image.planes == 4 && !view->holes ? 3 : image.planes;
  int status = retina_new(&r, &image, view->settings->bucket_arcmin, err);
  if (status != PLACIDO_OK) {
    return status;
  }
#pragma omp parallel for num_threads(view->threads)
  for (int row = 0; row < r.mosaic.rows; row++) {
    catch_row(&r, row, &image);
  }
#pragma omp parallel for num_threads(view->threads)
  for (int y = 0; y < image.height_px; y++) {
    for (int x = 0; x < image.width_px; x++) {
      show_pixel(&image, &r, x, y);
    }
  }
  placido_memory_free(r.light);
  return PLACIDO_OK;
}

const placido_effect placido_effect_receptors = {
  .name = "receptors",
  .summary = "the cones' mosaic carries the picture",
  .stage = PLACIDO_STAGE_IMAGE,
  .ask = ask,
  .apply = apply,
};

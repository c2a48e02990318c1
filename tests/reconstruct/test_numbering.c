/* Every edge gets its own number or none, whatever stands in the mires' way; and where the numbers
 * could be off by a whole mire there are none at all. */
#include "tests/support/near.h"

#include <math.h>
#include <placido/mires.h>
#include <placido/phantom.h>
#include <stdlib.h>
#include <string.h>

/* What is painted over the picture, about the innermost edge's centre. */
enum plant {
  NOTHING,
  INNERMOST_HIDDEN, /* a dark disc over the innermost mire */
  TWO_HIDDEN,
  GLARE,      /* the middle is lost in light */
  SECTOR,     /* 38 degrees cut off from the rest by dark strips, their inner mires hidden */
  BROKEN,     /* one mire is missing over half the circle */
  SEAM,       /* the gap of a cone's seam at 3 and 9 o'clock */
  LID_SHINE,  /* a bright arc along a lid, beyond hidden mires */
  LOW_CONTRAST
};

typedef struct numbering_case {
  const char *name, *instrument;
  placido_part parts[2];
  int part_count;
  placido_disturbance usual;
  enum plant plant;
  int edges;     /* as many as this, evenly spaced; 0: the instrument's */
  double duty;   /* width of the bright bands as a share of the period; 0: the instrument's */
  bool dark_first;
  double size;   /* of the picture; 0: half */
  double recall; /* share of the edges that must be numbered; 0: must be refused */
} numbering_case;

#define CONIC(r, q, x, y) {.kind = PLACIDO_PART_BICONIC, .as.biconic = {r, q, r, q, 0, x, y}}
#define CONE(h, s, x, y) {.kind = PLACIDO_PART_BUMP, .as.bump = {h, s, s, x, y, 0}}
#define EYE {CONIC(7.78, -0.24, 0, 0)}, 1
#define SEVERE {CONIC(7.7, -0.3, 0, 0), CONE(0.10, 0.92, 0.4, -0.8)}, 2
#define EXTREME {CONIC(7.7, -0.3, 0, 0), CONE(0.12, 1, 0.5, -0.9)}, 2
#define MODERATE {CONIC(7.7, -0.3, 0, 0), CONE(0.06, 1.15, 0.4, -0.8)}, 2
#define FOLDED(h, s, x, y) {CONIC(7.8, -0.2, 0, 0), CONE(h, s, x, y)}, 2
#define ORDINARY {.seed = 7, .blur_px = 0.7, .noise = 1.2}

static const numbering_case cases[] = {
    {"severe cone", "cone24", SEVERE, ORDINARY, .recall = 0.99},
    {"extreme cone", "disc18", EXTREME, ORDINARY, .recall = 0.99},
    {"lashes, nose, lid", "cone24", EYE,
     {.seed = 7, .blur_px = 0.7, .noise = 1.2, .lashes = 14, .nose = true, .lid = true},
     .recall = 0.84},
    {"severe with lashes", "disc18", SEVERE,
     {.seed = 7, .blur_px = 0.7, .noise = 1.2, .lashes = 14, .nose = true, .lid = true},
     .recall = 0.8},
    {"tear film", "cone24", EYE, {.seed = 7, .blur_px = 0.7, .noise = 1.2, .break_up = 0.3},
     .recall = 0.98},
    {"noise", "cone24", MODERATE, {.seed = 3, .blur_px = 0.8, .noise = 6}, .size = 1,
     .recall = 0.99},
    {"motion", "cone24", EYE, {.seed = 3, .blur_px = 0.5, .noise = 1, .motion_px = 2,
                               .motion_deg = 30}, .recall = 0.98},
    {"low contrast", "cone24", EYE, ORDINARY, LOW_CONTRAST, .recall = 0.99},
    {"decentred", "cone24", {CONIC(7.7, -0.25, 1.2, 0.9)}, 1, ORDINARY, .recall = 0.99},
    {"3 edges", "cone24", EYE, ORDINARY, .edges = 3, .recall = 0.99},
    {"60 edges", "cone24", MODERATE, ORDINARY, .edges = 60, .size = 1, .recall = 0.99},
    {"320 x 256", "cone24", MODERATE, ORDINARY, .edges = 16, .size = 0.25, .recall = 0.98},
    {"thin mires", "cone24", SEVERE, ORDINARY, .duty = 0.3, .size = 1, .recall = 0.99},
    {"mires that nearly touch", "cone24", SEVERE, ORDINARY, .duty = 0.75, .size = 1,
     .recall = 0.99},
    {"dark first", "cone24", MODERATE, ORDINARY, .dark_first = true, .recall = 0.99},
    {"sector cut off", "cone24", EYE, ORDINARY, SECTOR, .recall = 0.92},
    {"half a mire broken", "cone24", MODERATE, ORDINARY, BROKEN, .recall = 0.95},
    {"seam", "cone24", SEVERE, ORDINARY, SEAM, .recall = 0.9},
    {"shining lid", "cone24", EYE, ORDINARY, LID_SHINE, .recall = 0.7},
    {"innermost hidden", "cone24", EYE, ORDINARY, INNERMOST_HIDDEN, .recall = 0},
    {"innermost hidden, disc", "disc18", EYE, ORDINARY, INNERMOST_HIDDEN, .recall = 0},
    {"innermost of a cone hidden", "cone24", SEVERE, ORDINARY, INNERMOST_HIDDEN, .recall = 0},
    {"two hidden, steep", "cone24", {CONIC(7, -0.24, 0, 0)}, 1, ORDINARY, TWO_HIDDEN,
     .recall = 0},
    {"glare in the middle", "cone24", EYE, ORDINARY, GLARE, .recall = 0},
};

/* As many edges as asked for, at evenly spaced places between the instrument's first and last. */
static void space_edges(placido_instrument *in, int count) {
  placido_instrument all = *in;
  for (int k = 0; k < count; k++) {
    double at = (double)k * (all.edge_count - 1) / (count - 1);
    int i = at < all.edge_count - 1 ? (int)at : all.edge_count - 2;
    double share = at - i;
    const placido_edge *a = &all.edges[i], *b = a + 1;
    in->edges[k] = (placido_edge){a->radius_mm + share * (b->radius_mm - a->radius_mm),
                                  a->z_mm + share * (b->z_mm - a->z_mm)};
  }
  in->edge_count = count;
}

static placido_instrument instrument_of(const numbering_case *c) {
  placido_instrument in;
  assert_int_equal(placido_phantom_instrument(&in, c->instrument, NULL), PLACIDO_OK);
  if (c->edges) {
    space_edges(&in, c->edges);
  }
  for (int k = 1; c->duty > 0 && k + 1 < in.edge_count; k += 2) {
    const placido_edge *a = &in.edges[k - 1], *b = &in.edges[k + 1];
    in.edges[k] = (placido_edge){a->radius_mm + c->duty * (b->radius_mm - a->radius_mm),
                                 a->z_mm + c->duty * (b->z_mm - a->z_mm)};
  }
  double size = c->size > 0 ? c->size : 0.5;
  in.width_px = (int)(in.width_px * size);
  in.height_px = (int)(in.height_px * size);
  for (int i = 0; i < 2; i++) {
    in.focal_px[i] *= size;
    in.principal_px[i] = (in.principal_px[i] + 0.5) * size - 0.5;
  }
  in.first_band_bright = !c->dark_first;
  return in;
}

#define MERIDIANS 72

/* Where the edges truly are: radius about a centre, by edge and meridian. */
typedef struct truth {
  int edges;
  double centre_px[2];
  double *radius_px; /* edges × MERIDIANS; NaN: not seen */
} truth;

static double *true_radius(const truth *t, int edge, int meridian) {
  return &t->radius_px[edge * MERIDIANS + meridian % MERIDIANS];
}

/* Between the meridians, by linear interpolation. */
static double radius_between(const truth *t, int edge, double degree) {
  double at = degree * MERIDIANS / 360;
  int m = (int)floor(at);
  return (1 - at + m) * *true_radius(t, edge, m) + (at - m) * *true_radius(t, edge, m + 1);
}

static truth truth_about(const placido_surface *surface, const placido_instrument *in, double u,
                         double v) {
  truth t = {.edges = in->edge_count, .centre_px = {u, v}};
  t.radius_px = calloc((size_t)in->edge_count * MERIDIANS, sizeof *t.radius_px);
  assert_non_null(t.radius_px);
  for (int k = 0; k < t.edges; k++) {
    for (int m = 0; m < MERIDIANS; m++) {
      double at[2], degree = 360.0 * m / MERIDIANS;
      bool seen = placido_phantom_edge_at(surface, in, k, t.centre_px, degree, at) && at[0] > 4 &&
                  at[1] > 4 && at[0] < in->width_px - 5 && at[1] < in->height_px - 5;
      *true_radius(&t, k, m) = seen ? hypot(at[0] - u, at[1] - v) : NAN;
    }
  }
  return t;
}

/* The middle of the circle on which edge 0 is seen. */
static void find_middle(double middle_px[2], const placido_surface *surface,
                        const placido_instrument *in) {
  memcpy(middle_px, in->principal_px, sizeof in->principal_px);
  double u = 0, v = 0;
  int count = 0;
  for (int d = 0; d < 360; d += 10) {
    double at[2];
    if (placido_phantom_edge_at(surface, in, 0, in->principal_px, d, at)) {
      u += at[0];
      v += at[1];
      count++;
    }
  }
  if (count == 36) { /* else the principal point lies beyond it, on a cone's flank */
    middle_px[0] = u / count;
    middle_px[1] = v / count;
  }
}

/* The grey value that a plant puts at (radius, degree); -1 where it leaves the picture alone. */
static int planted(enum plant plant, const truth *t, double radius, double degree, int here) {
  const int dark = 12;
  double between[8];
  for (int k = 0; k < 8 && k + 1 < t->edges; k++) {
    between[k] = (radius_between(t, k, degree) + radius_between(t, k + 1, degree)) / 2;
  }
  double reach = radius_between(t, t->edges - 1, degree);
  switch (plant) {
  case INNERMOST_HIDDEN:
    return radius < between[1] ? dark : -1;
  case TWO_HIDDEN:
    return radius < between[3] ? dark : -1;
  case GLARE: {
    double light = here + 1000 * exp(-pow(radius / (0.15 * reach), 2) / 2);
    return light > 255 ? 255 : (int)light;
  }
  case SECTOR: {
    bool strip = fabs(degree - 20) < 3 || fabs(degree - 58) < 3;
    return strip || (degree > 20 && degree < 58 && radius < between[7]) ? dark : -1;
  }
  case BROKEN:
    return degree > 40 && degree < 230 && radius > between[5] && radius < between[7] ? dark : -1;
  case SEAM:
    return fabs(sin(degree * M_PI / 180)) * radius < 1.5 + 0.05 * radius ? dark : -1;
  case LID_SHINE: {
    double height = radius * sin(degree * M_PI / 180);
    int shine = height < 0.66 * reach ? 190 : 90;
    return height < 0.6 * reach ? -1 : height < 0.63 * reach ? dark : shine;
  }
  case LOW_CONTRAST:
    return 60 + (here - 60) * 3 / 20;
  default:
    return -1;
  }
}

static void paint(placido_frame *frame, enum plant plant, const truth *t) {
  for (int v = 0; v < frame->height_px && plant != NOTHING; v++) {
    for (int u = 0; u < frame->width_px; u++) {
      double x = u - t->centre_px[0], y = t->centre_px[1] - v;
      double degree = fmod(atan2(y, x) * 180 / M_PI + 360, 360);
      uint8_t *pixel = &frame->data[(size_t)v * frame->stride_bytes + (size_t)u];
      int value = planted(plant, t, hypot(x, y), degree, *pixel);
      *pixel = value < 0 ? *pixel : (uint8_t)value;
    }
  }
}

/* A number is wrong where the point lies nearer to another edge's place, or on none. */
static bool is_right(const placido_mire_point *p, const truth *t, const placido_mires *mires) {
  int m = (int)lrint(p->meridian_deg * MERIDIANS / 360);
  double want = *true_radius(t, p->edge, m), gap = INFINITY;
  for (int k = p->edge - 1; k <= p->edge + 1; k += 2) {
    if (k >= 0 && k < t->edges && !isnan(*true_radius(t, k, m))) {
      gap = fmin(gap, fabs(*true_radius(t, k, m) - want));
    }
  }
  double here = hypot(p->u_px - mires->centre_u_px, p->v_px - mires->centre_v_px);
  return isnan(want) || fabs(here - want) < 0.6 * gap;
}

static void check(const numbering_case *c) {
  placido_instrument in = instrument_of(c);
  placido_surface *surface;
  placido_error err = {0};
  placido_frame frame = {0};
  placido_mires mires;
  placido_mires_options options = {.meridians = MERIDIANS,
                                   .edges_min = c->edges && c->edges < 5 ? c->edges : 0};
  double middle[2];
  assert_int_equal(
      placido_surface_new(&surface, 0, 6, c->parts, (size_t)c->part_count, NULL, &err),
      PLACIDO_OK);
  assert_int_equal(placido_phantom_render(&frame, surface, &in, &c->usual, 2, &err), PLACIDO_OK);
  find_middle(middle, surface, &in);
  truth t = truth_about(surface, &in, middle[0], middle[1]);
  paint(&frame, c->plant, &t);
  int status = placido_mires_find(&mires, &frame, &in, &options, NULL, &err);
  free(t.radius_px);
  size_t wrong = 0, seen = 0;
  if (!status) {
    t = truth_about(surface, &in, mires.centre_u_px, mires.centre_v_px);
    for (int i = 0; i < t.edges * MERIDIANS; i++) {
      seen += !isnan(t.radius_px[i]);
    }
    for (size_t i = 0; i < mires.count; i++) {
      wrong += !is_right(&mires.points[i], &t, &mires);
    }
    for (size_t i = 0; i < mires.doubtful_count; i++) {
      wrong += !is_right(&mires.doubtful[i], &t, &mires);
    }
    free(t.radius_px);
  }
  double recall = status ? 0 : (double)(mires.count + mires.doubtful_count) / (double)seen;
  print_message("%-28s %s %.3f numbered, %zu wrong, folded %.3f\n", c->name,
                status ? "refused" : "", recall, wrong, status ? 0 : mires.folded);
  assert_int_equal(status, c->recall > 0 ? PLACIDO_OK : PLACIDO_QUALITY);
  assert_int_equal(wrong, 0);
  assert_true(recall >= c->recall);
  if (!status) {
    assert_true(mires.folded < 0.01);
  }
  placido_mires_free(&mires);
  placido_frame_free(&frame);
  placido_surface_free(surface);
}

static void no_edge_gets_anothers_number(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    check(&cases[i]);
  }
}

/* Two points of these corneas mirror the same mire: the places about the cone are marked. */
static void folds_are_told(void **state) {
  (void)state;
  static const numbering_case folds[] = {
      {"fold", "cone24", FOLDED(0.10, 0.42, 0.5, -1), ORDINARY, .size = 1},
      {"fold, disc", "disc18", FOLDED(0.10, 0.42, 0.5, -1), ORDINARY, .size = 1},
      {"fold above", "cone24", FOLDED(0.08, 0.35, 0.9, 1), ORDINARY, .size = 1},
  };
  for (size_t i = 0; i < sizeof folds / sizeof folds[0]; i++) {
    const numbering_case *c = &folds[i];
    placido_instrument in = instrument_of(c);
    placido_surface *surface;
    placido_frame frame = {0};
    placido_mires mires;
    assert_int_equal(placido_surface_new(&surface, 0, 6, c->parts, 2, NULL, NULL), PLACIDO_OK);
    assert_int_equal(placido_phantom_render(&frame, surface, &in, &c->usual, 2, NULL), PLACIDO_OK);
    int status = placido_mires_find(&mires, &frame, &in, NULL, NULL, NULL);
    if (!status) {
      double u = 0, v = 0;
      size_t count = 0;
      for (size_t k = 0; k < mires.count; k++) {
        const placido_mire_point *p = &mires.points[k];
        u += p->folded ? p->u_px - in.principal_px[0] : 0;
        v += p->folded ? in.principal_px[1] - p->v_px : 0;
        count += p->folded;
      }
      print_message("%-28s folded on %.3f of the meridians, %zu points\n", c->name, mires.folded,
                    count);
      assert_true(mires.folded > 0.03);
      assert_true(count > 20);
      /* the marked points lie on the cone's side of the centre */
      double x = c->parts[1].as.bump.x_mm, y = c->parts[1].as.bump.y_mm;
      assert_true(u * x + v * y > 0.8 * hypot(u, v) * hypot(x, y));
      placido_mires_free(&mires);
    }
    assert_true(status == PLACIDO_OK || status == PLACIDO_QUALITY);
    placido_frame_free(&frame);
    placido_surface_free(surface);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_edge_gets_anothers_number),
                                     cmocka_unit_test(folds_are_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}

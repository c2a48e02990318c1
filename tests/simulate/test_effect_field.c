/* The field against brute force: the light of every lit pixel traced by itself, from the direction
 * in which that pixel stands, with Snell's law and a retina written here. */
#include "bins.h"
#include "eyes.h"
#include "simulate/effects/effect.h"
#include "simulate/plan/nodes.h"
#include "simulate/plan/run.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

enum { SIDE = 360, SQUARES = 5, SQUARE = 8, ACROSS = 44, BIN = 6, BINS = SIDE / BIN };

static const double pi = 3.14159265358979323846;
static const double arcmin_per_px = 1.25; /* 7.5 degrees: corners are 5.3 degrees off the middle */
static const double arcmin_rad = 3.14159265358979323846 / 10800;

/* A ray by itself. Depth grows into the eye, from the cornea's point on the axis. */
typedef struct ray {
  double at[3], along[3];
} ray;

/* To the cornea, by Newton's method. */
static bool meet(ray *r, const placido_surface *surface, double axis_sag_mm, placido_jet *jet) {
  for (int step = 0; step < 4; step++) {
    if (!placido_surface_at(surface, r->at[0], r->at[1], jet)) {
      return false;
    }
    double above = jet->sag - axis_sag_mm - r->at[2];
    double way = above / (r->along[2] - jet->sx * r->along[0] - jet->sy * r->along[1]);
    for (int i = 0; i < 3; i++) {
      r->at[i] += way * r->along[i];
    }
  }
  return placido_surface_at(surface, r->at[0], r->at[1], jet);
}

/* Snell's law at the normal (-sx, -sy, 1). */
static void refract(ray *r, const placido_jet *jet, double index) {
  double normal[3] = {-jet->sx, -jet->sy, 1}, length = 0, cosine = 0;
  for (int i = 0; i < 3; i++) {
    length += normal[i] * normal[i];
  }
  for (int i = 0; i < 3; i++) {
    normal[i] /= sqrt(length);
    cosine += normal[i] * r->along[i];
  }
  double within = sqrt(1 - (1 - cosine * cosine) / (index * index));
  for (int i = 0; i < 3; i++) {
    r->along[i] = r->along[i] / index + (within - cosine / index) * normal[i];
  }
}

/* To the sphere of the retina, whose pole lies at retina_mm on the axis. */
static void land(ray *r, double retina_mm) {
  const double radius_mm = 12;
  double from[3] = {r->at[0], r->at[1], r->at[2] - (retina_mm - radius_mm)}, half = 0, rest = 0;
  for (int i = 0; i < 3; i++) {
    half += from[i] * r->along[i];
    rest += from[i] * from[i];
  }
  double way = -half + sqrt(half * half - rest + radius_mm * radius_mm);
  for (int i = 0; i < 3; i++) {
    r->at[i] += way * r->along[i];
  }
}

/* What is traced. */
typedef struct model {
  const placido_surface *surface;
  placido_eye eye;
  double axis_sag_mm, nodal_mm;
  double axis[2][2];     /* how the landing point follows the direction, on the axis */
  double fixation[2];    /* where the patient fixates, from the ray through the pupil's middle */
  double mean[2];        /* of the light, on the axis; both in radians */
} model;

/* A ray from the direction (right, up) in radians of slope, as the patient has it, that heads for
 * (x, y) from the centre of the entrance pupil. What the patient has on the right is on the
 * instrument's left: its light travels to +x. Light from above travels to -y. */
static bool trace(ray *r, const model *m, double right, double up, double x_mm, double y_mm) {
  double length = sqrt(1 + right * right + up * up);
  placido_jet jet;
  *r = (ray){{m->eye.pupil_x_mm + x_mm, m->eye.pupil_y_mm + y_mm, 3.05},
             {right / length, -up / length, 1 / length}};
  if (!meet(r, m->surface, m->axis_sag_mm, &jet)) {
    return false;
  }
  refract(r, &jet, m->eye.index);
  land(r, m->eye.retina_mm);
  return true;
}

/* How the landing point of the ray through the pupil's middle follows the direction (right, down):
 * mm a radian. */
static void follow(double j[2][2], const model *m, double right, double down) {
  const double apart = 2e-3;
  for (int k = 0; k < 2; k++) {
    double dx = k == 0 ? apart / 2 : 0, dy = k == 1 ? apart / 2 : 0;
    ray more, less;
    assert_true(trace(&more, m, right + dx, -(down + dy), 0, 0));
    assert_true(trace(&less, m, right - dx, -(down - dy), 0, 0));
    for (int i = 0; i < 2; i++) {
      j[i][k] = (more.at[i] - less.at[i]) / apart;
    }
  }
}

static void solve(double found[2], double j[2][2], const double x[2]) {
  double det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
  found[0] = (j[1][1] * x[0] - j[0][1] * x[1]) / det;
  found[1] = (j[0][0] * x[1] - j[1][0] * x[0]) / det;
}

/* How a ray that lands at `at` is seen beside the ray through the pupil's middle of its direction:
 * where the middle ray of another direction lands so; on the axis a millimetre is what it is at the
 * nodal distance. Radians, right and down. */
static void angle_of(double angle[2], const model *m, double there[2][2], const ray *r,
                     const ray *chief) {
  double beside[2] = {r->at[0] - chief->at[0], r->at[1] - chief->at[1]}, turned[2];
  solve(turned, there, beside);
  for (int k = 0; k < 2; k++) {
    angle[k] = (m->axis[k][0] * turned[0] + m->axis[k][1] * turned[1]) / m->nodal_mm;
  }
}

/* The mean of the light from a direction. */
static void mean_of(double mean[2], const model *m, double there[2][2], double right, double down) {
  const int across = 24;
  const double radius_mm = m->eye.pupil_mm / 2;
  double count = 0, sum[2] = {0, 0}, angle[2];
  ray chief, r;
  assert_true(trace(&chief, m, right, -down, 0, 0));
  for (int i = 0; i < across * across; i++) {
    double x = radius_mm * ((2 * (i % across) + 1.0) / across - 1);
    double y = radius_mm * ((2 * (i / across) + 1.0) / across - 1);
    if (hypot(x, y) < radius_mm && trace(&r, m, right, -down, x, y)) {
      angle_of(angle, m, there, &r, &chief);
      sum[0] += angle[0];
      sum[1] += angle[1];
      count++;
    }
  }
  mean[0] = sum[0] / count;
  mean[1] = sum[1] / count;
}

static model model_of(const placido_surface *surface, double pupil_mm) {
  const placido_eye eye = {.pupil_mm = pupil_mm};
  const placido_optics optics = {.buckets = 33};
  placido_psf psf;
  placido_error err = {0};
  placido_jet jet;
  ray chief;
  model m = {.surface = surface};
  if (placido_psf_new(&psf, &m.eye, surface, &eye, &optics, NULL, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  m.axis_sag_mm = jet.sag;
  m.nodal_mm = m.eye.retina_mm - 2 / (jet.sxx + jet.syy);
  follow(m.axis, &m, 0, 0);
  assert_true(trace(&chief, &m, 0, 0, 0, 0));
  m.fixation[0] = (psf.centre_x_um / 1000 - chief.at[0]) / m.nodal_mm;
  m.fixation[1] = (psf.centre_y_um / 1000 - chief.at[1]) / m.nodal_mm;
  mean_of(m.mean, &m, m.axis, 0, 0);
  placido_psf_free(&psf);
  return m;
}

/* What is above on the left of the picture lands where docs/formats.md says that it is seen. */
static void test_nodes_stand_where_their_light_is_seen(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.25);
  model m = model_of(surface, 4);
  for (int node = 0; node < 9; node++) {
    double field_deg[2];
    ray r;
    placido_node_field_deg(field_deg, 131, 101, 10, 2, 3, node);
    double right_px = (node % 3 - 1) * 55, up_px = (1 - node / 3) * 40;
    assert_true(trace(&r, &m, -tan(field_deg[0] * pi / 180), tan(field_deg[1] * pi / 180), 0, 0));
    /* On the retina at (x, y): seen at x to the right and at -y upwards. */
    assert_true(right_px == 0 ? fabs(r.at[0]) < 1e-9 : r.at[0] * right_px > 0);
    assert_true(up_px == 0 ? fabs(r.at[1]) < 1e-9 : -r.at[1] * up_px > 0);
    /* A flat picture: tangents are proportional to pixels. */
    assert_near(tan(-field_deg[0] * pi / 180), right_px * 2 * arcmin_rad, 1e-12);
    assert_near(tan(field_deg[1] * pi / 180), up_px * 2 * arcmin_rad, 1e-12);
  }
  placido_surface_free(surface);
}

/* Weights sum to 1 everywhere, never step, and are constant on the rim: no seam can be seen. */
/* Of a sample along one side of the picture. */
static double share(int at, int size, int bleed_px, int nodes, int node) {
  return fmax(1 - fabs(placido_node_place(at, size, bleed_px, nodes) - node), 0);
}

static void test_weights_are_a_partition_without_seams(void **state) {
  (void)state;
  enum { WIDTH = 83, HEIGHT = 61, BLEED = 9 };
  static float sum[WIDTH * HEIGHT], weight[WIDTH * HEIGHT];
  const int sides[] = {1, 3, 5, 9};
  for (int k = 0; k < 4; k++) {
    int nodes = sides[k];
    double steepest = (nodes - 1) / (double)(HEIGHT - 2 * BLEED - 1) + 1e-6;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      sum[i] = 0;
    }
    for (int node = 0; node < nodes * nodes; node++) {
      for (int i = 0; i < WIDTH * HEIGHT; i++) {
        weight[i] = (float)(share(i % WIDTH, WIDTH, BLEED, nodes, node % nodes) *
                            share(i / WIDTH, HEIGHT, BLEED, nodes, node / nodes));
      }
      for (int i = 0; i < WIDTH * HEIGHT; i++) {
        sum[i] += weight[i];
        assert_true(weight[i] >= 0 && weight[i] <= 1);
        assert_true(i % WIDTH == 0 || fabsf(weight[i] - weight[i - 1]) <= (float)steepest);
        assert_true(i < WIDTH || fabsf(weight[i] - weight[i - WIDTH]) <= (float)steepest);
        if (i % WIDTH < BLEED) {
          assert_true(weight[i] == weight[i / WIDTH * WIDTH + BLEED]);
        }
      }
      /* Its own place has nothing of the others. */
      int row = BLEED, column = BLEED;
      if (nodes > 1) {
        row += node / nodes * (HEIGHT - 2 * BLEED - 1) / (nodes - 1);
        column += node % nodes * (WIDTH - 2 * BLEED - 1) / (nodes - 1);
      }
      if (nodes <= 3) { /* whole pixels */
        assert_near((double)weight[row * WIDTH + column], 1, 1e-6);
      }
    }
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
      assert_near((double)sum[i], 1, 1e-6); /* floats */
    }
  }
}

/* Bright squares on black, over the whole picture. */
static placido_scene squares(void) {
  placido_scene scene = {.name = "squares", .arcmin_per_px = arcmin_per_px, .bits = 8};
  scene.conditions.luminance_cd_m2 = NAN;
  scene.conditions.distance_m = INFINITY;
  assert_int_equal(placido_image_new(&scene.image, SIDE, SIDE, 1, NULL), PLACIDO_OK);
  for (int i = 0; i < SIDE * SIDE; i++) {
    int pitch = SIDE / SQUARES, from = (pitch - SQUARE) / 2;
    int x = i % SIDE % pitch - from, y = i / SIDE % pitch - from;
    scene.image.data[i] = x >= 0 && x < SQUARE && y >= 0 && y < SQUARE;
  }
  return scene;
}

/* A pixel is a square: what lands in it is its. */
static void drop(double *seen, double column, double row, double light) {
  int x = (int)floor(column + 0.5), y = (int)floor(row + 0.5);
  if (x >= 0 && x < SIDE && y >= 0 && y < SIDE) {
    seen[y * SIDE + x] += light;
  }
}

/* Every lit pixel by itself: rays fill its square and the pupil, from its own direction. Their mean
 * lies beside the pixel where it lies on the axis: the picture is not distorted. */
static void see_pixel(double *seen, const model *m, int column, int row) {
  const double radius_mm = m->eye.pupil_mm / 2, cell_mm = 2 * radius_mm / ACROSS;
  const double light = cell_mm * cell_mm / (pi * radius_mm * radius_mm);
  const double middle = 0.5 * (SIDE - 1), step = arcmin_per_px * arcmin_rad;
  double there[2][2], mean[2];
  unsigned seed = (unsigned)(row * SIDE + column);
  follow(there, m, (column - middle) * step, (row - middle) * step);
  mean_of(mean, m, there, (column - middle) * step, (row - middle) * step);
  for (int i = 0; i < ACROSS * ACROSS; i++) {
    double jitter[4];
    for (int k = 0; k < 4; k++) {
      seed = seed * 1664525u + 1013904223u;
      jitter[k] = (seed >> 8) / 16777216.0;
    }
    double x = (i % ACROSS + jitter[0]) * cell_mm - radius_mm;
    double y = (i / ACROSS + jitter[1]) * cell_mm - radius_mm;
    double right = column + jitter[2] - 0.5, down = row + jitter[3] - 0.5;
    ray chief, r;
    if (hypot(x, y) < radius_mm &&
        trace(&chief, m, (right - middle) * step, (middle - down) * step, 0, 0) &&
        trace(&r, m, (right - middle) * step, (middle - down) * step, x, y)) {
      double angle[2];
      angle_of(angle, m, there, &r, &chief);
      drop(seen, right + (angle[0] - mean[0] + m->mean[0] - m->fixation[0]) / step,
           down + (angle[1] - mean[1] + m->mean[1] - m->fixation[1]) / step, light);
    }
  }
}

static void see_by_brute_force(double binned[BINS * BINS], const model *m,
                               const placido_scene *scene) {
  double *seen = calloc(SIDE * SIDE, sizeof *seen);
  assert_non_null(seen);
  for (int i = 0; i < SIDE * SIDE; i++) {
    if (scene->image.data[i] > 0) {
      see_pixel(seen, m, i % SIDE, i / SIDE);
    }
  }
  bin_up(binned, seen, SIDE, BIN);
  free(seen);
}

/* As the program has it; `with` false: the spread of the middle everywhere. */
static void see_by_nodes(double binned[BINS * BINS], const model *m, const placido_scene *scene,
                         bool with, int nodes) {
  static const placido_effect *const effects[] = {&placido_effect_field};
  const placido_plan_settings settings = {.pupil_samples = 200, .wavelengths = 1, .layers = 1,
                                          .nodes = nodes, .bucket_arcmin = arcmin_per_px,
                                          .buckets = 129};
  placido_facts facts;
  placido_image image;
  placido_error err = {0};
  double *seen = calloc(SIDE * SIDE, sizeof *seen);
  assert_non_null(seen);
  assert_int_equal(placido_facts_find(&facts, scene, NULL), PLACIDO_OK);
  const placido_run run = {.surface = m->surface, .scene = scene, .facts = &facts,
                           .settings = &settings, .eye = &m->eye, .effects = effects,
                           .count = with, .threads = 1};
  if (placido_view_run(&image, NULL, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  for (int i = 0; i < SIDE * SIDE; i++) {
    seen[i] = (double)image.data[i];
  }
  bin_up(binned, seen, SIDE, BIN);
  placido_image_free(&image);
  free(seen);
}

/* A cone: the footprint of light from the side lies on another part of it. Interpolation's error
 * falls with the nodes' distance, down to the noise of brute force: 0.007 with 1,500 rays a pixel, and
 * less with more of them. */
static void test_nodes_approach_brute_force(void **state) {
  (void)state;
  enum { STEPS = 4 };
  static double truth[BINS * BINS], seen[BINS * BINS];
  const int nodes[STEPS] = {1, 3, 5, 9};
  double error[STEPS];
  placido_surface *surface = keratoconus(0);
  placido_scene scene = squares();
  model m = model_of(surface, 4);
  see_by_brute_force(truth, &m, &scene);
  see_by_nodes(seen, &m, &scene, false, 1);
  double without = misplaced(seen, truth, BINS * BINS);
  for (int k = 0; k < STEPS; k++) {
    see_by_nodes(seen, &m, &scene, true, nodes[k]);
    error[k] = misplaced(seen, truth, BINS * BINS);
  }
  assert_true(without > 0.05 && error[0] > 0.05); /* so much of the light lies elsewhere */
  assert_true(error[1] < error[0] / 4);
  assert_true(error[2] < 0.75 * error[1]);
  assert_true(error[3] < 0.75 * error[1] && error[3] < 0.009);
  placido_image_free(&scene.image);
  placido_surface_free(surface);
}

/* Root mean square of how far rays are seen from where they are in the middle, all of them being
 * moved so that their mean stays: arcmin. */
static double unrest(const model *m, const placido_sketch_rays *rays, double right, double down) {
  double there[2][2], square = 0, mean[2] = {0, 0};
  ray chief, middle_chief, r, middle_r;
  follow(there, m, right, down);
  assert_true(trace(&middle_chief, m, 0, 0, 0, 0) && trace(&chief, m, right, -down, 0, 0));
  for (int i = 0; i < rays->count; i++) {
    double x = (double)rays->x_mm[i], y = (double)rays->y_mm[i], middle[2], angle[2];
    assert_true(trace(&middle_r, m, 0, 0, x, y) && trace(&r, m, right, -down, x, y));
    angle_of(angle, m, there, &r, &chief);
    angle_of(middle, m, (double(*)[2])m->axis, &middle_r, &middle_chief);
    for (int k = 0; k < 2; k++) {
      double turn = (angle[k] - middle[k]) / arcmin_rad;
      mean[k] += (double)rays->weight[i] * turn;
      square += (double)rays->weight[i] * turn * turn;
    }
  }
  return sqrt(square - mean[0] * mean[0] - mean[1] * mean[1]);
}

/* A sunflower of rays. */
static void fill(placido_sketch_rays *rays, double radius_mm) {
  rays->count = PLACIDO_SKETCH_RAYS;
  for (int i = 0; i < rays->count; i++) {
    double radius = radius_mm * sqrt((i + 0.5) / rays->count), angle = 2.399963 * i;
    rays->x_mm[i] = (float)(radius * cos(angle));
    rays->y_mm[i] = (float)(radius * sin(angle));
    rays->weight[i] = 1 / (float)rays->count;
  }
}

static double rms(const placido_strokes *strokes, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += (double)(strokes->angle_x[i] * strokes->angle_x[i] +
                    strokes->angle_y[i] * strokes->angle_y[i]);
  }
  return sqrt(sum / count);
}

/* The strokes are those of the place where there is something to be seen: behind the cornea alone, as
 * the whole eye is refused. */
static void test_strokes_are_those_where_it_is_seen(void **state) {
  (void)state;
  enum { COLUMNS = 24, ROWS = 16 };
  static placido_sketch_rays rays;
  placido_surface *surface = keratoconus(30);
  placido_scene scene = {.arcmin_per_px = 1};
  model m = model_of(surface, 5);
  double least = INFINITY;
  fill(&rays, 2.5);
  for (int corner = 0; corner < 5; corner++) {
    placido_facts facts = {.planes = 1, .width_deg = 6, .height_deg = 4, .columns = COLUMNS,
                           .rows = ROWS, .cell_arcmin = 15, .brightest = {4}};
    placido_strokes strokes = {.turns = false};
    placido_answer answer = {.strokes = &strokes};
    const placido_question question = {.surface = surface, .scene = &scene, .eye = &m.eye,
                                       .facts = &facts, .rays = &rays, .bucket_arcmin = 0.5,
                                       .refused = PLACIDO_GIVES_WHOLE_EYE};
    double right = corner % 2 ? 3 : -3, down = corner / 2 ? 2 : -2;
    int column = corner % 2 ? COLUMNS - 1 : 0, row = corner / 2 ? ROWS - 1 : 0;
    if (corner == 4) { /* in the middle: the outer ends of the cells around are not far */
      right = down = 0;
      column = COLUMNS / 2 - 1;
      row = ROWS / 2 - 1;
    }
    facts.most[row * COLUMNS + column] = 1;
    placido_effect_field.ask(&question, &answer);
    double found = rms(&strokes, rays.count);
    double alone = unrest(&m, &rays, tan(right * pi / 180), tan(down * pi / 180));
    assert_true(answer.applies && strokes.turns && answer.bound == 0);
    assert_near(answer.share, 0.25, 1e-9); /* a light of 1, where others may be of 4 */
    if (corner < 4) {
      assert_near(found, alone, 0.05 * alone); /* light 20' beside is off the tangent plane */
      least = fmin(least, found);
    } else {
      assert_true(found < least / 3);
    }
  }
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_nodes_stand_where_their_light_is_seen),
    cmocka_unit_test(test_weights_are_a_partition_without_seams),
    cmocka_unit_test(test_nodes_approach_brute_force),
    cmocka_unit_test(test_strokes_are_those_where_it_is_seen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

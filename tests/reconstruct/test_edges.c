/* Edges where they are, and as sure as they say: against the phantom's exact trace, over noise,
 * blur, narrow mires, motion, uneven light and glare. */
#include "base/random.h"
#include "reconstruct/mires/plane.h"
#include "reconstruct/mires/polar.h"
#include "reconstruct/mires/steps.h"
#include "tests/support/near.h"

#include <placido/mires.h>
#include <placido/phantom.h>
#include <string.h>

#define EVERY 17 /* points are compared; no divisor of the 360 meridians */

/* What a picture shows. */
typedef struct picture {
  const char *name, *eye, *instrument;
  double scale; /* of the image against the instrument's own */
  double blur_px, noise, motion_px;
  double thinner; /* share of a mire's width that it loses */
  double uneven;  /* how much brighter the right border is than the left */
  double rms_px;  /* at most so far off */
} picture;

/* Errors of measured points across the edge. */
typedef struct errors {
  size_t count, far;
  double mean, rms, over_sigma, rising, falling;
} errors;

/* The instrument with another size of image, and mires made thinner. */
static placido_instrument adapt(const picture *p) {
  placido_instrument it;
  assert_int_equal(placido_phantom_instrument(&it, p->instrument, NULL), PLACIDO_OK);
  it.width_px = (int)lround(it.width_px * p->scale);
  it.height_px = (int)lround(it.height_px * p->scale);
  it.principal_px[0] = (it.width_px - 1) / 2.0;
  it.principal_px[1] = (it.height_px - 1) / 2.0;
  it.focal_px[0] *= p->scale;
  it.focal_px[1] *= p->scale;
  for (int k = 0; k + 1 < it.edge_count; k += 2) {
    placido_edge *inner = &it.edges[k], outer = it.edges[k + 1];
    inner->radius_mm += p->thinner * (outer.radius_mm - inner->radius_mm);
    inner->z_mm += p->thinner * (outer.z_mm - inner->z_mm);
  }
  return it;
}

/* Noise and uneven light come last, as in a camera whose lens darkens to one side; without noise
 * the rounding to 8 bits is what is left. */
static void expose(placido_frame *frame, const picture *p) {
  for (int y = 0; y < frame->height_px; y++) {
    uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (int x = 0; x < frame->width_px; x++) {
      uint64_t pixel = (uint64_t)y * (uint64_t)frame->width_px + (uint64_t)x;
      double light = 1 + p->uneven * ((double)x / frame->width_px - 0.5);
      double grey = row[x] * light + p->noise * placido_random_normal(5, 0, pixel);
      row[x] = (uint8_t)(fmax(0, fmin(255, grey)) + 0.5);
    }
  }
}

static placido_frame render(const picture *p, const placido_surface *eye,
                            const placido_instrument *instrument) {
  placido_frame frame = {0};
  placido_disturbance how = {.seed = 3, .blur_px = p->blur_px, .motion_px = p->motion_px,
                             .motion_deg = 30};
  assert_int_equal(placido_phantom_render(&frame, eye, instrument, &how, 2, NULL), PLACIDO_OK);
  return frame;
}

static errors compare(const placido_mires *mires, const placido_surface *eye,
                      const placido_instrument *instrument) {
  errors e = {0};
  double centre[2] = {mires->centre_u_px, mires->centre_v_px}, sums[2] = {0};
  size_t counts[2] = {0};
  for (size_t i = 0; i < mires->count; i += EVERY) {
    const placido_mire_point *p = &mires->points[i];
    double at[2], radian = p->meridian_deg * M_PI / 180;
    if (!placido_phantom_edge_at(eye, instrument, p->edge, centre, p->meridian_deg, at)) {
      e.far++;
      continue;
    }
    double off = (p->u_px - at[0]) * cos(radian) - (p->v_px - at[1]) * sin(radian);
    e.far += fabs(off) > 1;
    e.count++;
    e.mean += off;
    e.rms += off * off;
    e.over_sigma += off * off / (p->sigma_px * p->sigma_px);
    sums[p->edge % 2] += off;
    counts[p->edge % 2]++;
  }
  e.mean /= (double)e.count;
  e.rms = sqrt(e.rms / (double)e.count);
  e.over_sigma = sqrt(e.over_sigma / (double)e.count);
  e.rising = sums[0] / (double)counts[0];
  e.falling = sums[1] / (double)counts[1];
  return e;
}

/* Whether two pictures differ in no more than noise and light. */
static bool same_scene(const picture *a, const picture *b) {
  return strcmp(a->eye, b->eye) == 0 && strcmp(a->instrument, b->instrument) == 0 &&
         a->scale == b->scale && a->blur_px == b->blur_px && a->motion_px == b->motion_px &&
         a->thinner == b->thinner;
}

/* Measures an exposure of the scene `clean`. */
static errors measure(const picture *p, const placido_frame *clean, const placido_surface *eye,
                      const placido_instrument *instrument, double filter_px, double *coverage) {
  placido_mires mires;
  placido_error err = {0};
  placido_frame frame = {0};
  assert_int_equal(placido_frame_resize(&frame, clean->width_px, clean->height_px, clean->format,
                                        NULL),
                   PLACIDO_OK);
  for (int y = 0; y < frame.height_px; y++) {
    memcpy(frame.data + (size_t)y * frame.stride_bytes,
           clean->data + (size_t)y * clean->stride_bytes, (size_t)frame.width_px);
  }
  expose(&frame, p);
  placido_mires_options how = {.filter_px = filter_px, .threads = 2};
  if (placido_mires_find(&mires, &frame, instrument, &how, NULL, &err)) {
    fail_msg("%s: %s", p->name, err.text);
  }
  *coverage = mires.coverage;
  errors e = compare(&mires, eye, instrument);
  placido_mires_free(&mires);
  placido_frame_free(&frame);
  return e;
}

/* What the standard deviation claims is what happens, within the 0.8 to 1.25 that error bars are
 * worth something at, where noise makes the error. Pictures without noise are left with the
 * renderer's 16 rays a pixel, whose errors run along the edges and are seen less well: up to 1.4.
 * The error itself stays under what was reached, with some room. Bias is under 0.01 px, of rising
 * and of falling edges, and what three standard deviations of their mean allow. */
static void edges_are_where_they_say(void **state) {
  (void)state;
  static const picture pictures[] = {
      {"sharp, no noise", "normal", "cone24", 1, 0.8, 0, 0, 0, 0, 0.021},
      {"sharp", "normal", "cone24", 1, 0.8, 1.2, 0, 0, 0, 0.024},
      {"noisy", "normal", "cone24", 1, 0.8, 3, 0, 0, 0, 0.033},
      {"very noisy", "normal", "cone24", 1, 0.8, 6, 0, 0, 0, 0.056},
      {"uneven light", "normal", "cone24", 1, 0.8, 1.2, 0, 0, 0.4, 0.024},
      {"blurred, no noise", "normal", "cone24", 1, 1.5, 0, 0, 0, 0, 0.019},
      {"blurred", "normal", "cone24", 1, 1.5, 1.2, 0, 0, 0, 0.026},
      {"blurred and noisy", "normal", "cone24", 1, 1.5, 3, 0, 0, 0, 0.048},
      {"blurred and very noisy", "normal", "cone24", 1, 1.5, 6, 0, 0, 0, 0.09},
      {"very blurred, no noise", "normal", "cone24", 1, 2.5, 0, 0, 0, 0, 0.028},
      {"very blurred", "normal", "cone24", 1, 2.5, 1.2, 0, 0, 0, 0.07},
      {"very blurred and noisy", "normal", "cone24", 1, 2.5, 3, 0, 0, 0, 0.145},
      {"moved", "normal", "cone24", 1, 0.8, 1.2, 3, 0, 0, 0.025},
      {"thin mires", "normal", "cone24", 1, 0.8, 1.2, 0, 0.4, 0, 0.025},
      {"thin mires, blurred", "normal", "cone24", 1, 1.5, 1.2, 0, 0.4, 0, 0.045},
      {"wide mires", "normal", "cone24", 1, 0.8, 1.2, 0, -0.5, 0, 0.027},
      {"keratoconus", "keratoconus", "cone24", 1, 0.8, 1.2, 0, 0, 0, 0.024},
      {"disc", "normal", "disc18", 1, 0.8, 1.2, 0, 0, 0, 0.027},
      {"small image", "normal", "cone24", 0.5, 0.8, 1.2, 0, 0, 0, 0.031},
  };
  placido_surface *eye = NULL;
  placido_instrument instrument;
  placido_frame clean = {0};
  for (size_t i = 0; i < sizeof pictures / sizeof pictures[0]; i++) {
    const picture *p = &pictures[i];
    if (i == 0 || !same_scene(p, p - 1)) {
      placido_surface_free(eye);
      placido_frame_free(&clean);
      assert_int_equal(placido_phantom_eye(&eye, p->eye, NULL), PLACIDO_OK);
      instrument = adapt(p);
      clean = render(p, eye, &instrument);
    }
    double coverage;
    errors e = measure(p, &clean, eye, &instrument, 0, &coverage);
    print_message("%-24s rms %.4f px, over sigma %.2f, rising %+.4f falling %+.4f, %.3f found\n",
                  p->name, e.rms, e.over_sigma, e.rising, e.falling, coverage);
    assert_int_equal(e.far, 0);
    assert_true(coverage > 0.98);
    assert_true(e.rms < p->rms_px);
    assert_true(e.over_sigma > 0.8 && e.over_sigma < (p->noise > 0 ? 1.25 : 1.4));
    double chance = 3 * e.rms / sqrt((double)e.count / 2);
    assert_near(e.rising, 0, 0.01 + chance);
    assert_near(e.falling, 0, 0.01 + chance);
  }
  placido_surface_free(eye);
  placido_frame_free(&clean);
}

/* A Gaussian of standard deviation s averages noise over 2 √π s pixels: errors go with s^-1/2. On
 * the 40 % of the meridians that run aslant the kernel is the narrow one, whose variance at 2 px is
 * 2.2 and not 4, and blurs the edge by 1 px² besides, from 2.6: errors there are 1.16 × 1.09 times
 * as large; and 0.02 px are the renderer's own (above). Within a quarter. One pixel is the default.
 * */
static void a_wider_filter_averages_more(void **state) {
  (void)state;
  static const picture noisy = {"very noisy", "normal", "cone24", 1, 1.5, 6, 0, 0, 0, 0};
  static const double filters_px[] = {0, 1, 0.6, 2};
  enum { FILTERS = sizeof filters_px / sizeof filters_px[0] };
  placido_surface *eye;
  errors found[FILTERS];
  assert_int_equal(placido_phantom_eye(&eye, "normal", NULL), PLACIDO_OK);
  placido_instrument instrument = adapt(&noisy);
  placido_frame clean = render(&noisy, eye, &instrument);
  for (int i = 0; i < FILTERS; i++) {
    double coverage;
    found[i] = measure(&noisy, &clean, eye, &instrument, filters_px[i], &coverage);
    print_message("filter %.1f px: rms %.4f px, over sigma %.2f, rising %+.4f falling %+.4f\n",
                  filters_px[i], found[i].rms, found[i].over_sigma, found[i].rising,
                  found[i].falling);
    assert_true(coverage > 0.98);
    double chance = 3 * found[i].rms / sqrt((double)found[i].count / 2);
    assert_near(found[i].rising, 0, 0.01 + chance);
    assert_near(found[i].falling, 0, 0.01 + chance);
  }
  assert_true(found[0].rms == found[1].rms);
  for (int i = 2; i < FILTERS; i++) {
    double expected = sqrt(1 / filters_px[i]), got = found[i].rms / found[1].rms;
    assert_near(got / expected, 1, 0.25);
  }
  placido_surface_free(eye);
  placido_frame_free(&clean);
}

/* Saturated spots lie across the mires like a lamp's reflections. What is measured beside them
 * stays where it is: the next edge is 9 px away, and a spot's border would be off by some pixels. */
static void glare_is_no_edge(void **state) {
  (void)state;
  static const picture bright = {"glare", "normal", "cone24", 1, 0.8, 1.2, 0, 0, 0, 0};
  placido_surface *eye;
  placido_mires mires;
  assert_int_equal(placido_phantom_eye(&eye, "normal", NULL), PLACIDO_OK);
  placido_instrument instrument = adapt(&bright);
  placido_frame frame = render(&bright, eye, &instrument);
  expose(&frame, &bright);
  for (int spot = 0; spot < 12; spot++) {
    double angle = 0.37 + 2.4 * spot, away = 60 + 25 * spot;
    double u = 639.5 + away * cos(angle), v = 511.5 + away * sin(angle);
    for (int y = (int)v - 9; y <= (int)v + 9; y++) {
      for (int x = (int)u - 9; x <= (int)u + 9; x++) {
        if (hypot(x - u, y - v) < 8.5) {
          frame.data[(size_t)y * frame.stride_bytes + (size_t)x] = 255;
        }
      }
    }
  }
  assert_int_equal(placido_mires_find(&mires, &frame, &instrument, NULL, NULL, NULL), PLACIDO_OK);
  double centre[2] = {mires.centre_u_px, mires.centre_v_px}, worst = 0;
  for (size_t i = 0; i < mires.count; i++) {
    const placido_mire_point *p = &mires.points[i];
    double at[2], nearest = INFINITY;
    for (int spot = 0; spot < 12; spot++) {
      double angle = 0.37 + 2.4 * spot, away = 60 + 25 * spot;
      nearest = fmin(nearest, hypot(p->u_px - 639.5 - away * cos(angle),
                                    p->v_px - 511.5 - away * sin(angle)));
    }
    if (p->used && nearest < 16) {
      assert_true(placido_phantom_edge_at(eye, &instrument, p->edge, centre, p->meridian_deg, at));
      worst = fmax(worst, hypot(p->u_px - at[0], p->v_px - at[1]));
    }
  }
  print_message("worst beside glare: %.3f px\n", worst);
  assert_true(worst < 1);
  placido_mires_free(&mires);
  placido_frame_free(&frame);
  placido_surface_free(eye);
}

/* The brightest of three planes may be the one without mires: contrast chooses. */
static void the_plane_with_the_mires_is_taken(void **state) {
  (void)state;
  placido_frame frame = {0};
  placido_image plane;
  assert_int_equal(placido_frame_resize(&frame, 64, 48, PLACIDO_RGB8, NULL), PLACIDO_OK);
  for (int y = 0; y < 48; y++) {
    for (int x = 0; x < 64; x++) {
      uint8_t *pixel = frame.data + (size_t)y * frame.stride_bytes + 3 * (size_t)x;
      pixel[0] = 250;
      pixel[1] = (uint8_t)(100 + 60 * (x / 3 % 2));
      pixel[2] = (uint8_t)(90 + 20 * (x / 3 % 2));
    }
  }
  assert_int_equal(placido_mires_plane(&plane, &frame, NULL), PLACIDO_OK);
  assert_near(plane.data[64 * 20], 100.0 / 255, 1e-6);
  assert_near(plane.data[64 * 20 + 3], 160.0 / 255, 1e-6);
  placido_image_free(&plane);
  placido_frame_free(&frame);
}

/* One thread or two: every bit the same. */
static void threads_change_nothing(void **state) {
  (void)state;
  static const picture noisy = {"threads", "irregular", "cone24", 0.5, 0.8, 3, 0, 0, 0, 0};
  placido_surface *eye;
  placido_mires one, two;
  assert_int_equal(placido_phantom_eye(&eye, noisy.eye, NULL), PLACIDO_OK);
  placido_instrument instrument = adapt(&noisy);
  placido_frame frame = render(&noisy, eye, &instrument);
  expose(&frame, &noisy);
  placido_mires_options alone = {.threads = 1}, both = {.threads = 2};
  assert_int_equal(placido_mires_find(&one, &frame, &instrument, &alone, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_mires_find(&two, &frame, &instrument, &both, NULL, NULL), PLACIDO_OK);
  assert_int_equal(one.count, two.count);
  for (size_t i = 0; i < one.count; i++) {
    assert_true(one.points[i].u_px == two.points[i].u_px);
    assert_true(one.points[i].v_px == two.points[i].v_px);
    assert_true(one.points[i].sigma_px == two.points[i].sigma_px);
  }
  placido_mires_free(&one);
  placido_mires_free(&two);
  placido_frame_free(&frame);
  placido_surface_free(eye);
}

/* Gathering pixels adds a known variance: the bowl u² + v² comes out higher by it, whatever the
 * meridian. */
static void the_kernel_blurs_as_it_says(void **state) {
  (void)state;
  static const double filters_px[] = {0.6, 1, 1.7, 4};
  placido_image plane;
  double centre[2] = {30.3, 29.6};
  assert_int_equal(placido_image_new(&plane, 64, 64, 1, NULL), PLACIDO_OK);
  for (int y = 0; y < 64; y++) {
    for (int x = 0; x < 64; x++) {
      plane.data[64 * y + x] = (float)(((x - 30.3) * (x - 30.3) + (y - 29.6) * (y - 29.6)) / 4000);
    }
  }
  for (int f = 0; f < 4; f++) {
    double filter_px = filters_px[f]; /* the widest has little room */
    placido_polar polar;
    assert_int_equal(placido_polar_new(&polar, &plane, centre, 20, 48, filter_px, 1, NULL),
                     PLACIDO_OK);
    assert_null(polar.clipped);
    assert_near(polar.along[0].tangential_px2, filter_px * filter_px, 1e-12);
    assert_true(polar.along[0].count > 0);
    for (int m = 0; m < 48; m++) {
      const placido_meridian *along = &polar.along[m];
      assert_true(filter_px > 2 || (along->start_px < -6 && along->count * along->step_px > 25));
      for (int i = 0; i < along->count; i++) {
        double r = along->start_px + i * along->step_px;
        double expected = r * r + along->radial_px2 + along->tangential_px2;
        /* weights are tabulated 256 to the pixel: 2 r / 512 */
        assert_near(4000 * (double)polar.data[m * polar.samples + i], expected, 0.1);
      }
    }
    placido_polar_free(&polar);
  }
  placido_image_free(&plane);
}

/* Eight noisy steps at a time, each with a neighbour's tail that is taken off: the places scatter
 * about the truth as widely as `spread` says. 1600 of them tell that within 2 %; 6 % is asked for.
 */
static void fitted_steps_scatter_as_they_say(void **state) {
  (void)state;
  const double place = 0.13, width = 1.1, noise = 0.01;
  double squares = 0, expected = 0, mean = 0, residuals = 0;
  for (int run = 0; run < 200; run++) {
    static placido_steps steps;
    placido_step_lanes neighbour = {{0}, {0}, {0}, {0}};
    steps = (placido_steps){.samples = 11};
    for (int l = 0; l < PLACIDO_STEPS_LANES; l++) {
      steps.first[l] = -5;
      steps.pitch[l] = steps.step.width[l] = steps.usual[l] = neighbour.width[l] = 1;
      steps.step.height[l] = 0.4F;
      neighbour.place[l] = 5;
      neighbour.height[l] = -0.5F;
      for (int i = 0; i < steps.samples; i++) {
        uint64_t key = (uint64_t)(run * 1000 + l * 50 + i);
        steps.value[i][l] =
            (float)(0.3 + 0.25 * erf((i - 5 - place) / width * M_SQRT1_2) +
                    -0.25 * (1 + erf((i - 10) * M_SQRT1_2)) +
                    noise * placido_random_normal(11, 0, key));
        steps.weight[i][l] = 1;
      }
    }
    placido_steps_take_off(&steps, &neighbour, 0);
    placido_steps_fit(&steps, 0.001F);
    for (int l = 0; l < PLACIDO_STEPS_LANES; l++) {
      double off = (double)steps.step.place[l] - place;
      mean += off / (200 * PLACIDO_STEPS_LANES);
      squares += off * off;
      expected += noise * noise * (double)steps.spread[l];
      residuals += (double)steps.squares[l] / (200 * PLACIDO_STEPS_LANES);
    }
  }
  assert_near(sqrt(squares / expected), 1, 0.06);
  assert_near(mean, 0, 0.002);
  assert_near(residuals / (noise * noise), 11 - 4, 0.4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_kernel_blurs_as_it_says),
      cmocka_unit_test(fitted_steps_scatter_as_they_say),
      cmocka_unit_test(the_plane_with_the_mires_is_taken),
      cmocka_unit_test(edges_are_where_they_say),
    cmocka_unit_test(a_wider_filter_averages_more),
      cmocka_unit_test(glare_is_no_edge),
      cmocka_unit_test(threads_change_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}

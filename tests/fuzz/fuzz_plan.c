/* The planner, asked of eyes, scenes and wishes that nobody would think of: what it decides is
 * bounded, accounted for, and where it runs gives light in every pixel. Each byte of the input
 * chooses a value; behind them come the picture's samples. */
#include "simulate/plan/plan.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/target.h"

#include "base/memory.h"

#include <placido/plan.h>

#include <math.h>
#include <string.h>

#define SIDE_MAX_PX 6
#define RUN_MAX_MS 5.0  /* what a plan may cost to be run here */
#define SEARCHED 5      /* of 256: the eye's focus is not given, and searching it takes long */

/* What is left of the input. */
struct bytes {
  const uint8_t *data;
  size_t size;
};

static uint8_t next(struct bytes *bytes) {
  return fuzz_byte(&bytes->data, &bytes->size);
}

/* One of the values: the usual ones come first, then those at the borders and beyond. */
static double choose(struct bytes *bytes, const double *values, size_t count) {
  return values[next(bytes) % count];
}
#define CHOOSE(bytes, ...)                                                                        \
  choose((bytes), (const double[]){__VA_ARGS__}, sizeof((double[]){__VA_ARGS__}) / sizeof(double))

static int make_surface(placido_surface **surface, struct bytes *bytes, placido_error *err) {
  placido_part parts[3] = {{.kind = PLACIDO_PART_BICONIC}};
  size_t count = 1;
  parts[0].as.biconic.r1 = CHOOSE(bytes, 7.8, 12, 5, 6.5, 1e3, 0.5, -7.8, 1e9, 1e-3);
  parts[0].as.biconic.r2 = CHOOSE(bytes, 7.8, 7.5, 12, 5, -7.8, 1e6);
  parts[0].as.biconic.q1 = CHOOSE(bytes, -0.2, 0, -1, 1, -3, 30, 1e6);
  parts[0].as.biconic.q2 = CHOOSE(bytes, -0.2, 0, -1, 1, -3);
  parts[0].as.biconic.axis_deg = CHOOSE(bytes, 0, 30, 90, 180, 1e9);
  const uint8_t more = next(bytes);
  if (more & 1) {
    parts[count].kind = PLACIDO_PART_BUMP;
    parts[count].as.bump.height_mm = CHOOSE(bytes, 0.03, 0.2, -0.1, 5, 1e-9);
    parts[count].as.bump.sigma_x_mm = CHOOSE(bytes, 0.8, 0.1, 2, 1e-3, 1e3);
    parts[count].as.bump.sigma_y_mm = CHOOSE(bytes, 0.8, 0.2, 3);
    parts[count++].as.bump.y_mm = CHOOSE(bytes, -1, 0, 0.3);
  }
  if (more & 2) {
    parts[count].kind = PLACIDO_PART_RIDGE;
    parts[count].as.ridge.slope = CHOOSE(bytes, 0.01, 0.1, 1, -5);
    parts[count++].as.ridge.width_mm = CHOOSE(bytes, 0.2, 0.01, 1e-6);
  }
  const double vertex_mm = CHOOSE(bytes, 0, 1, -1000, 1000);
  return placido_surface_new(surface, vertex_mm, CHOOSE(bytes, 4.5, 2, 0.5, 20, 1e-3), parts, count,
                             NULL, err);
}

static placido_eye make_eye(struct bytes *bytes) {
  placido_eye eye = {.pupil_mm = CHOOSE(bytes, 3, 0, 5, 8, 2, 0.3, 0.1, 12, 13, -1, NAN)};
  eye.pupil_x_mm = CHOOSE(bytes, 0, 0.3, -2, 100);
  eye.pupil_y_mm = CHOOSE(bytes, 0, -0.2, 3);
  eye.index = CHOOSE(bytes, 0, 1.3375, 1.376, 1.01, 2, 1, 5, NAN);
  eye.retina_mm = CHOOSE(bytes, 24, 30.9, 31, 20, 200, 5, -3);
  if (next(bytes) == SEARCHED) {
    eye.retina_mm = 0;
    eye.correct = (enum placido_correct)(next(bytes) % 3);
  }
  eye.correction.m_D = CHOOSE(bytes, 0, -1, 3, -30, 1e3, NAN);
  eye.correction.j0_D = CHOOSE(bytes, 0, 0.5, -10);
  eye.age_years = CHOOSE(bytes, 0, 20, 75, 5, 100, 101);
  eye.iris = (enum placido_iris)(next(bytes) % 5);
  return eye;
}

static double sample(struct bytes *bytes) {
  const uint8_t byte = next(bytes);
  return byte == 255 ? 1e6 : byte == 254 ? 1e-30 : byte / 128.0;
}

static int make_depth(placido_scene *scene, struct bytes *bytes, size_t pixels,
                      placido_error *err) {
  scene->depth_D = placido_memory_new(pixels, sizeof *scene->depth_D, err);
  for (size_t i = 0; scene->depth_D && i < pixels; i++) {
    scene->depth_D[i] = (float)CHOOSE(bytes, 0, 1, 0.2, 3, 100);
  }
  return scene->depth_D ? PLACIDO_OK : PLACIDO_MEMORY;
}

static int make_scene(placido_scene *scene, struct bytes *bytes, placido_error *err) {
  static const int planes[] = {1, 3, 4};
  const int width_px = 1 + next(bytes) % SIDE_MAX_PX, height_px = 1 + next(bytes) % SIDE_MAX_PX;
  const size_t pixels = (size_t)width_px * (size_t)height_px;
  const uint8_t how = next(bytes);
  *scene = (placido_scene){.name = "fuzz", .bits = 8, .allow_coarse = how & 4};
  scene->arcmin_per_px = CHOOSE(bytes, 0.5, 1, 0.1, 4, 60, 1e-3, 600);
  scene->bleed_px = how & 8 && width_px > 2 && height_px > 2;
  scene->resampling = how & 16 ? PLACIDO_RESAMPLING_BICUBIC : PLACIDO_RESAMPLING_AREA;
  scene->conditions = (placido_conditions){
      .luminance_cd_m2 = CHOOSE(bytes, 100, NAN, 0.01, 1e-6, 1e6),
      .distance_m = CHOOSE(bytes, INFINITY, 0.4, 1, 0.01, 1e9),
      .spectrum = (enum placido_spectrum)(next(bytes) % 5),
      .wavelength_nm = CHOOSE(bytes, 555, 380, 780),
      .tolerance = CHOOSE(bytes, 0.01, 1e-6, 1, 0.1, 1e-3)};
  int status = placido_image_new(&scene->image, width_px, height_px, planes[how % 3], err);
  if (status == PLACIDO_OK && how & 32) {
    status = make_depth(scene, bytes, pixels, err);
  }
  for (size_t i = 0; status == PLACIDO_OK && i < pixels * (size_t)scene->image.planes; i++) {
    const double light = sample(bytes);
    scene->image.data[i] = (float)(i / pixels == 3 ? fmin(light, 1) : light);
  }
  return status;
}

static placido_plan_wish make_wish(struct bytes *bytes) {
  placido_plan_wish wish = {.tolerance = CHOOSE(bytes, 0, 0.01, 1e-6, 1, 2, -1),
                            .bucket_arcmin = CHOOSE(bytes, 0, 0.5, 1, 0.25, 0.01, 60, 61)};
  wish.finest = next(bytes) % 16 == 1;
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    const uint8_t force = next(bytes);
    wish.force[i] = (enum placido_force)(force < 3 ? force : 0);
  }
  return wish;
}

static bool is_share(double value) {
  return value >= 0 && value <= 1;
}

/* Every effect is accounted for, and what the planner left out fits into the tolerance. */
static void check(const placido_plan *plan) {
  double left_out = 0;
  size_t count;
  const placido_verdict *verdicts = placido_plan_verdicts(plan, &count);
  const placido_plan_settings *settings = placido_plan_settings_of(plan);
  const placido_eye *eye = placido_plan_eye(plan);
  for (size_t i = 0; i < count; i++) {
    FUZZ_REQUIRE(is_share(verdicts[i].bound));
    FUZZ_REQUIRE(isfinite(verdicts[i].cost_ms) && verdicts[i].cost_ms >= 0);
    FUZZ_REQUIRE(memchr(verdicts[i].reason, '\0', sizeof verdicts[i].reason) != NULL);
    FUZZ_REQUIRE(verdicts[i].reason[0] != '\0' && !strchr(verdicts[i].reason, '\n'));
    FUZZ_REQUIRE(!plan->own[i] || !verdicts[i].runs);
    FUZZ_REQUIRE(!(verdicts[i].runs && verdicts[i].force == PLACIDO_FORCE_OFF));
    left_out += plan->own[i] ? verdicts[i].bound : 0;
  }
  FUZZ_REQUIRE(left_out <= plan->wish.tolerance);
  FUZZ_REQUIRE(isfinite(settings->bound) && settings->bound >= 0);
  FUZZ_REQUIRE(isfinite(settings->cost_ms) && settings->cost_ms >= 0);
  FUZZ_REQUIRE(settings->pupil_samples >= 1 && settings->wavelengths >= 1 && settings->layers >= 1);
  FUZZ_REQUIRE(settings->nodes % 2 == 1 && settings->buckets % 2 == 1);
  FUZZ_REQUIRE(eye->pupil_mm > 0 && eye->retina_mm > 0 && isfinite(eye->retina_mm));
}

static void run(const placido_plan *plan, const placido_scene *scene) {
  placido_image seen;
  placido_error err = {0};
  if (!fuzz_check(placido_plan_run(&seen, NULL, plan, &err), &err)) {
    FUZZ_REQUIRE(seen.data == NULL);
    return;
  }
  FUZZ_REQUIRE(seen.planes >= scene->image.planes || scene->image.planes == 4);
  const size_t pixels = (size_t)seen.width_px * (size_t)seen.height_px;
  for (size_t i = 0; i < pixels * (size_t)seen.planes; i++) {
    FUZZ_REQUIRE(isfinite(seen.data[i]));
  }
  placido_image_free(&seen);
}

static void plan_and_run(const placido_surface *surface, struct bytes *bytes) {
  placido_scene scene;
  placido_plan *plan = NULL;
  placido_notes notes = {0};
  placido_error err = {0};
  const placido_eye eye = make_eye(bytes);
  const placido_plan_wish wish = make_wish(bytes);
  if (make_scene(&scene, bytes, &err) == PLACIDO_OK &&
      fuzz_check(placido_plan_new(&plan, surface, &eye, &scene, &wish, &notes, &err), &err)) {
    check(plan);
    if (placido_plan_settings_of(plan)->cost_ms <= RUN_MAX_MS) {
      run(plan, &scene);
    }
  } else {
    FUZZ_REQUIRE(plan == NULL);
  }
  placido_plan_free(plan);
  placido_scene_free(&scene);
  placido_notes_clear(&notes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  struct bytes bytes = {data, size};
  placido_surface *surface;
  placido_error err = {0};
  if (fuzz_check(make_surface(&surface, &bytes, &err), &err)) {
    plan_and_run(surface, &bytes);
  }
  placido_surface_free(surface);
  return 0;
}

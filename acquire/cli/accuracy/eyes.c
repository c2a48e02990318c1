/* The table of eyes, and what has to be known of each before anything is measured. */
#include "acquire/cli/accuracy/eyes.h"

#include "base/memory.h"

#include <placido/phantom.h>

#define INSTRUMENT "cone24"
#define REPEATS 3
#define RADIUS_MM 5.6 /* that of the phantom's own eyes */

/* A small sensor at a short exposure, focused as well as a person does it. */
#define NOISE 2.0
#define BLUR_PX 0.8

/* Looking past the camera, with trefoil, coma and smaller terms as after a scar. */
static const placido_part decentred_irregular[] = {
    {PLACIDO_PART_BICONIC, {.biconic = {7.88, -0.12, 7.56, -0.05, 150, 0.35, -0.2}}},
    {PLACIDO_PART_ZERNIKE,
     {.zernike =
          {{[6] = -1.4, [7] = 2.1, [8] = -1.2, [9] = 0.9, [11] = 0.8, [12] = -0.7, [16] = 0.5},
           4}}},
};

static const struct {
  const char *name;
  const char *built_in; /* NULL: of the parts above */
  placido_disturbance disturbance;
  bool when_quick;
} eyes[] = {
    {"sphere", "sphere", {.noise = NOISE, .blur_px = BLUR_PX, .seed = 1}, false},
    {"normal", "normal", {.noise = NOISE, .blur_px = BLUR_PX, .seed = 2}, true},
    {"with-the-rule", "with-the-rule", {.noise = NOISE, .blur_px = BLUR_PX, .seed = 3}, false},
    {"after-laser", "post-prk", {.noise = NOISE, .blur_px = BLUR_PX, .seed = 4}, false},
    {"decentred-irregular", NULL, {.noise = NOISE, .blur_px = BLUR_PX, .seed = 5}, false},
    {"keratoconus", "keratoconus", {.noise = NOISE, .blur_px = BLUR_PX, .seed = 6}, true},
    {"keratoconus-severe",
     "keratoconus-severe",
     {.noise = NOISE, .blur_px = BLUR_PX, .seed = 7},
     false},
    {"lashes-and-noise",
     "astigmatic",
     {.noise = 3 * NOISE, .blur_px = BLUR_PX, .lashes = 30, .nose = true, .seed = 8},
     false},
};
#define EYES (sizeof eyes / sizeof *eyes)

/* As fine as makes a difference. Knots are as residuals ask for: finer ones only follow the noise,
 * and on a severe keratoconus they find folds that are none. */
static struct accuracy_knobs finest_knobs(bool quick) {
  return (struct accuracy_knobs){.meridians = quick ? 360 : 1440,
                                 .filter_px = 1,
                                 .degree = 5,
                                 .tolerance = 0.001,
                                 .samples = quick ? 200 : 800,
                                 .doubles = 1};
}

int accuracy_eye_mires(placido_mires *mires, const struct accuracy_eye *eye,
                       const struct accuracy_knobs *knobs, placido_error *err) {
  const placido_mires_options options = {
      .meridians = knobs->meridians, .filter_px = knobs->filter_px, .threads = 1};
  return placido_mires_find(mires, &eye->frame, &eye->instrument, &options, NULL, err);
}

int accuracy_eye_fit(placido_fit **fit, placido_mires *mires, const struct accuracy_eye *eye,
                     const struct accuracy_knobs *knobs, placido_error *err) {
  const placido_fit_options options = {.axis_z_mm = eye->axis_z_mm,
                                       .knot_mm = knobs->knot_mm,
                                       .degree = knobs->degree,
                                       .tolerance = knobs->tolerance,
                                       .threads = 1};
  return placido_fit_new(fit, mires, &eye->instrument, &options, NULL, err);
}

static int render(struct accuracy_eye *eye, size_t number, placido_error *err) {
  const char *built_in = eyes[number].built_in;
  placido_jet jet;
  int status = placido_phantom_instrument(&eye->instrument, INSTRUMENT, err);
  if (status == PLACIDO_OK) {
    status = built_in ? placido_phantom_eye(&eye->truth, built_in, err)
                      : placido_surface_new(&eye->truth, 0, RADIUS_MM, decentred_irregular,
                                            sizeof decentred_irregular / sizeof(placido_part),
                                            NULL, err);
  }
  if (status == PLACIDO_OK) {
    placido_surface_at(eye->truth, 0, 0, &jet);
    eye->axis_z_mm = placido_surface_vertex_z_mm(eye->truth) - jet.sag;
    status = placido_phantom_render(&eye->frame, eye->truth, &eye->instrument,
                                    &eyes[number].disturbance, 0, err);
  }
  return status;
}

static int find(struct accuracy_eye *eye, const struct accuracy_bench *bench, placido_error *err) {
  const struct accuracy_knobs *finest = &bench->finest;
  int status = accuracy_eye_mires(&eye->mires, eye, finest, err);
  if (status == PLACIDO_OK) {
    status = accuracy_eye_fit(&eye->fit, &eye->mires, eye, finest, err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_sight_new(&eye->seen, placido_fit_surface(eye->fit), &bench->chart, finest,
                                err);
  }
  return status == PLACIDO_OK
             ? accuracy_sight_new(&eye->true_seen, eye->truth, &bench->chart, finest, err)
             : status;
}

int accuracy_bench_new(struct accuracy_bench *bench, const struct settings *settings, bool quick,
                       void (*progress)(void *user, const char *eye), void *user,
                       placido_error *err) {
  *bench = (struct accuracy_bench){.quick = quick,
                                   .repeats = quick ? 1 : REPEATS,
                                   .settings = settings,
                                   .finest = finest_knobs(quick)};
  bench->eyes = placido_memory_new(EYES, sizeof *bench->eyes, err);
  int status = bench->eyes ? accuracy_chart_new(&bench->chart, quick, err) : PLACIDO_MEMORY;
  for (size_t i = 0; i < EYES && status == PLACIDO_OK; i++) {
    if (quick && !eyes[i].when_quick) {
      continue;
    }
    struct accuracy_eye *eye = &bench->eyes[bench->count++];
    eye->name = eyes[i].name;
    if (progress) {
      progress(user, eye->name);
    }
    placido_error reason = {0};
    status = render(eye, i, &reason);
    if (status == PLACIDO_OK) {
      status = find(eye, bench, &reason);
    }
    if (status != PLACIDO_OK) {
      placido_error_set(err, status, "eye %s, everything at its finest: %s", eye->name,
                        reason.text);
    }
  }
  return status;
}

void accuracy_bench_free(struct accuracy_bench *bench) {
  for (size_t i = 0; i < bench->count; i++) {
    struct accuracy_eye *eye = &bench->eyes[i];
    accuracy_sight_free(&eye->true_seen);
    accuracy_sight_free(&eye->seen);
    placido_fit_free(eye->fit);
    placido_mires_free(&eye->mires);
    placido_frame_free(&eye->frame);
    placido_surface_free(eye->truth);
  }
  accuracy_chart_free(&bench->chart);
  placido_memory_free(bench->eyes);
  *bench = (struct accuracy_bench){0};
}

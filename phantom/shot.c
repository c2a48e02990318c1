/* A picture is made as light makes it: mires by way of the cornea, eye and face, lens, sensor. */
#include "phantom/shot.h"

#include "base/cv/cv.h"
#include "phantom/light.h"
#include "phantom/scene.h"
#include "phantom/sensor.h"

#include <math.h>

#define SIDE_MAX 65536

/* A quantity that the caller asked for, and where it must lie. */
typedef struct range {
  const char *name;
  double value, low, high;
} range;

static int check_ranges(const range *ranges, size_t count, placido_error *err) {
  for (size_t i = 0; i < count; i++) {
    const range *r = &ranges[i];
    if (!(r->value >= r->low && r->value <= r->high)) {
      return placido_error_set(err, PLACIDO_INPUT, "phantom: %s is %g, expected %g to %g", r->name,
                               r->value, r->low, r->high);
    }
  }
  return PLACIDO_OK;
}

static int check_instrument(const placido_instrument *instrument, placido_error *err) {
  const double far = 1e6;
  const range ranges[] = {
      {"image width", instrument->width_px, 1, SIDE_MAX},
      {"image height", instrument->height_px, 1, SIDE_MAX},
      {"number of edges", instrument->edge_count, 1, PLACIDO_EDGES_MAX},
      {"focal length along u", instrument->focal_px[0], 1e-6, 1e9},
      {"focal length along v", instrument->focal_px[1], 1e-6, 1e9},
      {"principal point u", instrument->principal_px[0], -far, far},
      {"principal point v", instrument->principal_px[1], -far, far},
      {"camera position x", instrument->position_mm[0], -far, far},
      {"camera position y", instrument->position_mm[1], -far, far},
      {"camera position z", instrument->position_mm[2], -far, far},
  };
  int status = check_ranges(ranges, sizeof ranges / sizeof *ranges, err);
  for (int i = 0; i < 5 && status == PLACIDO_OK; i++) {
    const range term = {"a distortion term", instrument->distortion[i], -1e9, 1e9};
    status = check_ranges(&term, 1, err);
  }
  for (int k = 0; k < instrument->edge_count && status == PLACIDO_OK; k++) {
    const range edge[] = {
        {"an edge's radius", instrument->edges[k].radius_mm, 1e-6, far},
        {"an edge's z", instrument->edges[k].z_mm, -far, far},
    };
    status = check_ranges(edge, 2, err);
  }
  return status;
}

static int check_disturbance(const placido_disturbance *asked, placido_error *err) {
  const range ranges[] = {
      {"subsamples", asked->subsamples, 0, 64},
      {"blur_px", asked->blur_px, 0, 100},
      {"motion_px", asked->motion_px, 0, 200},
      {"motion_deg", asked->motion_deg, -360, 360},
      {"noise", asked->noise, 0, 255},
      {"lashes", asked->lashes, 0, 1000},
      {"break_up", asked->break_up, 0, 0.5},
      {"shift_mm[0]", asked->shift_mm[0], -20, 20},
      {"shift_mm[1]", asked->shift_mm[1], -20, 20},
      {"shift_mm[2]", asked->shift_mm[2], -20, 20},
      {"bits", asked->bits == 0 ? 8 : asked->bits, 8, 16},
  };
  return check_ranges(ranges, sizeof ranges / sizeof *ranges, err);
}

int placido_phantom_shot_prepare(placido_phantom_shot *shot, const placido_surface *surface,
                                 const placido_instrument *instrument,
                                 const placido_disturbance *disturbance, int threads,
                                 placido_error *err) {
  *shot = (placido_phantom_shot){.lid_mm = INFINITY, .threads = threads};
  if (!surface || !instrument) {
    return placido_error_set(err, PLACIDO_INPUT, "phantom: no %s given",
                             surface ? "instrument" : "surface");
  }
  if (disturbance) {
    shot->disturbance = *disturbance;
  }
  int status = check_instrument(instrument, err);
  if (status == PLACIDO_OK) {
    status = check_disturbance(&shot->disturbance, err);
  }
  placido_disturbance *asked = &shot->disturbance;
  asked->subsamples = asked->subsamples ? asked->subsamples : 4;
  asked->bits = asked->bits ? asked->bits : 8;
  shot->lid_mm = asked->lid ? PLACIDO_PHANTOM_LID_MM : INFINITY;
  shot->surface = surface;
  shot->instrument = instrument;
  return status;
}

/* The mires' light, one plane; `film` is room for a broken tear film. */
static int light_mires(placido_image *picture, const placido_phantom_shot *shot,
                       placido_phantom_film *film, placido_error *err) {
  const placido_disturbance *asked = &shot->disturbance;
  if (asked->break_up > 0) {
    double radius_mm = fmin(placido_surface_radius_mm(shot->surface), 5);
    placido_phantom_film_break(film, asked->break_up, radius_mm, asked->seed);
  }
  placido_phantom_rig rig = placido_phantom_rig_of(shot->surface, shot->instrument, asked->shift_mm,
                                                   asked->break_up > 0 ? film : NULL);
  return placido_phantom_light(picture, &rig, asked->subsamples, shot->threads, err);
}

static placido_phantom_scene scene_of(const placido_phantom_shot *shot) {
  const placido_disturbance *asked = &shot->disturbance;
  return (placido_phantom_scene){
      .instrument = shot->instrument,
      .vertex_mm = {asked->shift_mm[0], asked->shift_mm[1],
                    asked->shift_mm[2] + placido_surface_vertex_z_mm(shot->surface)},
      .nose = asked->nose,
      .lid_mm = shot->lid_mm,
      .lashes = asked->lashes,
      .seed = asked->seed,
  };
}

static int blur(placido_image *picture, const placido_phantom_shot *shot, placido_error *err) {
  const placido_disturbance *asked = &shot->disturbance;
  int status = PLACIDO_OK;
  if (asked->blur_px > 0) {
    status = placido_cv_blur(picture, asked->blur_px, asked->blur_px, err);
  }
  if (status == PLACIDO_OK && asked->motion_px > 0) {
    status = placido_phantom_sensor_move(picture, asked->motion_px, asked->motion_deg,
                                         shot->threads, err);
  }
  return status;
}

int placido_phantom_shot_take(placido_frame *frame, const placido_phantom_shot *shot,
                              placido_error *err) {
  const placido_disturbance *asked = &shot->disturbance;
  placido_phantom_film film;
  placido_image picture = {0};
  int status =
      placido_image_new(&picture, shot->instrument->width_px, shot->instrument->height_px, 1, err);
  if (status == PLACIDO_OK) {
    status = light_mires(&picture, shot, &film, err);
  }
  if (status == PLACIDO_OK) {
    placido_phantom_scene scene = scene_of(shot);
    status = placido_phantom_scene_paint(&picture, &scene, shot->threads, err);
  }
  if (status == PLACIDO_OK) {
    status = blur(&picture, shot, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_phantom_sensor_expose(frame, &picture, asked->noise, asked->bits, asked->seed,
                                           shot->number, shot->threads, err);
  }
  placido_image_free(&picture);
  return status;
}

int placido_phantom_render(placido_frame *frame, const placido_surface *surface,
                           const placido_instrument *instrument,
                           const placido_disturbance *disturbance, int threads,
                           placido_error *err) {
  placido_phantom_shot shot;
  int status = placido_phantom_shot_prepare(&shot, surface, instrument, disturbance, threads, err);
  return status == PLACIDO_OK ? placido_phantom_shot_take(frame, &shot, err) : status;
}

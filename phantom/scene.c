/* The eye around the mires: a pupil, a textured iris, the white, and what hangs before them. The
 * mires' reflection adds to what is behind the cornea; lid and lashes cover both. */
#include "phantom/scene.h"

#include "base/memory.h"
#include "phantom/camera.h"
#include "phantom/light.h"

#include <math.h>

/* Grey levels of 8 bits, and sizes of an average eye. */
static const double mire_grey = 176, pupil_grey = 14, iris_grey = 43, white_grey = 83;
static const double skin_grey = 126;
static const double pupil_mm = 1.8, limbus_mm = 5.85;

/* From 0 at `low` to 1 at `high`, with no slope at either end. */
static double ramp(double low, double high, double value) {
  double t = (value - low) / (high - low);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}

/* Fibres of the iris: weak and broad, for real irides hardly show beside the mires. */
static double iris_texture(double r_mm, double angle) {
  double bend = 1.1 * sin(4.1 * r_mm) + 0.4 * sin(9.7 * r_mm + 2);
  return 3.5 * sin(23 * angle + 3 * bend) + 1.8 * sin(41 * angle - 2 * bend + 1) +
         1.5 * sin(2.3 * r_mm + 3 * cos(angle));
}

/* The eye's own brightness, (x, y) from the vertex. */
static double eye_grey(double x_mm, double y_mm) {
  double r_mm = hypot(x_mm, y_mm);
  double inner = ramp(pupil_mm - 0.08, pupil_mm + 0.12, r_mm);
  double outer = ramp(limbus_mm - 0.12, limbus_mm + 0.18, r_mm);
  double iris = iris_grey;
  if (inner > 0 && outer < 1) {
    iris += iris_texture(r_mm, atan2(y_mm, x_mm));
  }
  return (1 - outer) * (pupil_grey + inner * (iris - pupil_grey)) + outer * white_grey;
}

/* How much of the mires' light passes the nose: none in a sector at the lower left. */
static double past_nose(double x_mm, double y_mm) {
  const double degree = 57.29577951308232, border_mm = 0.05;
  double r_mm = hypot(x_mm, y_mm);
  double from_middle_deg = fabs(atan2(-y_mm, -x_mm) * degree - 20);
  double into_sector_mm = r_mm * (24 - from_middle_deg) / degree;
  double depth_mm = fmin(into_sector_mm, r_mm - 2.8);
  return 1 - ramp(-border_mm, border_mm, depth_mm);
}

/* Share of the lid's skin at a place: its margin is an arc that sinks towards the corners. */
static double lid_cover(double x_mm, double y_mm, double lid_mm) {
  return ramp(-0.02, 0.02, y_mm - (lid_mm - 0.05 * x_mm * x_mm));
}

static double lid_grey(double x_mm, double y_mm) {
  return skin_grey + 7 * sin(4.3 * x_mm + 0.6 * y_mm) + 4 * sin(3.1 * y_mm + 0.5 * x_mm * x_mm);
}

/* Where a camera ray meets the plane of the vertex, from the vertex. */
static void on_eye(const placido_phantom_scene *scene, const double normalised[2],
                   double place[2]) {
  placido_phantom_ray ray = placido_phantom_camera_ray(scene->instrument, normalised);
  double distance = ray.from[2] - scene->vertex_mm[2];
  for (int i = 0; i < 2; i++) {
    place[i] = ray.from[i] + distance * ray.along[i] - scene->vertex_mm[i];
  }
}

/* Nose and lid belong to the face: they stay where they are when the eye moves. */
static double grey_at(const placido_phantom_scene *scene, const double normalised[2], double lit) {
  double eye[2];
  on_eye(scene, normalised, eye);
  double x_mm = eye[0] + scene->vertex_mm[0], y_mm = eye[1] + scene->vertex_mm[1];
  if (scene->nose) {
    lit *= past_nose(x_mm, y_mm);
  }
  double grey = eye_grey(eye[0], eye[1]) + mire_grey * lit;
  double lid = lid_cover(x_mm, y_mm, scene->lid_mm);
  return lid > 0 ? grey + lid * (lid_grey(x_mm, y_mm) - grey) : grey;
}

static int paint_row(placido_image *picture, const placido_phantom_scene *scene, int y) {
  size_t width = (size_t)picture->width_px;
  double *points = placido_memory_new(2 * width, sizeof *points, NULL);
  if (!points) {
    return PLACIDO_MEMORY;
  }
  for (size_t x = 0; x < width; x++) {
    points[2 * x] = (double)x;
    points[2 * x + 1] = y;
  }
  int status = placido_phantom_camera_normalise(points, points, width, scene->instrument, NULL);
  float *row = placido_image_plane(picture, 0) + (size_t)y * width;
  for (size_t x = 0; x < width && status == PLACIDO_OK; x++) {
    row[x] = (float)grey_at(scene, points + 2 * x, (double)row[x]);
  }
  placido_memory_free(points);
  return status;
}

int placido_phantom_scene_paint(placido_image *picture, const placido_phantom_scene *scene,
                                int threads, placido_error *err) {
  int status = PLACIDO_OK;
  threads = placido_phantom_threads(threads);
#pragma omp parallel for schedule(static) num_threads(threads) reduction(min : status)
  for (int y = 0; y < picture->height_px; y++) {
    int row_status = paint_row(picture, scene, y);
    status = row_status < status ? row_status : status;
  }
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "painting of the eye stopped: %s",
                             status == PLACIDO_MEMORY ? "out of memory"
                                                      : "lens undistortion failed");
  }
  placido_phantom_lashes_draw(picture, scene->lashes, scene->seed);
  return PLACIDO_OK;
}

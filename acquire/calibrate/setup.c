/* The unknowns' starts and prior standard deviations. */
#include "acquire/calibrate/setup.h"

#include "base/memory.h"
#include "reconstruct/camera.h"

/* Nobody measures where a ball stands across the axis: the picture says it. */
#define ACROSS_SIGMA_MM 5.0

int placido_calibrate_problem_new(placido_calibrate_problem *problem,
                                  const placido_instrument *start,
                                  const placido_uncertainty *prior, int ball_count,
                                  int view_count, placido_error *err) {
  int parameters = PLACIDO_UNCERTAINTY_CAMERA + 2 * start->edge_count;
  *problem = (placido_calibrate_problem){.start = *start,
                                         .parameters = parameters,
                                         .shared = parameters + ball_count,
                                         .ball_count = ball_count,
                                         .view_count = view_count};
  problem->start_value = placido_memory_new((size_t)problem->shared, sizeof(double), err);
  problem->sigma = placido_memory_new((size_t)problem->shared, sizeof(double), err);
  problem->views = placido_memory_new((size_t)view_count, sizeof *problem->views, err);
  if (!problem->start_value || !problem->sigma || !problem->views) {
    placido_calibrate_problem_free(problem);
    return PLACIDO_MEMORY;
  }
  for (int i = 0; i < parameters; i++) {
    problem->start_value[i] = *placido_instrument_parameter(&problem->start, i);
    problem->sigma[i] = prior && prior->sigma ? prior->sigma[i] : 0;
  }
  return PLACIDO_OK;
}

void placido_calibrate_problem_free(placido_calibrate_problem *problem) {
  placido_memory_free(problem->start_value);
  placido_memory_free(problem->sigma);
  placido_memory_free(problem->views);
  *problem = (placido_calibrate_problem){0};
}

void placido_calibrate_ball_set(placido_calibrate_problem *problem, int ball, double radius_mm,
                                double sigma_mm) {
  problem->start_value[problem->parameters + ball] = radius_mm;
  problem->sigma[problem->parameters + ball] = sigma_mm;
}

void placido_calibrate_view_set(placido_calibrate_problem *problem, int view,
                                const placido_mires *mires, int ball, double z_mm,
                                double z_sigma_mm) {
  placido_ray ray =
      placido_camera_ray(&problem->start, mires->centre_u_px, mires->centre_v_px);
  double t = (z_mm - ray.origin[2]) / ray.direction[2];
  problem->views[view] = (placido_calibrate_view){
      .mires = mires,
      .ball = ball,
      .start_mm = {ray.origin[0] + t * ray.direction[0], ray.origin[1] + t * ray.direction[1],
                   z_mm},
      .sigma_mm = {ACROSS_SIGMA_MM, ACROSS_SIGMA_MM, z_sigma_mm}};
}

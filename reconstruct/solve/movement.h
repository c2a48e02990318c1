/* How far the eye moved between two frames, from the mires alone. */
#ifndef PLACIDO_SOLVE_MOVEMENT_H
#define PLACIDO_SOLVE_MOVEMENT_H

#include "reconstruct/solve/engine/shape.h"

/* Where an eye is, as a rigid body: first turned about the pivot, then shifted. */
typedef struct placido_pose {
  double pivot_mm[3];
  double turn_rad[3]; /* axis of rotation times angle */
  double shift_mm[3];
} placido_pose;

/* A point of the eye, carried along. */
void placido_pose_carry(const placido_pose *pose, const double point_mm[3], double carried_mm[3]);

/* As placido_sample_trace, with the shape at that pose; the hit is in the instrument's frame. Its
 * second derivatives are those of the eye's own frame. */
void placido_sample_trace_moved(placido_sample *sample, const placido_shape *shape,
                                const placido_pose *pose);

/* Finds the pose from which the shape mirrors the samples best, starting from the one given, in at
 * most steps_max steps of robust Gauss-Newton. Turns that the mires do not tell stay 0. Leaves the
 * samples traced at it; `work` holds `count` numbers. Returns false, and leaves them anyhow, where
 * fewer than half of the samples meet the shape. */
bool placido_pose_find(placido_pose *pose, placido_sample *samples, size_t count,
                       const placido_shape *shape, int steps_max, int threads, double *work);

#endif

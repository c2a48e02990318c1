/* Robust Gauss-Newton over the six freedoms of a rigid eye. Under a fixed camera ray a movement of
 * velocity v changes the surface z(x, y) by v_z - p v_x - q v_y, and its slopes by that quantity's
 * derivatives along the surface. */
#include "reconstruct/solve/movement.h"

#include "base/dense.h"
#include "reconstruct/median.h"

#include <math.h>

#define FREEDOMS 6 /* shift, then turn */
#define CLOSE_MM 1e-7
#define SPREAD_LEAST_PX 0.005
#define OUTLIER 3.0 /* spreads at which a sample counts half */
/* Beforehand an eye is taken to turn by a degree or so while it is looked at. A sphere's turns
 * about its centre show in no mire: this keeps them at 0. */
#define TURN_SIGMA_RAD 0.0175
#define SHARE_LEAST 0.5
#define SAMPLES_ENOUGH 4000 /* six freedoms need no more */

/* The rotation by the vector `turn` (Rodrigues), or back. */
static void turn_vector(const double turn[3], bool back, const double in[3], double out[3]) {
  double angle = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
  double s = angle > 1e-9 ? sin(angle) / angle : 1;
  double c = angle > 1e-9 ? (1 - cos(angle)) / (angle * angle) : 0.5;
  double once[3] = {turn[1] * in[2] - turn[2] * in[1], turn[2] * in[0] - turn[0] * in[2],
                    turn[0] * in[1] - turn[1] * in[0]};
  double twice[3] = {turn[1] * once[2] - turn[2] * once[1], turn[2] * once[0] - turn[0] * once[2],
                     turn[0] * once[1] - turn[1] * once[0]};
  for (int i = 0; i < 3; i++) {
    out[i] = in[i] + (back ? -s : s) * once[i] + c * twice[i];
  }
}

void placido_pose_carry(const placido_pose *pose, const double point_mm[3], double carried_mm[3]) {
  double from_pivot[3];
  for (int i = 0; i < 3; i++) {
    from_pivot[i] = point_mm[i] - pose->pivot_mm[i];
  }
  turn_vector(pose->turn_rad, false, from_pivot, carried_mm);
  for (int i = 0; i < 3; i++) {
    carried_mm[i] += pose->pivot_mm[i] + pose->shift_mm[i];
  }
}

/* The ray as the eye sees it: carried back by the pose. */
static placido_ray ray_of_eye(const placido_ray *ray, const placido_pose *pose) {
  placido_ray own = *ray;
  double from_pivot[3];
  for (int i = 0; i < 3; i++) {
    from_pivot[i] = ray->origin[i] - pose->pivot_mm[i] - pose->shift_mm[i];
  }
  turn_vector(pose->turn_rad, true, from_pivot, own.origin);
  turn_vector(pose->turn_rad, true, ray->direction, own.direction);
  for (int i = 0; i < 3; i++) {
    own.origin[i] += pose->pivot_mm[i];
  }
  return own;
}

void placido_sample_trace_moved(placido_sample *sample, const placido_shape *shape,
                                const placido_pose *pose) {
  placido_sample own = *sample;
  own.ray = ray_of_eye(&sample->ray, pose);
  placido_sample_trace(&own, shape);
  sample->t = own.t;
  sample->residual_px = own.residual_px;
  if (isnan(own.residual_px)) {
    return;
  }
  double point[3] = {own.hit.x, own.hit.y, own.hit.z}, normal[3] = {-own.hit.p, -own.hit.q, 1};
  double carried[3], turned[3];
  placido_pose_carry(pose, point, carried);
  turn_vector(pose->turn_rad, false, normal, turned);
  sample->hit = own.hit;
  sample->hit.x = carried[0];
  sample->hit.y = carried[1];
  sample->hit.z = carried[2];
  sample->hit.p = -turned[0] / turned[2];
  sample->hit.q = -turned[1] / turned[2];
  sample->miss = placido_mirror_miss(&sample->ray, &sample->hit, sample->edge);
  sample->slope = hypot(sample->miss.by_u, sample->miss.by_v);
  sample->residual_px = sample->slope > 0 ? sample->miss.f / sample->slope : NAN;
}

/* The residual's derivatives by shift and turn. */
static void row_of(double row[FREEDOMS], const placido_sample *s, const placido_pose *pose) {
  const placido_hit *h = &s->hit;
  const placido_miss *m = &s->miss;
  double at[3] = {h->x, h->y, h->z};
  for (int i = 0; i < FREEDOMS; i++) {
    double v[3] = {i == 0, i == 1, i == 2}, w[3] = {i == 3, i == 4, i == 5};
    if (i >= 3) {
      double arm[3];
      for (int j = 0; j < 3; j++) {
        arm[j] = at[j] - pose->pivot_mm[j] - pose->shift_mm[j];
      }
      v[0] = w[1] * arm[2] - w[2] * arm[1];
      v[1] = w[2] * arm[0] - w[0] * arm[2];
      v[2] = w[0] * arm[1] - w[1] * arm[0];
    }
    double dz = v[2] - h->p * v[0] - h->q * v[1];
    double dp =
        -w[1] - h->p * w[1] * h->p - h->q * (w[2] - w[0] * h->p) - h->xx * v[0] - h->xy * v[1];
    double dq =
        w[0] - h->p * (w[1] * h->q - w[2]) + h->q * w[0] * h->q - h->xy * v[0] - h->yy * v[1];
    row[i] = (m->by_z * dz + m->by_p * dp + m->by_q * dq) / s->slope;
  }
}

/* The step of the pose that lessens the traced samples' residuals most. */
static void find_step(double step[FREEDOMS], const placido_pose *pose,
                      const placido_sample *samples, size_t count, size_t stride,
                      double spread_px) {
  double a[FREEDOMS][FREEDOMS] = {{0}};
  const double prior = 1 / (TURN_SIGMA_RAD * TURN_SIGMA_RAD);
  for (int i = 0; i < FREEDOMS; i++) {
    a[i][i] = i < 3 ? 1e-9 : prior;
    step[i] = i < 3 ? 0 : -prior * pose->turn_rad[i - 3];
  }
  for (size_t s = 0; s < count; s += stride) {
    double r = samples[s].residual_px / spread_px, row[FREEDOMS];
    if (isnan(r)) {
      continue;
    }
    double weight = 1 / (1 + r * r / (OUTLIER * OUTLIER));
    row_of(row, &samples[s], pose);
    for (int i = 0; i < FREEDOMS; i++) {
      double pull = weight * row[i] / spread_px;
      step[i] -= pull * r;
      for (int j = 0; j <= i; j++) {
        a[i][j] += pull * row[j] / spread_px;
      }
    }
  }
  placido_dense_factor(&a[0][0], FREEDOMS, FREEDOMS, 0);
  placido_dense_solve(&a[0][0], FREEDOMS, FREEDOMS, step);
}

/* Traces every stride-th sample; returns the robust spread of the residuals, NaN where none met the
 * shape, and in `share` how many did. */
static double trace_all(placido_sample *samples, size_t count, size_t stride,
                        const placido_shape *shape, const placido_pose *pose, int threads,
                        double *work, double *share) {
#pragma omp parallel for num_threads(threads)
  for (size_t i = 0; i < count; i += stride) {
    placido_sample_trace_moved(&samples[i], shape, pose);
  }
  size_t asked = 0, met = 0;
  for (size_t i = 0; i < count; i += stride) {
    asked++;
    if (!isnan(samples[i].residual_px)) {
      work[met++] = fabs(samples[i].residual_px);
    }
  }
  *share = asked ? (double)met / (double)asked : 0;
  return 1.4826 * placido_quantile(work, met, 0.5);
}

bool placido_pose_find(placido_pose *pose, placido_sample *samples, size_t count,
                       const placido_shape *shape, int steps_max, int threads, double *work) {
  const size_t stride = count / SAMPLES_ENOUGH + 1;
  double largest = INFINITY, share;
  for (int n = 0; n < steps_max && largest > CLOSE_MM; n++) {
    double step[FREEDOMS];
    double spread_px = trace_all(samples, count, stride, shape, pose, threads, work, &share);
    if (share < SHARE_LEAST) {
      break;
    }
    find_step(step, pose, samples, count, stride, fmax(spread_px, SPREAD_LEAST_PX));
    largest = 0;
    for (int i = 0; i < 3; i++) {
      pose->shift_mm[i] += step[i];
      pose->turn_rad[i] += step[i + 3];
      largest = fmax(largest, fmax(fabs(step[i]), fabs(step[i + 3])));
    }
  }
  trace_all(samples, count, 1, shape, pose, threads, work, &share);
  return share >= SHARE_LEAST;
}

/* Skew rays. */
#include "skew.h"

#include <math.h>

const double skew_paper_index[4] = {1.376, 1.3374, 1.42, 1.336};

static const double entrance_mm = 3.05;

skew_eye skew_cornea(double radius_mm, double q, double index, double retina_mm) {
  return (skew_eye){1, {{0, radius_mm, q, index}}, retina_mm, 0};
}

skew_eye skew_navarro(double radius_mm, double q, double accommodation_D, const double index[4],
                      double retina_mm) {
  double a = log(accommodation_D + 1), chamber = 3.05 - 0.05 * a, thick = 4 + 0.1 * a;
  return (skew_eye){4,
                    {{0, radius_mm, q, index[0]},
                     {0.55, 6.5, 0, index[1]},
                     {0.55 + chamber, 10.2 - 1.75 * a, -3.1316 - 0.34 * a, index[2]},
                     {0.55 + chamber + thick, -6 + 0.2294 * a, -1 - 0.125 * a, index[3]}},
                    retina_mm,
                    0};
}

static double off(const skew_surface *s, const double p[3]) {
  double z = p[2] - s->vertex_mm;
  return p[0] * p[0] + p[1] * p[1] + (1 + s->q) * z * z - 2 * s->radius_mm * z;
}

/* On to the surface, from the plane of its vertex. */
static bool meet(const skew_surface *s, double p[3], const double t[3], double *way) {
  double start = (s->vertex_mm - p[2]) / t[2], at[3];
  *way = start;
  for (int step = 0; step < 60; step++) {
    for (int k = 0; k < 3; k++) {
      at[k] = p[k] + *way * t[k];
    }
    double z = at[2] - s->vertex_mm;
    double slope = 2 * (at[0] * t[0] + at[1] * t[1] + (1 + s->q) * z * t[2] - s->radius_mm * t[2]);
    *way -= off(s, at) / slope;
  }
  for (int k = 0; k < 3; k++) {
    p[k] += *way * t[k];
  }
  return fabs(off(s, p)) < 1e-9;
}

/* Snell: what is along the surface is kept times the index. */
static bool bend(const skew_surface *s, const double p[3], double t[3], double before) {
  double normal[3] = {p[0], p[1], (1 + s->q) * (p[2] - s->vertex_mm) - s->radius_mm};
  double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  double along = 0, kept[3], square = 0;
  for (int k = 0; k < 3; k++) {
    along += t[k] * normal[k] / length;
  }
  for (int k = 0; k < 3; k++) {
    kept[k] = before / s->index * (t[k] - along * normal[k] / length);
    square += kept[k] * kept[k];
  }
  for (int k = 0; k < 3; k++) {
    t[k] = kept[k] + copysign(sqrt(1 - square), along) * normal[k] / length;
  }
  return square < 1;
}

static bool reach_retina(const skew_eye *eye, double p[3], const double t[3], double *way) {
  *way = (eye->retina_mm - p[2]) / t[2];
  double middle = eye->retina_mm - eye->retina_radius_mm, radius = eye->retina_radius_mm;
  for (int step = 0; step < 60 && radius > 0; step++) {
    double at[3] = {p[0] + *way * t[0], p[1] + *way * t[1], p[2] + *way * t[2] - middle};
    double too_far = at[0] * at[0] + at[1] * at[1] + at[2] * at[2] - radius * radius;
    *way -= too_far / (2 * (at[0] * t[0] + at[1] * t[1] + at[2] * t[2]));
  }
  for (int k = 0; k < 3; k++) {
    p[k] += *way * t[k];
  }
  return isfinite(p[0] + p[1] + p[2]);
}

bool skew_land(const skew_eye *eye, const double tangent[2], const double entry_mm[2],
               double landing[3], double direction[3], double *path_mm) {
  double length = sqrt(1 + tangent[0] * tangent[0] + tangent[1] * tangent[1]), way;
  double t[3] = {-tangent[0] / length, -tangent[1] / length, 1 / length};
  double p[3] = {entry_mm[0], entry_mm[1], entrance_mm}, before = 1;
  bool arrives = true;
  *path_mm = t[0] * p[0] + t[1] * p[1] + t[2] * p[2];
  for (int i = 0; i < eye->count; i++) {
    const skew_surface *s = &eye->surfaces[i];
    arrives = arrives && meet(s, p, t, &way);
    *path_mm += before * way;
    arrives = arrives && bend(s, p, t, before);
    before = s->index;
  }
  arrives = arrives && reach_retina(eye, p, t, &way);
  *path_mm += before * way;
  for (int k = 0; k < 3; k++) {
    landing[k] = p[k];
    direction[k] = t[k];
  }
  return arrives;
}

void skew_follow(const skew_eye *eye, const double tangent[2], double j[2][2]) {
  const double step = 1e-4, middle[2] = {0, 0};
  for (int k = 0; k < 2; k++) {
    double more[2] = {tangent[0], tangent[1]}, less[2] = {tangent[0], tangent[1]}, a[3], b[3];
    double direction[3], path;
    more[k] += step;
    less[k] -= step;
    skew_land(eye, more, middle, a, direction, &path);
    skew_land(eye, less, middle, b, direction, &path);
    j[0][k] = (b[0] - a[0]) / (2 * step);
    j[1][k] = (b[1] - a[1]) / (2 * step);
  }
}

double skew_power_D(const skew_eye *eye, double *focus_mm) {
  const double axis[2] = {0, 0}, entry_mm[2] = {1e-4, 0};
  double landing[3], t[3], path;
  skew_eye flat = *eye;
  flat.retina_radius_mm = 0;
  skew_land(&flat, axis, entry_mm, landing, t, &path);
  *focus_mm = landing[2] - landing[0] * t[2] / t[0];
  return -1000 * eye->surfaces[eye->count - 1].index * t[0] / t[2] / entry_mm[0];
}

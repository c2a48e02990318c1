/* Exact edge positions without an image: along a meridian, the place where the traced ray changes
 * from the band within a circle to the band beyond it, by bisection. */
#include "phantom/trace.h"

#include <math.h>
#include <placido/phantom.h>

/* A meridian of the image. */
typedef struct meridian {
  const placido_phantom_rig *rig;
  double centre_px[2], along[2];
} meridian;

static void point_at(const meridian *m, double distance_px, double point_px[2]) {
  for (int i = 0; i < 2; i++) {
    point_px[i] = m->centre_px[i] + distance_px * m->along[i];
  }
}

/* Traces the ray seen at a distance from the centre. False outside the image. */
static bool look(const meridian *m, double distance_px, placido_phantom_hit *hit) {
  const placido_instrument *instrument = m->rig->instrument;
  double point[2], normalised[2];
  point_at(m, distance_px, point);
  if (!(point[0] >= -0.5 && point[0] <= instrument->width_px - 0.5 && point[1] >= -0.5 &&
        point[1] <= instrument->height_px - 0.5)) {
    return false;
  }
  if (placido_phantom_camera_normalise(normalised, point, 1, instrument, NULL) != PLACIDO_OK) {
    return false;
  }
  placido_phantom_trace(m->rig, normalised, hit);
  return true;
}

static bool is_within(const placido_phantom_hit *hit, int edge) {
  return hit->on_cornea && hit->band < edge;
}

/* Halves the pixel before `high`, whose ends lie on the two sides. The edge is seen where in the
 * end the bands on both sides are its own; the cornea's rim and folds of the reflection are not
 * edges. */
static bool bisect(const meridian *m, int edge, double high, placido_phantom_hit inner,
                   placido_phantom_hit outer, double *distance_px) {
  double low = high - 1;
  while (high - low > 1e-11 * (1 + high)) {
    double middle = 0.5 * (low + high);
    placido_phantom_hit hit = inner;
    if (middle <= low || middle >= high || !look(m, middle, &hit)) {
      break;
    }
    if (is_within(&hit, edge)) {
      low = middle;
      inner = hit;
    } else {
      high = middle;
      outer = hit;
    }
  }
  *distance_px = 0.5 * (low + high);
  return outer.on_cornea && outer.band == edge && inner.band == edge - 1;
}

/* Bisects for every edge from `first` to `last` that has not been seen nearer to the centre.
 * Returns how many were seen now. */
static int see_between(const meridian *m, int first, int last, double high,
                       const placido_phantom_hit *inner, const placido_phantom_hit *outer,
                       double (*positions_px)[2]) {
  int seen = 0;
  for (int k = first; k <= last; k++) {
    double distance_px;
    if (isnan(positions_px[k][0]) && bisect(m, k, high, *inner, *outer, &distance_px)) {
      point_at(m, distance_px, positions_px[k]);
      seen++;
    }
  }
  return seen;
}

/* Walks outwards a pixel at a time, first into an edge's circle where the centre lies beyond it,
 * until the edges from `first` to `last` have been seen. */
static void find(const meridian *m, int first, int last, double (*positions_px)[2]) {
  placido_phantom_hit hit = {0}, inner = {0};
  int left = last - first + 1;
  for (double distance = 0; left > 0 && look(m, distance, &hit); distance += 1) {
    if (inner.on_cornea && !is_within(&hit, inner.band + 1)) {
      int from = inner.band + 1, to = hit.on_cornea ? hit.band : last;
      left -= see_between(m, from > first ? from : first, to < last ? to : last, distance, &inner,
                          &hit, positions_px);
    }
    inner = hit;
  }
}

static void see_edges(const placido_surface *surface, const placido_instrument *instrument,
                      int first, int last, const double centre_px[2], double meridian_deg,
                      double (*positions_px)[2]) {
  const double still[3] = {0, 0, 0}, radian = meridian_deg / 57.29577951308232;
  placido_phantom_rig rig = placido_phantom_rig_of(surface, instrument, still, NULL);
  meridian m = {
      .rig = &rig,
      .centre_px = {centre_px[0], centre_px[1]},
      .along = {cos(radian), -sin(radian)},
  };
  for (int k = first; k <= last; k++) {
    positions_px[k][0] = positions_px[k][1] = NAN;
  }
  if (isfinite(meridian_deg)) {
    find(&m, first, last, positions_px);
  }
}

bool placido_phantom_edge_at(const placido_surface *surface, const placido_instrument *instrument,
                             int edge, const double centre_px[2], double meridian_deg,
                             double position_px[2]) {
  double positions_px[PLACIDO_EDGES_MAX][2];
  position_px[0] = position_px[1] = NAN;
  if (edge < 0 || edge >= instrument->edge_count) {
    return false;
  }
  see_edges(surface, instrument, edge, edge, centre_px, meridian_deg, positions_px);
  position_px[0] = positions_px[edge][0];
  position_px[1] = positions_px[edge][1];
  return !isnan(position_px[0]);
}

void placido_phantom_edges_at(const placido_surface *surface, const placido_instrument *instrument,
                              const double centre_px[2], double meridian_deg,
                              double (*positions_px)[2]) {
  see_edges(surface, instrument, 0, instrument->edge_count - 1, centre_px, meridian_deg,
            positions_px);
}

/* Where on a cornea the camera sees the mires: along every semi-meridian the point at which its
 * ray, mirrored, meets the edge's circle. The edges are taken from the surface, not from single
 * edge points: so their error is the surface's, and its variants tell it. */
#include "reconstruct/indices/mirrored.h"

#include <math.h>

#define PI 3.14159265358979323846
#define SEEN_MIN 0.9 /* of an edge's meridians */
#define USED_MIN 0.7 /* of its points: the fit drops whole arcs where it doubts */
#define GAP_MAX_DEG 15.0
#define SEARCH_MM 0.02    /* step of the first search outwards */
#define NEIGHBOUR_MM 0.01 /* second point of the secant */
#define SECANT_MM 1e-6    /* least distance of the secant's points */
#define CLOSE_MM 1e-10
#define STEPS_MAX 20

/* A camera that looks at a surface, and the direction in which a mire is sought. */
struct sight {
  const placido_instrument *instrument;
  const placido_surface *surface;
  placido_vertex vertex;
  double cosine, sine;
};

static struct sight sight_along(const placido_instrument *instrument,
                                const placido_surface *surface, placido_vertex vertex, int point) {
  double angle = 2 * PI * point / PLACIDO_MIRE_RING_POINTS;
  return (struct sight){instrument, surface, vertex, cos(angle), sin(angle)};
}

/* By how much the mirrored ray of the point at distance r passes outside the edge, times its rise
 * (so that it is regular where the ray runs level). NaN off the surface. */
static double miss(const struct sight *sight, int edge, double r_mm) {
  const placido_instrument *instrument = sight->instrument;
  const double *eye = instrument->position_mm;
  double x = sight->vertex.x_mm + r_mm * sight->cosine;
  double y = sight->vertex.y_mm + r_mm * sight->sine;
  placido_jet jet;
  placido_surface_at(sight->surface, x, y, &jet);
  double z = placido_surface_vertex_z_mm(sight->surface) - jet.sag;
  double depth = eye[2] - z; /* the ray comes along (dx, dy, -1) */
  bool pinhole = instrument->model == PLACIDO_PINHOLE;
  double dx = pinhole ? (x - eye[0]) / depth : 0, dy = pinhole ? (y - eye[1]) / depth : 0;
  /* mirrored at the normal (sx, sy, 1) */
  double turn = 2 * (dx * jet.sx + dy * jet.sy - 1) / (1 + jet.sx * jet.sx + jet.sy * jet.sy);
  double rx = dx - turn * jet.sx, ry = dy - turn * jet.sy, rz = -1 - turn;
  double rise = instrument->edges[edge].z_mm - z;
  double px = x * rz + rise * rx, py = y * rz + rise * ry;
  return sqrt(px * px + py * py) - instrument->edges[edge].radius_mm * rz;
}

/* Secant steps from r; NaN where they lead nowhere. Points too close to each other tell rounding,
 * not the slope. */
static double solve(const struct sight *sight, int edge, double r_mm, double *slope) {
  double last = r_mm + NEIGHBOUR_MM, last_miss = miss(sight, edge, last), r = r_mm;
  for (int step = 0; step < STEPS_MAX; step++) {
    double now = miss(sight, edge, r);
    if (fabs(r - last) > SECANT_MM) {
      *slope = (now - last_miss) / (r - last);
    }
    last = r;
    last_miss = now;
    r -= now / *slope;
    if (fabs(r - last) < CLOSE_MM) {
      return r;
    }
  }
  return NAN;
}

/* The first place outwards of r at which the ray passes outside the edge. */
static double search(const struct sight *sight, int edge, double r_mm) {
  double limit = 2 * placido_surface_radius_mm(sight->surface);
  double r = r_mm;
  while (r < limit && miss(sight, edge, r) < 0) { /* also ends off the surface, by NaN */
    r += SEARCH_MM;
  }
  return r;
}

/* One edge all around, each direction beginning at its neighbour's; false where it is not there. */
static bool trace(placido_mirrored *mirrored, int line, const placido_surface *surface,
                  const placido_instrument *instrument) {
  int edge = mirrored->first_edge + line;
  double r = line > 0 ? mirrored->r_mm[line - 1][0] : SEARCH_MM;
  for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i++) {
    struct sight sight = sight_along(instrument, surface, mirrored->vertex, i);
    if (i == 0) {
      r = search(&sight, edge, r);
    }
    r = solve(&sight, edge, r, &mirrored->slope[line][i]);
    mirrored->r_mm[line][i] = r;
    if (!(r > 0)) {
      return false;
    }
  }
  return true;
}

/* Whether the edge was seen all around, and the fit believes most of it. */
static bool is_complete(const placido_mires *mires, int edge) {
  int seen = 0, used = 0;
  double first = NAN, last = NAN, gap = 0;
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *point = &mires->points[i];
    if (point->edge == edge) {
      seen++;
      used += point->used;
      gap = fmax(gap, point->meridian_deg - last);
      first = isnan(first) ? point->meridian_deg : first;
      last = point->meridian_deg;
    }
  }
  gap = fmax(gap, first + 360 - last);
  return seen >= SEEN_MIN * mires->meridian_count && used >= USED_MIN * seen && gap <= GAP_MAX_DEG;
}

void placido_mirrored_find(placido_mirrored *mirrored, const placido_surface *surface,
                           const placido_mires *mires, const placido_instrument *instrument) {
  *mirrored = (placido_mirrored){.vertex = placido_vertex_find(surface),
                                 .first_edge = instrument->first_band_bright ? 0 : 1};
  if (isnan(mirrored->vertex.x_mm)) {
    return;
  }
  for (int mire = 0; mire < PLACIDO_MIRE_RINGS_MAX; mire++) {
    int inner = mirrored->first_edge + 2 * mire;
    if (inner + 1 >= instrument->edge_count || !is_complete(mires, inner) ||
        !is_complete(mires, inner + 1) || !trace(mirrored, 2 * mire, surface, instrument) ||
        !trace(mirrored, 2 * mire + 1, surface, instrument)) {
      return;
    }
    mirrored->count++;
  }
}

void placido_mirrored_rings(placido_mire_rings *rings, const placido_mirrored *mirrored,
                            const placido_surface *variant, const placido_instrument *instrument,
                            int stride) {
  rings->count = mirrored->count;
  rings->cso = false;
  for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i += stride) {
    struct sight sight = sight_along(instrument, variant, mirrored->vertex, i);
    for (int mire = 0; mire < mirrored->count; mire++) {
      double sum = 0;
      for (int line = 2 * mire; line <= 2 * mire + 1; line++) {
        double r = mirrored->r_mm[line][i];
        int edge = mirrored->first_edge + line;
        sum += variant ? r - miss(&sight, edge, r) / mirrored->slope[line][i] : r;
      }
      rings->points_mm[mire][i][0] = mirrored->vertex.x_mm + sum / 2 * sight.cosine;
      rings->points_mm[mire][i][1] = mirrored->vertex.y_mm + sum / 2 * sight.sine;
    }
  }
}

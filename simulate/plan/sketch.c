/* The rays of a sketch: where they pass the pupil, where they are seen, and what effects do to
 * them. */
#include "simulate/plan/sketch.h"

#include "simulate/eye.h"
#include "simulate/trace.h"
#include "simulate/wavefront.h"

#include <math.h>

enum { RINGS = PLACIDO_SKETCH_RINGS, SPOKES = 3 * RINGS, NODES = PLACIDO_SKETCH_RAYS };

static const double pi = 3.14159265358979323846;

double placido_sketch_direction_deg(int index) { return 45 * index; }

/* The pupil's nodes, and for each the ray that passes it, -1 where none arrives. */
typedef struct disc {
  double x[NODES], y[NODES], weight[NODES];
  short ray[NODES];
} disc;

static int node_of(int ring, int spoke) { return ring * SPOKES + (spoke + SPOKES) % SPOKES; }

/* Radius of a node's ring, and the outer edge of its ring of cells, in pupil radii: a ring of cells
 * has the area that its weights say. */
static double ring_radius(const disc *d, int ring) { return d->x[node_of(ring, 0)]; }

/* Rings come from the outside in or from the inside out. */
static double edge_squared(const disc *d, int ring) {
  double area = 0;
  for (int other = 0; other < RINGS; other++) {
    if (ring_radius(d, other) <= ring_radius(d, ring)) {
      area += SPOKES * d->weight[node_of(other, 0)];
    }
  }
  return area;
}

static double ring_height(const disc *d, int ring) {
  double outer = edge_squared(d, ring);
  double inner = outer - SPOKES * d->weight[node_of(ring, 0)];
  return sqrt(fmin(outer, 1)) - sqrt(fmax(inner, 0));
}

/* The ring next to `ring` outwards (1) or inwards (-1), -1 where there is none. */
static int next_ring(const disc *d, int ring, int outwards) {
  int step = ring_radius(d, RINGS - 1) > ring_radius(d, 0) ? outwards : -outwards;
  int next = ring + step;
  return next >= 0 && next < RINGS ? next : -1;
}

static short ray_or(const disc *d, int node, short otherwise) {
  return node >= 0 && d->ray[node] >= 0 ? d->ray[node] : otherwise;
}

static void find_cell(placido_sketch *sketch, const disc *d, int ring, int spoke) {
  const short own = d->ray[node_of(ring, spoke)];
  const int outside = next_ring(d, ring, 1), inside = next_ring(d, ring, -1);
  const double radius = ring_radius(d, ring);
  placido_sketch_cell *cell = &sketch->cells[own];
  cell->before = ray_or(d, node_of(ring, spoke - 1), own);
  cell->after = ray_or(d, node_of(ring, spoke + 1), own);
  cell->outer = ray_or(d, outside >= 0 ? node_of(outside, spoke) : -1, own);
  /* inwards of the innermost ring is its other side */
  int across = inside >= 0 ? node_of(inside, spoke) : node_of(ring, spoke + SPOKES / 2);
  double across_radius = inside >= 0 ? ring_radius(d, inside) : -radius;
  cell->inner = ray_or(d, across, own);
  double way = (cell->outer != own ? ring_radius(d, outside) : radius) -
               (cell->inner != own ? across_radius : radius);
  int sides = (cell->before != own) + (cell->after != own);
  cell->around = sides > 0 ? 1 / (float)sides : 0;
  cell->outwards = way > 0 ? (float)(ring_height(d, ring) / way) : 0;
}

/* Places along a direction, and how far it is from there to the nearer of the pupil's rims. */
static void find_places(placido_sketch *sketch, int direction) {
  const double angle = placido_sketch_direction_deg(direction) * pi / 180;
  const double radius = sketch->pupil_mm / 2, c = cos(angle), s = sin(angle);
  const placido_sketch_rays *rays = &sketch->rays;
  float *place = sketch->place_mm[direction];
  for (int i = 0; i < rays->count; i++) {
    double x = (double)rays->x_mm[i], y = (double)rays->y_mm[i];
    double along = c * x + s * y, beside = c * y - s * x;
    place[i] = (float)along;
    sketch->rim_mm[direction][i] =
      (float)(sqrt(fmax(radius * radius - beside * beside, 0)) - fabs(along));
  }
  for (int i = 0; i < rays->count; i++) {
    const placido_sketch_cell *cell = &sketch->cells[i];
    sketch->around_mm[direction][i] = (place[cell->after] - place[cell->before]) * cell->around;
    sketch->outwards_mm[direction][i] = (place[cell->outer] - place[cell->inner]) * cell->outwards;
  }
}

/* Keeps the nodes that have a ray: those with an angle that is a number. */
static void keep(placido_sketch *sketch, disc *d, const float *angle_x, const float *angle_y,
                 double pupil_mm) {
  placido_sketch_rays *rays = &sketch->rays;
  double sum = 0;
  *sketch = (placido_sketch){.pupil_mm = pupil_mm};
  for (int node = 0; node < NODES; node++) {
    d->ray[node] = -1;
    if (isfinite(angle_x[node]) && isfinite(angle_y[node])) {
      int i = rays->count++;
      d->ray[node] = (short)i;
      rays->x_mm[i] = (float)(d->x[node] * pupil_mm / 2);
      rays->y_mm[i] = (float)(d->y[node] * pupil_mm / 2);
      rays->angle_x[i] = angle_x[node];
      rays->angle_y[i] = angle_y[node];
      rays->weight[i] = (float)d->weight[node];
      sum += d->weight[node];
    }
  }
  for (int i = 0; i < rays->count; i++) {
    rays->weight[i] /= (float)sum;
  }
  for (int node = 0; node < NODES; node++) {
    if (d->ray[node] >= 0) {
      find_cell(sketch, d, node / SPOKES, node % SPOKES);
    }
  }
  for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
    find_places(sketch, direction);
  }
}

void placido_sketch_disc(placido_sketch *sketch, double pupil_mm) {
  static const float straight[NODES];
  disc d;
  placido_disc_quadrature(d.x, d.y, d.weight, RINGS);
  keep(sketch, &d, straight, straight, pupil_mm);
}

bool placido_sketch_trace(placido_sketch *sketch, const placido_surface *surface,
                          const placido_eye *eye, const double fixation_mm[2]) {
  float angle_x[NODES], angle_y[NODES];
  placido_apex apex;
  disc d;
  placido_disc_quadrature(d.x, d.y, d.weight, RINGS);
  *sketch = (placido_sketch){.pupil_mm = eye->pupil_mm};
  if (placido_apex_find(&apex, surface, eye, NULL) != PLACIDO_OK) {
    return false;
  }
  double arcmin_mm = placido_apex_nodal_mm(&apex, eye->index, eye->retina_mm) * PLACIDO_ARCMIN_RAD;
  for (int i = 0; i < NODES; i++) {
    placido_entry entry;
    double x_mm = eye->pupil_x_mm + d.x[i] * eye->pupil_mm / 2;
    double y_mm = eye->pupil_y_mm + d.y[i] * eye->pupil_mm / 2;
    bool met = placido_entry_at(&entry, surface, &apex, x_mm, y_mm);
    bool arrives = met && placido_entry_trace(&entry, eye, eye->retina_mm, &x_mm, &y_mm);
    angle_x[i] = arrives ? (float)((x_mm - fixation_mm[0]) / arcmin_mm) : NAN;
    angle_y[i] = arrives ? (float)((y_mm - fixation_mm[1]) / arcmin_mm) : NAN;
  }
  keep(sketch, &d, angle_x, angle_y, eye->pupil_mm);
  return sketch->rays.count > 0;
}

static void turn(placido_strokes *whole, const placido_strokes *part, int rays) {
  for (int i = 0; i < rays; i++) {
    whole->angle_x[i] += part->angle_x[i];
    whole->angle_y[i] += part->angle_y[i];
  }
  whole->turns = true;
}

static void dim(placido_strokes *whole, const placido_strokes *part, int rays) {
  for (int i = 0; i < rays; i++) {
    whole->weight[i] = whole->dims ? whole->weight[i] * part->weight[i] : part->weight[i];
  }
  whole->dims = true;
}

void placido_strokes_add(placido_strokes *whole, const placido_strokes *part, int rays) {
  if (part->turns) {
    turn(whole, part, rays);
  }
  if (part->dims) {
    dim(whole, part, rays);
  }
  if (part->lights > 0) {
    whole->lights = part->lights;
    for (int light = 0; light < part->lights; light++) {
      whole->light[light] = part->light[light];
    }
  }
  whole->shift_x_arcmin += part->shift_x_arcmin;
  whole->shift_y_arcmin += part->shift_y_arcmin;
  whole->defocus_D += part->defocus_D;
  whole->relief_D += part->relief_D;
  whole->waves = whole->waves || part->waves;
  whole->aperture_arcmin = hypot(whole->aperture_arcmin, part->aperture_arcmin);
}

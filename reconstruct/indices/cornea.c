/* The cornea as the indices see it: sampled about its vertex. */
#include "reconstruct/indices/cornea.h"

#include "base/memory.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)

/* ISO 19980; the meridian's slope is taken about the line through the vertex along the axis. */
static double axial(const placido_jet *jet, double r, double c, double s) {
  double slope = c * jet->sx + s * jet->sy;
  return PLACIDO_KERATOMETRIC * slope / (r * sqrt(1 + slope * slope));
}

static void sample_rings(placido_cornea *cornea, double vertex_sag) {
  const placido_layout *layout = cornea->layout;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double r = placido_ring_radius(ring), *before = cornea->power.before[ring];
    for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
      double c = layout->cosine[a], s = layout->sine[a], power = NAN;
      placido_jet jet = {.sag = NAN};
      if (layout->covered[ring][a]) {
        placido_surface_at(cornea->surface, cornea->vertex.x_mm + r * c,
                           cornea->vertex.y_mm + r * s, &jet);
        power = axial(&jet, r, c, s);
      }
      cornea->axial_D[ring][a] = power;
      cornea->sag_mm[ring][a] = jet.sag - vertex_sag;
      before[a + 1] = before[a] + (layout->covered[ring][a] ? power : 0);
    }
  }
}

/* Tangential power comes with the grid's jets (steepest.c), so that they are evaluated once. */
static void sample_grid(placido_cornea *cornea) {
  const placido_layout *layout = cornea->layout;
  double vertex_z = placido_surface_vertex_z_mm(cornea->surface);
  placido_peak *peak = &cornea->steepest;
  *peak = (placido_peak){NAN, NAN, NAN};
  cornea->grid.count = layout->grid_count;
  cornea->grid.sampled = layout->grid_sampled;
  cornea->grid.diameter_mm = PLACIDO_ZONE_MAX_MM;
  for (size_t i = 0; i < layout->grid_count; i++) {
    placido_map_point point = {.x_mm = layout->grid[i][0], .y_mm = layout->grid[i][1]};
    placido_surface_at(cornea->surface, point.x_mm, point.y_mm, &point.jet);
    cornea->grid.points[i][0] = point.x_mm;
    cornea->grid.points[i][1] = point.y_mm;
    cornea->grid.points[i][2] = vertex_z - point.jet.sag;
    double power = placido_map_tangential(&point);
    if (!(power <= peak->power_D)) { /* also where there is none yet */
      *peak = (placido_peak){point.x_mm, point.y_mm, power};
    }
  }
}

int placido_cornea_new(placido_cornea **cornea, const placido_layout *layout,
                       const placido_surface *surface, placido_error *err) {
  *cornea = NULL;
  placido_cornea *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  made->grid.points = placido_memory_new(layout->grid_count, sizeof *made->grid.points, err);
  if (!made->grid.points) {
    placido_cornea_free(made);
    return PLACIDO_MEMORY;
  }
  made->layout = layout;
  made->surface = surface;
  made->vertex = placido_vertex_find(surface);
  placido_jet jet; /* of NaN where there is no vertex: so are all samples */
  placido_surface_at(surface, made->vertex.x_mm, made->vertex.y_mm, &jet);
  sample_rings(made, jet.sag);
  sample_grid(made);
  size_t count;
  const placido_index_group *const *groups = placido_index_groups(&count);
  for (size_t i = 0; i < count; i++) {
    if (groups[i]->measure) {
      groups[i]->measure(made);
    }
  }
  *cornea = made;
  return PLACIDO_OK;
}

void placido_cornea_free(placido_cornea *cornea) {
  if (cornea) {
    placido_memory_free(cornea->grid.points);
    placido_memory_free(cornea);
  }
}

static bool nearest_is_covered(const placido_layout *layout, double r_mm, double angle_deg) {
  int ring = (int)(r_mm / PLACIDO_RING_STEP_MM);
  long azimuth = lround(angle_deg / 360 * PLACIDO_AZIMUTHS) % PLACIDO_AZIMUTHS;
  return ring < PLACIDO_RINGS &&
         layout->covered[ring][azimuth < 0 ? azimuth + PLACIDO_AZIMUTHS : azimuth];
}

static placido_jet jet_at(const placido_cornea *cornea, double r_mm, double c, double s) {
  placido_jet jet;
  placido_surface_at(cornea->surface, cornea->vertex.x_mm + r_mm * c,
                     cornea->vertex.y_mm + r_mm * s, &jet);
  return jet;
}

double placido_cornea_axial(const placido_cornea *cornea, double r_mm, double angle_deg) {
  if (!nearest_is_covered(cornea->layout, r_mm, angle_deg)) {
    return NAN;
  }
  double c = cos(angle_deg * DEGREE), s = sin(angle_deg * DEGREE);
  placido_jet jet = jet_at(cornea, r_mm, c, s);
  return axial(&jet, r_mm, c, s);
}

double placido_cornea_sag(const placido_cornea *cornea, double r_mm, double angle_deg) {
  if (!nearest_is_covered(cornea->layout, r_mm, angle_deg)) {
    return NAN;
  }
  return jet_at(cornea, r_mm, cos(angle_deg * DEGREE), sin(angle_deg * DEGREE)).sag -
         jet_at(cornea, 0, 0, 0).sag;
}

double placido_cornea_mean(const placido_cornea *cornea, double from_diameter_mm,
                           double to_diameter_mm) {
  double sum = 0, area = 0;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double weight = placido_ring_area(ring, from_diameter_mm, to_diameter_mm);
    if (weight > 0) {
      sum += weight * cornea->power.before[ring][PLACIDO_AZIMUTHS];
      area += weight * cornea->layout->support.before[ring][PLACIDO_AZIMUTHS];
    }
  }
  return sum / area;
}

double placido_peak_offset(double before, double peak, double behind) {
  double bend = before - 2 * peak + behind;
  double offset = bend != 0 ? 0.5 * (before - behind) / bend : 0;
  return isfinite(offset) ? fmax(-0.5, fmin(0.5, offset)) : 0;
}

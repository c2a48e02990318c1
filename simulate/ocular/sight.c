/* Sight: the chief ray, where it lands, and how that follows its direction. */
#include "simulate/ocular/sight.h"

#include "simulate/eye.h"

#include <math.h>

enum { STEPS_MAX = 12 };

static const double settled_mm = 1e-9;
static const double usual_nm = 555;
static const double apart = 1e-3; /* tangents between directions that differ */

static void set_direction(placido_sight *s, const double tangent[2]) {
  s->incidence.slope[0] = -tangent[0];
  s->incidence.slope[1] = -tangent[1];
}

/* The slope in air of the ray that is (x, y) from the pupil's centre at this depth. */
static void find_approach(double slope[2], const placido_sight *s, double x_mm, double y_mm,
                          double depth_mm) {
  const placido_incidence *in = &s->incidence;
  slope[0] = (in->slope[0] + in->nearness * x_mm) / (1 + in->nearness * depth_mm);
  slope[1] = (in->slope[1] + in->nearness * y_mm) / (1 + in->nearness * depth_mm);
}

void placido_sight_aim(const placido_sight *s, const placido_beam *beam, size_t at, double x_mm,
                       double y_mm) {
  double depth_mm = 0, off_mm = INFINITY, slope[2];
  double x = x_mm - s->pupil_x_mm, y = y_mm - s->pupil_y_mm;
  placido_jet jet;
  find_approach(slope, s, x, y, PLACIDO_ENTRANCE_PUPIL_MM); /* of the whole straight ray */
  double lean = fabs(slope[0]) + fabs(slope[1]);
  for (int step = 0; step < STEPS_MAX && !(fabs(off_mm) * lean < settled_mm); step++) {
    double before_mm = PLACIDO_ENTRANCE_PUPIL_MM - depth_mm;
    beam->x_mm[at] = x_mm - before_mm * slope[0];
    beam->y_mm[at] = y_mm - before_mm * slope[1];
    if (!placido_surface_at(s->surface, beam->x_mm[at], beam->y_mm[at], &jet)) {
      break;
    }
    off_mm = jet.sag - s->axis_sag_mm - depth_mm;
    depth_mm += off_mm / (1 - jet.sx * slope[0] - jet.sy * slope[1]);
  }
  beam->depth_mm[at] = jet.sag - s->axis_sag_mm;
  beam->sx[at] = jet.sx;
  beam->sy[at] = jet.sy;
}

void placido_sight_entry(const placido_sight *s, const placido_beam *beam, size_t at,
                         double entry_mm[2]) {
  double depth_mm = beam->depth_mm[at], slope[2];
  entry_mm[0] = beam->x_mm[at] - s->pupil_x_mm;
  entry_mm[1] = beam->y_mm[at] - s->pupil_y_mm;
  find_approach(slope, s, entry_mm[0], entry_mm[1], depth_mm);
  entry_mm[0] += (PLACIDO_ENTRANCE_PUPIL_MM - depth_mm) * slope[0];
  entry_mm[1] += (PLACIDO_ENTRANCE_PUPIL_MM - depth_mm) * slope[1];
}

static void pass(const placido_sight *s, const placido_beam *beam) {
  placido_beam_enter(beam, &s->incidence);
  for (int i = 0; i < PLACIDO_NAVARRO_SURFACES && s->whole; i++) {
    placido_beam_refract(beam, &s->behind.surfaces[i]);
  }
}

void placido_sight_land(const placido_sight *s, const placido_beam *beam) {
  pass(s, beam);
  if (s->radius_mm > 0) {
    placido_beam_sphere(beam, s->retina_mm - s->radius_mm, s->radius_mm, s->index);
  } else {
    placido_beam_plane(beam, s->retina_mm, s->index);
  }
}

void placido_sight_depart(const placido_sight *s, const placido_beam *beam) {
  pass(s, beam);
  if (s->whole) {
    placido_beam_plane(beam, s->from_mm, s->index);
  }
}

/* The chief ray to the retina; false where it does not arrive. */
static bool land_chief(const placido_sight *s, const double tangent[2], double landing[3]) {
  placido_sight turned = *s;
  double block[PLACIDO_BEAM_COLUMNS];
  placido_beam ray = placido_beam_of(block, 1);
  set_direction(&turned, tangent);
  placido_sight_aim(&turned, &ray, 0, s->pupil_x_mm, s->pupil_y_mm);
  placido_sight_land(&turned, &ray);
  landing[0] = ray.px[0];
  landing[1] = ray.py[0];
  landing[2] = ray.pz[0];
  return isfinite(landing[0]) && isfinite(landing[1]) && isfinite(landing[2]);
}

/* Unit vectors in the retina at a place. */
static void find_tangents(double across[3], double along[3], const placido_sight *s,
                          const double at[3]) {
  double normal[3] = {0, 0, 1};
  if (s->radius_mm > 0) {
    normal[0] = at[0] / s->radius_mm;
    normal[1] = at[1] / s->radius_mm;
    normal[2] = (at[2] - s->retina_mm) / s->radius_mm + 1;
  }
  double length = sqrt(1 - normal[0] * normal[0]);
  across[0] = length;
  across[1] = -normal[0] * normal[1] / length;
  across[2] = -normal[0] * normal[2] / length;
  along[0] = 0;
  along[1] = normal[2] / length;
  along[2] = -normal[1] / length;
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* How the landing point follows the tangents of the direction, in coordinates of the retina at
 * `tangent`; the image is upside down, the angle at which it is seen is not. */
static bool follow(double scale[2][2], const placido_sight *s, const double tangent[2],
                   const double across[3], const double along[3]) {
  bool arrives = true;
  for (int k = 0; k < 2; k++) {
    double more[2] = {tangent[0], tangent[1]}, less[2] = {tangent[0], tangent[1]};
    double a[3], b[3];
    more[k] += apart / 2;
    less[k] -= apart / 2;
    arrives = land_chief(s, more, a) && land_chief(s, less, b) && arrives;
    double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    scale[0][k] = dot(way, across) / apart;
    scale[1][k] = dot(way, along) / apart;
  }
  return arrives;
}

/* Of 2 × 2, rows outer. */
static bool invert(double *inverse, const double *m) {
  double det = m[0] * m[3] - m[1] * m[2];
  inverse[0] = m[3] / det;
  inverse[1] = -m[1] / det;
  inverse[2] = -m[2] / det;
  inverse[3] = m[0] / det;
  return isfinite(1 / det);
}

/* scale × (that on the axis)⁻¹ × nodal_mm: exactly nodal_mm on the axis. */
static bool weigh(placido_sight *s, const double tangent[2], double nodal_mm) {
  static const double axis[2] = {0, 0};
  double landing[3], across[3], along[3], middle[2][2], back[2][2], there[2][2];
  if (tangent[0] == 0 && tangent[1] == 0) {
    s->scale[0][0] = s->scale[1][1] = nodal_mm;
    return true;
  }
  if (!land_chief(s, axis, landing)) {
    return false;
  }
  find_tangents(across, along, s, landing);
  if (!follow(middle, s, axis, across, along) || !invert(&back[0][0], &middle[0][0]) ||
      !follow(there, s, tangent, s->across, s->along)) {
    return false;
  }
  for (int i = 0; i < 2; i++) {
    for (int k = 0; k < 2; k++) {
      s->scale[i][k] = nodal_mm * (there[i][0] * back[0][k] + there[i][1] * back[1][k]);
    }
  }
  return true;
}

/* The focus: the chief ray's landing point plus the offset, on the retina. */
static void place_focus(placido_sight *s, const double landing[3], const double offset_arcmin[2]) {
  const double rad[2] = {offset_arcmin[0] * PLACIDO_ARCMIN_RAD,
                         offset_arcmin[1] * PLACIDO_ARCMIN_RAD};
  double u = s->scale[0][0] * rad[0] + s->scale[0][1] * rad[1];
  double v = s->scale[1][0] * rad[0] + s->scale[1][1] * rad[1];
  for (int k = 0; k < 3; k++) {
    s->focus[k] = landing[k] + u * s->across[k] + v * s->along[k];
  }
  double square = s->radius_mm * s->radius_mm - s->focus[0] * s->focus[0] -
                  s->focus[1] * s->focus[1];
  if (s->radius_mm > 0 && square > 0) {
    s->focus[2] = s->retina_mm - s->radius_mm + sqrt(square);
  }
}

/* Path and sines of the chief ray, from which all others are reckoned. */
static void reckon(placido_sight *s) {
  double block[PLACIDO_BEAM_COLUMNS];
  placido_beam ray = placido_beam_of(block, 1);
  placido_sight_aim(s, &ray, 0, s->pupil_x_mm, s->pupil_y_mm);
  placido_sight_depart(s, &ray);
  double from[3] = {ray.px[0] - s->focus[0], ray.py[0] - s->focus[1], ray.pz[0] - s->focus[2]};
  double way_mm = sqrt(dot(from, from));
  s->chief_mm = ray.path_mm[0] + s->index * way_mm;
  s->chief_sine[0] = dot(from, s->across) / way_mm;
  s->chief_sine[1] = dot(from, s->along) / way_mm;
}

/* Of the retina; 0: flat. */
static double radius_mm(const placido_apex *apex, const placido_eye *eye,
                        const placido_ocular *ocular) {
  if (!ocular->curved) {
    return 0;
  }
  double nodal_mm = ocular->whole ? PLACIDO_RETINA_NODAL_MM
                                  : placido_apex_nodal_mm(apex, eye->index, eye->retina_mm);
  return PLACIDO_RETINA_RADIUS_MM * nodal_mm / PLACIDO_RETINA_NODAL_MM;
}

static void settle(placido_sight *s, const placido_surface *surface, const placido_apex *apex,
                   const placido_eye *eye, const placido_ocular *ocular, double wavelength_nm) {
  const placido_correction *worn = &eye->correction;
  *s = (placido_sight){.surface = surface,
                       .axis_sag_mm = apex->axis_sag_mm,
                       .pupil_mm = eye->pupil_mm,
                       .pupil_x_mm = eye->pupil_x_mm,
                       .pupil_y_mm = eye->pupil_y_mm,
                       .incidence = {.nearness = ocular->whole ? ocular->accommodation_D / 1000 : 0,
                                     .xx = (worn->m_D + worn->j0_D) / 1000,
                                     .xy = worn->j45_D / 1000,
                                     .yy = (worn->m_D - worn->j0_D) / 1000,
                                     .x_mm = eye->pupil_x_mm,
                                     .y_mm = eye->pupil_y_mm,
                                     .index = eye->index},
                       .whole = ocular->whole,
                       .index = eye->index,
                       .retina_mm = eye->retina_mm,
                       .radius_mm = radius_mm(apex, eye, ocular)};
  if (ocular->whole) {
    s->behind = placido_navarro_at(ocular->accommodation_D,
                                   wavelength_nm > 0 ? wavelength_nm : usual_nm);
    s->incidence.index = placido_navarro_cornea(&s->behind);
    s->index = placido_navarro_vitreous(&s->behind);
    s->from_mm = placido_navarro_cornea_image_mm(&s->behind);
  }
}

int placido_sight_new(placido_sight *sight, const placido_surface *surface,
                      const placido_eye *eye, const placido_ocular *ocular,
                      const double field_deg[2], const double offset_arcmin[2],
                      double wavelength_nm, placido_error *err) {
  const double rad_per_deg = acos(-1) / 180;
  const double tangent[2] = {tan(field_deg[0] * rad_per_deg), tan(field_deg[1] * rad_per_deg)};
  placido_apex apex;
  double landing[3];
  int status = placido_apex_find(&apex, surface, eye, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  settle(sight, surface, &apex, eye, ocular, wavelength_nm);
  set_direction(sight, tangent);
  bool arrives = land_chief(sight, tangent, landing);
  if (arrives) {
    find_tangents(sight->across, sight->along, sight, landing);
    arrives = ocular->whole
                ? follow(sight->scale, sight, tangent, sight->across, sight->along)
                : weigh(sight, tangent, placido_apex_nodal_mm(&apex, eye->index, eye->retina_mm));
  }
  if (arrives) {
    place_focus(sight, landing, offset_arcmin);
    reckon(sight);
    arrives = invert(&sight->inverse[0][0], &sight->scale[0][0]) && isfinite(sight->chief_mm);
  }
  return arrives ? PLACIDO_OK
                 : placido_error_set(err, PLACIDO_QUALITY,
                                     "light from (%g, %g) degrees does not reach the retina "
                                     "through the middle of the pupil at (%g, %g) mm",
                                     field_deg[0], field_deg[1], eye->pupil_x_mm,
                                     eye->pupil_y_mm);
}

void placido_sight_angle(const placido_sight *s, const placido_beam *beam, size_t at,
                         double angle[2]) {
  double from[3] = {beam->px[at] - s->focus[0], beam->py[at] - s->focus[1],
                    beam->pz[at] - s->focus[2]};
  double u = dot(from, s->across), v = dot(from, s->along);
  angle[0] = s->inverse[0][0] * u + s->inverse[0][1] * v;
  angle[1] = s->inverse[1][0] * u + s->inverse[1][1] * v;
}

/* Across a tangent of the surface that rays depart from: the sines' change, and the path's. */
typedef struct turn {
  double sine[2], path_mm;
} turn;

static turn turn_along(const placido_sight *s, const placido_beam *beam, size_t at,
                       const double unit[3], double way_mm, const double sine[2],
                       const double tangent[3]) {
  double part = dot(unit, tangent);
  double along_ray =
    beam->tx[at] * tangent[0] + beam->ty[at] * tangent[1] + beam->tz[at] * tangent[2];
  return (turn){{(dot(tangent, s->across) - sine[0] * part) / way_mm,
                 (dot(tangent, s->along) - sine[1] * part) / way_mm},
                -s->index * (along_ray + part)};
}

placido_standing placido_sight_stand(const placido_sight *s, const placido_beam *beam, size_t at) {
  const double(*j)[2] = s->scale, (*k)[2] = s->inverse;
  double sx = s->whole ? 0 : beam->sx[at], sy = s->whole ? 0 : beam->sy[at];
  double unit[3] = {beam->px[at] - s->focus[0], beam->py[at] - s->focus[1],
                    beam->pz[at] - s->focus[2]};
  double way_mm = sqrt(dot(unit, unit));
  for (int i = 0; i < 3; i++) {
    unit[i] /= way_mm;
  }
  const double sine[2] = {dot(unit, s->across), dot(unit, s->along)};
  const double first[3] = {1, 0, sx}, second[3] = {0, 1, sy};
  turn a = turn_along(s, beam, at, unit, way_mm, sine, first);
  turn b = turn_along(s, beam, at, unit, way_mm, sine, second);
  double det = a.sine[0] * b.sine[1] - b.sine[0] * a.sine[1];
  double u = (a.path_mm * b.sine[1] - b.path_mm * a.sine[1]) / det / s->index;
  double v = (b.path_mm * a.sine[0] - a.path_mm * b.sine[0]) / det / s->index;
  double across = s->index * (sine[0] - s->chief_sine[0]);
  double along = s->index * (sine[1] - s->chief_sine[1]);
  return (placido_standing){
    .opd_mm = s->chief_mm - beam->path_mm[at] - s->index * way_mm,
    .place = {j[0][0] * across + j[1][0] * along, j[0][1] * across + j[1][1] * along},
    .slope = {k[0][0] * u + k[0][1] * v, k[1][0] * u + k[1][1] * v}};
}

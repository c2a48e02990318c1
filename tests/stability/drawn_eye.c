/* The families' numbers: radii and asphericities of healthy eyes vary by 0.25 mm and 0.12; cones of
 * 3 D to grade IV (J. L. Alió, M. H. Shabayek, J. Refract. Surg. 22 (2006) 539); higher orders some
 * 0.15 um of the wavefront a term (Salmon and van de Pol 2006), three times that of sag; ablations
 * of 1 to 8 D. */
#include "tests/stability/drawn_eye.h"

#include "base/random.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <string.h>

static const double cornea_mm = 5.6;

struct range {
  double low, high;
};

/* What a family's corneas are made of; a range of zeros: without. */
struct family {
  const char *name;
  int share; /* of 200 */
  struct range radius_mm, q, cylinder_D, off_mm;
  double terms_um;       /* standard deviation of the terms of order 3 over 4.5 mm */
  struct range cone_mm, cone_sigma_mm;
  struct range laser_D;
  struct range ridge;    /* slope */
};

static const struct family families[DRAWN_FAMILIES] = {
    {.name = "conicoid",
     .share = 24,
     .radius_mm = {7.3, 8.3},
     .q = {-0.5, 0.1},
     .off_mm = {0, 0.1}},
    {.name = "toric",
     .share = 26,
     .radius_mm = {7.4, 8.3},
     .q = {-0.4, 0},
     .cylinder_D = {0.5, 4},
     .off_mm = {0, 0.1}},
    {.name = "decentred",
     .share = 20,
     .radius_mm = {7.4, 8.2},
     .q = {-0.4, 0},
     .cylinder_D = {0, 1.5},
     .off_mm = {0.2, 0.6}},
    {.name = "irregular",
     .share = 24,
     .radius_mm = {7.4, 8.2},
     .q = {-0.4, 0},
     .cylinder_D = {0, 2},
     .off_mm = {0, 0.2},
     .terms_um = 1.2},
    {.name = "mild cone",
     .share = 16,
     .radius_mm = {7.5, 8},
     .q = {-0.4, -0.1},
     .cylinder_D = {0, 2},
     .off_mm = {0, 0.1},
     .terms_um = 0.4,
     .cone_mm = {0.01, 0.03},
     .cone_sigma_mm = {1, 1.4}},
    {.name = "cone",
     .share = 16,
     .radius_mm = {7.5, 8},
     .q = {-0.4, -0.1},
     .cylinder_D = {0, 2},
     .off_mm = {0, 0.1},
     .terms_um = 0.6,
     .cone_mm = {0.03, 0.07},
     .cone_sigma_mm = {1, 1.3}},
    {.name = "severe cone",
     .share = 12,
     .radius_mm = {7.4, 7.8},
     .q = {-0.4, -0.1},
     .cylinder_D = {0, 2},
     .off_mm = {0, 0.1},
     .terms_um = 1.2,
     .cone_mm = {0.07, 0.12},
     .cone_sigma_mm = {0.95, 1.25}},
    {.name = "flat",
     .share = 14,
     .radius_mm = {8.6, 11},
     .q = {0, 0.6},
     .cylinder_D = {0, 1},
     .off_mm = {0, 0.2}},
    {.name = "steep",
     .share = 14,
     .radius_mm = {6, 7},
     .q = {-0.4, 0},
     .cylinder_D = {0, 1},
     .off_mm = {0, 0.2}},
    {.name = "post-laser",
     .share = 20,
     .radius_mm = {7.5, 8},
     .q = {-0.3, 0},
     .cylinder_D = {0, 1},
     .off_mm = {0, 0.1},
     .terms_um = 0.3,
     .laser_D = {1, 8}},
    {.name = "ridge",
     .share = 14,
     .radius_mm = {7.6, 8},
     .q = {-0.3, 0},
     .cylinder_D = {0, 1},
     .off_mm = {0, 0.1},
     .terms_um = 0.3,
     .ridge = {0.002, 0.008}},
};

int drawn_family(int number, int of) {
  int below = 0, family = 0;
  for (; family < DRAWN_FAMILIES - 1; family++) {
    below += families[family].share;
    if (number * 200 < below * of) {
      break;
    }
  }
  return family;
}

const char *drawn_family_name(int family) {
  return families[family].name;
}

/* Numbers are drawn in order. */
struct draw {
  uint64_t seed, eye, count;
};

static double within(struct draw *draw, struct range range) {
  return placido_random_uniform(draw->seed, draw->eye, draw->count++, range.low, range.high);
}

static double normal(struct draw *draw) {
  return placido_random_normal(draw->seed, draw->eye, draw->count++);
}

static void place(struct draw *draw, struct range off_mm, double *x_mm, double *y_mm) {
  double off = within(draw, off_mm), turn = within(draw, (struct range){0, 2 * M_PI});
  *x_mm = off * cos(turn);
  *y_mm = off * sin(turn);
}

static double any_axis(struct draw *draw) {
  return within(draw, (struct range){0, 180});
}

static placido_part base_of(struct draw *draw, const struct family *family) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC};
  part.as.biconic.r1 = within(draw, family->radius_mm);
  part.as.biconic.r2 = 337.5 / (337.5 / part.as.biconic.r1 + within(draw, family->cylinder_D));
  part.as.biconic.q1 = part.as.biconic.q2 = within(draw, family->q);
  part.as.biconic.axis_deg = any_axis(draw);
  place(draw, family->off_mm, &part.as.biconic.cx, &part.as.biconic.cy);
  return part;
}

/* Orders 3 to 5, smaller by a third from one to the next. */
static placido_part terms_of(struct draw *draw, const struct family *family) {
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE};
  part.as.zernike.radius_mm = 4.5;
  for (int j = 6; j < 21; j++) {
    int order = j < 10 ? 3 : j < 15 ? 4 : 5;
    part.as.zernike.coefficients_um[j] = family->terms_um * pow(1.5, 3 - order) * normal(draw);
  }
  return part;
}

static placido_part cone_of(struct draw *draw, const struct family *family) {
  placido_part part = {.kind = PLACIDO_PART_BUMP};
  part.as.bump.height_mm = within(draw, family->cone_mm);
  part.as.bump.sigma_x_mm = within(draw, family->cone_sigma_mm);
  part.as.bump.sigma_y_mm = within(draw, family->cone_sigma_mm);
  place(draw, (struct range){0.3, 1.3}, &part.as.bump.x_mm, &part.as.bump.y_mm);
  part.as.bump.axis_deg = any_axis(draw);
  return part;
}

static placido_part laser_of(struct draw *draw, const struct family *family, double r0_mm) {
  placido_part part = {.kind = PLACIDO_PART_ABLATION};
  part.as.ablation.dioptres = within(draw, family->laser_D);
  part.as.ablation.zone_mm = within(draw, (struct range){5.5, 6.5});
  part.as.ablation.blend_mm = within(draw, (struct range){0.8, 1.6});
  part.as.ablation.r0 = r0_mm;
  part.as.ablation.n = 1.376;
  place(draw, (struct range){0, 0.5}, &part.as.ablation.cx, &part.as.ablation.cy);
  return part;
}

static placido_part ridge_of(struct draw *draw, const struct family *family) {
  placido_part part = {.kind = PLACIDO_PART_RIDGE};
  part.as.ridge.slope = within(draw, family->ridge);
  part.as.ridge.width_mm = within(draw, (struct range){0.12, 0.3});
  part.as.ridge.offset_mm = within(draw, (struct range){0.2, 1.2});
  part.as.ridge.axis_deg = any_axis(draw);
  return part;
}

static placido_surface *cornea_of(struct draw *draw, const struct family *family) {
  placido_part parts[5] = {base_of(draw, family)};
  size_t count = 1;
  if (family->terms_um > 0) {
    parts[count++] = terms_of(draw, family);
  }
  if (family->cone_mm.high > 0) {
    parts[count++] = cone_of(draw, family);
  }
  if (family->laser_D.high > 0) {
    parts[count++] = laser_of(draw, family, parts[0].as.biconic.r1);
  }
  if (family->ridge.high > 0) {
    parts[count++] = ridge_of(draw, family);
  }
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, cornea_mm, parts, count, NULL, NULL),
                   PLACIDO_OK);
  return surface;
}

placido_uncertainty drawn_workshop(const placido_instrument *instrument, double size) {
  enum { CAMERA_MODES = 9, MODES = 12 };
  static const struct {
    int parameter;
    double sigma;
    int with;
    double with_sigma;
  } camera[CAMERA_MODES] = {{2, 0.2, 3, 0},      {3, 0.2, 2, 0},       {4, 0.2, 8, 1},
                            {6, 2e-3, 7, 1e-3},  {7, 2e-3, 6, -1e-3},  {9, 0.05, 2, 4.5},
                            {10, 0.05, 3, -4.5}, {11, 0.05, 0, 0},     {0, 5, 1, 5}};
  placido_uncertainty u;
  assert_int_equal(placido_uncertainty_new(&u, instrument->edge_count, MODES, NULL), PLACIDO_OK);
  const size_t stride = (size_t)u.parameter_count;
  const int edges = u.edge_count, first = PLACIDO_UNCERTAINTY_CAMERA;
  for (int m = 0; m < CAMERA_MODES; m++) {
    u.factor[(size_t)m * stride + (size_t)camera[m].parameter] = size * camera[m].sigma;
    u.factor[(size_t)m * stride + (size_t)camera[m].with] = size * camera[m].with_sigma;
  }
  double *radii = u.factor + 9 * stride, *heights = u.factor + 10 * stride;
  double *waves = u.factor + 11 * stride;
  for (int k = 0; k < edges; k++) {
    double along = (double)k / edges;
    radii[first + k] = size * 5e-4 * instrument->edges[k].radius_mm;
    heights[first + edges + k] = size * 0.05;
    waves[first + k] = size * 0.02 * sin(9 * along);
    waves[first + edges + k] = size * 0.02 * cos(7 * along);
  }
  return u;
}

static void draw_instrument(struct drawn_eye *eye, struct draw *draw, int sources) {
  const char *name = within(draw, (struct range){0, 1}) < 0.75 ? "cone24" : "disc18";
  assert_int_equal(placido_phantom_instrument(&eye->nominal, name, NULL), PLACIDO_OK);
  eye->real = eye->nominal;
  double size = within(draw, (struct range){0.2, 1});
  if (sources & DRAWN_GEOMETRY) {
    eye->geometry = drawn_workshop(&eye->nominal, size);
    for (int m = 0; m < eye->geometry.mode_count; m++) {
      placido_uncertainty_apply(&eye->real, &eye->real, &eye->geometry, m, normal(draw));
    }
  }
}

static void draw_distance(struct drawn_eye *eye, struct draw *draw, int sources) {
  placido_jet jet;
  assert_true(placido_surface_at(eye->cornea, 0, 0, &jet));
  double sigma_mm = within(draw, (struct range){0.005, 0.05}), off = normal(draw);
  eye->axis_z_sigma_mm = sources & DRAWN_DISTANCE ? sigma_mm : 0;
  eye->axis_z_mm =
      placido_surface_vertex_z_mm(eye->cornea) - jet.sag + eye->axis_z_sigma_mm * off;
}

/* Mires that are hidden: a sector beyond some edge (nose, lid), arcs of 3 to 15 degrees over a few
 * edges (lashes), single points. */
enum hiding { HIDES_NOTHING, HIDES_SECTOR, HIDES_ARCS, HIDES_POINTS, HIDINGS };

struct hidden_arc {
  double from_deg, wide_deg;
  int first, last; /* edges */
};

/* Anywhere round the middle; it begins at this share of the edges and goes over so many of them. */
static struct hidden_arc arc_of(struct draw *draw, struct range wide_deg, struct range share,
                                int edges, int length) {
  struct hidden_arc arc;
  arc.from_deg = within(draw, (struct range){0, 360});
  arc.wide_deg = within(draw, wide_deg);
  arc.first = (int)(within(draw, share) * edges);
  arc.last = arc.first + length;
  return arc;
}

static bool is_in(const struct hidden_arc *arc, const placido_mire_point *point) {
  double off = fmod(point->meridian_deg - arc->from_deg + 720, 360);
  return off < arc->wide_deg && point->edge >= arc->first && point->edge <= arc->last;
}

static void drop(placido_mires *mires, const struct hidden_arc *arcs, int count, double share,
                 const struct draw *draw) {
  size_t left = 0;
  for (size_t i = 0; i < mires->count; i++) {
    bool hidden = placido_random_uniform(draw->seed, draw->eye + 1000000, i, 0, 1) < share;
    for (int k = 0; k < count; k++) {
      hidden = hidden || is_in(&arcs[k], &mires->points[i]);
    }
    if (!hidden) {
      mires->points[left++] = mires->points[i];
    }
  }
  mires->count = left;
}

static void hide(struct drawn_eye *eye, struct draw *draw) {
  enum { ARCS = 24 };
  struct hidden_arc arcs[ARCS];
  int edges = eye->mires.edge_count, count = 0;
  double share = 0;
  if (eye->hidden == HIDES_SECTOR) {
    arcs[count++] = arc_of(draw, (struct range){30, 100}, (struct range){0.25, 0.6}, edges, edges);
  } else if (eye->hidden == HIDES_ARCS) {
    for (; count < ARCS; count++) {
      int length = (int)within(draw, (struct range){2, 12});
      arcs[count] = arc_of(draw, (struct range){3, 15}, (struct range){0.1, 1}, edges, length);
    }
  } else if (eye->hidden == HIDES_POINTS) {
    share = within(draw, (struct range){0.05, 0.6});
  }
  drop(&eye->mires, arcs, count, share, draw);
}

void drawn_noise(placido_mires *mires, uint64_t seed, uint64_t stream, double sigma_px) {
  for (size_t i = 0; i < mires->count; i++) {
    placido_mire_point *p = &mires->points[i];
    double du = p->u_px - mires->centre_u_px, dv = p->v_px - mires->centre_v_px;
    double off = sigma_px * placido_random_normal(seed, stream, i) / hypot(du, dv);
    p->u_px += off * du;
    p->v_px += off * dv;
    p->sigma_px = sigma_px;
  }
}

static int find_in_picture(struct drawn_eye *eye, struct draw *draw) {
  placido_disturbance usual = {.seed = draw->seed * 1000 + draw->eye,
                               .lashes = eye->hidden == HIDES_ARCS ? 12 : 0,
                               .nose = eye->hidden == HIDES_SECTOR};
  usual.blur_px = within(draw, (struct range){0.6, 1.2});
  usual.noise = within(draw, (struct range){0.8, 2});
  placido_frame frame = {0};
  placido_mires_options how = {.threads = 2};
  placido_error err = {0};
  int status = placido_phantom_render(&frame, eye->cornea, &eye->real, &usual, 2, &err);
  if (!status) {
    status = placido_mires_find(&eye->mires, &frame, &eye->nominal, &how, NULL, &err);
  }
  if (status) {
    print_message("eye %d: %s\n", eye->number, err.text);
  }
  placido_frame_free(&frame);
  return status;
}

int drawn_eye_new(struct drawn_eye *eye, uint64_t seed, int number, int of, int sources,
                  bool rendered) {
  *eye = (struct drawn_eye){
      .family = drawn_family(number, of), .number = number, .rendered = rendered};
  struct draw draw = {.seed = seed, .eye = (uint64_t)number};
  eye->cornea = cornea_of(&draw, &families[eye->family]);
  draw_instrument(eye, &draw, sources);
  draw_distance(eye, &draw, sources);
  eye->noise_px = 0.02 * pow(5, within(&draw, (struct range){0, 1}));
  double hiding = within(&draw, (struct range){0, HIDINGS + 1});
  eye->hidden = hiding < HIDINGS ? (int)hiding : HIDES_NOTHING;
  if (rendered) {
    return find_in_picture(eye, &draw);
  }
  eye->mires = truth_points(eye->cornea, &eye->real, DRAWN_MERIDIANS, 0, NULL);
  drawn_noise(&eye->mires, seed, 2000000 + (uint64_t)number, eye->noise_px);
  hide(eye, &draw);
  return PLACIDO_OK;
}

void drawn_eye_free(struct drawn_eye *eye) {
  placido_surface_free(eye->cornea);
  placido_uncertainty_free(&eye->geometry);
  placido_mires_free(&eye->mires);
}

int drawn_eye_fit(placido_fit **fit, struct drawn_eye *eye, placido_error *err) {
  placido_fit_options options = {.axis_z_mm = eye->axis_z_mm,
                                 .axis_z_sigma_mm = eye->axis_z_sigma_mm,
                                 .geometry = &eye->geometry,
                                 .threads = 2};
  return placido_fit_new(fit, &eye->mires, &eye->nominal, &options, NULL, err);
}

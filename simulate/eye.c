/* The eye behind the cornea: defaults, ranges, and the angular scale of its retina.
 *
 * A single refracting surface of radius R sends the ray through its centre of curvature straight
 * on, so a retinal distance t at L behind the apex is seen under t / (L - R). A fixed size in
 * micrometres is right for one eye only: 2.5 um is half a minute where L - R is 17.19 mm, and a
 * cornea of 7.8 mm alone has 23.1 mm. */
#include "simulate/eye.h"

#include <math.h>

static const double default_bucket_arcmin = 0.5;
static const double seed_bucket_um = 2.5; /* D. Garcia, CWhatUC: "half a minute" */

static int check(double value, double min, double max, const char *name,
                 placido_error *err) {
  if (value >= min && value <= max) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_INPUT, "%s is %g, expected %g to %g", name, value, min,
                           max);
}

int placido_eye_settle(placido_eye *settled, const placido_eye *eye, placido_error *err) {
  *settled = *eye;
  if (settled->index == 0) {
    settled->index = PLACIDO_EYE_INDEX;
  }
  const double sphere_max_D = PLACIDO_SPHERE_MAX_D, cross_max_D = PLACIDO_CROSS_MAX_D;
  struct { double value, min, max; const char *name; } ranges[] = {
    {settled->pupil_mm, 0.1, 12, "the pupil's diameter (mm)"},
    {settled->pupil_x_mm, -6, 6, "the pupil's x (mm)"},
    {settled->pupil_y_mm, -6, 6, "the pupil's y (mm)"},
    {settled->index, 1.01, 2, "the refractive index"},
    {settled->correction.m_D, -sphere_max_D, sphere_max_D, "the correction's mean sphere (D)"},
    {settled->correction.j0_D, -cross_max_D, cross_max_D, "the correction's J0 (D)"},
    {settled->correction.j45_D, -cross_max_D, cross_max_D, "the correction's J45 (D)"},
    {(double)settled->correct, PLACIDO_CORRECT_NONE, PLACIDO_CORRECT_SPHERE, "what is corrected"},
  };
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
    int status = check(ranges[i].value, ranges[i].min, ranges[i].max, ranges[i].name, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  if (settled->retina_mm == 0) {
    return PLACIDO_OK;
  }
  return check(settled->retina_mm, 5, 200, "the retina's distance (mm)", err);
}

static int default_to(int value, int otherwise) { return value == 0 ? otherwise : value; }

static int check_seed(const placido_optics *settled, placido_error *err) {
  if (settled->bucket_arcmin != default_bucket_arcmin) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the seed's buckets are called %g arcmin, not %g: leave one out",
                             default_bucket_arcmin, settled->bucket_arcmin);
  }
  if (settled->wavelength_nm != 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the seed has rays, no diffraction: leave the wavelength out");
  }
  if (settled->pattern != PLACIDO_PATTERN_CROSSHATCH) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the seed's rays are a crosshatch: leave the pattern out");
  }
  return PLACIDO_OK;
}

/* Rays from samples; both given is a contradiction. */
static int settle_rays(placido_optics *settled, placido_error *err) {
  if (settled->samples != 0 && settled->rays != 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d samples across the pupil and %ld rays: leave one out",
                             settled->samples, settled->rays);
  }
  if (settled->rays == 0) {
    settled->samples = default_to(settled->samples, settled->cwhatuc ? 100 : 400); /* as the seed */
    int status = check(settled->samples, 2, 4000, "samples across the pupil", err);
    long n = settled->samples;
    settled->rays = n * n + (n - 1) * (n - 1);
    return status;
  }
  return check((double)settled->rays, 1, 50e6, "rays", err);
}

int placido_optics_settle(placido_optics *settled, const placido_optics *optics,
                          placido_error *err) {
  *settled = *optics;
  settled->buckets = default_to(settled->buckets, 257);
  settled->threads = default_to(settled->threads, 1);
  if (settled->bucket_arcmin == 0) {
    settled->bucket_arcmin = default_bucket_arcmin;
  }
  if (settled->cwhatuc) {
    settled->light = PLACIDO_LIGHT_COUNTED;
    settled->grow = 1;
  } else if (settled->grow == 0) {
    settled->grow = 4;
  }
  if (settled->buckets % 2 == 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%d buckets a side, expected an odd number",
                             settled->buckets);
  }
  struct { double value, min, max; const char *name; } ranges[] = {
    {settled->pattern, 0, PLACIDO_PATTERN_QUASI_RANDOM, "the pattern"},
    {settled->light, 0, PLACIDO_LIGHT_COUNTED, "the way of counting light"},
    {settled->buckets, 3, PLACIDO_PSF_BUCKETS_MAX, "buckets a side"},
    {settled->bucket_arcmin, 0.01, 60, "the bucket (arcmin)"},
    {settled->grow, 1, 16, "the growth of the PSF"},
    {settled->threads, 1, 256, "threads"},
  };
  for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
    int status = check(ranges[i].value, ranges[i].min, ranges[i].max, ranges[i].name, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  int status = settled->wavelength_nm == 0
                 ? PLACIDO_OK
                 : check(settled->wavelength_nm, 300, 1200, "the wavelength (nm)", err);
  if (status == PLACIDO_OK) {
    status = settle_rays(settled, err);
  }
  return status == PLACIDO_OK && settled->cwhatuc ? check_seed(settled, err) : status;
}

/* Mean curvature of a surface patch (do Carmo, Differential Geometry, 3-3), positive for a dome. */
static double mean_curvature(const placido_jet *jet) {
  double slope2 = 1 + jet->sx * jet->sx + jet->sy * jet->sy;
  double numerator = (1 + jet->sx * jet->sx) * jet->syy - 2 * jet->sx * jet->sy * jet->sxy +
                     (1 + jet->sy * jet->sy) * jet->sxx;
  return numerator / (2 * slope2 * sqrt(slope2));
}

int placido_apex_find(placido_apex *apex, const placido_surface *surface, const placido_eye *eye,
                      placido_error *err) {
  *apex = (placido_apex){0};
  placido_jet axis, centre;
  if (!placido_surface_at(surface, 0, 0, &axis)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the surface is not defined on the axis, from where the retina's "
                             "distance is measured");
  }
  if (!placido_surface_at(surface, eye->pupil_x_mm, eye->pupil_y_mm, &centre)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the surface is not defined at the pupil's centre (%g, %g mm)",
                             eye->pupil_x_mm, eye->pupil_y_mm);
  }
  double curvature = mean_curvature(&centre);
  apex->axis_sag_mm = axis.sag;
  apex->radius_mm = curvature > 0 ? 1 / curvature : INFINITY;
  return PLACIDO_OK;
}

double placido_apex_nodal_mm(const placido_apex *apex, double index, double retina_mm) {
  if (apex->radius_mm > retina_mm / 2) {
    return retina_mm / index;
  }
  return retina_mm - apex->radius_mm;
}

double placido_apex_bucket_um(const placido_apex *apex, const placido_optics *optics, double index,
                              double retina_mm) {
  if (optics->cwhatuc) {
    return seed_bucket_um;
  }
  double nodal_um = 1000 * placido_apex_nodal_mm(apex, index, retina_mm);
  return nodal_um * optics->bucket_arcmin * PLACIDO_ARCMIN_RAD;
}

/* psf.csv and psf.json: a point spread function on disk. */
#include "base/file.h"
#include "base/json.h"

#include <placido/plan.h>
#include <placido/psf.h>
#include <placido/quality.h>

#include <math.h>
#include <string.h>

static const char not_planned[] = "the cornea alone was asked for";

static void write_row(FILE *stream, const double *values, int n) {
  for (int i = 0; i < n; i++) {
    fprintf(stream, "%.17g%c", values[i], i == n - 1 ? '\n' : ',');
  }
}

int placido_psf_save_csv(const placido_psf *psf, const char *path, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int row = 0; row < psf->n; row++) {
    write_row(file.stream, &psf->values[(size_t)row * (size_t)psf->n], psf->n);
  }
  return placido_file_commit(&file, err);
}

/* Takes both references; false where memory is out. */
static bool put(json_t *object, const char *key, json_t *value) {
  return json_object_set_new(object, key, value) == 0;
}

static bool put_real(json_t *object, const char *key, double value) {
  return put(object, key, placido_json_real(value));
}

static json_t *correction_json(const placido_correction *correction) {
  double sphere_D, cylinder_D, axis_deg;
  json_t *object = json_object();
  placido_correction_clinical(correction, &sphere_D, &cylinder_D, &axis_deg);
  if (put_real(object, "sphere_D", sphere_D) && put_real(object, "cylinder_D", cylinder_D) &&
      put_real(object, "axis_deg", axis_deg)) {
    return object;
  }
  json_decref(object);
  return NULL;
}

/* What the point spread function itself has of effects. */
static bool has_effect(const placido_psf *psf, const char *name) {
  return psf->wavelength_nm > 0 && strcmp(name, "diffraction") == 0;
}

static bool append_left_out(json_t *list, const char *name, const char *why, double estimate) {
  json_t *object = json_object();
  bool whole = put(object, "name", json_string(name)) && put(object, "why", json_string(why)) &&
               put_real(object, "estimate", estimate) && put(object, "unit", json_string("white"));
  return json_array_append_new(list, object) == 0 && whole;
}

/* Sorts what the plan says of effects into what ran and what did not; without a plan nothing did. */
static bool sort_effects(json_t *ran, json_t *left_out, const placido_psf *psf,
                         const placido_plan *plan) {
  size_t count = 0;
  const placido_verdict *verdicts = plan != NULL ? placido_plan_verdicts(plan, &count) : NULL;
  const char *name, *summary;
  bool whole = true;
  for (size_t i = 0; whole && placido_effect_at(i, &name, &summary); i++) {
    const placido_verdict *verdict = i < count ? &verdicts[i] : NULL;
    if (has_effect(psf, name) || (verdict != NULL && verdict->runs)) {
      whole = json_array_append_new(ran, json_string(name)) == 0;
    } else {
      whole = append_left_out(left_out, name, verdict != NULL ? verdict->reason : not_planned,
                              verdict != NULL ? verdict->bound : (double)NAN);
    }
  }
  return whole;
}

static json_t *effects_json(const placido_psf *psf, const placido_plan *plan) {
  json_t *object = json_object(), *ran = json_array(), *left_out = json_array();
  bool worn = psf->correction.m_D != 0 || psf->correction.j0_D != 0 || psf->correction.j45_D != 0;
  bool whole = json_array_append_new(ran, json_string("corneal-refraction")) == 0 &&
               (!worn || json_array_append_new(ran, json_string("thin-lens-correction")) == 0) &&
               sort_effects(ran, left_out, psf, plan);
  whole = put(object, "ran", ran) && whole;
  whole = put(object, "left_out", left_out) && whole;
  if (whole) {
    return object;
  }
  json_decref(object);
  return NULL;
}

/* Contrast at a few frequencies, null where the buckets are too wide for one, and the radii that hold
 * half and four fifths of the light. */
static bool put_quality(json_t *root, const placido_psf *psf) {
  static const int frequencies_cpd[] = {5, 10, 20, 30};
  placido_mtf mtf = {0};
  json_t *list = json_array();
  double most_cpd = 30 / psf->bucket_arcmin;
  int count = most_cpd >= 30 ? 7 : (int)(most_cpd / 5) + 1;
  bool known = count > 1 && placido_mtf_new(&mtf, psf, count, 5, NULL) == PLACIDO_OK, whole = true;
  for (size_t i = 0; i < sizeof frequencies_cpd / sizeof *frequencies_cpd; i++) {
    int k = frequencies_cpd[i] / 5;
    json_t *row = json_object();
    whole = put(row, "cycles_per_degree", json_integer(frequencies_cpd[i])) &&
            put(row, "contrast", known && k < count ? placido_json_real(mtf.radial[k])
                                                    : json_null()) && whole;
    whole = json_array_append_new(list, row) == 0 && whole;
  }
  placido_mtf_free(&mtf);
  return put(root, "mtf", list) && whole &&
         put_real(root, "encircled_50_arcmin", placido_encircled_radius(psf, 0.5)) &&
         put_real(root, "encircled_80_arcmin", placido_encircled_radius(psf, 0.8));
}

static bool put_method(json_t *root, const placido_psf *psf) {
  bool waves = psf->wavelength_nm > 0;
  return put(root, "method", json_string(waves ? "diffraction" : "geometric")) &&
         put(root, "wavelength_nm", waves ? placido_json_real(psf->wavelength_nm) : json_null());
}

static json_t *psf_json(const placido_psf *psf, const placido_plan *plan, double seconds) {
  json_t *root = json_object();
  bool whole = put(root, "format", json_string("placido-psf/1")) &&
               put_real(root, "pupil_mm", psf->pupil_mm) && put_method(root, psf) &&
               put(root, "rays", json_integer(psf->rays)) &&
               put(root, "rays_entered", json_integer(psf->rays_entered)) &&
               put(root, "rays_landed", json_integer(psf->rays_landed)) &&
               put(root, "rays_missed", json_integer(psf->rays_missed)) &&
               put(root, "rays_grazed", json_integer(psf->rays_grazed)) &&
               put(root, "rays_reflected", json_integer(psf->rays_reflected)) &&
               put_real(root, "outside", psf->outside) &&
               put_real(root, "strehl_g", psf->strehl_g) &&
               put_real(root, "rms_arcmin", placido_psf_moments(psf).rms) &&
               put_quality(root, psf) &&
               put_real(root, "bucket_arcmin", psf->bucket_arcmin) &&
               put_real(root, "bucket_um", psf->bucket_um) &&
               put(root, "correction", correction_json(&psf->correction)) &&
               put_real(root, "retina_mm", psf->retina_mm) &&
               put_real(root, "refractive_index", psf->index) &&
               put(root, "effects", effects_json(psf, plan)) && put_real(root, "seconds", seconds);
  if (whole) {
    return root;
  }
  json_decref(root);
  return NULL;
}

int placido_psf_save_json(const placido_psf *psf, const placido_plan *plan, double seconds,
                          const char *path, placido_error *err) {
  json_t *root = psf_json(psf, plan, seconds);
  if (root == NULL) {
    return placido_error_set(err, PLACIDO_MEMORY, "out of memory while writing %s", path);
  }
  int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}

/* compare.json: `placido-compare/1`, docs/formats.md. */
#include "acquire/cli/compare.h"

#include "acquire/cli/record.h"
#include "base/json.h"

#include <math.h>

static const double degrees = 57.29577951308232;

/* Takes the reference of `value`, which may be NULL when memory is out. */
static void put(json_t *object, bool *failed, const char *key, json_t *value) {
  *failed |= json_object_set_new(object, key, value) != 0;
}

static void put_real(json_t *object, bool *failed, const char *key, double value) {
  put(object, failed, key, placido_json_real(value));
}

static json_t *build_exam(const struct compared_exam *exam, bool *failed) {
  json_t *object = json_object();
  put(object, failed, "path", record_text(exam->path));
  put(object, failed, "eye", exam->eye[0] ? record_text(exam->eye) : json_null());
  put(object, failed, "created", exam->created[0] ? record_text(exam->created) : json_null());
  return object;
}

static json_t *build_measure(double value, double sigma, bool *failed) {
  json_t *object = json_object();
  put_real(object, failed, "value", value);
  put_real(object, failed, "sigma", sigma);
  return object;
}

static json_t *build_alignment(const placido_alignment *a, bool *failed) {
  static const struct {
    const char *name;
    enum placido_motion_term term;
    double unit;
  } terms[] = {{"shift_x_mm", PLACIDO_SHIFT_X, 1},      {"shift_y_mm", PLACIDO_SHIFT_Y, 1},
               {"piston_um", PLACIDO_PISTON, 1e3},      {"tilt_x_deg", PLACIDO_TILT_X, degrees},
               {"tilt_y_deg", PLACIDO_TILT_Y, degrees}, {"torsion_deg", PLACIDO_TORSION, degrees}};
  if (!a->aligned) {
    return json_null();
  }
  json_t *object = json_object();
  for (size_t k = 0; k < sizeof terms / sizeof terms[0]; k++) {
    put(object, failed, terms[k].name,
        build_measure(terms[k].unit * a->terms[terms[k].term],
                      terms[k].unit * a->sigmas[terms[k].term], failed));
  }
  put(object, failed, "points", json_integer((long long)a->points));
  put(object, failed, "steps", json_integer(a->steps));
  put_real(object, failed, "rms_before_um", a->rms_before_um);
  put_real(object, failed, "rms_um", a->rms_um);
  put_real(object, failed, "chi_square", a->chi_square);
  return object;
}

static json_t *build_zone(const placido_difference *difference, enum placido_difference_kind kind,
                          const double bounds_mm[2], bool *failed) {
  json_t *object = json_object();
  placido_difference_zone zone =
      placido_difference_zone_find(difference, kind, bounds_mm[0], bounds_mm[1]);
  put_real(object, failed, "from_mm", zone.from_mm);
  put_real(object, failed, "to_mm", zone.to_mm);
  put(object, failed, "points", json_integer((long long)zone.points));
  put_real(object, failed, "mean", zone.mean);
  put_real(object, failed, "standard_deviation", zone.deviation);
  put_real(object, failed, "largest", zone.largest);
  put_real(object, failed, "significant", zone.significant);
  return object;
}

static json_t *build_maps(const placido_difference *difference, bool *failed) {
  json_t *maps = json_object();
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    enum placido_difference_kind kind = (enum placido_difference_kind)k;
    json_t *object = json_object(), *zones = json_array();
    put(object, failed, "unit", json_string(placido_difference_unit(kind)));
    for (int z = 0; z < PLACIDO_DIFFERENCE_ZONES; z++) {
      *failed |=
          json_array_append_new(
              zones, build_zone(difference, kind, placido_difference_zone_mm(z), failed)) != 0;
    }
    put(object, failed, "zones", zones);
    put(maps, failed, placido_difference_name(kind), object);
  }
  return maps;
}

static json_t *build_change(const struct compared_change *change, bool *failed) {
  json_t *object = json_object();
  bool known = isfinite(change->difference) && isfinite(change->sigma);
  put(object, failed, "name", json_string(change->name));
  put(object, failed, "unit", json_string(change->unit));
  put_real(object, failed, "first", change->first);
  put_real(object, failed, "second", change->second);
  put_real(object, failed, "difference", change->difference);
  put_real(object, failed, "sigma", change->sigma);
  put(object, failed, "significant",
      known ? json_boolean(fabs(change->difference) > 2 * change->sigma) : json_null());
  return object;
}

json_t *comparison_json(const struct comparison *comparison) {
  bool failed = false;
  json_t *root = json_object(), *exams = json_array(), *indices = json_array();
  json_t *warnings = json_array();
  const placido_notes *notes = &comparison->outcome->notes;
  for (int k = 0; k < 2; k++) {
    failed |= json_array_append_new(exams, build_exam(&comparison->exams[k], &failed)) != 0;
  }
  for (size_t k = 0; k < comparison->change_count; k++) {
    failed |= json_array_append_new(indices, build_change(&comparison->changes[k], &failed)) != 0;
  }
  for (size_t k = 0; k < notes->count; k++) {
    failed |= json_array_append_new(warnings, record_text(notes->lines[k])) != 0;
  }
  put(root, &failed, "format", json_string("placido-compare/1"));
  put(root, &failed, "software", json_string(PROGRAM_VERSION));
  put(root, &failed, "created", json_string(comparison->created));
  put(root, &failed, "exams", exams);
  put(root, &failed, "mirrored", json_boolean(comparison->exams[1].measured.mirrored));
  put(root, &failed, "alignment", build_alignment(&comparison->alignment, &failed));
  put(root, &failed, "maps", build_maps(&comparison->difference, &failed));
  put(root, &failed, "indices", indices);
  put(root, &failed, "warnings", warnings);
  if (failed) {
    json_decref(root);
    return NULL;
  }
  return root;
}

/* The results of the accuracy test as a table and for machines. */
#include "acquire/cli/iso_check.h"
#include "acquire/cli/record.h"
#include "base/file.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>

static void write_number(FILE *stream, double value) {
  if (isfinite(value)) {
    fprintf(stream, ",%.17g", value);
  } else {
    fputc(',', stream);
  }
}

static void write_zone(FILE *stream, const placido_iso_result *result, const placido_iso_zone *zone) {
  placido_text_quote(stream, result->object);
  const double numbers[] = {zone->inner_mm, zone->outer_mm, (double)zone->points, zone->covered,
                            zone->axial_mean_D, zone->axial_2sd_D,
                            zone->elevation_mean_um, zone->elevation_2sd_um};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
    write_number(stream, numbers[i]);
  }
  fputc('\n', stream);
}

int iso_save_csv(const placido_iso_result *results, size_t count, const char *path,
                 placido_error *err) {
  placido_file file = {0};
  const int status = placido_file_create(&file, path, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  fputs("object,inner_mm,outer_mm,points,covered,axial_mean_D,axial_2sd_D,elevation_mean_um,"
        "elevation_2sd_um\n", file.stream);
  for (size_t i = 0; i < count; i++) {
    for (int k = 0; k < PLACIDO_ISO_ZONES && results[i].failure[0] == '\0'; k++) {
      write_zone(file.stream, &results[i], &results[i].zones[k]);
    }
  }
  return placido_file_commit(&file, err);
}

static json_t *zone_object(const placido_iso_zone *zone) {
  return json_pack("{s:f, s:o, s:I, s:f, s:o, s:o, s:o, s:o}", "inner_mm", zone->inner_mm,
                   "outer_mm", placido_json_real(zone->outer_mm),
                   "points", (json_int_t)zone->points, "covered", zone->covered, "axial_mean_D",
                   placido_json_real(zone->axial_mean_D), "axial_2sd_D",
                   placido_json_real(zone->axial_2sd_D), "elevation_mean_um",
                   placido_json_real(zone->elevation_mean_um), "elevation_2sd_um",
                   placido_json_real(zone->elevation_2sd_um));
}

static json_t *check_object(const placido_iso_check *check) {
  return json_pack("{s:s, s:s, s:o, s:f, s:b}", "name", check->name, "unit", check->unit, "value",
                   placido_json_real(check->value), "limit", check->limit, "passed",
                   (int)check->passed);
}

static json_t *result_object(const placido_iso_result *result) {
  const bool failed = result->failure[0] != '\0';
  json_t *zones = json_array(), *checks = json_array();
  bool lost = false;
  for (int k = 0; k < PLACIDO_ISO_ZONES && !failed; k++) {
    lost = json_array_append_new(zones, zone_object(&result->zones[k])) != 0 || lost;
  }
  for (size_t i = 0; i < result->check_count; i++) {
    lost = json_array_append_new(checks, check_object(&result->checks[i])) != 0 || lost;
  }
  json_t *root = json_pack(
      "{s:o, s:o, s:b, s:o, s:[f,f,f], s:o, s:o, s:o}", "object", record_text(result->object),
      "image", result->image[0] ? record_text(result->image) : json_null(), "passed",
      (int)result->passed, "failure", failed ? record_text(result->failure) : json_null(),
      "shift_mm", result->shift_mm[0], result->shift_mm[1], result->shift_mm[2],
      "elevation_rms_6_um", placido_json_real(failed ? (double)NAN : result->elevation_rms_6_um),
      "zones", zones, "checks", checks);
  if (lost) {
    json_decref(root);
    return NULL;
  }
  return root;
}

json_t *iso_result_json(const placido_iso_result *results, size_t count, const char *instrument,
                        const char *created) {
  json_t *objects = json_array();
  bool passed = true, lost = false;
  for (size_t i = 0; i < count; i++) {
    passed = passed && results[i].passed;
    lost = json_array_append_new(objects, result_object(&results[i])) != 0 || lost;
  }
  json_t *root = json_pack("{s:s, s:s, s:s, s:o, s:b, s:s, s:o}", "format", "placido-iso-check/1",
                           "software", PROGRAM_VERSION, "created", created, "instrument",
                           record_text(instrument), "passed", (int)passed, "note",
                           iso_targets_note, "objects", objects);
  if (lost) {
    json_decref(root);
    return NULL;
  }
  return root;
}

int iso_save_json(const placido_iso_result *results, size_t count, const char *instrument,
                  const char *created, const char *path, placido_error *err) {
  json_t *root = iso_result_json(results, count, instrument, created);
  const int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}

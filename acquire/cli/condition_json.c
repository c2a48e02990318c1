/* Condition numbers for machines and for people. */
#include "acquire/cli/condition.h"

#include "base/json.h"

#include <math.h>
#include <string.h>

/* By independent errors of a pixel root mean square in all edge points. */
static double per_px(const struct conditions *all, const struct condition *one) {
  return one->by_edges / all->edge_sigma_px;
}

static double relative_edges(const struct conditions *all, const struct condition *one) {
  return per_px(all, one) * all->edge_scale_px / fabs(one->value);
}

static double relative_distance(const struct conditions *all, const struct condition *one) {
  return one->per_mm * all->distance_scale_mm / fabs(one->value);
}

static json_t *output(const struct conditions *all, const struct condition *one) {
  return json_pack(
      "{s:s, s:s, s:o, s:o, s:o, s:{s:o, s:o, s:o}, s:{s:o, s:o, s:o}, s:{s:o}}", "name",
      one->name, "unit", one->unit, "pupil_mm", placido_json_real(one->pupil_mm), "value",
      placido_json_real(one->value), "sigma", placido_json_real(one->sigma), "edges", "per_sigma",
      placido_json_real(one->by_edges), "per_px", placido_json_real(per_px(all, one)),
      "relative", placido_json_real(relative_edges(all, one)), "distance", "per_sigma",
      placido_json_real(fabs(one->per_mm) * all->distance_sigma_mm), "per_mm",
      placido_json_real(one->per_mm), "relative",
      placido_json_real(relative_distance(all, one)), "geometry", "per_sigma",
      placido_json_real(one->by_geometry));
}

json_t *conditions_json(const struct conditions *conditions) {
  json_t *outputs = json_array();
  bool failed = !outputs;
  for (size_t i = 0; i < conditions->count; i++) {
    failed = json_array_append_new(outputs, output(conditions, &conditions->items[i])) || failed;
  }
  json_t *object = json_pack(
      "{s:o, s:i, s:{s:{s:o, s:o}, s:{s:o, s:o}}, s:o}", "normal_matrix",
      placido_json_real(conditions->matrix), "zone_mm", CONDITION_ZONE_MM, "inputs", "edges",
      "sigma_px", placido_json_real(conditions->edge_sigma_px), "scale_px",
      placido_json_real(conditions->edge_scale_px), "distance", "sigma_mm",
      placido_json_real(conditions->distance_sigma_mm), "scale_mm",
      placido_json_real(conditions->distance_scale_mm), "outputs", outputs);
  if (failed) {
    json_decref(object);
    return NULL;
  }
  return object;
}

static const struct condition *find(const struct conditions *conditions, const char *name) {
  for (size_t i = 0; i < conditions->count; i++) {
    if (strcmp(conditions->items[i].name, name) == 0) {
      return &conditions->items[i];
    }
  }
  return NULL;
}

void conditions_tell(char *text, size_t size, const struct conditions *conditions) {
  const struct condition *height = find(conditions, "elevation");
  const struct condition *power = find(conditions, "simk_mean_D");
  text[0] = '\0';
  if (height && power && isfinite(power->per_mm)) {
    snprintf(text, size,
             "Independent errors of 0.1 px in all edge points change elevation by %.2g µm root "
             "mean square and the mean of SimK by %.2g D; 0.1 mm of the distance changes them by "
             "%.2g µm and %.2g D. The condition number of the fit's equations is %.1e.",
             0.1 * per_px(conditions, height), 0.1 * per_px(conditions, power),
             0.1 * height->per_mm, 0.1 * power->per_mm, conditions->matrix);
  }
}

/* Writes down what was examined, how, how well and how long it took. */
#include "acquire/cli/record.h"

#include "acquire/cli/plan_json.h"
#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>

/* An object being built; `failed` once a value did not fit into memory. */
struct builder {
  json_t *object;
  bool failed;
};

static struct builder builder_new(void) {
  struct builder builder = {.object = json_object()};
  builder.failed = !builder.object;
  return builder;
}

/* Takes the reference of `value`, which may be NULL when memory is out. */
static void put(struct builder *builder, const char *key, json_t *value) {
  if (!builder->object || json_object_set_new(builder->object, key, value) != 0) {
    builder->failed = true;
  }
}

static void put_real(struct builder *builder, const char *key, double value) {
  put(builder, key, placido_json_real(value));
}

static void put_integer(struct builder *builder, const char *key, long long value) {
  put(builder, key, json_integer(value));
}

static void put_text(struct builder *builder, const char *key, const char *text) {
  put(builder, key, text[0] ? record_text(text) : json_null());
}

/* Moves a finished child into its parent. */
static void put_object(struct builder *builder, const char *key, struct builder child) {
  builder->failed = builder->failed || child.failed;
  put(builder, key, child.object);
}

static void append(struct builder *builder, json_t *array, json_t *value) {
  if (json_array_append_new(array, value) != 0) {
    builder->failed = true;
  }
}

json_t *record_text(const char *text) {
  json_t *value = json_string(text);
  if (value) {
    return value;
  }
  char *ascii = placido_memory_string(text, NULL);
  if (!ascii) {
    return NULL;
  }
  for (char *c = ascii; *c; c++) {
    *c = (unsigned char)*c < 0x80 ? *c : '?';
  }
  value = json_string(ascii);
  placido_memory_free(ascii);
  return value;
}

static struct builder build_input(const struct examination *examination) {
  struct builder builder = builder_new();
  const placido_device_info *source = &examination->source;
  put_text(&builder, "path", examination->settings->input);
  if (examination->frame.data || examination->elevation.count > 0) {
    put_text(&builder, "eye", source->eye);
  }
  if (examination->frame.data) {
    put_text(&builder, "vendor", source->vendor);
    put_text(&builder, "model", source->model);
    put_text(&builder, "serial", source->serial);
    put_text(&builder, "instrument", examination->instrument.name);
    put(&builder, "calibrated", json_boolean(examination->instrument.calibrated));
  }
  return builder;
}

/* A number that has a default: null says that the default was used. */
static void put_asked(struct builder *builder, const char *key, double value) {
  put_real(builder, key, value != 0.0 ? value : (double)NAN);
}

static struct builder build_settings(const struct examination *examination) {
  struct builder builder = builder_new();
  const struct settings *settings = examination->settings;
  if (examination->frame.data) {
    put_real(&builder, "axis_z_mm", examination->axis_z_mm);
    put_real(&builder, "axis_z_sigma_mm", examination->axis_z_sigma_mm);
    put_asked(&builder, "combine", settings->combine);
    put_asked(&builder, "meridians", settings->meridians);
    put_asked(&builder, "filter_px", settings->filter_px);
    put_asked(&builder, "knot_mm", settings->knot_mm);
    put_asked(&builder, "degree", settings->degree);
    put_asked(&builder, "fit_tolerance", settings->fit_tolerance);
  }
  if (examination->views.scene_count > 0) {
    json_t *pupils = json_array(), *scenes = json_array();
    for (size_t i = 0; i < settings->pupils_mm.count; i++) {
      const double pupil_mm = settings->pupils_mm.values[i];
      append(&builder, pupils, pupil_mm == PUPIL_AUTO ? json_string("auto")
                                                      : placido_json_real(pupil_mm));
    }
    for (size_t i = 0; i < examination->views.scene_count; i++) {
      append(&builder, scenes, record_text(examination->views.scenes[i].name));
    }
    put(&builder, "pupils_mm", pupils);
    put(&builder, "scenes", scenes);
    put_asked(&builder, "index", settings->index);
    put_asked(&builder, "retina_mm", settings->retina_mm);
    put_asked(&builder, "axial_length_mm", settings->behind.axial_mm);
    put_asked(&builder, "samples", settings->samples);
    put(&builder, "pattern", record_text(ray_pattern_name(settings->rays.pattern)));
    put(&builder, "light", record_text(ray_light_name(settings->cwhatuc ? PLACIDO_LIGHT_COUNTED
                                                                        : settings->rays.light)));
    put_asked(&builder, "grow", settings->rays.grow);
    put_asked(&builder, "trials", settings->trials);
    put_asked(&builder, "diffraction_nm", settings->rays.wavelength_nm);
    put_asked(&builder, "through_focus_D", settings->rays.through_focus_D);
    put_asked(&builder, "bucket_arcmin", settings->bucket_arcmin);
    put(&builder, "cwhatuc", json_boolean(settings->cwhatuc));
    put_asked(&builder, "tolerance", settings->plan.tolerance);
    put_asked(&builder, "age_years", settings->plan.age_years);
    put(&builder, "iris", json_string(plan_iris_name(settings->plan.iris)));
    put(&builder, "forced", plan_json_forced(&settings->plan));
  }
  put_integer(&builder, "threads", examination->threads);
  return builder;
}

/* What each of several frames gave. */
static void put_combined(struct builder *builder, const struct combination *combination) {
  json_t *frames = json_array();
  for (size_t i = 0; i < combination->count; i++) {
    const placido_movement *movement = &combination->movements[i];
    struct builder frame = builder_new();
    json_t *shift = json_array();
    for (int axis = 0; axis < 3; axis++) {
      append(&frame, shift, placido_json_real(movement->shift_mm[axis]));
    }
    put_integer(&frame, "frame", combination->index[i]);
    put_real(&frame, "weight", movement->weight);
    put(&frame, "shift_mm", shift);
    put_real(&frame, "spread_px", movement->spread_px);
    builder->failed = builder->failed || frame.failed;
    append(builder, frames, frame.object);
  }
  put(builder, "combined", frames);
}

static struct builder build_capture(const struct examination *examination) {
  struct builder builder = builder_new();
  put_integer(&builder, "frame", examination->choice.index);
  put_integer(&builder, "frames", examination->choice.frames);
  put_integer(&builder, "damaged", examination->choice.damaged);
  put_real(&builder, "score", examination->choice.score);
  put_real(&builder, "coverage", examination->mires.coverage);
  put_real(&builder, "contrast", examination->mires.contrast);
  json_t *centre = json_array();
  append(&builder, centre, placido_json_real(examination->mires.centre_u_px));
  append(&builder, centre, placido_json_real(examination->mires.centre_v_px));
  put(&builder, "centre_px", centre);
  if (examination->combination.count > 0) {
    put_combined(&builder, &examination->combination);
  }
  return builder;
}

#define BUDGET_ZONE_MM 6

/* Where the error bars come from, rms over the zone. */
static struct builder build_budget(const struct examination *examination) {
  static const char *const names[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = "noise",
      [PLACIDO_SIGMA_DISTANCE] = "distance",
      [PLACIDO_SIGMA_GEOMETRY] = "geometry",
  };
  struct builder builder = builder_new();
  placido_sigma budget[PLACIDO_SIGMA_SOURCES];
  placido_fit_budget(examination->fit, BUDGET_ZONE_MM, budget);
  put_real(&builder, "zone_mm", BUDGET_ZONE_MM);
  put_real(&builder, "axis_z_um", 1e3 * examination->axis_z_sigma_mm);
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    struct builder source = builder_new();
    put_real(&source, "z_um", budget[i].z_um);
    put_real(&source, "axial_D", budget[i].axial_D);
    put_object(&builder, names[i], source);
  }
  return builder;
}

static const double pi = 3.14159265358979323846;

static void put_shape(struct builder *builder, const char *key,
                      const placido_conicoid_shape *shape) {
  const double cross = sqrt(shape->d_mm1 * shape->d_mm1 + shape->e_mm1 * shape->e_mm1);
  struct builder best = builder_new();
  put_real(&best, "r1_mm", 1 / (shape->c_mm1 - cross));
  put_real(&best, "r2_mm", 1 / (shape->c_mm1 + cross));
  put_real(&best, "q", shape->p - 1);
  put_real(&best, "axis_deg",
           cross > 0 ? fmod(90 / pi * atan2(-shape->e_mm1, -shape->d_mm1) + 180, 180) : (double)NAN);
  put_real(&best, "x_mm", shape->x_mm);
  put_real(&best, "y_mm", shape->y_mm);
  put_real(&best, "z_mm", shape->z_mm);
  put_real(&best, "zone_mm", shape->zone_mm);
  put_object(builder, key, best);
}

/* What the maps take for granted, beside the best-fit sphere. */
static struct builder build_maps(const placido_maps *maps) {
  struct builder builder = builder_new();
  put_real(&builder, "index", maps->index);
  put_real(&builder, "retina_mm", maps->retina_mm);
  put_real(&builder, "vertex_x_mm", maps->vertex_mm[0]);
  put_real(&builder, "vertex_y_mm", maps->vertex_mm[1]);
  put_shape(&builder, "best_fit_conic", &maps->references[PLACIDO_REFERENCE_CONIC]);
  put_shape(&builder, "best_fit_toric", &maps->references[PLACIDO_REFERENCE_TORIC]);
  return builder;
}

static struct builder build_fit(const struct examination *examination) {
  struct builder builder = builder_new();
  const placido_fit_summary fit = placido_fit_summary_get(examination->fit);
  const placido_sphere *sphere = &examination->maps.sphere;
  put_real(&builder, "rms_px", fit.rms_px);
  put_real(&builder, "sigma_px", fit.sigma_px);
  put_integer(&builder, "points", (long long)fit.points);
  put_integer(&builder, "points_used", (long long)fit.points_used);
  put_integer(&builder, "steps", fit.steps);
  put_real(&builder, "knot_mm", fit.knot_mm);
  put_real(&builder, "radius_mm", fit.radius_mm);
  put_real(&builder, "condition", fit.condition);
  put_real(&builder, "axis_z_mm", fit.axis_z_mm);
  put_real(&builder, "axis_z_sigma_mm", fit.axis_z_sigma_mm);
  put_integer(&builder, "axis_z_solved", fit.axis_z_solved);
  struct builder best = builder_new();
  put_real(&best, "radius_mm", sphere->radius_mm);
  put_real(&best, "x_mm", sphere->x_mm);
  put_real(&best, "y_mm", sphere->y_mm);
  put_real(&best, "z_mm", sphere->z_mm);
  put_real(&best, "zone_mm", sphere->zone_mm);
  put_object(&builder, "best_fit_sphere", best);
  put_object(&builder, "error_budget", build_budget(examination));
  return builder;
}

/* What the maker of the file says of the eye. */
static struct builder build_maker(const placido_elevation_maker *maker) {
  struct builder builder = builder_new();
  put_real(&builder, "k1_D", maker->k_D[0]);
  put_real(&builder, "k1_axis_deg", maker->axis_deg[0]);
  put_real(&builder, "k2_D", maker->k_D[1]);
  put_real(&builder, "k2_axis_deg", maker->axis_deg[1]);
  put_real(&builder, "corneal_diameter_mm", maker->corneal_diameter_mm);
  put_real(&builder, "pupil_diameter_mm", maker->pupil_diameter_mm);
  put_real(&builder, "pupil_radius_of_curvature_mm", maker->pupil_radius_mm);
  put_text(&builder, "eye_flag", maker->eye_flag);
  return builder;
}

/* What others measured, and how well the surface follows it. */
static struct builder build_heights(const struct examination *examination) {
  struct builder builder = builder_new();
  const placido_elevation *elevation = &examination->elevation;
  const placido_heights_summary *fitted = &examination->heights;
  put_text(&builder, "kind", elevation->kind);
  put_integer(&builder, "points", (long long)fitted->count);
  put_integer(&builder, "missing", (long long)elevation->missing);
  put_real(&builder, "spacing_mm", fitted->spacing_mm);
  put_real(&builder, "rms_um", fitted->rms_um);
  put_real(&builder, "sigma_um", fitted->sigma_um);
  put_real(&builder, "worst_um", fitted->worst_um);
  put_integer(&builder, "worst_line", elevation->lines[fitted->worst]);
  put_real(&builder, "correlation", fitted->correlation);
  if (elevation->ring_count > 0) {
    put_object(&builder, "maker", build_maker(&elevation->maker));
  }
  return builder;
}

static void put_lens(struct builder *builder, const struct prescription *lens) {
  put_real(builder, "sphere_D", lens->sphere_D);
  put_real(builder, "cylinder_D", lens->cylinder_D);
  put_real(builder, "axis_deg", lens->axis_deg);
}

/* logMAR by test; null where it lies beyond. */
static struct builder build_acuity(const struct acuity_view *view) {
  struct builder builder = builder_new();
  for (size_t i = 0; i < view->count; i++) {
    put_real(&builder, view->items[i].test->name, view->items[i].logmar);
  }
  return builder;
}

static struct builder build_pupil(const struct view *view, const struct settings *settings) {
  struct builder builder = builder_new(), glasses = builder_new();
  const struct prescription cornea = prescription_cornea(&view->psf.correction);
  const struct prescription spectacles =
      prescription_spectacles(settings, &view->psf.correction);
  put_real(&builder, "pupil_mm", view->psf.pupil_mm);
  put_text(&builder, "directory", view->directory);
  put(&builder, "automatic", json_boolean(view->automatic));
  put_real(&builder, "strehl_g", view->psf.strehl_g);
  put_real(&builder, "strehl_g_sigma", view->strehl_g_sigma);
  put_lens(&builder, &cornea);
  put_real(&glasses, "vertex_mm", spectacles.vertex_mm);
  put_lens(&glasses, &spectacles);
  put_object(&builder, "spectacles", glasses);
  put_real(&builder, "retina_mm", view->psf.retina_mm);
  put_integer(&builder, "rays_entered", view->psf.rays_entered);
  put_integer(&builder, "rays_landed", view->psf.rays_landed);
  put_integer(&builder, "rays_missed", view->psf.rays_missed);
  if (view->acuity.count > 0) {
    put_object(&builder, "logmar", build_acuity(&view->acuity));
    put_integer(&builder, "ghosts", view->acuity.ghosts.count);
  }
  return builder;
}

static struct builder build_seconds(const struct examination *examination) {
  struct builder builder = builder_new();
  const struct stages *stages = &examination->outcome->stages;
  const size_t running = stages->ended || stages->count == 0 ? 0 : 1;
  for (size_t i = 0; i < stages->count - running; i++) {
    put_real(&builder, stages->items[i].name, stages->items[i].seconds);
  }
  put_real(&builder, "total", stages->total);
  return builder;
}

static void put_views(struct builder *builder, const struct views *views,
                      const struct settings *settings) {
  json_t *pupils = json_array();
  for (size_t i = 0; i < views->count; i++) {
    const struct builder pupil = build_pupil(&views->items[i], settings);
    builder->failed = builder->failed || pupil.failed;
    append(builder, pupils, pupil.object);
  }
  put(builder, "pupils", pupils);
}

static void put_warnings(struct builder *builder, const placido_notes *notes) {
  json_t *warnings = json_array();
  for (size_t i = 0; i < notes->count; i++) {
    append(builder, warnings, record_text(notes->lines[i]));
  }
  put(builder, "warnings", warnings);
}

static struct builder build_record(const struct examination *examination) {
  struct builder builder = builder_new();
  put_text(&builder, "format", examination->recipe->format);
  put_text(&builder, "software", PROGRAM_VERSION);
  put_text(&builder, "created", examination->created);
  put_object(&builder, "input", build_input(examination));
  put_object(&builder, "settings", build_settings(examination));
  if (examination->promise.made) {
    put(&builder, "accuracy", promise_json(examination));
  }
  if (examination->elevation.count > 0) {
    put_object(&builder, "heights", build_heights(examination));
  }
  if (examination->frame.data) {
    put_object(&builder, "capture", build_capture(examination));
  }
  if (examination->fit) {
    put_object(&builder, "fit", build_fit(examination));
    put(&builder, "condition", conditions_json(&examination->conditions));
    put_object(&builder, "maps", build_maps(&examination->maps));
  }
  if (examination->views.scene_count > 0) {
    put_views(&builder, &examination->views, examination->settings);
  }
  put_object(&builder, "seconds", build_seconds(examination));
  put_warnings(&builder, &examination->outcome->notes);
  return builder;
}

int record_save(const struct examination *examination, const char *path, placido_error *err) {
  struct builder builder = build_record(examination);
  int status = PLACIDO_MEMORY;
  if (builder.failed) {
    placido_error_set(err, status, "out of memory while writing %s", path);
  } else {
    status = placido_json_save(builder.object, path, err);
  }
  json_decref(builder.object);
  return status;
}

static struct builder build_index(const placido_index_value *index) {
  struct builder builder = builder_new();
  put_text(&builder, "name", index->name);
  put_text(&builder, "unit", index->unit);
  put_real(&builder, "value", index->value);
  put_real(&builder, "sigma", index->sigma);
  return builder;
}

json_t *record_result(const struct examination *examination) {
  struct builder builder = build_record(examination);
  put_text(&builder, "directory", examination->settings->output);
  if (examination->fit) {
    json_t *indices = json_array();
    for (size_t i = 0; i < examination->index_count; i++) {
      append(&builder, indices, build_index(&examination->indices[i]).object);
    }
    put(&builder, "indices", indices);
  }
  if (builder.failed) {
    json_decref(builder.object);
    return NULL;
  }
  return builder.object;
}

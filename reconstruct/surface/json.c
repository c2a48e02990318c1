/* Surface files: `placido-surface/1` read and written. */
#include "base/json.h"

#include "base/memory.h"
#include "reconstruct/surface/coverage.h"
#include "reconstruct/surface/surface.h"

#include <math.h>
#include <stdio.h>

#define FORMAT "placido-surface/1"
#define RADIUS_MM 4.5 /* where a file names none */

static const char *const keys[] = {"format",   "vertex_z_mm", "radius_mm", "parts",
                                   "coverage", "covariance",  NULL};

/* What a file holds, on its way to placido_surface_new, which copies it. */
struct content {
  double vertex_z_mm, radius_mm;
  size_t part_count;
  placido_part *parts;
  void **storage; /* of each part's arrays */
  placido_coverage coverage;
  unsigned char *mask;
};

static int read_optional(const placido_json *json, const char *path, double fallback, double *value,
                         placido_error *err) {
  *value = fallback;
  return placido_json_find(json, path) ? placido_json_number(json, path, value, err) : PLACIDO_OK;
}

static int read_frame(struct content *content, const placido_json *json, placido_error *err) {
  int status = read_optional(json, "vertex_z_mm", 0, &content->vertex_z_mm, err);
  if (status || (status = read_optional(json, "radius_mm", RADIUS_MM, &content->radius_mm, err))) {
    return status;
  }
  if (fabs(content->vertex_z_mm) > 1000) {
    return placido_json_refuse(json, "vertex_z_mm", err, "is %g, -1000 to 1000 is expected",
                               content->vertex_z_mm);
  }
  if (content->radius_mm <= 0 || content->radius_mm > PLACIDO_SURFACE_RADIUS_MAX_MM) {
    return placido_json_refuse(json, "radius_mm", err, "is %g, more than 0, at most %g is expected",
                               content->radius_mm, PLACIDO_SURFACE_RADIUS_MAX_MM);
  }
  return PLACIDO_OK;
}

static int read_parts(struct content *content, const placido_json *json, placido_notes *notes,
                      placido_error *err) {
  size_t count;
  int status = placido_json_count(json, "parts", &count, err);
  if (status) {
    return status;
  }
  if (!json_is_array(placido_json_find(json, "parts")) || count < 1 ||
      count > PLACIDO_SURFACE_PARTS_MAX) {
    return placido_json_refuse(json, "parts", err, "an array of 1 to %d parts is expected",
                               PLACIDO_SURFACE_PARTS_MAX);
  }
  content->parts = placido_memory_new(count, sizeof *content->parts, err);
  content->storage = placido_memory_new(count, sizeof *content->storage, err);
  if (!content->parts || !content->storage) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count && !status; i++) {
    char path[32];
    snprintf(path, sizeof path, "parts[%zu]", i);
    content->part_count = i + 1;
    status = placido_part_read(&content->parts[i], &content->storage[i], json, path, notes, err);
  }
  return status;
}

static void free_content(struct content *content) {
  for (size_t i = 0; i < content->part_count; i++) {
    placido_memory_free(content->storage[i]);
  }
  placido_memory_free(content->parts);
  placido_memory_free(content->storage);
  placido_memory_free(content->mask);
}

int placido_surface_load(placido_surface **surface, const char *path, placido_notes *notes,
                         placido_error *err) {
  *surface = NULL;
  struct content content = {0};
  placido_json *json = NULL;
  int status = placido_json_load(&json, path, FORMAT, err);
  if (status || (status = read_frame(&content, json, err)) ||
      (status = read_parts(&content, json, notes, err))) {
    goto done;
  }
  bool covered = placido_json_find(json, "coverage") != NULL;
  if (covered) {
    status = placido_coverage_read(&content.coverage, &content.mask, content.radius_mm, json, notes,
                                   err);
  }
  if (!status) {
    placido_json_warn_unknown(json, "", keys, notes);
    status = placido_surface_new(surface, content.vertex_z_mm, content.radius_mm, content.parts,
                                 content.part_count, covered ? &content.coverage : NULL, err);
  }
done:
  free_content(&content);
  placido_json_free(json);
  return status;
}

static json_t *write_parts(const placido_surface *surface) {
  json_t *list = json_array();
  for (size_t i = 0; i < surface->term_count; i++) {
    if (json_array_append_new(list, placido_part_write(&surface->terms[i].part))) {
      json_decref(list);
      return NULL;
    }
  }
  return list;
}

int placido_surface_save(const placido_surface *surface, const char *path, placido_error *err) {
  json_t *root = json_object();
  int failed = json_object_set_new(root, "format", json_string(FORMAT)) ||
               json_object_set_new(root, "vertex_z_mm", placido_json_real(surface->vertex_z_mm)) ||
               json_object_set_new(root, "radius_mm", placido_json_real(surface->radius_mm)) ||
               json_object_set_new(root, "parts", write_parts(surface));
  if (!failed && surface->has_coverage) {
    failed = json_object_set_new(root, "coverage", placido_coverage_write(&surface->coverage, err));
  }
  int status = failed ? placido_error_set(err, PLACIDO_MEMORY, "out of memory writing a surface")
                      : placido_json_save(root, path, err);
  json_decref(root);
  return status;
}

/* Which objects are measured: those of the phantom, or images with what they show. */
#include "acquire/cli/iso_check.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Spheres as ISO 10343 asks for its own check (below 6.8, 7.5 to 8.1, above 9.1 mm), a toric of
 * 3 D, and ellipsoids: one of a normal cornea's kind, one steeper, and one with three axes of 8.7,
 * 9 and 10 mm (Halstead, Barsky, Klein and Mandell, SPIE 3246 (1998)). */
static const struct {
  const char *name;
  double r1_mm, q1, r2_mm, q2, axis_deg;
  bool toric, aspheric, quick;
} phantoms[] = {
    {"sphere 6.5 mm", 6.5, 0, 6.5, 0, 0, false, false, false},
    {"sphere 7.8 mm", 7.8, 0, 7.8, 0, 0, false, false, true},
    {"sphere 9.4 mm", 9.4, 0, 9.4, 0, 0, false, false, false},
    {"toric 7.8 mm, 3 D", 337.5 / 41.77, 0, 337.5 / 44.77, 0, 25, true, false, true},
    {"ellipsoid 7.8 mm, Q -0.26", 7.8, -0.26, 7.8, -0.26, 0, false, true, false},
    {"ellipsoid 7.3 mm, Q -0.5", 7.3, -0.5, 7.3, -0.5, 0, false, true, true},
    {"ellipsoid 8.7 9 10 mm", 7.569, 0.7569 - 1, 8.1, 0.81 - 1, 10, true, true, false},
};

#define TRUTH_RADIUS_MM 5.5 /* beyond what the instruments see */

static int make_conic(placido_surface **surface, double r1_mm, double q1, double r2_mm, double q2,
                      double axis_deg, placido_error *err) {
  const placido_part part = {.kind = PLACIDO_PART_BICONIC,
                             .as.biconic = {r1_mm, q1, r2_mm, q2, axis_deg, 0, 0}};
  const double equator_mm = fmin(r1_mm / sqrt(fmax(1 + q1, 0.1)), r2_mm / sqrt(fmax(1 + q2, 0.1)));
  return placido_surface_new(surface, 0, fmin(TRUTH_RADIUS_MM, 0.95 * equator_mm), &part, 1, NULL,
                             err);
}

static int list_phantoms(struct iso_objects *objects, bool quick, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < sizeof phantoms / sizeof phantoms[0] && status == PLACIDO_OK; i++) {
    if (quick && !phantoms[i].quick) {
      continue;
    }
    struct iso_object *object = &objects->items[objects->count];
    *object = (struct iso_object){.toric = phantoms[i].toric, .aspheric = phantoms[i].aspheric};
    snprintf(object->name, sizeof object->name, "%s", phantoms[i].name);
    status = make_conic(&object->truth, phantoms[i].r1_mm, phantoms[i].q1, phantoms[i].r2_mm,
                        phantoms[i].q2, phantoms[i].axis_deg, err);
    objects->count += status == PLACIDO_OK;
  }
  return status;
}

/* A number is the radius of a sphere, anything else a surface file. */
static int make_object(struct iso_object *object, const char *what, placido_notes *notes,
                       placido_error *err) {
  char *end;
  const double radius_mm = strtod(what, &end);
  if (end == what || *end != '\0') {
    snprintf(object->name, sizeof object->name, "%s", placido_text_tail(what));
    object->toric = object->aspheric = true;
    return placido_surface_load(&object->truth, what, notes, err);
  }
  if (!(radius_mm >= 4 && radius_mm <= 20)) {
    return placido_error_set(err, PLACIDO_INPUT, "a sphere of %s mm, expected 4 to 20", what);
  }
  snprintf(object->name, sizeof object->name, "sphere %g mm", radius_mm);
  return make_conic(&object->truth, radius_mm, 0, radius_mm, 0, 0, err);
}

static int add_object(struct iso_objects *objects, const char *image, const char *what,
                      double axis_z_mm, placido_notes *notes, placido_error *err) {
  if (objects->count == ISO_OBJECTS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "more than %d objects", ISO_OBJECTS_MAX);
  }
  struct iso_object *object = &objects->items[objects->count];
  *object = (struct iso_object){.axis_z_mm = axis_z_mm, .free_pose = true};
  const int length = snprintf(object->image, sizeof object->image, "%s", image);
  if (length >= (int)sizeof object->image) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: the path is too long",
                             placido_text_tail(image));
  }
  const int status = make_object(object, what, notes, err);
  objects->count += status == PLACIDO_OK;
  return status;
}

static int list_pairs(struct iso_objects *objects, const struct settings *settings,
                      placido_notes *notes, placido_error *err) {
  const struct text_list *images = &settings->iso_images, *known = &settings->iso_objects;
  const struct number_list *heights = &settings->iso_axis_z_mm;
  if (images->count != known->count) {
    return placido_error_set(err, STATUS_USAGE,
                             "%zu --image and %zu --sphere or --surface: one of these each",
                             images->count, known->count);
  }
  if (heights->count > 1 && heights->count != images->count) {
    return placido_error_set(err, STATUS_USAGE, "--axis-z: %zu values for %zu images, expected "
                             "one for all or one each", heights->count, images->count);
  }
  int status = PLACIDO_OK;
  for (size_t i = 0; i < images->count && status == PLACIDO_OK; i++) {
    const double z = heights->count == 0   ? (double)NAN
                     : heights->count == 1 ? heights->values[0]
                                           : heights->values[i];
    status = add_object(objects, images->values[i], known->values[i], z, notes, err);
  }
  return status;
}

/* `word` as it stands where it is a number or a whole path, else beside the list. */
static int beside(char path[PLACIDO_PATH_MAX], const char *list, const char *word,
                  placido_error *err) {
  char *end;
  strtod(word, &end);
  const char *slash = strrchr(list, '/');
  const bool number = end != word && *end == '\0';
  const int folder = slash && !number && word[0] != '/' ? (int)(slash - list) + 1 : 0;
  const int length = snprintf(path, PLACIDO_PATH_MAX, "%.*s%s", folder, list, word);
  return length < PLACIDO_PATH_MAX ? PLACIDO_OK
                                   : placido_error_set(err, PLACIDO_INPUT,
                                                       "%s: the path is too long",
                                                       placido_text_tail(word));
}

/* "image,object[,axis_z_mm]"; empty lines and those that begin with # say nothing. */
static int read_line(struct iso_objects *objects, const char *list, int number, char *line,
                     placido_notes *notes, placido_error *err) {
  line[strcspn(line, "\r\n")] = '\0';
  if (line[0] == '\0' || line[0] == '#') {
    return PLACIDO_OK;
  }
  char *object = strchr(line, ','), *height = object ? strchr(object + 1, ',') : NULL, *end = NULL;
  double axis_z_mm = NAN;
  if (object) {
    *object++ = '\0';
  }
  if (height) {
    *height++ = '\0';
    axis_z_mm = strtod(height, &end);
  }
  if (!object || (height && (end == height || *end != '\0' || !isfinite(axis_z_mm)))) {
    return placido_error_set(err, PLACIDO_INPUT, "%s:%d: expected image,object[,axis_z_mm]",
                             placido_text_tail(list), number);
  }
  char image[PLACIDO_PATH_MAX], known[PLACIDO_PATH_MAX];
  int status = beside(image, list, line, err);
  if (status == PLACIDO_OK) {
    status = beside(known, list, object, err);
  }
  return status == PLACIDO_OK ? add_object(objects, image, known, axis_z_mm, notes, err) : status;
}

#define LIST_MAX_BYTES (1u << 20)

static int read_list(struct iso_objects *objects, const char *path, placido_notes *notes,
                     placido_error *err) {
  char *text = NULL, *rest = NULL;
  size_t size;
  int number = 0, status = placido_file_read(&text, &size, path, LIST_MAX_BYTES, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (char *line = text; line && status == PLACIDO_OK; line = rest) {
    rest = strchr(line, '\n');
    if (rest) {
      *rest++ = '\0';
    }
    status = read_line(objects, path, ++number, line, notes, err);
  }
  placido_memory_free(text);
  return status;
}

int iso_objects_list(struct iso_objects *objects, const struct settings *settings,
                     placido_notes *notes, placido_error *err) {
  *objects = (struct iso_objects){0};
  const bool images = settings->iso_images.count > 0 || settings->iso_objects.count > 0;
  int status = PLACIDO_OK;
  if (images) {
    status = list_pairs(objects, settings, notes, err);
  }
  if (status == PLACIDO_OK && settings->iso_list) {
    status = read_list(objects, settings->iso_list, notes, err);
  }
  if (status == PLACIDO_OK && !images && !settings->iso_list) {
    status = list_phantoms(objects, settings->quick, err);
  }
  if (status == PLACIDO_OK && objects->count == 0) {
    status = placido_error_set(err, PLACIDO_INPUT, "%s names no object", settings->iso_list);
  }
  if (status != PLACIDO_OK) {
    iso_objects_free(objects);
  }
  return status;
}

void iso_objects_free(struct iso_objects *objects) {
  for (size_t i = 0; i < objects->count; i++) {
    placido_surface_free(objects->items[i].truth);
  }
  objects->count = 0;
}

/* The options about the eye behind the cornea. */
#include "acquire/cli/eye_settings.h"

#include "acquire/cli/settings.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))
#define LENS_MAX_D 40.0
#define VERTEX_MAX_MM 30.0

static const double usual_vertex_mm = 12.0;

/* Sphere, cylinder and axis at the vertex distance into a lens on the cornea. */
static int take_lens(struct worn_lens *lens, const struct option_row *row, const char *text,
                     const double parts[3], double vertex_mm, placido_error *err) {
  const double sphere = parts[0], cylinder = parts[1];
  if (fabs(sphere) > LENS_MAX_D || fabs(cylinder) > LENS_MAX_D ||
      fabs(sphere + 0.5 * cylinder) > LENS_MAX_D) {
    return placido_error_set(err, STATUS_USAGE,
                             "--%s %s: sphere, cylinder and their mean sphere range from -%g to "
                             "%g D",
                             row->name, text, LENS_MAX_D, LENS_MAX_D);
  }
  const placido_correction worn = placido_correction_of(sphere, cylinder, parts[2]);
  *lens = (struct worn_lens){.given = true, .vertex_mm = vertex_mm};
  placido_error reason = {0};
  if (placido_correction_move(&lens->power, &worn, vertex_mm, &reason) != PLACIDO_OK) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: %s", row->name, text, reason.text);
  }
  return PLACIDO_OK;
}

static int parse_lens(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  struct number_list list;
  const int status = parse_tuple(&list, row, text, 3, 3, err);
  return status == PLACIDO_OK ? take_lens(field, row, text, list.values, 0, err) : status;
}

/* A number behind blanks or one comma; false where there is none. */
static bool read_part(const char **text, double *value) {
  const char *at = *text + strspn(*text, " \t");
  at += *at == ',';
  char *end;
  errno = 0;
  *value = strtod(at, &end);
  *text = end;
  return end != at && errno != ERANGE && isfinite(*value);
}

/* "S", "S C AXIS", either with "@MM" behind it. */
static int parse_worn(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  double parts[3] = {0.0, 0.0, 0.0}, vertex_mm = 0.0;
  size_t count = 0;
  const char *next = text;
  bool understood = true, at_cornea = true;
  while (understood && *(next += strspn(next, " \t")) != '\0') {
    if (*next == '@') {
      next++;
      understood = at_cornea && count > 0 && read_part(&next, &vertex_mm);
      at_cornea = false;
    } else {
      understood = at_cornea && count < COUNT(parts) && read_part(&next, &parts[count++]);
    }
  }
  if (!understood || (count != 1 && count != COUNT(parts))) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: a sphere, or sphere, cylinder and axis, "
                             "were expected, like \"-2.5 -0.75 90 @12\"", row->name, text);
  }
  if (vertex_mm < 0.0 || vertex_mm > VERTEX_MAX_MM || fabs(parts[2]) > 180.0) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: the axis ranges from -180 to 180 degrees, "
                             "the distance from 0 to %g mm", row->name, text, VERTEX_MAX_MM);
  }
  return take_lens(field, row, text, parts, vertex_mm, err);
}

static int parse_correct(void *field, const struct option_row *row, const char *text,
                         placido_error *err) {
  static const char *const names[] = {[PLACIDO_CORRECT_NONE] = "none",
                                      [PLACIDO_CORRECT_FULL] = "full",
                                      [PLACIDO_CORRECT_SPHERE] = "sphere"};
  for (size_t i = 0; i < COUNT(names); i++) {
    if (strcmp(text, names[i]) == 0) {
      *(struct asked_correction *)field = (struct asked_correction){true, (enum placido_correct)i};
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE, "--%s %s: sphere, full or none was expected",
                           row->name, text);
}

static const struct option_row eye_rows[] = {
    {"retina", 0, "MM", "Distance of the retina from the cornea in this eye without a crystalline "
     "lens, mm (default: searched for the best focus).", FIELD(retina_mm), parse_number, 5, 200},
    {"axial-length", 0, "MM", "Length of the eye from cornea to retina, mm: the retina then stands "
     "where it does for an average lens at rest. Not with --retina.", FIELD(behind.axial_mm),
     parse_number, 18, 36},
    {"correct", 0, "full|sphere|none", "What is searched for the best focus: sphere, cylinder and "
     "axis; the sphere alone; nothing, for which the retina must be known (default: full; with "
     "--wear sphere, or none where the retina is known). The sphere is the retina's distance where "
     "that is not known, else the lens's.", FIELD(behind.correct), parse_correct, 0, 0},
    {"wear", 0, "\"S C AXIS @MM\"", "The lens worn: sphere, cylinder (dioptres) and axis (degrees), "
     "and how many mm before the cornea (default 0); \"S @MM\" without a cylinder.",
     FIELD(behind.lens), parse_worn, 0, 0},
    {"correction", 0, "S,C,AXIS", "The same on the cornea.", FIELD(behind.lens), parse_lens, -180,
     180},
    {"vertex", 0, "MM", "Distance of the spectacles for which the lens is also given, mm before the "
     "cornea (default: that of --wear, else 12).", FIELD(behind.vertex_mm), parse_number, 1,
     VERTEX_MAX_MM},
};

const struct option_group options_eye = {"Eye", eye_rows, COUNT(eye_rows)};

static bool retina_known(const struct settings *settings) {
  return settings->retina_mm > 0.0 || settings->behind.axial_mm > 0.0;
}

int eye_settings_check(const struct settings *settings, placido_error *err) {
  const struct eye_settings *behind = &settings->behind;
  if (settings->retina_mm > 0.0 && behind->axial_mm > 0.0) {
    return placido_error_set(err, STATUS_USAGE,
                             "--retina and --axial-length both say where the retina is: leave one "
                             "out");
  }
  if (!behind->correct.given) {
    return PLACIDO_OK;
  }
  if (behind->correct.what == PLACIDO_CORRECT_FULL && behind->lens.given) {
    return placido_error_set(err, STATUS_USAGE,
                             "--correct full searches the lens: leave --wear out, or keep its "
                             "cylinder with --correct sphere");
  }
  if (behind->correct.what == PLACIDO_CORRECT_NONE && !retina_known(settings)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--correct none: a cornea alone does not tell where the retina is; "
                             "give --retina or --axial-length");
  }
  return PLACIDO_OK;
}

int eye_settings_read(placido_eye *eye, const struct settings *settings, double pupil_mm,
                      placido_error *err) {
  const struct eye_settings *behind = &settings->behind;
  const enum placido_correct with_lens =
      retina_known(settings) ? PLACIDO_CORRECT_NONE : PLACIDO_CORRECT_SPHERE;
  const enum placido_correct usual = behind->lens.given ? with_lens : PLACIDO_CORRECT_FULL;
  *eye = (placido_eye){.pupil_mm = pupil_mm,
                       .index = settings->index,
                       .retina_mm = settings->retina_mm,
                       .correct = behind->correct.given ? behind->correct.what : usual,
                       .correction = behind->lens.power,
                       .age_years = settings->plan.age_years,
                       .iris = settings->plan.iris};
  if (behind->axial_mm == 0.0) {
    return PLACIDO_OK;
  }
  const double index = settings->index > 0.0 ? settings->index : PLACIDO_EYE_INDEX;
  return placido_eye_retina_of_length(&eye->retina_mm, behind->axial_mm, index, err);
}

struct prescription prescription_cornea(const placido_correction *correction) {
  struct prescription lens = {.vertex_mm = 0.0};
  placido_correction_clinical(correction, &lens.sphere_D, &lens.cylinder_D, &lens.axis_deg);
  return lens;
}

struct prescription prescription_spectacles(const struct settings *settings,
                                            const placido_correction *correction) {
  const struct eye_settings *behind = &settings->behind;
  const double worn_mm = behind->lens.vertex_mm > 0.0 ? behind->lens.vertex_mm : usual_vertex_mm;
  const double vertex_mm = behind->vertex_mm > 0.0 ? behind->vertex_mm : worn_mm;
  placido_correction moved;
  placido_correction_move(&moved, correction, -vertex_mm, NULL); /* NaN where there is none */
  struct prescription lens = prescription_cornea(&moved);
  lens.vertex_mm = vertex_mm;
  return lens;
}

/* The options of `placido import` and `placido export`. */
#include "acquire/cli/exchange_settings.h"

#include "acquire/cli/settings.h"
#include "acquire/cli/subject_id.h"

#include <stddef.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, exchange.name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

/* A unit at the beginning of `text`; NULL where there is none, else what follows it. */
static const char *read_unit(double *mm, const char *text) {
  static const struct {
    const char *name;
    double mm;
  } units[] = {{"mm", 1.0}, {"um", 1e-3}};
  for (size_t i = 0; i < COUNT(units); i++) {
    if (strncmp(text, units[i].name, 2) == 0) {
      *mm = units[i].mm;
      return text + 2;
    }
  }
  return NULL;
}

static int parse_unit(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  placido_elevation_options *reading = field;
  const char *rest = read_unit(&reading->xy_mm, text);
  reading->z_mm = reading->xy_mm;
  if (rest && *rest == ',') {
    rest = read_unit(&reading->z_mm, rest + 1);
  }
  if (!rest || *rest) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: mm, um, or both like mm,um (across, "
                             "heights) was expected", row->name, text);
  }
  return PLACIDO_OK;
}

static int parse_sign(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  placido_elevation_options *reading = field;
  if (strcmp(text, "up") != 0 && strcmp(text, "down") != 0) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: up (towards the camera) or down (into "
                             "the eye) was expected", row->name, text);
  }
  reading->sign = strcmp(text, "up") == 0 ? PLACIDO_HEIGHT_UP : PLACIDO_HEIGHT_DOWN;
  return PLACIDO_OK;
}

static const struct option_row import_rows[] = {
    {"output", 'o', "DIR", "Directory to write. It appears whole or not at all; an earlier result "
     "of the same command is replaced, anything else is not touched.",
     offsetof(struct settings, output), parse_text, 0, 0},
    {"unit", 0, "UNIT[,UNIT]", "Unit of a table whose header names none: mm or um, of x and y and "
     "of heights (default mm).", FIELD(reading), parse_unit, 0, 0},
    {"heights", 0, "up|down", "Whether heights grow towards the camera or into the eye (default: "
     "whichever makes the cornea bulge towards the camera).", FIELD(reading), parse_sign, 0, 0},
    {"eye", 0, "OD|OS", "Which eye it is, where the file does not say.", FIELD(eye), parse_eye, 0,
     0},
    {"knots", 0, "MM", "Knot spacing of the surface's spline, mm (default: 0.5, or finer where the "
     "residuals ask for it).", offsetof(struct settings, knot_mm), parse_number, 0.15, 2},
    {"timing", 0, NULL, "Print the wall time of every stage.", offsetof(struct settings, timing),
     parse_switch, 0, 0},
};

static const struct option_row export_rows[] = {
    {"zernike", 0, "FILE", "OSA/ANSI Zernike terms of the sag: a .json or a .csv.", FIELD(zernike),
     parse_text, 0, 0},
    {"radius", 0, "MM", "Radius of the disc of the Zernike terms, mm (default 3, or less where "
     "data end).", FIELD(radius_mm), parse_number, 0.1, 20},
    {"order", 0, "N", "Highest order of the Zernike terms (default 8).", FIELD(order),
     parse_integer, 1, 15},
    {"stl", 0, "FILE", "A mesh of triangles, binary STL in mm.", FIELD(stl), parse_text, 0, 0},
    {"ply", 0, "FILE", "A mesh coloured by axial power, binary PLY in mm.", FIELD(ply), parse_text,
     0, 0},
    {"solid", 0, "MM", "Close the mesh: walls down to a flat bottom so far below its lowest point, "
     "mm (default: an open surface).", FIELD(solid_mm), parse_number, 0.01, 100},
    {"csv", 0, "FILE", "Heights on a square grid: x_mm, y_mm, z_mm, empty where data do not "
     "support one.", FIELD(csv), parse_text, 0, 0},
    {"step", 0, "MM", "Spacing of grid and mesh, mm (default 0.1).", FIELD(step_mm), parse_number,
     0.01, 1},
    {"dicom", 0, "FILE", "A DICOM Corneal Topography Map of axial power (by DCMTK's dump2dcm).",
     FIELD(dicom), parse_text, 0, 0},
    {"eye", 0, "OD|OS", "Which eye it is, for DICOM (default: what the exam recorded).",
     FIELD(eye), parse_eye, 0, 0},
    {"subject", 0, "ID", "Patient ID for DICOM, an opaque one (default: ANONYMOUS).",
     FIELD(subject), parse_subject, 0, 0},
    {"uid-seed", 0, "TEXT", "Make DICOM's unique identifiers from this text instead of chance: the "
     "same text, the same identifiers.", FIELD(uid_seed), parse_text, 0, 0},
};

const struct option_group options_import = {"Import", import_rows, COUNT(import_rows)};
const struct option_group options_export = {"Export", export_rows, COUNT(export_rows)};

/* The options of `placido iso-check`. */
#include "acquire/cli/settings.h"

#include <stddef.h>
#include <stdlib.h>

#define FIELD(name) offsetof(struct settings, name)

/* A radius among the objects: a number, so that no file is meant. */
static int parse_sphere(void *field, const struct option_row *row, const char *text,
                        placido_error *err) {
  double radius_mm;
  const int status = parse_number(&radius_mm, row, text, err);
  return status == PLACIDO_OK ? parse_text_more(field, row, text, err) : status;
}

static const struct option_row rows[] = {
    {"output", 'o', "DIR", "Directory to write: iso-check.html, iso-check.csv and iso-check.json. "
     "It appears whole or not at all; an earlier result is replaced (default: only a table is "
     "printed).", FIELD(output), parse_text, 0, 0},
    {"quick", 0, NULL, "Fewer objects.", FIELD(quick), parse_switch, 0, 0},
    {"instrument", 0, "NAME|FILE", "The topographer's geometry: a file, or for the phantom a "
     "built-in one (default cone24).", FIELD(instrument), parse_text, 0, 0},
    {"image", 0, "FILE", "Picture or session of a real object, in place of the phantom's. May be "
     "given several times, each with the object it shows.", FIELD(iso_images), parse_text_more, 0,
     0},
    {"sphere", 0, "MM", "The object is a sphere of this radius.", FIELD(iso_objects), parse_sphere,
     4, 20},
    {"surface", 0, "FILE", "The object is this surface (placido-surface/1); it is shifted, not "
     "turned, to where it fits the measurement best.", FIELD(iso_objects), parse_text_more, 0, 0},
    {"list", 0, "FILE.csv", "Images and objects, a line each: image,object[,axis_z_mm], the object "
     "a radius or a surface file.", FIELD(iso_list), parse_text, 0, 0},
    {"axis-z", 0, "Z,...", "z of the objects on the instrument's axis, mm: one for all, or one "
     "each (default: what a session recorded, else 0).", FIELD(iso_axis_z_mm), parse_numbers, -100,
     100},
    {"knots", 0, "MM", "Knot spacing of the surface's spline, mm (default: 0.5, or finer where the "
     "residuals ask for it).", FIELD(knot_mm), parse_number, 0.15, 2},
    {"meridians", 0, "N", "Meridians along which edges are measured (default 360).",
     FIELD(meridians), parse_integer, 24, 1440},
};

const struct option_group options_iso = {"Accuracy test", rows, sizeof rows / sizeof rows[0]};

/* The options of maps and of their comparison. */
#include "acquire/cli/settings.h"

#include <stddef.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

/* In the order of enum placido_scale_mode. */
static const char *const scales[] = {"fixed", "absolute", "adaptive"};

static int parse_scale(void *field, const struct option_row *row, const char *text,
                       placido_error *err) {
  for (size_t k = 0; k < COUNT(scales); k++) {
    if (strcmp(text, scales[k]) == 0) {
      *(int *)field = (int)k;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE, "--%s %s: fixed, absolute or adaptive was expected",
                           row->name, text);
}

static const struct option_row map_rows[] = {
    {"zone", 0, "MM",
     "Diameter of the zone that elevation's sphere, conicoid and toric conicoid "
     "are fitted to, mm (default 8).",
     FIELD(maps.zone_mm), parse_number, 1, 20},
    {"scale", 0, "NAME",
     "Colours of the maps' pictures: fixed (ISO 19980's steps about one value, "
     "the smallest that holds the map), absolute (the same for every eye) or adaptive (about the "
     "map's own middle). Default fixed.",
     FIELD(maps.scale), parse_scale, 0, 0},
};

static const struct option_row compare_rows[] = {
    {"mirror", 0, NULL, "Mirror the second exam, x to -x: a left eye against a right one.",
     FIELD(compare.mirror), parse_switch, 0, 0},
    {"no-align", 0, NULL,
     "Compare the corneas as they stood before the instrument, without "
     "moving the second onto the first.",
     FIELD(compare.no_align), parse_switch, 0, 0},
};

const struct option_group options_maps = {"Maps", map_rows, COUNT(map_rows)};
const struct option_group options_compare = {"Comparison", compare_rows, COUNT(compare_rows)};

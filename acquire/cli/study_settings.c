/* The options of `placido study`. */
#include "acquire/cli/settings.h"

#include <stddef.h>

#define FIELD(name) offsetof(struct settings, name)

static const struct option_row rows[] = {
    {"output", 'o', "DIR", "Directory to write: study.html, study.csv, study.json and a folder of "
     "pictures for every eye. It appears whole or not at all; an earlier study is replaced.",
     FIELD(output), parse_text, 0, 0},
    {"pupils", 0, "MM,MM,...", "Diameters of the pupil, mm (default 2,4,8).", FIELD(pupils_mm),
     parse_numbers, 0.1, 12},
    {"scenes", 0, "NAME|FILE,...", "What is looked at: charts by name, placido-scene/1 files "
     "(default tumbling-e,fan,building; with --quick tumbling-e).", FIELD(study_scenes), parse_text,
     0, 0},
    {"eyes", 0, "NAME,...", "Only these: of the folder by their file's name without .json, or any "
     "of the phantom's.", FIELD(study_eyes), parse_text, 0, 0},
    {"index", 0, "N", "Refractive index behind the cornea (default 1.3375).", FIELD(index),
     parse_number, 1.01, 2},
    {"cwhatuc", 0, NULL, "As the program CWhatUC did it: buckets of 2.5 µm, each called half a "
     "minute.", FIELD(cwhatuc), parse_switch, 0, 0},
    {"quick", 0, NULL, "Fewer rays, fewer trials of the observer, one chart.", FIELD(quick),
     parse_switch, 0, 0},
};

const struct option_group options_study = {"Study", rows, sizeof rows / sizeof rows[0]};

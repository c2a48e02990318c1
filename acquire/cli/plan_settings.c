/* The options about effects, and the wish that they amount to. */
#include "acquire/cli/plan_settings.h"

#include "acquire/cli/settings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FIELD(name) offsetof(struct settings, name)
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

int parse_pupils(void *field, const struct option_row *row, const char *text,
                 placido_error *err) {
  static const struct number_word automatic = {"auto", PUPIL_AUTO};
  return parse_tuple_or_word(field, row, text, 1, LIST_MAX, &automatic, err);
}

static void force_all(enum placido_force force[], enum placido_force how) {
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    force[i] = how;
  }
}

/* "on NAME", "off NAME", "off all": what stands later on the command line holds. */
static int parse_force(void *field, const struct option_row *row, const char *text,
                       placido_error *err) {
  enum placido_force *force = field;
  const char *name = strchr(text, ' ');
  const size_t length = name ? (size_t)(name - text) : strlen(text);
  const bool on = length == 2 && strncmp(text, "on", length) == 0;
  if (!on && !(length == 3 && strncmp(text, "off", length) == 0)) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: on or off was expected (%s)", row->name,
                             text, row->value);
  }
  if (!name || name[1] == '\0') {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: the name of an effect, or \"all\", is "
                             "missing", row->name, text);
  }
  const enum placido_force how = on ? PLACIDO_FORCE_ON : PLACIDO_FORCE_OFF;
  const int index = placido_effect_find(++name);
  if (strcmp(name, "all") == 0) {
    force_all(force, how);
  } else if (index >= 0) {
    force[index] = how;
  } else {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: there is no effect \"%s\" (placido help "
                             "plan lists them)", row->name, text, name);
  }
  return PLACIDO_OK;
}

static const char *const iris_names[] = {[PLACIDO_IRIS_BROWN] = "brown",
                                         [PLACIDO_IRIS_DARK] = "dark",
                                         [PLACIDO_IRIS_GREEN] = "green",
                                         [PLACIDO_IRIS_BLUE] = "blue"};

const char *plan_iris_name(enum placido_iris iris) { return iris_names[iris]; }

static int parse_iris(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  for (size_t i = 0; i < COUNT(iris_names); i++) {
    if (strcmp(text, iris_names[i]) == 0) {
      *(enum placido_iris *)field = (enum placido_iris)i;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, STATUS_USAGE, "--%s %s: brown, dark, green or blue was expected",
                           row->name, text);
}

static const struct option_row rows[] = {
    {"tolerance", 0, "SHARE", "Largest error of a picture, in linear light relative to white, that "
     "leaving effects out may cause (default: the scene's, 0.01).", FIELD(plan.tolerance),
     parse_number, 1e-6, 1},
    {"force", 0, "on|off NAME", "Has an effect run, or left out, whatever it is worth; \"all\" are "
     "all of them. May be given several times; the later one holds. \"off all\" is the cornea "
     "alone, by rays, in one colour.", FIELD(plan.force), parse_force, 0, 0},
    {"age", 0, "YEARS", "Of the eye: pupil, accommodation, straylight (default 35).",
     FIELD(plan.age_years), parse_number, 5, 100},
    {"iris", 0, "brown|dark|green|blue", "The less pigment, the more straylight (default brown).",
     FIELD(plan.iris), parse_iris, 0, 0},
};

const struct option_group options_effects = {"Effects", rows, COUNT(rows)};

static bool any_forced_on(const enum placido_force force[]) {
  for (size_t i = 0; i < PLACIDO_EFFECTS_MAX; i++) {
    if (force[i] == PLACIDO_FORCE_ON) {
      return true;
    }
  }
  return false;
}

int plan_settings_check(const struct settings *settings, placido_error *err) {
  const struct spread_settings *spread = &settings->spread;
  if (!settings->cwhatuc && (spread->doubles || spread->wisdom || spread->memory_MB > 0)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--%s is for --cwhatuc: plans choose how scenes are convolved",
                             spread->doubles ? "double" : spread->wisdom ? "wisdom" : "memory");
  }
  if (settings->cwhatuc && any_forced_on(settings->plan.force)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--cwhatuc knows the cornea alone: leave --force on out");
  }
  for (size_t i = 0; i < settings->pupils_mm.count && settings->cwhatuc; i++) {
    if (settings->pupils_mm.values[i] == PUPIL_AUTO) {
      return placido_error_set(err, STATUS_USAGE,
                               "--cwhatuc knows no pupil that follows the light: say --pupils in "
                               "mm");
    }
  }
  return PLACIDO_OK;
}

int plan_settings_check_scene(const struct number_list *pupils, const placido_scene *scene,
                              placido_error *err) {
  for (size_t i = 0; i < pupils->count; i++) {
    if (pupils->values[i] == PUPIL_AUTO && isnan(scene->conditions.luminance_cd_m2)) {
      return placido_error_set(err, STATUS_USAGE,
                               "scene %s: the pupil that it gives is not known, as its luminance "
                               "is not: say --pupils in mm, or luminance_cd_m2 in a scene file",
                               scene->name);
    }
  }
  return PLACIDO_OK;
}

placido_plan_wish plan_settings_read(const struct settings *settings, int threads) {
  placido_plan_wish wish = {.tolerance = settings->plan.tolerance,
                            .bucket_arcmin = settings->bucket_arcmin,
                            .threads = threads};
  memcpy(wish.force, settings->plan.force, sizeof wish.force);
  return wish;
}

double plan_settings_tolerance(const struct settings *settings, const placido_scene *scene) {
  const double asked = settings->plan.tolerance;
  return asked > 0.0 ? asked : scene->conditions.tolerance;
}

void plan_list_effects(void) {
  const char *name, *summary;
  puts("\nEffects");
  for (size_t i = 0; placido_effect_at(i, &name, &summary); i++) {
    printf("  %-23s %s\n", name, summary);
  }
}

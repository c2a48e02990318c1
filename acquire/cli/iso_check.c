/* `placido iso-check`: how accurately the instrument, or the whole chain on its phantom, measures
 * objects of known shape. */
#include "acquire/cli/iso_check.h"

#include "acquire/cli/command.h"
#include "acquire/cli/figures.h"
#include "acquire/cli/place.h"
#include "acquire/cli/subject.h"
#include "base/file.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define MARKER "iso-check.json"

struct work {
  const struct settings *settings;
  struct outcome *outcome;
  char created[32];
  placido_instrument instrument;
  struct iso_objects objects;
  placido_iso_result results[ISO_OBJECTS_MAX];
  size_t count, failed;
  placido_directory directory;
};

static int prepare(struct work *w, placido_error *err) {
  const time_t now = time(NULL);
  struct tm utc;
  if (!gmtime_r(&now, &utc) ||
      strftime(w->created, sizeof w->created, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    w->created[0] = '\0';
  }
  const struct settings *settings = w->settings;
  placido_notes *notes = &w->outcome->notes;
  int status = iso_objects_list(&w->objects, settings, notes, err);
  if (status == PLACIDO_OK && w->objects.items[0].image[0] != '\0' && !settings->instrument) {
    status = placido_error_set(err, STATUS_USAGE,
                               "give the topographer's geometry with --instrument FILE");
  }
  if (status == PLACIDO_OK) {
    status = subject_instrument(&w->instrument,
                                settings->instrument ? settings->instrument : "cone24", notes, err);
  }
  return status;
}

/* The phantom's instruments are what they say: that one of them is nominal is no warning. */
static int measure(struct work *w, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < w->objects.count && status == PLACIDO_OK; i++) {
    const struct iso_object *object = &w->objects.items[i];
    placido_iso_result *result = &w->results[i];
    placido_error reason = {0};
    stages_next(&w->outcome->stages, "%s", object->name);
    placido_notes *notes = object->image[0] != '\0' ? &w->outcome->notes : NULL;
    status = iso_object_check(result, object, &w->instrument, w->settings, (unsigned)i + 1, notes,
                              &reason);
    if (status == PLACIDO_QUALITY) {
      snprintf(result->failure, sizeof result->failure, "%s", reason.text);
      result->passed = false;
      status = PLACIDO_OK;
    } else if (status != PLACIDO_OK) {
      placido_error_set(err, status, "%s: %s", object->name, reason.text);
    }
    w->count += status == PLACIDO_OK;
    w->failed += status == PLACIDO_OK && !result->passed;
  }
  return status;
}

static void print_zone(const struct settings *settings, const char *name,
                       const placido_iso_zone *zone) {
  char bounds[32];
  if (isinf(zone->outer_mm)) {
    snprintf(bounds, sizeof bounds, "over %g", zone->inner_mm);
  } else {
    snprintf(bounds, sizeof bounds, "%g to %g", zone->inner_mm, zone->outer_mm);
  }
  if (zone->points == 0) {
    say(settings, "%-28s %-7s %7d %5d", name, bounds, 0, 0);
    return;
  }
  say(settings, "%-28s %-7s %7ld %5.0f %+9.4f %8.4f %+10.3f %8.3f", name, bounds, zone->points,
      100 * zone->covered, zone->axial_mean_D, zone->axial_2sd_D, zone->elevation_mean_um,
      zone->elevation_2sd_um);
}

static void print_table(const struct work *w) {
  const struct settings *settings = w->settings;
  say(settings, "%-28s %-7s %7s %5s %9s %8s %10s %8s", "object", "zone mm", "points", "%",
      "axial D", "2 SD", "height um", "2 SD");
  for (size_t i = 0; i < w->count; i++) {
    const placido_iso_result *result = &w->results[i];
    if (result->failure[0] != '\0') {
      say(settings, "%-28s not measured: %s", result->object, result->failure);
      continue;
    }
    for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
      print_zone(settings, k == 0 ? result->object : "", &result->zones[k]);
    }
  }
}

static void print_checks(const struct work *w) {
  say(w->settings, "\n%s\nAxial power: |mean| + 2 SD. Elevation: rms about its mean.",
      iso_targets_note);
  for (size_t i = 0; i < w->count; i++) {
    const placido_iso_result *result = &w->results[i];
    for (size_t k = 0; k < result->check_count; k++) {
      const placido_iso_check *check = &result->checks[k];
      say(w->settings, "%-28s %-24s %9.4f of %-5g %-4s %s", result->object, check->name,
          check->value, check->limit, check->unit, check->passed ? "passed" : "FAILED");
    }
  }
}

static int save(struct work *w, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const char *folder = w->directory.temporary;
  stages_next(&w->outcome->stages, "files");
  int status = placido_path_join(path, folder, "iso-check.csv", err);
  if (status == PLACIDO_OK) {
    status = iso_save_csv(w->results, w->count, path, err);
  }
  if (status == PLACIDO_OK) {
    status = figures_iso(w->results, w->count, w->instrument.name, w->created, folder,
                         &w->outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, MARKER, err);
  }
  if (status == PLACIDO_OK) {
    status = iso_save_json(w->results, w->count, w->instrument.name, w->created, path, err);
  }
  interrupt_hold(w->outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_directory_commit(&w->directory, err);
  }
  interrupt_release(w->outcome->interrupt, &w->directory);
  return status;
}

static int conclude(struct work *w, placido_error *err) {
  const int status = w->settings->output ? save(w, err) : PLACIDO_OK;
  stages_end(&w->outcome->stages);
  print_table(w);
  print_checks(w);
  if (status == PLACIDO_OK && w->failed > 0) {
    return placido_error_set(err, PLACIDO_QUALITY, "%zu of %zu objects miss the targets",
                             w->failed, w->count);
  }
  return status;
}

static int make_place(struct work *w, placido_error *err) {
  if (!w->settings->output) {
    return PLACIDO_OK;
  }
  int status = place_check(w->settings->output, MARKER, err);
  if (status == PLACIDO_OK) {
    interrupt_hold(w->outcome->interrupt);
    status = placido_directory_create(&w->directory, w->settings->output, MARKER, err);
    interrupt_release(w->outcome->interrupt, &w->directory);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct work *w = placido_memory_new(1, sizeof *w, err);
  if (!w) {
    return PLACIDO_MEMORY;
  }
  w->settings = settings;
  w->outcome = outcome;
  int status = prepare(w, err);
  if (status == PLACIDO_OK) {
    status = make_place(w, err);
  }
  if (status == PLACIDO_OK) {
    status = measure(w, err);
  }
  if (status == PLACIDO_OK) {
    status = conclude(w, err);
    outcome->result = iso_result_json(w->results, w->count, w->instrument.name, w->created);
  }
  placido_directory_discard(&w->directory);
  iso_objects_free(&w->objects);
  placido_memory_free(w);
  return status;
}

static const struct option_group *const groups[] = {&options_iso, &options_general, NULL};

const struct command command_iso_check = {
    .name = "iso-check",
    .summary = "Measure objects of known shape: accuracy by zone, as ISO 19980 tests it.",
    .usage = "[OPTION...]",
    .examples =
        "  placido iso-check -o accuracy\n"
        "      spheres, a toric and ellipsoids, rendered and measured: accuracy/iso-check.html\n"
        "  placido iso-check --instrument cone.json --image a.png --sphere 6.5 \\\n"
        "      --image b.png --sphere 9.4 --axis-z 0.02,-0.01 -o accuracy\n"
        "      pictures of real balls; --surface FILE where the object is no sphere\n"
        "  placido iso-check --instrument cone.json --list objects.csv\n"
        "      a line each: image, radius or surface file, axis-z\n",
    .groups = groups,
    .run = run,
};

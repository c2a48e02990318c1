/* `placido compare`: what changed between two exams of an eye, or sets a person's eyes apart. */
#include "acquire/cli/compare.h"

#include "acquire/cli/place.h"
#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static const double degrees = 57.29577951308232;

/* Eyes of one side are compared as they are, those of both sides mirrored. */
static void check_sides(const struct comparison *c) {
  const char *first = c->exams[0].eye, *second = c->exams[1].eye;
  bool known = first[0] && second[0], same = strcmp(first, second) == 0;
  if (known && !same && !c->settings->compare.mirror) {
    placido_notes_add(&c->outcome->notes, "%s is compared with %s as it is (--mirror)", first,
                      second);
  } else if (known && same && c->settings->compare.mirror) {
    placido_notes_add(&c->outcome->notes, "both exams are of %s, and one of them is mirrored",
                      first);
  }
}

static int read_exams(struct comparison *c, placido_error *err) {
  const struct settings *settings = c->settings;
  placido_notes *notes = &c->outcome->notes;
  stages_next(&c->outcome->stages, "read");
  int status = compared_exam_load(&c->exams[0], settings->input, false, notes, err);
  if (status == PLACIDO_OK) {
    status = compared_exam_load(&c->exams[1], settings->more.values[0], settings->compare.mirror,
                                notes, err);
  }
  if (status == PLACIDO_OK) {
    check_sides(c);
    compared_indices_find(c);
  }
  return status;
}

static int find_difference(struct comparison *c, placido_error *err) {
  const placido_measured *first = &c->exams[0].measured, *second = &c->exams[1].measured;
  int status = PLACIDO_OK;
  if (!c->settings->compare.no_align) {
    stages_next(&c->outcome->stages, "align");
    status = placido_align(&c->alignment, first, second, err);
  }
  stages_next(&c->outcome->stages, "difference");
  return status == PLACIDO_OK
             ? placido_difference_new(&c->difference, first, second, &c->alignment, err)
             : status;
}

static int save(struct comparison *c, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const char *folder = c->directory.temporary;
  stages_next(&c->outcome->stages, "files and figures");
  int status = placido_path_join(path, folder, "difference.csv", err);
  if (status == PLACIDO_OK) {
    status = placido_difference_save(&c->difference, path, err);
  }
  if (status == PLACIDO_OK) {
    status = comparison_draw(c, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, COMPARE_MARKER, err);
  }
  if (status == PLACIDO_OK) {
    c->outcome->result = comparison_json(c);
    status = c->outcome->result
                 ? placido_json_save(c->outcome->result, path, err)
                 : placido_error_set(err, PLACIDO_MEMORY, "out of memory for the comparison");
  }
  interrupt_hold(c->outcome->interrupt);
  if (status == PLACIDO_OK) {
    status = placido_directory_commit(&c->directory, err);
  }
  interrupt_release(c->outcome->interrupt, &c->directory);
  return status;
}

static void print_alignment(const struct comparison *c) {
  const placido_alignment *a = &c->alignment;
  if (!a->aligned) {
    say(c->settings, "not aligned");
    return;
  }
  say(c->settings,
      "aligned at %zu points, %.3f to %.3f µm rms: shift %+.3f ± %.3f, %+.3f ± %.3f mm", a->points,
      a->rms_before_um, a->rms_um, a->terms[PLACIDO_SHIFT_X], a->sigmas[PLACIDO_SHIFT_X],
      a->terms[PLACIDO_SHIFT_Y], a->sigmas[PLACIDO_SHIFT_Y]);
  say(c->settings, "tilt %+.2f ± %.2f, %+.2f ± %.2f°, cyclotorsion %+.2f ± %.2f°",
      degrees * a->terms[PLACIDO_TILT_X], degrees * a->sigmas[PLACIDO_TILT_X],
      degrees * a->terms[PLACIDO_TILT_Y], degrees * a->sigmas[PLACIDO_TILT_Y],
      degrees * a->terms[PLACIDO_TORSION], degrees * a->sigmas[PLACIDO_TORSION]);
}

static void print_zones(const struct comparison *c) {
  say(c->settings, "%-12s %-8s %9s %9s %9s %14s", "difference", "zone mm", "mean", "2 SD",
      "largest", "significant %");
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    for (int z = 0; z < PLACIDO_DIFFERENCE_ZONES; z++) {
      enum placido_difference_kind kind = (enum placido_difference_kind)k;
      const double *bounds = placido_difference_zone_mm(z);
      placido_difference_zone zone =
          placido_difference_zone_find(&c->difference, kind, bounds[0], bounds[1]);
      say(c->settings, "%-12s %g to %-3g %+9.3f %9.3f %+9.3f %10.0f %s",
          z == 0 ? placido_difference_name(kind) : "", bounds[0], bounds[1], zone.mean,
          2 * zone.deviation, zone.largest, 100 * zone.significant, placido_difference_unit(kind));
    }
  }
}

static void print_changes(const struct comparison *c) {
  for (size_t k = 0; k < c->change_count; k++) {
    const struct compared_change *change = &c->changes[k];
    if (isfinite(change->sigma) && fabs(change->difference) > 2 * change->sigma) {
      say(c->settings, "changed: %-26s %+9.3f ± %.3f %s", change->name, change->difference,
          change->sigma, change->unit);
    }
  }
}

static int check_words(const struct settings *settings, placido_error *err) {
  if (settings->more.count == 1 && settings->more.values[0][0] != '\0') {
    return PLACIDO_OK;
  }
  return placido_error_set(err, STATUS_USAGE, "two exams are compared: EXAM_A EXAM_B, not %zu",
                           1 + settings->more.count);
}

static int make_place(struct comparison *c, placido_error *err) {
  int status = place_check(c->settings->output, COMPARE_MARKER, err);
  if (status == PLACIDO_OK) {
    interrupt_hold(c->outcome->interrupt);
    status = placido_directory_create(&c->directory, c->settings->output, COMPARE_MARKER, err);
    interrupt_release(c->outcome->interrupt, &c->directory);
  }
  return status;
}

static void note_time(char created[32]) {
  const time_t now = time(NULL);
  struct tm utc;
  if (!gmtime_r(&now, &utc) || strftime(created, 32, "%Y-%m-%dT%H:%M:%SZ", &utc) == 0) {
    created[0] = '\0';
  }
}

static int compare(struct comparison *c, placido_error *err) {
  int status = check_words(c->settings, err);
  if (status == PLACIDO_OK) {
    status = make_place(c, err);
  }
  if (status == PLACIDO_OK) {
    status = read_exams(c, err);
  }
  if (status == PLACIDO_OK) {
    status = find_difference(c, err);
  }
  if (status == PLACIDO_OK) {
    status = save(c, err);
  }
  stages_end(&c->outcome->stages);
  if (status == PLACIDO_OK) {
    print_alignment(c);
    print_zones(c);
    print_changes(c);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct comparison *c = placido_memory_new(1, sizeof *c, err);
  if (!c) {
    return PLACIDO_MEMORY;
  }
  c->settings = settings;
  c->outcome = outcome;
  note_time(c->created);
  settings_use_threads(settings);
  const int status = compare(c, err);
  placido_directory_discard(&c->directory);
  placido_difference_free(&c->difference);
  placido_measured_free(&c->exams[0].measured);
  placido_measured_free(&c->exams[1].measured);
  placido_memory_free(c);
  return status;
}

static const struct option_group *const groups[] = {&options_directory, &options_compare,
                                                    &options_general, NULL};

const struct command command_compare = {
    .name = "compare",
    .summary = "Two exams of one eye, or of both eyes: what differs, and how sure that is.",
    .usage = "EXAM_A EXAM_B -o DIR [OPTION...]",
    .examples =
        "  placido compare exam-january exam-june -o change\n"
        "      aligns the second with the first; difference maps, with what is significant\n"
        "  placido compare right left --mirror -o asymmetry\n",
    .groups = groups,
    .needs_word = "EXAM_A",
    .may_have_more = true,
    .needs_output = true,
    .run = run,
};

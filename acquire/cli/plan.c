/* `placido plan`: which effects would be seen in a scene, before anything is computed. */
#include "acquire/cli/command.h"
#include "acquire/cli/plan_json.h"
#include "acquire/cli/views.h"

#include <stdio.h>

/* Who looks at what. */
struct onlooker {
  placido_surface *surface;
  placido_scene scene;
};

static int check(const struct settings *settings, const struct number_list *pupils,
                 placido_error *err) {
  if (!settings->eye) {
    return placido_error_set(err, STATUS_USAGE,
                             "--eye SURFACE.json is missing: whose eye looks (placido help plan)");
  }
  if (settings->output && pupils->count > 1) {
    return placido_error_set(err, STATUS_USAGE,
                             "-o takes one plan: give one pupil, or --json for all of them");
  }
  const int status = eye_settings_check(settings, err);
  return status == PLACIDO_OK ? views_check_pupils(pupils, err) : status;
}

static int load(struct onlooker *onlooker, const struct settings *settings,
                const struct number_list *pupils, placido_notes *notes, placido_error *err) {
  int status = placido_scene_load(&onlooker->scene, settings->input, views_chart_scale(settings),
                                  notes, err);
  if (status == PLACIDO_OK) {
    onlooker->scene.allow_coarse |= settings->allow_coarse;
    status = plan_settings_check_scene(pupils, &onlooker->scene, err);
  }
  return status == PLACIDO_OK
             ? placido_surface_load(&onlooker->surface, settings->eye, notes, err)
             : status;
}

/* What becomes of a plan: text for people, an object for machines, a file. */
static int hand_out(const placido_plan *plan, const struct settings *settings, json_t *list,
                    placido_error *err) {
  int status = PLACIDO_OK;
  if (settings->json) {
    status = plan_json_append(list, plan, err);
  } else if (!settings->quiet) {
    status = placido_plan_write(plan, stdout, err);
  }
  if (status == PLACIDO_OK && settings->output) {
    status = placido_plan_save(plan, settings->output, err);
  }
  return status;
}

static int plan_pupil(const struct onlooker *onlooker, const struct settings *settings,
                      double pupil_mm, json_t *list, placido_notes *notes, placido_error *err) {
  const placido_plan_wish wish = plan_settings_read(settings, settings_use_threads(settings));
  placido_plan *plan = NULL;
  placido_eye eye;
  int status = eye_settings_read(&eye, settings, pupil_mm, err);
  if (status == PLACIDO_OK) {
    status = placido_plan_new(&plan, onlooker->surface, &eye, &onlooker->scene, &wish, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = hand_out(plan, settings, list, err);
  }
  placido_plan_free(plan);
  return status;
}

static int plan_pupils(const struct onlooker *onlooker, const struct settings *settings,
                       const struct number_list *pupils, json_t *list, placido_notes *notes,
                       placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < pupils->count && status == PLACIDO_OK; i++) {
    if (i > 0) {
      say(settings, "%s", "");
    }
    status = plan_pupil(onlooker, settings, pupils->values[i], list, notes, err);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  static const struct number_list automatic = {.count = 1, .values = {PUPIL_AUTO}};
  const struct number_list *pupils =
      settings->plan.pupils_mm.count > 0 ? &settings->plan.pupils_mm : &automatic;
  struct onlooker onlooker = {0};
  json_t *list = json_array();
  int status = check(settings, pupils, err);
  if (status == PLACIDO_OK) {
    stages_next(&outcome->stages, "read");
    status = load(&onlooker, settings, pupils, &outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    stages_next(&outcome->stages, "plan");
    status = plan_pupils(&onlooker, settings, pupils, list, &outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    outcome->result = json_pack("{sO}", "plans", list);
  }
  json_decref(list);
  placido_surface_free(onlooker.surface);
  placido_scene_free(&onlooker.scene);
  return status;
}

#define FIELD(name) offsetof(struct settings, name)

static const struct option_row rows[] = {
    {"eye", 0, "SURFACE.json", "The cornea of the eye that looks (placido-surface/1).", FIELD(eye),
     parse_text, 0, 0},
    {"pupils", 0, "MM,MM,...", "Diameters of the pupil, mm, a plan each; \"auto\" among them: what "
     "the scene's luminance gives (default auto).", FIELD(plan.pupils_mm), parse_pupils, 0.1, 12},
    {"output", 'o', "FILE.json", "Write the plan to this file, too (placido-plan/1); one pupil.",
     FIELD(output), parse_text, 0, 0},
    {"bucket", 0, "ARCMIN", "Width of a bucket of the seen picture, minutes of arc (default 0.5).",
     FIELD(bucket_arcmin), parse_number, 0.01, 10},
    {"index", 0, "N", "Refractive index behind the cornea (default 1.3375).", FIELD(index),
     parse_number, 1.01, 2},
    {"allow-coarse", 0, NULL, "Take scenes whose pixels are larger than the buckets, too.",
     FIELD(allow_coarse), parse_switch, 0, 0},
};

const struct option_group options_plan = {"Plan", rows, sizeof rows / sizeof rows[0]};

static const struct option_group *const groups[] = {&options_plan, &options_effects, &options_eye,
                                                    &options_general, NULL};

static void list_all(void) {
  plan_list_effects();
  views_list_charts();
}

const struct command command_plan = {
    .name = "plan",
    .summary = "Tell which effects would be seen in a scene, and why, before anything runs.",
    .usage = "SCENE --eye SURFACE.json [OPTION...]",
    .examples =
        "  placido plan street --eye exam/surface.json\n"
        "      through the pupil that the street's light gives at 35\n"
        "  placido plan building --eye exam/surface.json --pupils 2,4 --tolerance 0.003\n"
        "      through two pupils, errors being at most 0.3 % of white\n"
        "  placido plan page --eye exam/surface.json --age 65 --force off straylight --json\n"
        "      at 65 years, and never with straylight\n",
    .groups = groups,
    .list = list_all,
    .needs_word = "SCENE (a chart's name or a placido-scene/1 file)",
    .run = run,
};

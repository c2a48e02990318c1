/* The step that looks: for every pupil the point spread function, then each scene planned and run.
 * A pupil that the surface cannot fill and a scene too coarse for its buckets are left out with a
 * warning: the rest is worth having. */
#include "acquire/cli/examination.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define FOCUS_STEPS 41

/* What has no good answer is told and left out; other failures end the command. `err` has the
 * reason of either. */
static int leave_out(struct examination *examination, int status, const placido_error *reason,
                     placido_error *err) {
  if (status == PLACIDO_OK) {
    return PLACIDO_OK;
  }
  placido_error_set(err, status, "%s", reason->text);
  if (status == PLACIDO_QUALITY) {
    placido_notes_add(&examination->outcome->notes, "left out: %s", reason->text);
    return PLACIDO_OK;
  }
  return status;
}

static int see_psf(struct examination *examination, struct view *view, const placido_eye *eye,
                   placido_error *err) {
  const struct settings *settings = examination->settings;
  struct stages *stages = &examination->outcome->stages;
  const double reach_D = settings->rays.through_focus_D;
  const placido_optics optics = ray_settings_read(settings, examination->threads);
  stages_next(stages, "psf %.3g mm", eye->pupil_mm);
  int status = placido_psf_new(&view->psf, &view->eye, examination->surface, eye, &optics,
                               &examination->outcome->notes, err);
  promise_pupil_done(&examination->promise);
  view->seconds = stages_elapsed(stages);
  view->strehl_g_sigma = NAN;
  if (status == PLACIDO_OK && reach_D > 0) {
    stages_next(stages, "focus %.3g mm", eye->pupil_mm);
    status = placido_focus_curve_new(&view->focus, examination->surface, &view->eye, &optics,
                                     -reach_D, reach_D, FOCUS_STEPS, err);
  }
  if (status != PLACIDO_OK) {
    placido_psf_free(&view->psf);
  }
  return status;
}

static int plan_scene(placido_plan **plan, struct examination *examination, size_t scene,
                      const placido_eye *eye, placido_error *err) {
  placido_error reason = {0};
  const int status = promise_plan(plan, examination, scene, eye, &reason);
  return leave_out(examination, status, &reason, err);
}

/* As CWhatUC saw: by the pupil's own point spread function, without effects. */
static int see_plainly(placido_image *seen, struct examination *examination,
                       const struct view *view, size_t scene, placido_error *err) {
  char folder[PLACIDO_PATH_MAX];
  placido_notes *notes = &examination->outcome->notes;
  const placido_convolution how =
      spread_settings_read(folder, examination->settings, examination->threads, notes);
  return placido_scene_see_as(seen, &examination->views.scenes[scene], &view->psf, &how, notes,
                              err);
}

static int see_scene(struct examination *examination, struct view *view, size_t scene,
                     placido_error *err) {
  struct sight *sight = &view->sights[scene];
  const placido_scene *from = &examination->views.scenes[scene];
  struct stages *stages = &examination->outcome->stages;
  placido_error reason = {0};
  const double begun_s = stages_elapsed(stages);
  const int status = sight->plan ? placido_plan_run(&sight->image, NULL, sight->plan, &reason)
                                 : see_plainly(&sight->image, examination, view, scene, &reason);
  sight->run_s = stages_elapsed(stages) - begun_s;
  if (status == PLACIDO_OK) {
    placido_image_to_srgb(&sight->image);
  }
  if (status == PLACIDO_OK && placido_scene_coarse(from, &view->psf)) {
    placido_notes_add(&examination->outcome->notes,
                      "scene %s is coarse: a pixel is %.4g', the PSF's bucket %.4g'; blur finer "
                      "than a pixel is not real", from->name, from->arcmin_per_px,
                      view->psf.bucket_arcmin);
  }
  return leave_out(examination, status, &reason, err);
}

/* Every scene that has a plan; without effects every scene. */
static int see_scenes(struct examination *examination, struct view *view, placido_error *err) {
  int status = PLACIDO_OK;
  stages_next(&examination->outcome->stages, "run %.3g mm", view->psf.pupil_mm);
  for (size_t i = 0; i < examination->views.scene_count && status == PLACIDO_OK; i++) {
    if (view->sights[i].plan || examination->settings->cwhatuc) {
      status = see_scene(examination, view, i, err);
    }
  }
  return status;
}

/* A pupil that is given sees every scene. */
static int see_pupil(struct examination *examination, double pupil_mm, placido_error *err) {
  struct views *views = &examination->views;
  struct view *view = &views->items[views->count];
  placido_eye eye;
  int status = eye_settings_read(&eye, examination->settings, pupil_mm, err);
  if (status == PLACIDO_OK) {
    status = see_psf(examination, view, &eye, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  views_name_pupil(view->directory, pupil_mm, false);
  views->count++;
  stages_next(&examination->outcome->stages, "plan %.3g mm", pupil_mm);
  for (size_t i = 0; i < views->scene_count && status == PLACIDO_OK; i++) {
    if (!examination->settings->cwhatuc) {
      status = plan_scene(&view->sights[i].plan, examination, i, &eye, err);
    }
  }
  return status == PLACIDO_OK ? see_scenes(examination, view, err) : status;
}

/* The view of a plan's pupil: one that is there to a tenth of a millimetre, or a new one. */
static int find_view(struct view **found, struct examination *examination,
                     const placido_plan *plan, placido_error *err) {
  struct views *views = &examination->views;
  const placido_eye *eye = placido_plan_eye(plan);
  char directory[32];
  views_name_pupil(directory, eye->pupil_mm, true);
  for (size_t i = 0; i < views->count; i++) {
    if (strcmp(views->items[i].directory, directory) == 0) {
      *found = &views->items[i];
      return PLACIDO_OK;
    }
  }
  struct view *view = *found = &views->items[views->count];
  const int status = see_psf(examination, view, eye, err);
  if (status == PLACIDO_OK) {
    view->automatic = true;
    memcpy(view->directory, directory, sizeof view->directory);
    views->count++;
  }
  return status;
}

/* Hands every plan to the view of its pupil; a pupil that was given has seen all scenes already. */
static int sort_plans(placido_plan *plans[], struct examination *examination,
                      placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < examination->views.scene_count && status == PLACIDO_OK; i++) {
    struct view *view = NULL;
    placido_error reason = {0};
    if (plans[i]) {
      status = find_view(&view, examination, plans[i], &reason);
    }
    if (plans[i] && status == PLACIDO_OK && view->automatic) {
      view->sights[i].plan = plans[i];
      plans[i] = NULL;
    }
    status = leave_out(examination, status, &reason, err);
  }
  return status;
}

/* Every scene through the pupil that its light gives. */
static int see_automatic(struct examination *examination, placido_error *err) {
  struct views *views = &examination->views;
  placido_plan *plans[LIST_MAX] = {0};
  placido_eye eye;
  int status = eye_settings_read(&eye, examination->settings, PUPIL_AUTO, err);
  stages_next(&examination->outcome->stages, "plan auto");
  for (size_t i = 0; i < views->scene_count && status == PLACIDO_OK; i++) {
    status = plan_scene(&plans[i], examination, i, &eye, err);
  }
  if (status == PLACIDO_OK) {
    status = sort_plans(plans, examination, err);
  }
  for (size_t i = 0; i < views->scene_count; i++) {
    placido_plan_free(plans[i]);
  }
  for (size_t i = 0; i < views->count && status == PLACIDO_OK; i++) {
    if (views->items[i].automatic) {
      status = see_scenes(examination, &views->items[i], err);
    }
  }
  return status;
}

static int see_given(struct examination *examination, placido_error *reason) {
  const struct number_list *pupils = &examination->settings->pupils_mm;
  for (size_t i = 0; i < pupils->count; i++) {
    const double pupil_mm = pupils->values[i];
    const int status =
        pupil_mm == PUPIL_AUTO ? PLACIDO_OK : see_pupil(examination, pupil_mm, reason);
    if (status == PLACIDO_QUALITY) {
      placido_notes_add(&examination->outcome->notes, "pupil of %g mm left out: %s", pupil_mm,
                        reason->text);
    } else if (status != PLACIDO_OK) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static bool wants_automatic(const struct number_list *pupils) {
  for (size_t i = 0; i < pupils->count; i++) {
    if (pupils->values[i] == PUPIL_AUTO) {
      return true;
    }
  }
  return false;
}

int step_see(struct examination *examination, placido_error *err) {
  placido_error reason = {0};
  int status = see_given(examination, &reason);
  if (status == PLACIDO_OK && wants_automatic(&examination->settings->pupils_mm)) {
    status = see_automatic(examination, &reason);
  }
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  if (examination->views.count == 0 && !examination->fit) {
    return placido_error_set(err, PLACIDO_QUALITY, "no pupil can be simulated: %s", reason.text);
  }
  return PLACIDO_OK;
}

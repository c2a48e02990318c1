/* A view: begun with the cornea alone, handed from effect to effect, and taken down again. */
#include "base/memory.h"
#include "simulate/bleed.h"
#include "simulate/canvas.h"
#include "simulate/plan/run.h"
#include "simulate/spectrum/spectrum.h"

/* One wavelength, in focus: nothing that is seen follows from which it is until light diffracts. */
static placido_light single_light(const placido_conditions *conditions) {
  placido_light light = {.count = 1};
  light.waves[0].wavelength_nm = placido_spectrum_focus_nm(conditions);
  light.waves[0].weight = 1;
  return light;
}

static int begin(placido_view *view, placido_scene_canvas *canvas, const placido_run *run,
                 placido_error *err) {
  const placido_plan_settings *settings = run->settings;
  *view = (placido_view){.surface = run->surface,
                         .scene = run->scene,
                         .facts = run->facts,
                         .settings = settings,
                         .threads = run->threads,
                         .eye = *run->eye,
                         .open = run->open,
                         .light_count = 1,
                         .nodes = 1,
                         .core = 1};
  view->lights[0] = single_light(&run->scene->conditions);
  int status = placido_scene_canvas_new(canvas, run->scene, settings->bucket_arcmin,
                                        settings->buckets / 2, run->threads, err);
  if (status == PLACIDO_OK) {
    view->canvas = *canvas->image;
    view->bleed_px = canvas->bleed_px;
    view->holes = canvas->holes;
  }
  return status;
}

static void end(placido_view *view) {
  for (int i = 0; i < view->layer_count; i++) {
    placido_image_free(&view->layers[i].light);
    placido_memory_free(view->layers[i].cover);
  }
  placido_memory_free(view->layers);
  placido_psf_free(&view->psf);
  placido_image_free(&view->seen);
}

static int prepare(placido_view *view, void **state, const placido_effect *effect,
                   placido_error *err) {
  return effect->prepare != NULL ? effect->prepare(state, view, err) : PLACIDO_OK;
}

static int apply(placido_view *view, void *state, const placido_effect *effect,
                 placido_error *err) {
  return effect->apply != NULL ? effect->apply(state, view, err) : PLACIDO_OK;
}

static int act(placido_view *view, void **states, const placido_run *run, placido_error *err) {
  const placido_effect *const *effects = run->effects;
  int status = PLACIDO_OK;
  size_t images = 0; /* the first effect on the picture */
  for (; images < run->count && effects[images]->stage < PLACIDO_STAGE_IMAGE; images++) {
    status = prepare(view, &states[images], effects[images], err);
    if (status != PLACIDO_OK ||
        (status = apply(view, states[images], effects[images], err)) != PLACIDO_OK) {
      return status;
    }
  }
  for (size_t i = images; i < run->count && status == PLACIDO_OK; i++) {
    status = prepare(view, &states[i], effects[i], err);
  }
  if (status == PLACIDO_OK) {
    status = placido_view_spread(view, err);
  }
  for (size_t i = images; i < run->count && status == PLACIDO_OK; i++) {
    status = apply(view, states[i], effects[i], err);
  }
  return status;
}

/* What has become of the view goes to the caller. */
static void hand_over(placido_image *seen, placido_psf *psf, placido_view *view) {
  if (view->holes) {
    placido_scene_canvas_unweigh(&view->seen);
  }
  placido_bleed_cut(&view->seen, view->bleed_px);
  *seen = view->seen;
  view->seen = (placido_image){0};
  if (psf != NULL) {
    *psf = view->psf;
    view->psf = (placido_psf){0};
  }
}

int placido_view_run(placido_image *seen, placido_psf *psf, const placido_run *run,
                     placido_error *err) {
  placido_view view;
  placido_scene_canvas canvas;
  void *states[PLACIDO_EFFECTS_MAX] = {NULL};
  *seen = (placido_image){0};
  if (psf != NULL) {
    *psf = (placido_psf){0};
  }
  int status = begin(&view, &canvas, run, err);
  if (status == PLACIDO_OK) {
    status = act(&view, states, run, err);
  }
  if (status == PLACIDO_OK) {
    hand_over(seen, psf, &view);
  }
  for (size_t i = 0; i < run->count; i++) {
    if (run->effects[i]->release != NULL) {
      run->effects[i]->release(states[i]);
    }
  }
  end(&view);
  placido_scene_canvas_free(&canvas);
  return status;
}

/* Writes wavefront.json: terms and figures of every pupil, each with its standard deviation. */
#include "acquire/cli/wavefront.h"
#include "base/json.h"

#include <math.h>

/* Adds sigma and its sources to an object; a null reference says that memory is out. */
static json_t *with_spread(json_t *object, const struct spread *spread) {
  static const char *const names[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = "noise",
      [PLACIDO_SIGMA_DISTANCE] = "distance",
      [PLACIDO_SIGMA_GEOMETRY] = "geometry",
  };
  json_t *sources = json_object();
  bool failed = !object || json_object_set_new(object, "sigma", placido_json_real(spread->sigma));
  for (int k = 0; k < PLACIDO_SIGMA_SOURCES; k++) {
    failed = failed || json_object_set_new(sources, names[k], placido_json_real(spread->by[k]));
  }
  if (failed || json_object_set(object, "sources", sources) != 0) {
    json_decref(object);
    object = NULL;
  }
  json_decref(sources);
  return object;
}

static json_t *write_term(const struct wavefront_view *view, int j) {
  int n, m;
  placido_zernike_name(j, &n, &m);
  return with_spread(json_pack("{s:i, s:i, s:i, s:o}", "index", j, "n", n, "m", m, "value",
                               placido_json_real(view->front.coefficients_um[j])),
                     &view->terms[j]);
}

static json_t *write_figure(const struct wavefront_view *view, size_t i) {
  size_t count;
  const placido_wavefront_figure *figure = &placido_wavefront_figures(&count)[i];
  return with_spread(json_pack("{s:s, s:s, s:o, s:s}", "name", figure->name, "unit", figure->unit,
                               "value", placido_json_real(view->figures[i]), "help",
                               figure->help),
                     &view->figure_spreads[i]);
}

static json_t *write_view(const struct wavefront_view *view) {
  const placido_wavefront *w = &view->front;
  size_t count;
  placido_wavefront_figures(&count);
  json_t *terms = json_array(), *figures = json_array();
  bool failed = false;
  for (int j = 0; j < w->term_count; j++) {
    failed = json_array_append_new(terms, write_term(view, j)) != 0 || failed;
  }
  for (size_t i = 0; i < count && i < WAVEFRONT_FIGURES_MAX; i++) {
    failed = json_array_append_new(figures, write_figure(view, i)) != 0 || failed;
  }
  json_t *object = json_pack(
      "{s:f, s:[f,f], s:f, s:i, s:[f,f,f], s:i, s:f, s:f, s:f, s:o, s:o}", "pupil_mm",
      w->eye.pupil_mm, "centre_mm", w->eye.pupil_x_mm, w->eye.pupil_y_mm, "refractive_index",
      w->eye.index, "order", w->order, "focus_mm", w->focus_mm[0], w->focus_mm[1], w->focus_mm[2],
      "rays", (int)w->count, "missing", w->missing, "rms_um", w->rms_um, "rest_um", w->rest_um,
      "terms", terms, "figures", figures);
  if (failed) {
    json_decref(object);
    object = NULL;
  }
  return object;
}

int wavefronts_save(const struct wavefronts *wavefronts, const char *path, placido_error *err) {
  json_t *pupils = json_array();
  bool failed = !pupils;
  for (size_t i = 0; i < wavefronts->count; i++) {
    failed = json_array_append_new(pupils, write_view(&wavefronts->items[i])) != 0 || failed;
  }
  json_t *root = json_pack("{s:s, s:o}", "format", "placido-wavefront/1", "pupils", pupils);
  const int status = placido_json_save(failed ? NULL : root, path, err);
  json_decref(root);
  return status;
}
